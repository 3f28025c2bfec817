//! Angles of files (degrees) and of readings (radians, canonical).

use super::Fault;
use crate::column;

/// Receiver directions as they are read.
#[derive(Clone)]
pub(crate) struct Receivers {
    /// Polar angles, radians.
    pub(crate) theta: Vec<f64>,
    /// Azimuths, radians.
    pub(crate) phi: Vec<f64>,
    /// Degrees added to every azimuth.
    rotation: f64,
}

impl Receivers {
    /// Room for `capacity` directions whose azimuths are turned by `rotation` degrees.
    pub(crate) fn new(capacity: usize, rotation: f64) -> Self {
        Receivers {
            theta: column(capacity),
            phi: column(capacity),
            rotation,
        }
    }

    /// Adds a direction given in degrees.
    ///
    /// # Errors
    /// As [`receiver_angles`].
    #[inline(always)]
    pub(crate) fn push(&mut self, theta: f64, phi: f64) -> Result<(), Fault> {
        let (theta, phi) = receiver_angles(theta, phi, self.rotation)?;
        self.theta.push(theta);
        self.phi.push(phi);
        Ok(())
    }
}

/// Canonical radians of a polar angle of 0 to 180 degrees and an azimuth of -360 to 720 degrees, turned by `rotation`
/// degrees.
///
/// # Errors
/// Angles outside these ranges, NaN included.
#[inline(always)]
pub(crate) fn receiver_angles(theta: f64, phi: f64, rotation: f64) -> Result<(f64, f64), Fault> {
    if !(0.0..=180.0).contains(&theta) || !(-360.0..=720.0).contains(&phi) {
        return Err(out_of_range(theta, phi));
    }
    let phi = phi + rotation;
    let phi = if (0.0..360.0).contains(&phi) {
        phi
    } else {
        phi.rem_euclid(360.0)
    };
    let radians = phi.to_radians();
    // rounding may reach the full turn
    let phi = if radians < std::f64::consts::TAU {
        radians
    } else {
        0.0
    };
    Ok((theta.to_radians().min(std::f64::consts::PI), phi))
}

#[cold]
fn out_of_range(theta: f64, phi: f64) -> Fault {
    if (0.0..=180.0).contains(&theta) {
        Fault::new("phi", format!("{phi}"), "-360 to 720 degrees")
    } else {
        Fault::new(
            "theta",
            format!("{theta}"),
            "0 to 180 degrees (more than 90: the back of the sample)",
        )
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use gonio_geom::Angles;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn fast_and_general_conversion_agree(theta in 0.0..=180.0f64, phi in -360.0..=720.0f64) {
            let (t, p) = receiver_angles(theta, phi, 0.0).unwrap();
            let a = Angles::from_degrees(theta, phi);
            prop_assert!((t - a.theta).abs() < 1e-15);
            let d = (p - a.phi).abs();
            prop_assert!(d.min(std::f64::consts::TAU - d) < 1e-14);
            prop_assert!((0.0..std::f64::consts::TAU).contains(&p));
        }
    }

    #[test]
    fn the_largest_azimuth_below_a_turn_stays_below_a_turn() {
        let (_, phi) = receiver_angles(10.0, 360.0f64.next_down(), 0.0).unwrap();
        assert!(phi < std::f64::consts::TAU);
    }

    #[test]
    fn nan_angles_are_refused() {
        assert!(receiver_angles(f64::NAN, 0.0, 0.0).is_err());
        assert!(receiver_angles(0.0, f64::NAN, 0.0).is_err());
    }
}
