//! Unit vectors that leave the surface.

use std::f64::consts::TAU;

use glam::DVec3;

use crate::{Angles, Side};

/// A unit vector in the sample frame that leaves the surface: `wi` towards the source, `ws` towards the receiver.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Direction(DVec3);

impl Direction {
    /// The front normal `+z`.
    pub const NORMAL: Direction = Direction(DVec3::Z);

    /// The direction of polar angle `theta` and azimuth `phi` (radians; any values, not only canonical ones).
    pub fn from_spherical(theta: f64, phi: f64) -> Self {
        let (st, ct) = theta.sin_cos();
        let (sp, cp) = phi.sin_cos();
        Direction(DVec3::new(st * cp, st * sp, ct))
    }

    /// [`Direction::from_spherical`] of degrees.
    pub fn from_degrees(theta: f64, phi: f64) -> Self {
        Direction::from_spherical(theta.to_radians(), phi.to_radians())
    }

    /// `v` normalised; `None` when its length is zero or not finite.
    pub fn new(v: DVec3) -> Option<Self> {
        v.try_normalize().map(Direction)
    }

    /// Wraps a vector that is known to have unit length (checked in debug builds).
    pub fn from_unit(v: DVec3) -> Self {
        debug_assert!((v.length_squared() - 1.0).abs() < 1e-9, "not a unit vector: {v}");
        Direction(v)
    }

    /// The vector itself.
    pub fn vec(self) -> DVec3 {
        self.0
    }

    /// Cosine of the polar angle; negative on the back.
    pub fn cos_theta(self) -> f64 {
        self.0.z
    }

    /// Polar angle in `[0, pi]`, accurate near the poles too.
    pub fn theta(self) -> f64 {
        self.0.x.hypot(self.0.y).atan2(self.0.z)
    }

    /// Azimuth in `[0, 2 pi)`; 0 along the normal.
    pub fn phi(self) -> f64 {
        let phi = self.0.y.atan2(self.0.x);
        let phi = if phi < 0.0 { phi + TAU } else { phi };
        if phi >= TAU { 0.0 } else { phi }
    }

    /// Canonical polar angles.
    pub fn angles(self) -> Angles {
        Angles {
            theta: self.theta(),
            phi: self.phi(),
        }
    }

    /// The side this direction leaves to.
    pub fn side(self) -> Side {
        Side::of_z(self.0.z)
    }

    /// Mirror direction of reflection: `(theta, phi + pi)`.
    pub fn mirror(self) -> Self {
        Direction(DVec3::new(-self.0.x, -self.0.y, self.0.z))
    }

    /// Unbent transmission: `(pi - theta, phi + pi)`.
    pub fn through(self) -> Self {
        Direction(-self.0)
    }

    /// The same direction on the other side of the sample plane.
    pub fn flipped(self) -> Self {
        Direction(DVec3::new(self.0.x, self.0.y, -self.0.z))
    }

    /// Rotated about the normal by `angle` radians, counter-clockwise seen from the front.
    pub fn rotated(self, angle: f64) -> Self {
        let (s, c) = angle.sin_cos();
        Direction(DVec3::new(
            c * self.0.x - s * self.0.y,
            s * self.0.x + c * self.0.y,
            self.0.z,
        ))
    }

    /// Cosine of the angle to `other`.
    pub fn dot(self, other: Direction) -> f64 {
        self.0.dot(other.0)
    }

    /// Angle to `other` in radians, accurate for small angles too.
    pub fn angle_to(self, other: Direction) -> f64 {
        self.0.cross(other.0).length().atan2(self.dot(other))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn mirror_and_through_follow_the_conventions() {
        let wi = Direction::from_degrees(30.0, 40.0);
        let (theta, phi) = wi.mirror().angles().to_degrees();
        assert!((theta - 30.0).abs() < 1e-12 && (phi - 220.0).abs() < 1e-12);
        let (theta, phi) = wi.through().angles().to_degrees();
        assert!((theta - 150.0).abs() < 1e-12 && (phi - 220.0).abs() < 1e-12);
    }

    #[test]
    fn small_polar_angles_survive() {
        let theta = 1e-9;
        assert!((Direction::from_spherical(theta, 1.0).theta() - theta).abs() < 1e-20);
    }
}
