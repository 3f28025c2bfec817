//! Fresnel reflectance of a facet for unpolarised light.

use crate::analytic::Real;

/// Reflectance of a smooth facet by the cosine of the angle to its normal.
pub trait Fresnel: Copy + Send + Sync + std::fmt::Debug + 'static {
    /// Number of parameters.
    const N: usize;
    /// Prepared parameters.
    type Shape<R: Real>: Copy + Send + Sync;
    /// Prepares parameters.
    fn shape<R: Real>(p: &[R]) -> Self::Shape<R>;
    /// Reflectance at `cosine` in `[0, 1]`.
    fn reflectance<R: Real>(shape: &Self::Shape<R>, cosine: R::Plain) -> R;
}

/// `F = f0 + (1 - f0) (1 - cos)^5` [Schlick1994, eq. 15].
#[derive(Clone, Copy, Debug)]
pub struct Schlick;

/// The exact reflectance of a conductor of index `eta + i k` in air, unpolarised [BornWolf1999, section 14.4.1].
#[derive(Clone, Copy, Debug)]
pub struct Conductor;

impl Fresnel for Schlick {
    const N: usize = 1;
    type Shape<R: Real> = R;

    #[inline(always)]
    fn shape<R: Real>(p: &[R]) -> R {
        p[0]
    }

    #[inline(always)]
    fn reflectance<R: Real>(f0: &R, cosine: R::Plain) -> R {
        let x = (R::Plain::constant(1.0) - cosine).max(R::Plain::constant(0.0));
        let x2 = x * x;
        let rise = x2 * x2 * x;
        f0.times(R::Plain::constant(1.0) - rise).plus(rise)
    }
}

/// Prepared parameters of [`Conductor`].
#[derive(Clone, Copy, Debug)]
pub struct Index<R> {
    /// `eta^2 - k^2`.
    real: R,
    /// `4 eta^2 k^2`.
    imaginary2: R,
}

impl Fresnel for Conductor {
    const N: usize = 2;
    type Shape<R: Real> = Index<R>;

    #[inline(always)]
    fn shape<R: Real>(p: &[R]) -> Index<R> {
        let (eta2, k2) = (p[0].squared(), p[1].squared());
        Index {
            real: eta2 - k2,
            imaginary2: eta2 * k2 * 4.0,
        }
    }

    /// With `(a + i b)^2 = (eta + i k)^2 - sin^2`.
    #[inline(always)]
    fn reflectance<R: Real>(index: &Index<R>, cosine: R::Plain) -> R {
        let c2 = cosine * cosine;
        let s2 = R::Plain::constant(1.0) - c2;
        let t = index.real.plus(-s2);
        // Floors keep derivatives finite where a conductor without absorption reflects totally.
        let modulus = (t.squared() + index.imaginary2).max(R::constant(1e-30)).sqrt();
        let a = ((modulus + t) * 0.5).max(R::constant(1e-30)).sqrt();
        let cross = a.times(cosine * 2.0);
        let even = modulus.plus(c2);
        let perpendicular = (even - cross) / (even + cross);
        let even = modulus.times(c2).plus(s2 * s2);
        let cross = cross.times(s2);
        let ratio = (even - cross) / (even + cross);
        perpendicular * (ratio + 1.0) * 0.5
    }
}

/// The exact reflectance of an interface to a medium of relative index `eta`, unpolarised; 1 where it reflects totally.
/// `cosine` may depend on the parameters [Walter2007, eq. 22].
#[inline(always)]
pub fn dielectric<R: Real>(eta: R, cosine: R) -> R {
    let eta2 = eta.squared();
    // Total reflection makes g = 0, both amplitudes 1; the floor keeps the derivative finite.
    let g = (eta2 - 1.0 + cosine.squared()).max(R::constant(1e-30)).sqrt();
    let s = (cosine - g) / (cosine + g);
    let p = (eta2 * cosine - g) / (eta2 * cosine + g);
    (s.squared() + p.squared()) * 0.5
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_dielectric_reflects_what_its_index_says_at_normal_and_brewster_incidence() {
        let n = 1.5f64;
        assert!((dielectric(n, 1.0) - 0.04).abs() < 1e-15);
        // At Brewster's angle only the perpendicular part reflects: ((n^2-1)/(n^2+1))^2 / 2.
        let brewster = n.atan().cos();
        let expected = 0.5 * ((n * n - 1.0) / (n * n + 1.0)).powi(2);
        assert!((dielectric(n, brewster) - expected).abs() < 1e-15);
        assert!((dielectric(1.0 / n, 0.5) - 1.0).abs() < 1e-12);
        // Stokes: the same facet reflects the same share from either side.
        let inside = (1.0 - (0.6f64 / n).powi(2)).sqrt();
        assert!((dielectric(n, 0.8) - dielectric(1.0 / n, inside)).abs() < 1e-14);
    }

    #[test]
    fn a_conductor_without_absorption_is_a_dielectric() {
        for cosine in [1.0, 0.9, 0.5, 0.2, 0.01] {
            for n in [1.3f64, 1.7, 3.0] {
                let index = Conductor::shape(&[n, 0.0]);
                let got = Conductor::reflectance::<f64>(&index, cosine);
                assert!((got - dielectric(n, cosine)).abs() < 1e-13, "{n} {cosine}");
            }
        }
    }

    #[test]
    fn a_conductor_follows_the_complex_amplitudes() {
        for (n, k) in [(0.05f64, 4.2f64), (0.96, 6.69), (3.1, 3.3), (0.4, 0.01)] {
            let index = Conductor::shape(&[n, k]);
            for degrees in [0.0f64, 30.0, 60.0, 85.0, 89.0] {
                let (s, c) = degrees.to_radians().sin_cos();
                // w = sqrt((n + ik)^2 - s^2) in the upper half plane, by polar form.
                let (re, im) = (n * n - k * k - s * s, 2.0 * n * k);
                let (radius, angle) = (re.hypot(im).sqrt(), im.atan2(re) / 2.0);
                let (wr, wi) = (radius * angle.cos(), radius * angle.sin());
                let abs2 = |x: f64, y: f64| x * x + y * y;
                let perpendicular = abs2(c - wr, wi) / abs2(c + wr, wi);
                let (er, ei) = ((n * n - k * k) * c, 2.0 * n * k * c);
                let parallel = abs2(er - wr, ei - wi) / abs2(er + wr, ei + wi);
                let want = 0.5 * (perpendicular + parallel);
                let got = Conductor::reflectance::<f64>(&index, c);
                assert!((got - want).abs() < 1e-12, "{n} {k} {degrees}: {got} {want}");
            }
        }
    }
}
