//! Pearson's test of counts against expected counts.

use statrs::distribution::{ChiSquared, ContinuousCDF, DiscreteCDF, Poisson};
use statrs::function::erf::erfc;

/// Expected count below which bins are pooled.
const FEWEST: f64 = 5.0;

/// The outcome of a test.
#[derive(Clone, Copy, Debug)]
pub(crate) struct ChiSquare {
    /// Sum of `(observed - expected)^2 / expected`.
    pub(crate) statistic: f64,
    pub(crate) degrees: usize,
    /// Probability of a statistic as large or larger when the counts follow what is expected.
    pub(crate) p: f64,
}

/// Tests `observed` counts against `expected` ones; both sum to the number of samples. Bins that expect fewer than five
/// are pooled. A pool that expects fewer than five still is judged by the Poisson distribution instead, so that what
/// falls where nothing is expected counts; `p` is twice the smaller of the two probabilities then.
pub(crate) fn chi_square(observed: &[u64], expected: &[f64]) -> ChiSquare {
    assert_eq!(observed.len(), expected.len());
    let (mut pool_observed, mut pool_expected) = (0, 0.0);
    let (mut statistic, mut cells) = (0.0, 0usize);
    let mut cell = |o: u64, e: f64| {
        statistic += (o as f64 - e).powi(2) / e;
        cells += 1;
    };
    for (&o, &e) in observed.iter().zip(expected) {
        if e < FEWEST {
            pool_observed += o;
            pool_expected += e.max(0.0);
        } else {
            cell(o, e);
        }
    }
    let pooled = pool_expected >= FEWEST;
    if pooled {
        cell(pool_observed, pool_expected);
    }
    let degrees = cells.saturating_sub(1);
    let mut p = if degrees > 0 {
        ChiSquared::new(degrees as f64).unwrap().sf(statistic)
    } else {
        1.0
    };
    if !pooled && pool_observed > 0 {
        // Quadrature leaves a hundredth of a sample where there is nothing.
        let poisson = Poisson::new(pool_expected + 0.01).unwrap();
        p = (2.0 * p.min(poisson.sf(pool_observed - 1))).min(1.0);
    }
    ChiSquare {
        statistic,
        degrees,
        p,
    }
}

/// Probability of a standard normal deviate at least as far from zero as `z`.
pub(crate) fn two_sided(z: f64) -> f64 {
    erfc(z.abs() / std::f64::consts::SQRT_2)
}

/// Smallest probability that a single one of `tests` tests may have when all of them together shall raise a false
/// alarm at the rate `level` (Šidák).
pub(crate) fn sidak(level: f64, tests: usize) -> f64 {
    -((-level).ln_1p() / tests as f64).exp_m1()
}

#[test]
fn pooling_counts_what_falls_where_nothing_is_expected() {
    let fair = chi_square(&[100, 90, 105, 4, 1], &[100.0, 100.0, 94.0, 4.0, 2.0]);
    assert_eq!(fair.degrees, 3);
    // 0 + 1 + 121/94 + (5 - 6)^2/6
    assert!((fair.statistic - 2.453_900_7).abs() < 1e-6 && fair.p > 0.3);
    let stray = chi_square(&[100, 90, 90, 0, 22], &[100.0, 100.0, 98.0, 4.0, 0.0]);
    assert!(stray.degrees == 2 && stray.p < 1e-9, "{stray:?}");
    assert!(chi_square(&[7, 5], &[12.0, 0.0]).p < 1e-9);
    assert_eq!(chi_square(&[12, 0], &[12.0, 0.0]).p, 1.0);
}

#[test]
fn probabilities_follow_the_tables() {
    // Upper 5 % and 0.1 % points of chi-square with 10 degrees of freedom; two-sided 5 % of the normal.
    let p = |x| ChiSquared::new(10.0).unwrap().sf(x);
    assert!((p(18.307) - 0.05).abs() < 1e-5 && (p(29.588) - 0.001).abs() < 1e-6);
    assert!((two_sided(1.959_964) - 0.05).abs() < 1e-7);
    assert!((1.0 - (1.0 - sidak(0.01, 100)).powi(100) - 0.01).abs() < 1e-12);
}
