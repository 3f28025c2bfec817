//! Gauss-Legendre nodes on the unit interval.

use std::f64::consts::PI;
use std::sync::LazyLock;

const NODES: usize = 64;

/// Nodes and weights, roots of the Legendre polynomial by Newton steps [AbramowitzStegun1964, 25.4.29].
static RULE: LazyLock<[(f64, f64); NODES]> = LazyLock::new(|| {
    let n = NODES as f64;
    std::array::from_fn(|k| {
        let mut x = (PI * (k as f64 + 0.75) / (n + 0.5)).cos();
        let mut slope = 0.0;
        for _ in 0..20 {
            let (mut p, mut before) = (1.0, 0.0);
            for j in 1..=NODES {
                let j = j as f64;
                (p, before) = (((2.0 * j - 1.0) * x * p - (j - 1.0) * before) / j, p);
            }
            slope = n * (x * p - before) / (x * x - 1.0);
            x -= p / slope;
        }
        (0.5 * (1.0 - x), 1.0 / ((1.0 - x * x) * slope * slope))
    })
});

/// The nodes in `(0, 1)` with their weights, which sum to 1; exact for polynomials of degree up to 127.
pub(super) fn unit_interval() -> impl Iterator<Item = (f64, f64)> {
    RULE.iter().copied()
}

#[cfg(test)]
mod tests {
    use super::unit_interval;

    #[test]
    fn the_rule_integrates_polynomials_exactly() {
        for degree in [0, 1, 2, 17, 90, 127] {
            let sum: f64 = unit_interval().map(|(x, w)| w * x.powi(degree)).sum();
            assert!(
                (sum * f64::from(degree + 1) - 1.0).abs() < 1e-13,
                "{degree}: {sum}"
            );
        }
    }
}
