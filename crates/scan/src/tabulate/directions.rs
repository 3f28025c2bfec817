//! Directions dense where lobes are narrow.

use std::f64::consts::{FRAC_PI_2, TAU};

use gonio_geom::{Component, Direction, Side};

use super::domain;
use crate::ScanError;

/// Spacing of receiver directions: rings over the whole hemisphere, and rings of the half vector about the normal, whose
/// reflections close in on the mirror direction.
///
/// The half vector spaces a lobe evenly at every incidence: towards grazing a lobe of fixed width in the half vector
/// narrows across the plane of incidence as `cos(theta_i)`, and so do the reflected rings.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Spacing {
    /// Pitch of the rings over the hemisphere, radians, `[0.005, 0.5]`.
    pub pitch: f64,
    /// Pitch at the mirror direction, in the plane of incidence, radians, `[1e-5, pitch]`.
    pub peak_pitch: f64,
    /// Growth of the half vector's pitch per unit distance from the normal, `[0.01, 1]`.
    pub growth: f64,
    /// Tilt of the half vector up to which its rings reach, radians, `[0, 1.2]`; 0 leaves them out.
    pub reach: f64,
    /// Polar angle from the receiver side's normal that no direction passes, radians, `(0.1, pi/2)`.
    pub theta_max: f64,
}

impl Default for Spacing {
    /// 3 degrees, 0.1 degrees at the mirror direction, growing by 0.08 up to 25 degrees of the half vector; up to 88
    /// degrees.
    fn default() -> Self {
        Spacing {
            pitch: 3.0_f64.to_radians(),
            peak_pitch: 0.1_f64.to_radians(),
            growth: 0.08,
            reach: 25.0_f64.to_radians(),
            theta_max: 88.0_f64.to_radians(),
        }
    }
}

impl Spacing {
    pub(super) fn check(&self) -> Result<(), ScanError> {
        let ranges = [
            ("pitch", self.pitch, 0.005, 0.5),
            ("peak_pitch", self.peak_pitch, 1e-5, self.pitch),
            ("growth", self.growth, 0.01, 1.0),
            ("reach", self.reach, 0.0, 1.2),
            ("theta_max", self.theta_max, 0.1, FRAC_PI_2 - 1e-4),
        ];
        for (field, value, low, high) in ranges {
            if !(low..=high).contains(&value) {
                let (found, allowed) = if field == "growth" {
                    (value.to_string(), format!("{low} to {high}"))
                } else {
                    let [value, low, high] = [value, low, high].map(f64::to_degrees);
                    (
                        format!("{value:.6} degrees"),
                        format!("{low:.4} to {high:.4} degrees"),
                    )
                };
                return Err(domain(field, found, &allowed));
            }
        }
        Ok(())
    }

    /// The directions for incidence `wi` over the hemisphere of `component`.
    pub(super) fn directions(&self, wi: Direction, component: Component) -> Vec<Direction> {
        let side = component.scattered_side(wi.side());
        // everything is laid out for light on the front that is reflected, then turned over
        let above = if wi.side() == Side::Front {
            wi
        } else {
            wi.flipped()
        };
        let mut out = Vec::new();
        let mut theta = 0.5 * self.pitch;
        while theta <= self.theta_max {
            ring(theta, self.pitch, |d| out.push(d));
            theta += self.pitch;
        }
        let lowest = self.theta_max.cos();
        let mut keep = |half: Direction| {
            let v = 2.0 * above.dot(half) * half.vec() - above.vec();
            out.extend(Direction::new(v).filter(|d| d.cos_theta() >= lowest));
        };
        if self.reach > 0.0 {
            keep(Direction::NORMAL);
        }
        // a tilt of the half vector turns the reflection by twice as much
        let finest = 0.5 * self.peak_pitch;
        let mut tilt = finest;
        while tilt <= self.reach {
            let pitch = finest.max(self.growth * tilt);
            ring(tilt, pitch, &mut keep);
            tilt += pitch;
        }
        if side == Side::Back {
            out.iter_mut().for_each(|d| *d = d.flipped());
        }
        out
    }
}

/// The directions at polar angle `theta`, about `pitch` apart. The start turns from ring to ring, so that rings of equal
/// number do not line up.
fn ring(theta: f64, pitch: f64, mut visit: impl FnMut(Direction)) {
    const GOLDEN: f64 = 0.618_033_988_749_895;
    let n = (TAU * theta.sin() / pitch).round().max(6.0);
    let start = TAU * GOLDEN * (theta / pitch);
    for k in 0..n as usize {
        visit(Direction::from_spherical(theta, start + TAU * k as f64 / n));
    }
}
