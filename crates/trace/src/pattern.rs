//! What changes a surface or a light from place to place.

use std::sync::Arc;

use glam::Vec3;
use gonio_bsdf::Bsdf;

/// A factor on the colour of a surface, or on the light that it emits.
pub trait Pattern: Send + Sync {
    /// The factor in red, green and blue at a point, for a ray of unit direction that arrives there; `normal` is the unit
    /// normal of the front. At infinity the point is the origin and `normal` opposite to the ray.
    fn multiplier(&self, point: Vec3, normal: Vec3, direction: Vec3) -> Vec3;
}

/// A pattern on a material.
#[derive(Clone)]
pub struct Paint {
    /// The factor.
    pub pattern: Arc<dyn Pattern>,
    /// The part of the material that it does not touch, such as the gloss of plastic: the material with a black pattern.
    pub bare: Option<Arc<dyn Bsdf>>,
}

/// All factors of a list, multiplied.
#[derive(Clone)]
pub struct Product(pub Vec<Arc<dyn Pattern>>);

impl Pattern for Product {
    fn multiplier(&self, point: Vec3, normal: Vec3, direction: Vec3) -> Vec3 {
        let each = self.0.iter().map(|p| p.multiplier(point, normal, direction));
        each.fold(Vec3::ONE, |a, b| a * b)
    }
}

/// Light that leaves within a cone only: a spotlight.
#[derive(Clone, Copy, Debug)]
pub struct Cone {
    /// Where the light goes, unit.
    pub axis: Vec3,
    /// Cosine of half the angle of the cone.
    pub cos: f32,
}

impl Pattern for Cone {
    fn multiplier(&self, _point: Vec3, _normal: Vec3, direction: Vec3) -> Vec3 {
        if -direction.dot(self.axis) >= self.cos {
            Vec3::ONE
        } else {
            Vec3::ZERO
        }
    }
}
