//! Half and difference angles of a pair of directions \[Rusinkiewicz1998\].

use std::f64::consts::PI;

use gonio_geom::{DVec3, Direction};

/// An isotropic pair of directions by its half vector `h` and by `wi` in the frame whose pole is `h`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct HalfAngles {
    /// Polar angle of the half vector, radians, `[0, pi/2]`.
    pub theta_h: f64,
    /// Angle between incidence and half vector, radians, `[0, pi/2]`.
    pub theta_d: f64,
    /// Azimuth of the incidence about the half vector, radians, `[0, pi)`: counted from the direction in which the polar
    /// angle of the half vector grows, and modulo `pi`, since reciprocity makes both halves of the turn one.
    pub phi_d: f64,
}

impl HalfAngles {
    /// The angles of a reflection; `None` unless both directions leave to the front.
    pub fn of(wi: Direction, ws: Direction) -> Option<Self> {
        if !(wi.cos_theta() > 0.0 && ws.cos_theta() > 0.0) {
            return None;
        }
        let (i, h) = (wi.vec(), (wi.vec() + ws.vec()).try_normalize()?);
        let sin_h = h.x.hypot(h.y);
        // unit vectors of growing polar angle and azimuth at h; at the pole those of azimuth 0
        let (cos_p, sin_p) = if sin_h > 0.0 {
            (h.x / sin_h, h.y / sin_h)
        } else {
            (1.0, 0.0)
        };
        let x = i.dot(DVec3::new(h.z * cos_p, h.z * sin_p, -sin_h));
        let y = i.y * cos_p - i.x * sin_p;
        let phi_d = y.atan2(x).rem_euclid(PI);
        Some(HalfAngles {
            theta_h: sin_h.atan2(h.z),
            theta_d: x.hypot(y).atan2(i.dot(h)),
            phi_d: if phi_d < PI { phi_d } else { 0.0 },
        })
    }

    /// A pair with these angles whose half vector has azimuth 0: incidence and scattered direction, below the horizon
    /// where the angles say so.
    pub fn pair(&self) -> (Direction, Direction) {
        let (sin_h, cos_h) = self.theta_h.sin_cos();
        let (sin_d, cos_d) = self.theta_d.sin_cos();
        let (sin_p, cos_p) = self.phi_d.sin_cos();
        let across = DVec3::new(sin_d * cos_p * cos_h, sin_d * sin_p, -sin_d * cos_p * sin_h);
        let along = cos_d * DVec3::new(sin_h, 0.0, cos_h);
        (
            Direction::from_unit(along + across),
            Direction::from_unit(along - across),
        )
    }
}
