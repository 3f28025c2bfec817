//! Microfacet models [Walter2007]: mirrors or smooth interfaces of a given distribution of normals and of Smith masking.
//!
//! A model puts together a [`Distribution`], its [`Widths`] and a [`Fresnel`] reflectance: [`Reflection`] of a surface,
//! [`Interface`] between two media. [`compensated`] lists models that give back the light facets throw onto each other. [`catalogue`] names the combinations that the registry lists.

pub mod beckmann;
pub mod catalogue;
pub mod compensation;
pub mod distribution;
mod escape;
pub mod fresnel;
pub mod ggx;
pub mod interface;
mod quadrature;
pub mod reflection;
pub mod widths;

pub use beckmann::Beckmann;
pub use catalogue::Catalogued;
pub use compensation::{Compensated, CompensatedFamily, compensated};
pub use distribution::Distribution;
pub use fresnel::{Conductor, Fresnel, Schlick};
pub use ggx::Ggx;
pub use interface::Interface;
pub use reflection::Reflection;
pub use widths::{Elliptic, Isotropic, Widths};
