//! The Beckmann distribution of facet normals: Gaussian slopes.

use std::f64::consts::PI;

use crate::analytic::Real;

use super::distribution::unit;
use super::{Distribution, Widths};

/// `D = exp(-((h_x/alpha_x)^2 + (h_y/alpha_y)^2) / h_z^2) / (pi alpha_x alpha_y h_z^4)`,
/// `Lambda = (erf(a) - 1) / 2 + exp(-a^2) / (2 a sqrt(pi))` with `a = cos / sqrt((alpha_x v_x)^2 + (alpha_y v_y)^2)`
/// [Walter2007, eq. 25 and 26; Heitz2014, eq. 68 and 80 for two widths].
///
/// The masking is exact, not the rational approximation of [Walter2007, eq. 27] that renderers use.
#[derive(Clone, Copy, Debug)]
pub struct Beckmann;

/// `Lambda(v)`.
#[inline(always)]
fn lambda<W: Widths, R: Real>(widths: &W::Shape<R>, v: [R::Plain; 3]) -> R {
    // The smallest number keeps the derivative of the root finite at normal incidence, where Lambda is 0.
    let root = (W::stretched(widths, v) + 1e-30).sqrt();
    let a = root.recip().times(v[2].abs());
    let tail = (-a.squared()).exp() * root.times(v[2].abs().recip()) * (1.0 / PI.sqrt());
    (tail + a.erf() - 1.0) * 0.5
}

/// Slope `x` that a share `u` of the area of a Gaussian surface (width 1) seen from polar angle `theta` stays below.
///
/// The area below `x` is `F(x) = cos (1 + erf x) / 2 + sin exp(-x^2) / (2 sqrt(pi))`, up to `x = cot theta`, beyond
/// which facets face away [Heitz2014, section 5.2; inverted numerically as in Jakob2014]. Bracketed Newton steps.
fn visible_slope(cos: f64, sin: f64, u: f64) -> f64 {
    const FARTHEST: f64 = 8.0; // erfc(8) = 1e-29
    let area = |x: f64| 0.5 * (cos * libm::erfc(-x) + sin * (-x * x).exp() / PI.sqrt());
    let mut high = if sin * FARTHEST > cos { cos / sin } else { FARTHEST };
    let mut low = -FARTHEST;
    let wanted = u * area(high);
    // The median of all slopes is a good guess but at grazing incidence.
    let mut x = (0.5 * (low.max(-2.0) + high.min(2.0))).clamp(low, high);
    for _ in 0..80 {
        let excess = area(x) - wanted;
        if excess > 0.0 {
            high = x;
        } else {
            low = x;
        }
        let density = (cos - x * sin).max(0.0) * (-x * x).exp() / PI.sqrt();
        let newton = x - excess / density;
        let next = if newton > low && newton < high {
            newton
        } else {
            0.5 * (low + high)
        };
        if (next - x).abs() < 1e-13 * (1.0 + x.abs()) {
            return next;
        }
        x = next;
    }
    x
}

/// Inverse of `(1 + erf y) / 2`, by the same steps.
fn gaussian_slope(u: f64) -> f64 {
    visible_slope(1.0, 0.0, u)
}

/// Polar sine and cosine of `w` stretched by the widths, and the cosine and sine of its azimuth there.
fn stretched_frame<W: Widths>(widths: &W::Shape<f64>, w: [f64; 3]) -> ((f64, f64), (f64, f64)) {
    let v = unit(W::stretch(widths, w));
    let sin = v[0].hypot(v[1]);
    let azimuth = if sin > 0.0 {
        (v[0] / sin, v[1] / sin)
    } else {
        (1.0, 0.0)
    };
    ((sin, v[2]), azimuth)
}

/// The normal of slopes `x`, `y` in the frame of [`stretched_frame`].
fn normal<W: Widths>(widths: &W::Shape<f64>, (c, s): (f64, f64), x: f64, y: f64) -> [f64; 3] {
    W::unstretch(widths, [s * y - c * x, -(s * x + c * y), 1.0])
}

impl Distribution for Beckmann {
    /// exp(-6.5^2) = 4e-19.
    const REACH: f64 = 6.5;

    #[inline(always)]
    fn slopes<R: Real>(q: R) -> R {
        (-q).exp()
    }

    #[inline(always)]
    fn masking<W: Widths, R: Real>(widths: &W::Shape<R>, v: [R::Plain; 3]) -> R {
        (lambda::<W, R>(widths, v) + 1.0).times(v[2].abs()).recip()
    }

    #[inline(always)]
    fn visibility<W: Widths, R: Real>(widths: &W::Shape<R>, wi: [R::Plain; 3], ws: [R::Plain; 3]) -> R {
        let lambdas = lambda::<W, R>(widths, wi) + lambda::<W, R>(widths, ws);
        ((lambdas + 1.0).times(wi[2].abs() * ws[2].abs()) * 4.0).recip()
    }

    fn visible_normal<W: Widths>(widths: &W::Shape<f64>, w: [f64; 3], u: [f64; 2]) -> [f64; 3] {
        let ((sin, cos), azimuth) = stretched_frame::<W>(widths, w);
        let (x, y) = (visible_slope(cos, sin, u[0]), gaussian_slope(u[1]));
        normal::<W>(widths, azimuth, x, y)
    }
}
