//! From noise-free signal to what the instrument writes.

use gonio_geom::{Angles, DVec3, Direction};
use rand::{Rng, RngExt};
use rand_distr::StandardNormal;

use crate::Detector;

/// Degrees to which the instrument records a direction.
const ANGLE_STEP: f64 = 1e-4;

/// One reading of the noise-free `signal` at dark level `dark`, in the range that holds it and never past its full scale.
pub(crate) fn read(detector: &Detector, signal: f64, dark: f64, rng: &mut impl Rng) -> f64 {
    let range = detector.range(signal + dark);
    let sigma = detector.noise(range.noise_readout, signal);
    let reading = (signal + dark) * (1.0 + range.gain_error) + sigma * rng.sample::<f64, _>(StandardNormal);
    if detector.bits == 0 {
        return reading.min(range.full_scale);
    }
    let step = range.full_scale / 2.0_f64.powi(detector.bits as i32);
    ((reading / step).round() * step).min(range.full_scale)
}

/// The angles that are written for `d`, in radians.
pub(crate) fn recorded(d: Direction) -> Angles {
    let (theta, phi) = d.angles().to_degrees();
    let round = |x: f64| (x / ANGLE_STEP).round() * ANGLE_STEP;
    Angles::from_degrees(round(theta), round(phi))
}

/// Where the detector really stands when it records `d`.
pub(crate) fn pointed(detector: &Detector, d: Direction, rng: &mut impl Rng) -> Direction {
    let (a, b) = d.vec().any_orthonormal_pair();
    let (x, y): (f64, f64) = (rng.sample(StandardNormal), rng.sample(StandardNormal));
    let v: DVec3 = d.vec() + detector.pointing * (x * a + y * b);
    Direction::new(v).unwrap_or(d)
}
