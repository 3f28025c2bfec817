//! Sources of light that are sampled.

mod distant;
mod flat;
mod sky;
mod sphere;

pub use distant::Distant;
pub use flat::Flat;
pub use sky::Sky;
pub use sphere::Ball;

use glam::Vec3;

/// A direction towards a light.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Towards {
    /// Unit, from the point.
    pub(crate) direction: Vec3,
    /// How far the light is; infinite for a distant one.
    pub(crate) distance: f32,
    /// W/(m2 sr), each channel.
    pub(crate) radiance: Vec3,
    /// Per solid angle.
    pub(crate) pdf: f32,
}

/// A light source.
#[derive(Clone, Debug)]
pub enum Light {
    /// A polygon that emits on its front.
    Flat(Flat),
    /// A sphere that emits outward.
    Ball(Ball),
    /// A disk at infinity, such as the sun.
    Distant(Distant),
}

impl Light {
    /// Draws a direction towards it.
    #[inline]
    pub(crate) fn sample(&self, from: Vec3, u: [f32; 2]) -> Option<Towards> {
        match self {
            Light::Flat(light) => light.sample(from, u),
            Light::Ball(light) => light.sample(from, u),
            Light::Distant(light) => Some(light.sample(u)),
        }
    }

    /// Density per solid angle of a direction that meets it at a distance, under a cosine with its normal.
    #[inline]
    pub(crate) fn pdf(&self, from: Vec3, distance: f32, cos: f32) -> f32 {
        match self {
            Light::Flat(light) => light.pdf(distance, cos),
            Light::Ball(light) => light.pdf(from),
            Light::Distant(light) => light.pdf(),
        }
    }

    /// What it could at most bring to a point, roughly: for the choice between lights.
    #[inline]
    pub(crate) fn weight(&self, from: Vec3) -> f32 {
        match self {
            Light::Flat(light) => light.weight(from),
            Light::Ball(light) => light.weight(from),
            Light::Distant(light) => light.weight(),
        }
    }

    /// Unit normal of its front at a point of it; zero at infinity.
    pub(crate) fn normal(&self, point: Vec3) -> Vec3 {
        match self {
            Light::Flat(light) => light.normal(),
            Light::Ball(light) => light.normal(point),
            Light::Distant(_) => Vec3::ZERO,
        }
    }

    /// Its radiance without pattern, W/(m2 sr).
    #[inline]
    pub fn radiance(&self) -> Vec3 {
        match self {
            Light::Flat(light) => light.radiance,
            Light::Ball(light) => light.radiance,
            Light::Distant(light) => light.radiance,
        }
    }
}

/// All lights of a scene.
#[derive(Clone, Debug, Default)]
pub struct Lights {
    all: Vec<Light>,
}

impl Lights {
    pub(crate) fn new(all: Vec<Light>) -> Self {
        Lights { all }
    }

    #[inline]
    pub(crate) fn get(&self, k: u32) -> &Light {
        &self.all[k as usize]
    }

    #[inline]
    pub(crate) fn is_empty(&self) -> bool {
        self.all.is_empty()
    }

    /// Those at infinity.
    pub(crate) fn distant(&self) -> impl Iterator<Item = (u32, &Distant)> {
        self.all.iter().enumerate().filter_map(|(k, light)| match light {
            Light::Distant(d) => Some((k as u32, d)),
            _ => None,
        })
    }

    /// Chooses one by a uniform number: its index, its probability and the number left over.
    #[inline]
    pub(crate) fn choose(&self, from: Vec3, u: f32) -> Option<(u32, f32, f32)> {
        if self.all.len() == 1 {
            return Some((0, 1.0, u));
        }
        let total: f32 = self.all.iter().map(|l| l.weight(from)).sum();
        if total <= 0.0 {
            return None;
        }
        let mut left = u * total;
        for (k, light) in self.all.iter().enumerate() {
            let weight = light.weight(from);
            if left < weight {
                return Some((k as u32, weight / total, (left / weight).min(0.999_999_94)));
            }
            left -= weight;
        }
        None
    }

    /// The probability with which [`Lights::choose`] takes it.
    #[inline]
    pub(crate) fn probability(&self, from: Vec3, k: u32) -> f32 {
        if self.all.len() == 1 {
            return 1.0;
        }
        let total: f32 = self.all.iter().map(|l| l.weight(from)).sum();
        if total > 0.0 {
            self.all[k as usize].weight(from) / total
        } else {
            0.0
        }
    }
}
