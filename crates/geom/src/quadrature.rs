//! Quadrature on the unit interval.

use std::f64::consts::PI;

/// Nodes in `(0, 1)` and weights, which sum to 1, of the Gauss-Legendre rule of `n` nodes; exact for polynomials of degree
/// up to `2 n - 1` [AbramowitzStegun1964, 25.4.29]. No nodes for `n = 0`.
pub fn gauss_legendre(n: usize) -> Vec<(f64, f64)> {
    (0..n).map(|k| node(n, k)).collect()
}

/// Root `k` of the Legendre polynomial by Newton's iteration from Tricomi's estimate.
fn node(n: usize, k: usize) -> (f64, f64) {
    let degree = n as f64;
    let mut x = (PI * (k as f64 + 0.75) / (degree + 0.5)).cos();
    let mut slope = 1.0;
    for _ in 0..50 {
        let (mut p, mut before) = (1.0, 0.0);
        for m in 1..=n {
            let m = m as f64;
            (p, before) = (((2.0 * m - 1.0) * x * p - (m - 1.0) * before) / m, p);
        }
        slope = degree * (x * p - before) / (x * x - 1.0);
        let step = p / slope;
        x -= step;
        if step.abs() < 1e-15 {
            break;
        }
    }
    (0.5 * (1.0 - x), 1.0 / ((1.0 - x * x) * slope * slope))
}

#[cfg(test)]
mod tests {
    use super::gauss_legendre;

    #[test]
    fn the_rule_integrates_polynomials_exactly() {
        for n in [1, 2, 5, 32, 64] {
            for degree in [0, 1, n as i32, 2 * n as i32 - 1] {
                let sum: f64 = gauss_legendre(n).iter().map(|(x, w)| w * x.powi(degree)).sum();
                assert!(
                    (sum * f64::from(degree + 1) - 1.0).abs() < 1e-13,
                    "{n} nodes, degree {degree}: {sum}"
                );
            }
        }
    }
}
