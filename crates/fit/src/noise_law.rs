//! The variance of a reading as a function of its level.

/// `u(D)^2 = constant + relative D^2`: read-out noise and noise proportional to the signal, of one slice.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct NoiseLaw {
    /// Variance at zero DSF, 1/sr^2.
    pub constant: f64,
    /// Relative variance.
    pub relative: f64,
}

/// Square of the median absolute value of a standard normal variable.
const MEDIAN_SQUARE: f64 = 0.454_936_423_119_572_8;
/// Passes of the estimate; each shrinks what is left by the ratio of low to high `D^2`.
const PASSES: usize = 30;
/// Relative change of the law from which the passes end.
const SETTLED: f64 = 1e-9;
/// Readings the estimate looks at, at most.
const MAX_READINGS: usize = 20_000;

impl NoiseLaw {
    /// Variance at `dsf`, 1/sr^2.
    #[inline(always)]
    pub fn variance(&self, dsf: f64) -> f64 {
        self.constant + self.relative * dsf * dsf
    }

    /// The law behind stated variances of readings `dsf`: `constant` from the dimmest quarter of them, `relative` from
    /// the brightest, each a median, so that readings with further sources of uncertainty (steep slopes) do not count.
    /// `None` when fewer than eight variances are positive.
    pub fn of_variances(dsf: &[f64], variance: &[f64]) -> Option<Self> {
        let mut pairs: Vec<(f64, f64)> = thin(dsf)
            .zip(thin(variance))
            .filter(|(d, v)| d.is_finite() && v.is_finite() && *v > 0.0)
            .map(|(d, v)| (d * d, v))
            .collect();
        Self::of_squares(&mut pairs, 1.0)
    }

    /// The law behind residuals of a fit with predictions `dsf`, as [`NoiseLaw::of_variances`].
    pub fn of_residuals(dsf: &[f64], residual: &[f64]) -> Option<Self> {
        let mut pairs: Vec<(f64, f64)> = thin(dsf)
            .zip(thin(residual))
            .filter(|(d, r)| d.is_finite() && r.is_finite())
            .map(|(d, r)| (d * d, r * r))
            .collect();
        Self::of_squares(&mut pairs, MEDIAN_SQUARE)
    }

    /// The law for which `u2 = median_factor (constant + relative d2)` in the median.
    fn of_squares(pairs: &mut [(f64, f64)], median_factor: f64) -> Option<Self> {
        let n = pairs.len();
        if n < 8 {
            return None;
        }
        pairs.sort_by(|a, b| a.0.total_cmp(&b.0));
        let (dim, bright) = (&pairs[..n.div_ceil(4)], &pairs[n - n.div_ceil(4)..]);
        let mut law = NoiseLaw {
            constant: 0.0,
            relative: 0.0,
        };
        for _ in 0..PASSES {
            let before = law;
            law.constant =
                median(dim.iter().map(|&(d2, u2)| u2 / median_factor - law.relative * d2)).max(0.0);
            law.relative = median(
                bright
                    .iter()
                    .filter(|p| p.0 > 0.0)
                    .map(|&(d2, u2)| (u2 / median_factor - law.constant) / d2),
            )
            .max(0.0);
            if (law.constant - before.constant).abs() <= SETTLED * law.constant
                && (law.relative - before.relative).abs() <= SETTLED * law.relative
            {
                break;
            }
        }
        (law.constant + law.relative > 0.0).then_some(law)
    }
}

/// Evenly spaced ones of `values`, at most as many as an estimate looks at.
pub(crate) fn thin(values: &[f64]) -> impl Iterator<Item = f64> {
    let stride = values.len().div_ceil(MAX_READINGS).max(1);
    values.iter().step_by(stride).copied()
}

/// Median; 0 without values.
pub(crate) fn median(values: impl Iterator<Item = f64>) -> f64 {
    quantile(values, 0.5)
}

/// The order statistic at fraction `q`; 0 without values.
pub(crate) fn quantile(values: impl Iterator<Item = f64>, q: f64) -> f64 {
    let mut all: Vec<f64> = values.filter(|v| v.is_finite()).collect();
    if all.is_empty() {
        return 0.0;
    }
    let k = ((all.len() - 1) as f64 * q) as usize;
    *all.select_nth_unstable_by(k, f64::total_cmp).1
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_law_is_found_again_from_the_variances_it_gave() {
        let law = NoiseLaw {
            constant: 4e-8,
            relative: 1e-4,
        };
        let dsf: Vec<f64> = (0..400).map(|k| 0.05 + 1e-4 * f64::from(k * k)).collect();
        let mut variance: Vec<f64> = dsf.iter().map(|&d| law.variance(d)).collect();
        // One reading in ten lies on a slope.
        variance.iter_mut().step_by(10).for_each(|v| *v *= 9.0);
        let found = NoiseLaw::of_variances(&dsf, &variance).unwrap();
        assert!((found.relative / law.relative - 1.0).abs() < 1e-9, "{found:?}");
        assert!((found.constant / law.constant - 1.0).abs() < 1e-3, "{found:?}");
    }

    #[test]
    fn no_uncertainties_give_no_law() {
        assert_eq!(NoiseLaw::of_variances(&[1.0; 50], &[0.0; 50]), None);
    }
}
