//! One model at one incidence: draws samples once and judges them in every way.

use gonio_bsdf::{Bsdf, Lobe, Sample, directional_albedo};
use gonio_geom::{Component, Direction};
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64Mcg;

use crate::chi_square::{ChiSquare, chi_square, two_sided};
use crate::partition::Partition;

/// Samples that guide the subdivision into bins.
const PILOT: usize = 2000;

/// What `samples` samples say.
pub(crate) struct Trial {
    pub(crate) samples: u64,
    pub(crate) chi_square: ChiSquare,
    /// Integral of the density and the bound on its numerical error.
    pub(crate) mass: f64,
    pub(crate) mass_error: f64,
    /// Probability of so many successful samples, were they the integral of the density.
    pub(crate) p_accepted: f64,
    /// Mean weight, its standard error and the probability of such a mean, were it the albedo.
    pub(crate) mean: f64,
    pub(crate) standard_error: f64,
    pub(crate) albedo: f64,
    pub(crate) p_mean: f64,
}

/// Draws `samples` samples of `sampler` given `w` and compares them with `density` and with the albedo of `model`.
/// Ideal directions (mirror, unbent) have no density: but for their weights they count as failures.
pub(crate) fn run(
    model: &dyn Bsdf,
    sampler: impl Fn(Direction, [f64; 3]) -> Option<Sample>,
    w: Direction,
    seed: &str,
    samples: u64,
) -> Trial {
    let mut rng = Pcg64Mcg::seed_from_u64(fnv1a(seed));
    let draw = |rng: &mut Pcg64Mcg| sampler(w, rng.random());
    let pilot: Vec<Direction> = (0..PILOT)
        .filter_map(|_| draw(&mut rng))
        .filter(|s| s.lobe != Lobe::Delta)
        .map(|s| s.direction)
        .collect();
    let partition = Partition::new(|d| model.pdf(w, d), w, pilot, samples);
    let mut counts = vec![0u64; partition.mass.len() + 1];
    let (mut sum, mut squares, mut accepted) = (0.0, 0.0, 0u64);
    for _ in 0..samples {
        if let Some(s) = draw(&mut rng) {
            sum += s.weight;
            squares += s.weight * s.weight;
            if s.lobe != Lobe::Delta {
                counts[partition.bin(s.direction)] += 1;
                accepted += 1;
            }
        }
    }
    let n = samples as f64;
    let mass: f64 = partition.mass.iter().sum();
    if let Some(failed) = counts.last_mut() {
        *failed = samples - accepted;
    }
    let expected: Vec<f64> = partition
        .mass
        .iter()
        .chain([&(1.0 - mass)])
        .map(|m| m * n)
        .collect();

    let spread = (n * mass * (1.0 - mass).max(0.0)).sqrt();
    let p_accepted = deviation(accepted as f64 - n * mass, spread, n * 1e-6);
    let mean = sum / n;
    let albedo: f64 = [Component::Reflection, Component::Transmission]
        .map(|c| directional_albedo(model, w, c, 0))
        .iter()
        .sum();
    // Failures too rare to be seen among the samples still spread the mean: at least by the variance of an even weight.
    let unseen = (albedo * albedo * (1.0 - mass) / mass).max(0.0);
    let standard_error = ((squares / n - mean * mean).max(unseen) / n).sqrt();
    Trial {
        samples,
        chi_square: chi_square(&counts, &expected),
        mass,
        mass_error: partition.error,
        p_accepted,
        mean,
        standard_error,
        albedo,
        p_mean: deviation(mean - albedo, standard_error, 1e-6),
    }
}

/// Probability of a deviation as large, `slack` of which the quadrature may have caused.
fn deviation(d: f64, sigma: f64, slack: f64) -> f64 {
    let d = (d.abs() - slack).max(0.0);
    if d == 0.0 { 1.0 } else { two_sided(d / sigma) }
}

/// A seed that depends on the case alone, not on which others there are (Fowler, Noll and Vo's hash).
fn fnv1a(text: &str) -> u64 {
    text.bytes().fold(0xcbf2_9ce4_8422_2325, |h, b| {
        (h ^ u64::from(b)).wrapping_mul(0x0100_0000_01b3)
    })
}
