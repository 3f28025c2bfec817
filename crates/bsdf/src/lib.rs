//! Scattering models: what is evaluated and sampled.
//!
//! `f = dL_s / dE_i` in 1/sr, no cosine inside (docs/conventions.md). Directions leave the surface; a model answers
//! for both sides and both components, and returns 0 where it does not scatter.

pub mod albedo;
pub mod analytic;
pub mod batch;
pub mod channel;
pub mod compact;
pub mod components;
pub mod cone;
pub mod error;
pub mod half_difference;
pub mod klems;
pub mod quantity;
pub mod radiance;
pub mod rgl;
pub mod tensor_tree;
#[cfg(test)]
mod testing;
pub mod traits;

pub use albedo::directional_albedo;
pub use channel::Channel;
pub use compact::Compact;
pub use components::FourComponents;
pub use error::BsdfError;
pub use half_difference::HalfDifference;
pub use quantity::Quantity;
pub use radiance::RadianceMaterial;
pub use rgl::Rgl;
pub use traits::{Bsdf, Lobe, Properties, Sample};
