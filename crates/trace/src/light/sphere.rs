//! A luminous sphere.

use glam::Vec3;

use super::Towards;
use crate::vector::{Frame, in_cone};

/// A sphere that emits outward.
#[derive(Clone, Debug)]
pub struct Ball {
    /// W/(m2 sr), each channel.
    pub radiance: Vec3,
    centre: Vec3,
    radius: f32,
}

impl Ball {
    /// `None` without a positive radius.
    pub fn new(centre: Vec3, radius: f32, radiance: Vec3) -> Option<Self> {
        (radius > 0.0).then_some(Ball {
            radiance,
            centre,
            radius,
        })
    }

    pub(super) fn normal(&self, point: Vec3) -> Vec3 {
        (point - self.centre).normalize_or_zero()
    }

    /// One less the cosine of half the angle under which it is seen; `None` from inside.
    fn one_minus_cos(&self, from: Vec3) -> Option<f32> {
        let sin2 = self.radius * self.radius / from.distance_squared(self.centre);
        (sin2 < 1.0).then(|| sin2 / (1.0 + (1.0 - sin2).sqrt()))
    }

    #[inline]
    pub(super) fn sample(&self, from: Vec3, u: [f32; 2]) -> Option<Towards> {
        let cone = self.one_minus_cos(from)?;
        let way = self.centre - from;
        let distance = way.length();
        let local = in_cone(cone, u);
        let direction = Frame::about(way / distance).world(local);
        // The near one of the two points: as far as the tangent and less. Off the axis by the sine: of a small sphere, the
        // difference of two squares would be rounding, and its rim lie in its own shadow.
        let along = distance * local.z;
        let aside2 = distance * distance * (local.x * local.x + local.y * local.y);
        Some(Towards {
            direction,
            distance: along - (self.radius * self.radius - aside2).max(0.0).sqrt(),
            radiance: self.radiance,
            pdf: self.pdf(from),
        })
    }

    #[inline]
    pub(super) fn pdf(&self, from: Vec3) -> f32 {
        self.one_minus_cos(from)
            .map_or(0.0, |cone| 1.0 / (std::f32::consts::TAU * cone))
    }

    #[inline]
    pub(super) fn weight(&self, from: Vec3) -> f32 {
        let r2 = self.radius * self.radius;
        self.radiance.max_element() * std::f32::consts::PI * r2 / (from.distance_squared(self.centre) + r2)
    }
}
