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

/// What turns the normal of a surface without moving it.
pub trait Texture: Send + Sync {
    /// What is added to the unit normal of the front, at a point and for a ray as of [`Pattern::multiplier`].
    fn shift(&self, point: Vec3, normal: Vec3, direction: Vec3) -> Vec3;
}

/// All shifts of a list, added.
#[derive(Clone)]
pub struct Shifts(pub Vec<Arc<dyn Texture>>);

impl Texture for Shifts {
    fn shift(&self, point: Vec3, normal: Vec3, direction: Vec3) -> Vec3 {
        let each = self.0.iter().map(|t| t.shift(point, normal, direction));
        each.fold(Vec3::ZERO, |a, b| a + b)
    }
}

/// How a surface, or a part of a mixture, looks.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Layer {
    /// Index of its material; without meaning for a mixture.
    pub material: u32,
    /// Index of the pattern on its material.
    pub paint: Option<u32>,
    /// Index of what turns its normal.
    pub texture: Option<u32>,
    /// Index of the mixture that it is in place of a material.
    pub mixture: Option<u32>,
    /// Index of what turns it about its normal.
    pub up: Option<u32>,
}

/// Two looks, added in proportion.
#[derive(Clone)]
pub struct Mixture {
    /// Share of the first, from place to place; its first channel counts, within 0 to 1.
    pub share: Arc<dyn Pattern>,
    /// The two; mixtures among them stand before this one.
    pub layers: [Layer; 2],
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
