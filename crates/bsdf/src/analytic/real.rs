//! The numbers a formula is written in: plain, vectorised, or carrying derivatives.

use std::f64::consts::PI;
use std::ops::{Add, Div, Mul, Neg, Sub};

/// A number type that every analytic formula accepts.
///
/// Implemented for `f64` (library functions), [`Fast`](super::Fast) (branch-free functions that compilers vectorise)
/// and [`Dual`](super::Dual) (value and derivatives). A formula has no branches on values: [`Real::select`] takes
/// both sides, so that one formula serves all of them.
pub trait Real:
    Copy
    + Send
    + Sync
    + Neg<Output = Self>
    + Add<Output = Self>
    + Sub<Output = Self>
    + Mul<Output = Self>
    + Div<Output = Self>
    + Add<f64, Output = Self>
    + Sub<f64, Output = Self>
    + Mul<f64, Output = Self>
    + Div<f64, Output = Self>
{
    /// The same without derivatives; directions are of this type.
    type Plain: Real<Plain = Self::Plain>;

    /// `v` without derivatives.
    fn constant(v: f64) -> Self;
    /// `p` without derivatives.
    fn lift(p: Self::Plain) -> Self;
    /// The value, derivatives dropped.
    fn plain(self) -> Self::Plain;
    /// `self + p`.
    fn plus(self, p: Self::Plain) -> Self;
    /// `self p`.
    fn times(self, p: Self::Plain) -> Self;
    /// `yes` where `test > 0`, else `no`.
    fn select(test: Self::Plain, yes: Self, no: Self) -> Self;

    /// `e^self`.
    fn exp(self) -> Self;
    /// Natural logarithm of a positive number.
    fn ln(self) -> Self;
    /// `ln(1 + self)`, accurate near 0 too, for `self > -1`.
    fn ln_1p(self) -> Self;
    /// Square root.
    fn sqrt(self) -> Self;
    /// Error function.
    fn erf(self) -> Self;
    /// Sine and cosine.
    fn sin_cos(self) -> (Self, Self);

    /// `self^e` of a positive number.
    #[inline(always)]
    fn powf(self, e: Self) -> Self {
        (self.ln() * e).exp()
    }
    /// `1 / self`.
    #[inline(always)]
    fn recip(self) -> Self {
        Self::constant(1.0) / self
    }
    /// `self^2`.
    #[inline(always)]
    fn squared(self) -> Self {
        self * self
    }
    /// Absolute value.
    #[inline(always)]
    fn abs(self) -> Self {
        Self::select(self.plain(), self, -self)
    }
    /// The larger of two.
    #[inline(always)]
    fn max(self, other: Self) -> Self {
        Self::select((self - other).plain(), self, other)
    }
    /// The smaller of two.
    #[inline(always)]
    fn min(self, other: Self) -> Self {
        Self::select((self - other).plain(), other, self)
    }
}

impl Real for f64 {
    type Plain = f64;

    #[inline(always)]
    fn constant(v: f64) -> Self {
        v
    }
    #[inline(always)]
    fn lift(p: f64) -> Self {
        p
    }
    #[inline(always)]
    fn plain(self) -> f64 {
        self
    }
    #[inline(always)]
    fn plus(self, p: f64) -> Self {
        self + p
    }
    #[inline(always)]
    fn times(self, p: f64) -> Self {
        self * p
    }
    #[inline(always)]
    fn select(test: f64, yes: Self, no: Self) -> Self {
        if test > 0.0 { yes } else { no }
    }
    #[inline(always)]
    fn exp(self) -> Self {
        f64::exp(self)
    }
    #[inline(always)]
    fn ln(self) -> Self {
        f64::ln(self)
    }
    #[inline(always)]
    fn ln_1p(self) -> Self {
        f64::ln_1p(self)
    }
    #[inline(always)]
    fn sqrt(self) -> Self {
        f64::sqrt(self)
    }
    #[inline(always)]
    fn erf(self) -> Self {
        libm::erf(self)
    }
    #[inline(always)]
    fn sin_cos(self) -> (Self, Self) {
        f64::sin_cos(self)
    }
    #[inline(always)]
    fn powf(self, e: Self) -> Self {
        f64::powf(self, e)
    }
}

/// A value with `N` first derivatives: forward-mode differentiation [GriewankWalther2008].
#[derive(Clone, Copy, Debug)]
pub struct Dual<R, const N: usize> {
    /// The value.
    pub value: R,
    /// Its derivatives.
    pub slope: [R; N],
}

impl<R: Real<Plain = R>, const N: usize> Dual<R, N> {
    /// The `k`-th independent variable at `value`.
    #[inline(always)]
    pub fn variable(value: f64, k: usize) -> Self {
        let mut slope = [R::constant(0.0); N];
        slope[k] = R::constant(1.0);
        Dual {
            value: R::constant(value),
            slope,
        }
    }

    /// `value` with every derivative multiplied by `factor`: the chain rule of a function of one variable.
    #[inline(always)]
    fn chain(self, value: R, factor: R) -> Self {
        Dual {
            value,
            slope: self.slope.map(|d| d * factor),
        }
    }

    #[inline(always)]
    fn zip(self, other: Self, value: R, f: impl Fn(R, R) -> R) -> Self {
        let mut slope = self.slope;
        for (a, b) in slope.iter_mut().zip(other.slope) {
            *a = f(*a, b);
        }
        Dual { value, slope }
    }
}

impl<R: Real<Plain = R>, const N: usize> Neg for Dual<R, N> {
    type Output = Self;
    #[inline(always)]
    fn neg(self) -> Self {
        Dual {
            value: -self.value,
            slope: self.slope.map(|d| -d),
        }
    }
}
impl<R: Real<Plain = R>, const N: usize> Add for Dual<R, N> {
    type Output = Self;
    #[inline(always)]
    fn add(self, o: Self) -> Self {
        self.zip(o, self.value + o.value, |a, b| a + b)
    }
}
impl<R: Real<Plain = R>, const N: usize> Sub for Dual<R, N> {
    type Output = Self;
    #[inline(always)]
    fn sub(self, o: Self) -> Self {
        self.zip(o, self.value - o.value, |a, b| a - b)
    }
}
impl<R: Real<Plain = R>, const N: usize> Mul for Dual<R, N> {
    type Output = Self;
    #[inline(always)]
    #[allow(clippy::suspicious_arithmetic_impl)] // the product rule
    fn mul(self, o: Self) -> Self {
        self.zip(o, self.value * o.value, |a, b| a * o.value + b * self.value)
    }
}
impl<R: Real<Plain = R>, const N: usize> Div for Dual<R, N> {
    type Output = Self;
    #[inline(always)]
    #[allow(clippy::suspicious_arithmetic_impl)] // the quotient rule
    fn div(self, o: Self) -> Self {
        let r = R::constant(1.0) / o.value;
        let value = self.value * r;
        self.zip(o, value, |a, b| (a - b * value) * r)
    }
}
impl<R: Real<Plain = R>, const N: usize> Add<f64> for Dual<R, N> {
    type Output = Self;
    #[inline(always)]
    fn add(self, o: f64) -> Self {
        Dual {
            value: self.value + o,
            ..self
        }
    }
}
impl<R: Real<Plain = R>, const N: usize> Sub<f64> for Dual<R, N> {
    type Output = Self;
    #[inline(always)]
    fn sub(self, o: f64) -> Self {
        Dual {
            value: self.value - o,
            ..self
        }
    }
}
impl<R: Real<Plain = R>, const N: usize> Mul<f64> for Dual<R, N> {
    type Output = Self;
    #[inline(always)]
    fn mul(self, o: f64) -> Self {
        Dual {
            value: self.value * o,
            slope: self.slope.map(|d| d * o),
        }
    }
}
impl<R: Real<Plain = R>, const N: usize> Div<f64> for Dual<R, N> {
    type Output = Self;
    #[inline(always)]
    fn div(self, o: f64) -> Self {
        self * (1.0 / o)
    }
}

impl<R: Real<Plain = R>, const N: usize> Real for Dual<R, N> {
    type Plain = R;

    #[inline(always)]
    fn constant(v: f64) -> Self {
        Self::lift(R::constant(v))
    }
    #[inline(always)]
    fn lift(p: R) -> Self {
        Dual {
            value: p,
            slope: [R::constant(0.0); N],
        }
    }
    #[inline(always)]
    fn plain(self) -> R {
        self.value
    }
    #[inline(always)]
    fn plus(self, p: R) -> Self {
        Dual {
            value: self.value + p,
            ..self
        }
    }
    #[inline(always)]
    fn times(self, p: R) -> Self {
        self.chain(self.value * p, p)
    }
    #[inline(always)]
    fn select(test: R, yes: Self, no: Self) -> Self {
        yes.zip(no, R::select(test, yes.value, no.value), |a, b| {
            R::select(test, a, b)
        })
    }
    #[inline(always)]
    fn exp(self) -> Self {
        let e = self.value.exp();
        self.chain(e, e)
    }
    #[inline(always)]
    fn ln(self) -> Self {
        self.chain(self.value.ln(), self.value.recip())
    }
    #[inline(always)]
    fn ln_1p(self) -> Self {
        self.chain(self.value.ln_1p(), (self.value + 1.0).recip())
    }
    #[inline(always)]
    fn sqrt(self) -> Self {
        let r = self.value.sqrt();
        self.chain(r, (r * 2.0).recip())
    }
    #[inline(always)]
    fn erf(self) -> Self {
        let slope = (-self.value.squared()).exp() * (2.0 / PI.sqrt());
        self.chain(self.value.erf(), slope)
    }
    #[inline(always)]
    fn sin_cos(self) -> (Self, Self) {
        let (s, c) = self.value.sin_cos();
        (self.chain(s, c), self.chain(c, -s))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Every function of the trait in one smooth expression.
    fn expression<R: Real>(x: R, y: R) -> R {
        let (s, c) = (x * y).sin_cos();
        let a = (x * 0.3 + y.sqrt()).exp() - y.ln() * 2.0 + (x * y).ln_1p();
        let b = (s.abs() + c.squared() + 1.5).powf(x / y) + (x - y).erf();
        (a.max(b) + (x - 0.1).min(y)) / (y + 2.0) - x.recip()
    }

    #[test]
    fn derivatives_agree_with_central_differences() {
        for (x, y) in [(0.7, 1.3), (1.9, 0.4), (2.2, 3.1)] {
            let d = expression(Dual::<f64, 2>::variable(x, 0), Dual::variable(y, 1));
            assert!((d.value / expression(x, y) - 1.0).abs() < 1e-14);
            let h = 1e-5;
            let dx = (expression(x + h, y) - expression(x - h, y)) / (2.0 * h);
            let dy = (expression(x, y + h) - expression(x, y - h)) / (2.0 * h);
            assert!(
                (d.slope[0] - dx).abs() < 1e-8 * dx.abs().max(1.0),
                "{} {dx}",
                d.slope[0]
            );
            assert!(
                (d.slope[1] - dy).abs() < 1e-8 * dy.abs().max(1.0),
                "{} {dy}",
                d.slope[1]
            );
        }
    }
}
