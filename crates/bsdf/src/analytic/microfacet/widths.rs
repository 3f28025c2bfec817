//! Widths of a facet distribution: the same in every azimuth, or two along turned axes.

use std::f64::consts::PI;

use crate::analytic::Real;

/// How a distribution of facet slopes is stretched.
pub trait Widths: Copy + Send + Sync + std::fmt::Debug + 'static {
    /// Number of parameters.
    const N: usize;
    /// Prepared parameters.
    type Shape<R: Real>: Copy + Send + Sync;

    /// Prepares parameters: `alpha`, or `alpha_x`, `alpha_y`, `phi_x` (radians).
    fn shape<R: Real>(p: &[R]) -> Self::Shape<R>;
    /// `1 / (pi alpha_x alpha_y)`.
    fn norm<R: Real>(shape: &Self::Shape<R>) -> R;
    /// `(alpha_x v_x)^2 + (alpha_y v_y)^2`.
    fn stretched<R: Real>(shape: &Self::Shape<R>, v: [R::Plain; 3]) -> R;
    /// `(v_x / alpha_x)^2 + (v_y / alpha_y)^2`.
    fn squeezed<R: Real>(shape: &Self::Shape<R>, v: [R::Plain; 3]) -> R;
    /// [`Widths::squeezed`] of a vector that depends on the parameters.
    fn squeezed_by_parameters<R: Real>(shape: &Self::Shape<R>, v: [R; 3]) -> R;
    /// `v` in the axes of the distribution, x and y multiplied by their widths.
    fn stretch<R: Real>(shape: &Self::Shape<R>, v: [R; 3]) -> [R; 3];
    /// A vector in the axes of the distribution, x and y multiplied by their widths, back in the frame of the sample:
    /// normals go back with the transpose of [`Widths::stretch`].
    fn unstretch<R: Real>(shape: &Self::Shape<R>, v: [R; 3]) -> [R; 3];
    /// Whether parameters `p` give the same width in every azimuth.
    fn isotropic(p: &[f64]) -> bool;
}

/// One width `alpha` in every azimuth.
#[derive(Clone, Copy, Debug)]
pub struct Isotropic;

/// Widths `alpha_x`, `alpha_y` along axes of which x lies at azimuth `phi_x`.
#[derive(Clone, Copy, Debug)]
pub struct Elliptic;

/// Prepared parameters of [`Isotropic`].
#[derive(Clone, Copy, Debug)]
pub struct Round<R> {
    alpha: R,
    square: R,
    inverse_square: R,
}

/// Prepared parameters of [`Elliptic`].
#[derive(Clone, Copy, Debug)]
pub struct Ellipse<R> {
    alpha: (R, R),
    inverse: (R, R),
    /// Cosine and sine of `phi_x`.
    axis: (R, R),
}

impl Widths for Isotropic {
    const N: usize = 1;
    type Shape<R: Real> = Round<R>;

    #[inline(always)]
    fn shape<R: Real>(p: &[R]) -> Round<R> {
        let square = p[0].squared();
        Round {
            alpha: p[0],
            square,
            inverse_square: square.recip(),
        }
    }

    #[inline(always)]
    fn norm<R: Real>(shape: &Round<R>) -> R {
        shape.inverse_square * (1.0 / PI)
    }

    #[inline(always)]
    fn stretched<R: Real>(shape: &Round<R>, v: [R::Plain; 3]) -> R {
        shape.square.times(v[0] * v[0] + v[1] * v[1])
    }

    #[inline(always)]
    fn squeezed<R: Real>(shape: &Round<R>, v: [R::Plain; 3]) -> R {
        shape.inverse_square.times(v[0] * v[0] + v[1] * v[1])
    }

    #[inline(always)]
    fn squeezed_by_parameters<R: Real>(shape: &Round<R>, v: [R; 3]) -> R {
        shape.inverse_square * (v[0].squared() + v[1].squared())
    }

    #[inline(always)]
    fn stretch<R: Real>(shape: &Round<R>, v: [R; 3]) -> [R; 3] {
        [v[0] * shape.alpha, v[1] * shape.alpha, v[2]]
    }

    #[inline(always)]
    fn unstretch<R: Real>(shape: &Round<R>, v: [R; 3]) -> [R; 3] {
        [v[0] * shape.alpha, v[1] * shape.alpha, v[2]]
    }

    fn isotropic(_p: &[f64]) -> bool {
        true
    }
}

impl Widths for Elliptic {
    const N: usize = 3;
    type Shape<R: Real> = Ellipse<R>;

    #[inline(always)]
    fn shape<R: Real>(p: &[R]) -> Ellipse<R> {
        let (sin, cos) = p[2].sin_cos();
        Ellipse {
            alpha: (p[0], p[1]),
            inverse: (p[0].recip(), p[1].recip()),
            axis: (cos, sin),
        }
    }

    #[inline(always)]
    fn norm<R: Real>(shape: &Ellipse<R>) -> R {
        shape.inverse.0 * shape.inverse.1 * (1.0 / PI)
    }

    #[inline(always)]
    fn stretched<R: Real>(shape: &Ellipse<R>, v: [R::Plain; 3]) -> R {
        let (c, s) = shape.axis;
        let x = (c.times(v[0]) + s.times(v[1])) * shape.alpha.0;
        let y = (c.times(v[1]) - s.times(v[0])) * shape.alpha.1;
        x.squared() + y.squared()
    }

    #[inline(always)]
    fn squeezed<R: Real>(shape: &Ellipse<R>, v: [R::Plain; 3]) -> R {
        let (c, s) = shape.axis;
        let x = (c.times(v[0]) + s.times(v[1])) * shape.inverse.0;
        let y = (c.times(v[1]) - s.times(v[0])) * shape.inverse.1;
        x.squared() + y.squared()
    }

    #[inline(always)]
    fn squeezed_by_parameters<R: Real>(shape: &Ellipse<R>, v: [R; 3]) -> R {
        let (c, s) = shape.axis;
        let x = (c * v[0] + s * v[1]) * shape.inverse.0;
        let y = (c * v[1] - s * v[0]) * shape.inverse.1;
        x.squared() + y.squared()
    }

    #[inline(always)]
    fn stretch<R: Real>(shape: &Ellipse<R>, v: [R; 3]) -> [R; 3] {
        let (c, s) = shape.axis;
        [
            (c * v[0] + s * v[1]) * shape.alpha.0,
            (c * v[1] - s * v[0]) * shape.alpha.1,
            v[2],
        ]
    }

    #[inline(always)]
    fn unstretch<R: Real>(shape: &Ellipse<R>, v: [R; 3]) -> [R; 3] {
        let (c, s) = shape.axis;
        let (x, y) = (v[0] * shape.alpha.0, v[1] * shape.alpha.1);
        [c * x - s * y, s * x + c * y, v[2]]
    }

    fn isotropic(p: &[f64]) -> bool {
        p[0] == p[1]
    }
}
