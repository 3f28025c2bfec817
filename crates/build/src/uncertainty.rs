//! The uncertainty of a model at any pair of directions.

use gonio_geom::DVec3;

use crate::incidence::Part;
use crate::local_error::LocalError;
use crate::stated::PartErrors;

/// Standard deviation over mean absolute value of a normal deviate.
const OF_MEAN: f64 = 1.253_314_137_315_5;

/// Standard uncertainties of a BSDF value by their source, 1/sr.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Uncertainty {
    /// Noise of the readings that is left after smoothing, independent from direction to direction.
    pub noise: f64,
    /// What all readings share: beam power, reference standard.
    pub calibration: f64,
    /// Interpolation between readings and, beyond them, extrapolation of the slices.
    pub slice: f64,
    /// Interpolation between incidences, or extrapolation beyond them; `None` where no incidence could be left out to tell.
    pub incidence: Option<f64>,
}

impl Uncertainty {
    /// All together; without the part that is not known.
    pub fn total(&self) -> f64 {
        self.noise
            .hypot(self.calibration)
            .hypot(self.slice)
            .hypot(self.incidence.unwrap_or(0.0))
    }
}

/// The uncertainty of `part` for local directions `(i, s)`.
///
/// Noise and shared uncertainty are those of the slices that the value is made of, where they were read. Errors of
/// interpolation are known as means over a hemisphere of light, so in every direction they are the same share of the value.
pub(crate) fn at(part: &Part, local: &[LocalError], errors: &PartErrors, i: DVec3, s: DVec3) -> Uncertainty {
    let value = part.eval(i, s);
    let (mut noise, mut common, mut beyond) = (0.0, 0.0, 0.0);
    for (node, weight, s) in part.counterparts(i, s) {
        noise += (weight * local[node].noise(s)).powi(2);
        common += weight * local[node].common;
        beyond += weight.abs() * local[node].extrapolation(s);
    }
    let stated = errors.at(part.layout(), i);
    let gap = OF_MEAN * errors.gap(part.layout(), i);
    Uncertainty {
        noise: value * noise.sqrt(),
        calibration: value * common,
        slice: value * gap.hypot(beyond),
        incidence: stated.incidence.map(|e| OF_MEAN * e * value),
    }
}
