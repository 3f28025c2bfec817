//! Polar angles of a direction, canonical and extended.

use std::f64::consts::{PI, TAU};
use std::ops::RangeInclusive;

use crate::Direction;

/// Canonical polar angles in radians: `theta` in `[0, pi]` from `+z`, `phi` in `[0, 2 pi)` from `x`.
///
/// Kept beside [`Direction`] because a direction along the normal has lost its azimuth, and an incidence at the
/// normal still has one (the sample holder's).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Angles {
    /// Polar angle from the front normal, radians, `[0, pi]`.
    pub theta: f64,
    /// Azimuth from `x`, counter-clockwise seen from the front, radians, `[0, 2 pi)`.
    pub phi: f64,
}

/// Polar angles that a reading may state, degrees; canonical ones are 0 to 180.
pub const EXTENDED_THETA: RangeInclusive<f64> = -180.0..=270.0;

/// Azimuths that a reading may state, degrees; canonical ones are 0 to 360.
pub const STATED_PHI: RangeInclusive<f64> = -360.0..=720.0;

impl Angles {
    /// Canonical angles of any finite pair: `theta` is taken modulo `2 pi`; a `theta` past `pi` comes back on the
    /// other side of the pole (`2 pi - theta`, `phi + pi`). The direction they name is unchanged.
    pub fn canonical(theta: f64, phi: f64) -> Self {
        let mut theta = theta.rem_euclid(TAU);
        let mut phi = phi;
        if theta > PI {
            theta = TAU - theta;
            phi += PI;
        }
        let mut phi = phi.rem_euclid(TAU);
        if phi >= TAU {
            phi = 0.0; // rem_euclid of a tiny negative number rounds up to the modulus itself
        }
        Angles { theta, phi }
    }

    /// [`Angles::canonical`] of degrees.
    pub fn from_degrees(theta: f64, phi: f64) -> Self {
        Angles::canonical(theta.to_radians(), phi.to_radians())
    }

    /// Canonical angles of a reading as files and scripts state it, in degrees: `theta` in [`EXTENDED_THETA`], where a
    /// negative one or one past 180 lies on the opposite azimuth, `phi` in [`STATED_PHI`]. `None` outside, NaN included.
    ///
    /// Folded before the conversion to radians, where it is exact: -30 gives the bits of 30.
    pub fn from_stated_degrees(theta: f64, phi: f64) -> Option<Self> {
        if !EXTENDED_THETA.contains(&theta) || !STATED_PHI.contains(&phi) {
            return None;
        }
        let (theta, phi) = if theta < 0.0 {
            (-theta, phi + 180.0)
        } else if theta > 180.0 {
            (360.0 - theta, phi + 180.0)
        } else {
            (theta, phi)
        };
        Some(Angles::from_degrees(theta, phi.rem_euclid(360.0)))
    }

    /// `(theta, phi)` in degrees, as [`degrees`] gives them.
    pub fn to_degrees(self) -> (f64, f64) {
        (degrees(self.theta), degrees(self.phi))
    }

    /// The unit vector these angles name.
    pub fn direction(self) -> Direction {
        Direction::from_spherical(self.theta, self.phi)
    }

    /// Extended polar angle within the scan half-plane of azimuth `plane_phi` and its opposite: `-pi/2..pi/2` over
    /// the reflection hemisphere, `pi/2..3 pi/2` over the transmission hemisphere. `None` when the direction lies
    /// further than `tolerance` radians (great circle) from the plane. Plot and input notation only.
    pub fn extended_theta(self, plane_phi: f64, tolerance: f64) -> Option<f64> {
        let d = self.direction().vec();
        let (s, c) = plane_phi.sin_cos();
        let across = -d.x * s + d.y * c;
        if across.abs() > tolerance.sin() {
            return None;
        }
        let along = d.x * c + d.y * s;
        let extended = along.atan2(d.z);
        Some(if extended < -PI / 2.0 {
            extended + TAU
        } else {
            extended
        })
    }

    /// The inverse of [`Angles::extended_theta`].
    pub fn from_extended(extended_theta: f64, plane_phi: f64) -> Self {
        Angles::canonical(extended_theta, plane_phi)
    }
}

/// Degrees of an angle in radians. An angle within a turn that was made by `to_radians` of a decimal with at most 12
/// places after the point gives that decimal back, bit for bit; any other value is that of `f64::to_degrees` within
/// its rounding.
#[inline]
pub fn degrees(radians: f64) -> f64 {
    const PLACES: f64 = 1e12;
    // Adding and subtracting 1.5 2^52 rounds to an integer in every lane of the simplest vector instructions.
    const ROUND: f64 = 6_755_399_441_055_744.0;
    let plain = radians.to_degrees();
    // The integer and the power of ten are exact, so this is the f64 nearest to the decimal.
    let decimal = ((plain * PLACES + ROUND) - ROUND) / PLACES;
    // Both conversions round twice, the decimal once: 2.5 epsilons at most.
    if (decimal - plain).abs() <= 3.0 * f64::EPSILON * plain.abs() {
        decimal
    } else {
        plain
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(100_000))]

        #[test]
        fn decimal_degrees_survive_radians(digits in 0u64..=360_000_000_000_000, places in 0u32..=12) {
            let text = format!("{}e-12", digits / 10u64.pow(12 - places) * 10u64.pow(12 - places));
            let angle: f64 = text.parse().unwrap();
            prop_assert_eq!(degrees(angle.to_radians()).to_bits(), angle.to_bits());
        }

        #[test]
        fn other_angles_keep_their_value_within_rounding(radians in -1e4..1e4f64) {
            let plain = radians.to_degrees();
            prop_assert!((degrees(radians) - plain).abs() <= 3.0 * f64::EPSILON * plain.abs());
        }
    }

    #[test]
    fn degrees_of_zero_and_nan_are_themselves() {
        assert_eq!(degrees(0.0).to_bits(), 0.0f64.to_bits());
        assert!(degrees(f64::NAN).is_nan());
        assert!(degrees(f64::MIN_POSITIVE) > 0.0);
    }

    #[test]
    fn stated_angles_fold_exactly_and_end_at_their_ranges() {
        let same = |a: (f64, f64), b: (f64, f64)| {
            let [a, b] = [a, b].map(|(t, p)| Angles::from_stated_degrees(t, p));
            assert!(a.is_some() && a == b, "{a:?} {b:?}");
        };
        same((-30.0, 0.0), (30.0, 180.0));
        same((190.0, 10.0), (170.0, 190.0));
        same((45.0, -90.0), (45.0, 270.0));
        for (theta, phi) in [
            (-180.5, 0.0),
            (270.5, 0.0),
            (0.0, -361.0),
            (0.0, 721.0),
            (f64::NAN, 0.0),
            (0.0, f64::NAN),
        ] {
            assert_eq!(Angles::from_stated_degrees(theta, phi), None);
        }
    }

    #[test]
    fn a_polar_angle_past_pi_returns_over_the_pole() {
        let a = Angles::from_degrees(270.0, 10.0);
        let (theta, phi) = a.to_degrees();
        assert!((theta - 90.0).abs() < 1e-12 && (phi - 190.0).abs() < 1e-12);
    }

    #[test]
    fn a_negative_polar_angle_is_the_opposite_azimuth() {
        let (theta, phi) = Angles::from_degrees(-30.0, 0.0).to_degrees();
        assert!((theta - 30.0).abs() < 1e-12 && (phi - 180.0).abs() < 1e-12);
    }

    #[test]
    fn extended_angles_round_trip_over_both_hemispheres() {
        for deg in [-89.0, -30.0, 0.0, 45.0, 89.0, 91.0, 135.0, 180.0, 225.0, 269.0] {
            let a = Angles::from_extended(f64::to_radians(deg), 0.3);
            let back = a.extended_theta(0.3, 1e-9).unwrap().to_degrees();
            assert!((back - deg).abs() < 1e-9, "{deg} came back as {back}");
        }
    }

    #[test]
    fn a_direction_off_the_plane_has_no_extended_angle() {
        assert_eq!(Angles::from_degrees(30.0, 20.0).extended_theta(0.0, 0.01), None);
    }
}
