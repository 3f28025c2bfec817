//! A luminous disk at infinity.

use glam::Vec3;

use super::Towards;
use crate::vector::{Frame, in_cone};

/// A cone of directions with constant radiance: the sun, and RADIANCE's `source` of a light.
#[derive(Clone, Debug)]
pub struct Distant {
    /// W/(m2 sr), each channel.
    pub radiance: Vec3,
    frame: Frame,
    one_minus_cos: f32,
}

impl Distant {
    /// Towards `direction`, seen under the full angle `angle` in radians; `None` for a zero direction or angle.
    pub fn new(direction: Vec3, angle: f64, radiance: Vec3) -> Option<Self> {
        let half = 0.5 * angle;
        let drop = (2.0 * (0.5 * half).sin().powi(2)) as f32;
        (drop > 0.0).then_some(())?;
        Some(Distant {
            radiance,
            frame: Frame::about(direction.try_normalize()?),
            one_minus_cos: drop,
        })
    }

    /// Its middle.
    pub(crate) fn towards(&self) -> Vec3 {
        self.frame.z
    }

    /// Sine of its half angle.
    pub(crate) fn sin(&self) -> f32 {
        (self.one_minus_cos * (2.0 - self.one_minus_cos)).sqrt()
    }

    /// Whether a unit direction lies in it.
    #[inline]
    pub(crate) fn holds(&self, direction: Vec3) -> bool {
        // 1 - cos = |difference|^2 / 2, without cancellation.
        0.5 * (direction - self.frame.z).length_squared() <= self.one_minus_cos
    }

    #[inline]
    pub(super) fn sample(&self, u: [f32; 2]) -> Towards {
        Towards {
            direction: self.frame.world(in_cone(self.one_minus_cos, u)),
            distance: f32::INFINITY,
            radiance: self.radiance,
            pdf: self.pdf(),
        }
    }

    #[inline]
    pub(crate) fn pdf(&self) -> f32 {
        1.0 / (std::f32::consts::TAU * self.one_minus_cos)
    }

    #[inline]
    pub(super) fn weight(&self) -> f32 {
        self.radiance.max_element() * std::f32::consts::TAU * self.one_minus_cos
    }
}
