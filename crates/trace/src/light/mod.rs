//! Sources of light that are sampled.

mod distant;
mod flat;
mod pane;
mod portal;
mod sky;
mod sphere;

pub use distant::Distant;
pub use flat::Flat;
pub use pane::Pane;
pub(crate) use portal::{Openings, Seen};
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
    /// A rectangle that emits by direction.
    Pane(Pane),
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
            Light::Pane(light) => light.sample(from, u),
            Light::Distant(light) => Some(light.sample(u)),
        }
    }

    /// Density per solid angle of a direction that meets it at a distance, under a cosine with its normal.
    #[inline]
    pub(crate) fn pdf(&self, from: Vec3, direction: Vec3, distance: f32, cos: f32) -> f32 {
        match self {
            Light::Flat(light) => light.pdf(distance, cos),
            Light::Ball(light) => light.pdf(from),
            Light::Pane(light) => light.pdf(from, direction),
            Light::Distant(light) => light.pdf(),
        }
    }

    /// What it could at most bring to a point, roughly: for the choice between lights.
    #[inline]
    pub(crate) fn weight(&self, from: Vec3) -> f32 {
        match self {
            Light::Flat(light) => light.weight(from),
            Light::Ball(light) => light.weight(from),
            Light::Pane(light) => light.weight(from),
            Light::Distant(light) => light.weight(),
        }
    }

    /// Unit normal of its front at a point of it; zero at infinity.
    pub(crate) fn normal(&self, point: Vec3) -> Vec3 {
        match self {
            Light::Flat(light) => light.normal(),
            Light::Ball(light) => light.normal(point),
            Light::Pane(light) => light.normal(),
            Light::Distant(_) => Vec3::ZERO,
        }
    }

    /// Its radiance without pattern, W/(m2 sr).
    #[inline]
    pub fn radiance(&self) -> Vec3 {
        match self {
            Light::Flat(light) => light.radiance,
            Light::Ball(light) => light.radiance,
            Light::Pane(light) => light.radiance,
            Light::Distant(light) => light.radiance,
        }
    }
}

/// All lights of a scene. One of those at infinity is drawn, and one of the others: what the sun could bring, it mostly
/// brings to all points or to none, and says nothing of lamps.
#[derive(Clone, Debug, Default)]
pub struct Lights {
    all: Vec<Light>,
    near: Vec<u32>,
    far: Vec<u32>,
}

impl Lights {
    pub(crate) fn new(all: Vec<Light>) -> Self {
        let mut lights = Lights::default();
        for light in all {
            lights.push(light);
        }
        lights
    }

    /// Adds a light; its index.
    pub(crate) fn push(&mut self, light: Light) -> u32 {
        let k = self.all.len() as u32;
        self.group_mut(&light).push(k);
        self.all.push(light);
        k
    }

    #[inline]
    pub(crate) fn get(&self, k: u32) -> &Light {
        &self.all[k as usize]
    }

    fn group_mut(&mut self, light: &Light) -> &mut Vec<u32> {
        match light {
            Light::Distant(_) => &mut self.far,
            _ => &mut self.near,
        }
    }

    /// Whether all of them are flat.
    pub(crate) fn all_flat(&self) -> bool {
        self.all.iter().all(|l| matches!(l, Light::Flat(_)))
    }

    /// [`Lights::choose_near`] where all are flat: the light and its probability.
    #[inline(always)]
    pub(crate) fn choose_flat(&self, from: Vec3, u: f32) -> Option<(&Flat, f32)> {
        let (k, chance) = self.choose_near(from, u)?;
        match self.get(k) {
            Light::Flat(flat) => Some((flat, chance)),
            _ => None,
        }
    }

    /// Those at infinity.
    pub(crate) fn distant(&self) -> impl Iterator<Item = (u32, &Distant)> {
        self.far.iter().filter_map(|k| match self.get(*k) {
            Light::Distant(d) => Some((*k, d)),
            _ => None,
        })
    }

    /// Whether there are any at infinity, and others.
    #[inline(always)]
    pub(crate) fn kinds(&self) -> [bool; 2] {
        [!self.far.is_empty(), !self.near.is_empty()]
    }

    /// Chooses one that is not at infinity by a uniform number: its index and its probability.
    #[inline(always)]
    pub(crate) fn choose_near(&self, from: Vec3, u: f32) -> Option<(u32, f32)> {
        self.choose(&self.near, from, u)
    }

    /// Chooses one at infinity by a uniform number: its index and its probability.
    #[inline(always)]
    pub(crate) fn choose_far(&self, u: f32) -> Option<(u32, f32)> {
        self.choose(&self.far, Vec3::ZERO, u)
    }

    #[inline]
    fn choose(&self, group: &[u32], from: Vec3, u: f32) -> Option<(u32, f32)> {
        if let [only] = group {
            return Some((*only, 1.0));
        }
        let total = self.total(group, from);
        if total <= 0.0 {
            return None;
        }
        let mut left = u * total;
        for k in group {
            let weight = self.get(*k).weight(from);
            if left < weight {
                return Some((*k, weight / total));
            }
            left -= weight;
        }
        None
    }

    fn total(&self, group: &[u32], from: Vec3) -> f32 {
        group.iter().map(|k| self.get(*k).weight(from)).sum()
    }

    /// The probability with which one is chosen among its kind.
    #[inline]
    pub(crate) fn probability(&self, from: Vec3, k: u32) -> f32 {
        let light = self.get(k);
        let group = match light {
            Light::Distant(_) => &self.far,
            _ => &self.near,
        };
        if group.len() == 1 {
            return 1.0;
        }
        let total = self.total(group, from);
        if total > 0.0 {
            light.weight(from) / total
        } else {
            0.0
        }
    }
}
