//! The lamp in time: slow drift and fast flicker. Its spectrum enters through the weights of the detector's outputs.

use rand::{Rng, RngExt};
use rand_distr::StandardNormal;

use crate::InstrumentError;
use crate::error::in_range;

/// How the flux of the lamp changes while a campaign runs; all signals are proportional to it, dark levels are not.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Lamp {
    /// Relative change of the flux an hour, linear in time, `[-0.5, 0.5]`.
    pub drift: f64,
    /// Standard deviation of the flicker as a fraction of the flux, `[0, 0.2]`.
    pub flicker: f64,
    /// Time over which the flicker forgets itself (1/e), seconds, `[1e-4, 1e4]`.
    pub flicker_time: f64,
}

impl Default for Lamp {
    /// Steady.
    fn default() -> Self {
        Lamp {
            drift: 0.0,
            flicker: 0.0,
            flicker_time: 1.0,
        }
    }
}

impl Lamp {
    pub(crate) fn check(&self) -> Result<(), InstrumentError> {
        in_range("lamp_drift", self.drift, -0.5, 0.5, " an hour")?;
        in_range("lamp_flicker", self.flicker, 0.0, 0.2, "")?;
        in_range("lamp_flicker_time", self.flicker_time, 1e-4, 1e4, " s")
    }

    /// Flux at increasing `times` (seconds since the campaign began) over the flux at its begin: a line times one plus
    /// a stationary Gauss-Markov process.
    pub(crate) fn flux(&self, times: &[f64], rng: &mut impl Rng) -> Vec<f64> {
        let mut state: f64 = rng.sample(StandardNormal);
        let mut before = times.first().copied().unwrap_or(0.0);
        times
            .iter()
            .map(|&t| {
                let kept = (-(t - before) / self.flicker_time).exp();
                let fresh: f64 = rng.sample(StandardNormal);
                state = kept * state + (1.0 - kept * kept).max(0.0).sqrt() * fresh;
                before = t;
                (1.0 + self.drift * t / 3600.0).max(0.0) * (1.0 + self.flicker * state).max(0.0)
            })
            .collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand::SeedableRng;
    use rand_pcg::Pcg64Mcg;

    #[test]
    fn flicker_scatters_as_stated_and_forgets_itself_in_its_time() {
        let lamp = Lamp {
            drift: 0.0,
            flicker: 0.01,
            flicker_time: 0.1,
        };
        let times: Vec<f64> = (0..200_000).map(|k| f64::from(k) * 0.05).collect();
        let x: Vec<f64> = lamp
            .flux(&times, &mut Pcg64Mcg::seed_from_u64(1))
            .iter()
            .map(|f| f - 1.0)
            .collect();
        let n = x.len() as f64;
        let variance = x.iter().map(|v| v * v).sum::<f64>() / n;
        let next = x.windows(2).map(|w| w[0] * w[1]).sum::<f64>() / n;
        // 200 000 readings half a correlation time apart: the variance scatters by .5 %, five of that.
        assert!((variance / 1e-4 - 1.0).abs() < 0.025, "{variance}");
        assert!(
            (next / variance - (-0.5_f64).exp()).abs() < 0.02,
            "{}",
            next / variance
        );
    }

    #[test]
    fn drift_is_a_line_in_time() {
        let lamp = Lamp {
            drift: 0.02,
            ..Lamp::default()
        };
        let flux = lamp.flux(&[0.0, 1800.0, 3600.0], &mut Pcg64Mcg::seed_from_u64(1));
        for (found, expected) in flux.iter().zip([1.0, 1.01, 1.02]) {
            assert!((found - expected).abs() < 1e-12);
        }
    }
}
