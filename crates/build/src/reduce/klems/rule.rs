//! Quadrature over a ring of patches.

use std::f64::consts::PI;

use gonio_bsdf::klems::Ring;

/// A Gauss-Legendre rule on `[0, 1]`: nodes and weights.
pub(super) fn gauss(n: usize) -> Vec<(f64, f64)> {
    (0..n)
        .map(|k| {
            // Newton's iteration for the roots of the Legendre polynomial, from Tricomi's estimate [AbramowitzStegun1964]
            let mut x = (PI * (k as f64 + 0.75) / (n as f64 + 0.5)).cos();
            let mut slope = 1.0;
            for _ in 0..50 {
                let (mut p, mut before) = (1.0, 0.0);
                for m in 1..=n {
                    let m = m as f64;
                    (p, before) = (((2.0 * m - 1.0) * x * p - (m - 1.0) * before) / m, p);
                }
                slope = n as f64 * (x * p - before) / (x * x - 1.0);
                let step = p / slope;
                x -= step;
                if step.abs() < 1e-15 {
                    break;
                }
            }
            (0.5 * (1.0 - x), 1.0 / ((1.0 - x * x) * slope * slope))
        })
        .collect()
}

/// The coordinate of a ring at the share `t` of its way in cosine, with the weight of projected solid angle there.
///
/// Models are smooth in the cosine of the polar angle; in the sine squared they have infinite slope at the horizon.
pub(super) fn in_cosine(ring: &Ring, t: f64) -> (f64, f64) {
    let near = ring.theta_lo.to_radians().cos();
    let far = if ring.theta_hi == 90.0 {
        0.0
    } else {
        ring.theta_hi.to_radians().cos()
    };
    let c = near + t * (far - near);
    let u = (near * near - c * c) / (near * near - far * far);
    (u, 2.0 * c / (near + far))
}
