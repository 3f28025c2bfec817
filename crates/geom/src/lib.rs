//! Pure geometry of scattering: directions, spherical coordinates, warps, quadrature and spherical weights.
//!
//! Frame (docs/conventions.md): right-handed, `z` = outward normal of the sample's front, `x` = zero-azimuth mark.
//! Every [`Direction`] leaves the surface. Angles are radians.

pub mod angles;
pub mod delaunay;
pub mod direction;
pub mod disk;
pub mod half;
pub mod integrate;
pub mod quadrature;
pub mod side;
pub mod weights;

pub use angles::{Angles, EXTENDED_THETA, degrees};
pub use delaunay::{Delaunay, DelaunayError};
pub use direction::Direction;
pub use glam::DVec3;
pub use half::half_slope;
pub use side::{Component, Side};
