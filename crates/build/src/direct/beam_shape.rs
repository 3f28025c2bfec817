//! The beam as the detector sees it without a sample.

use std::f64::consts::TAU;

use gonio_fit::profile::Profile;

/// `peak exp(-(gamma / width)^exponent)`, integral 1 over solid angle: what every direction that light leaves to
/// unscattered becomes in the readings.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct BeamShape {
    exponent: f64,
    /// Angle at which the density has fallen to 1/e, radians.
    pub(crate) width: f64,
    /// Density in the middle, 1/sr.
    peak: f64,
}

impl BeamShape {
    /// From the second moment `w^2 Gamma(4/p) / Gamma(2/p)` and the exponent `p` of a signature.
    pub(crate) fn new(profile: &Profile) -> Self {
        let p = profile.shape;
        let zeroth = libm::tgamma(2.0 / p);
        let width = (profile.second_moment * zeroth / libm::tgamma(4.0 / p)).sqrt();
        BeamShape {
            exponent: p,
            width,
            peak: p / (TAU * width * width * zeroth),
        }
    }

    /// Density at angle `gamma` from the middle of a beam `scale` times as wide, 1/sr, and its derivatives with the squared
    /// angle and the logarithm of the scale.
    pub(crate) fn density(&self, gamma2: f64, scale: f64) -> (f64, f64, f64) {
        let u = (gamma2 / (self.width * scale).powi(2)).powf(0.5 * self.exponent);
        let value = self.peak / (scale * scale) * (-u).exp();
        let by_gamma2 = if gamma2 > 0.0 {
            -0.5 * self.exponent * u / gamma2 * value
        } else {
            0.0
        };
        (value, by_gamma2, (self.exponent * u - 2.0) * value)
    }

    /// Solid angle `1 / integral of the density squared`, sr.
    pub(crate) fn solid_angle(&self) -> f64 {
        (2.0 / self.exponent).exp2() / self.peak
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_density_has_the_integral_the_moment_and_the_solid_angle_it_states() {
        for exponent in [1.5, 2.0, 6.0] {
            let moment = f64::to_radians(0.2).powi(2);
            let shape = BeamShape::new(&Profile::new(exponent, moment).unwrap());
            let (n, end) = (20_000, 20.0 * shape.width);
            let mut sums = [0.0; 3];
            for k in 0..n {
                let gamma = (k as f64 + 0.5) * end / f64::from(n);
                let ring = TAU * gamma * end / f64::from(n);
                let value = shape.density(gamma * gamma, 1.0).0;
                sums[0] += ring * value;
                sums[1] += ring * value * gamma * gamma;
                sums[2] += ring * value * value;
            }
            assert!((sums[0] - 1.0).abs() < 1e-6, "{exponent}: {}", sums[0]);
            assert!((sums[1] / moment - 1.0).abs() < 1e-5);
            assert!((sums[2] * shape.solid_angle() - 1.0).abs() < 1e-6);
        }
    }

    #[test]
    fn the_derivatives_are_those_of_the_density() {
        let shape = BeamShape::new(&Profile::new(3.0, 1e-5).unwrap());
        let (g, s, h) = (6e-6, 1.1, 1e-6);
        let (_, by_gamma2, by_ln_scale) = shape.density(g, s);
        let d = |a: f64, b: f64, step: f64| (a - b) / (2.0 * step);
        let slope = d(
            shape.density(g * (1.0 + h), s).0,
            shape.density(g * (1.0 - h), s).0,
            g * h,
        );
        assert!((by_gamma2 / slope - 1.0).abs() < 1e-6);
        let slope = d(
            shape.density(g, s * h.exp()).0,
            shape.density(g, s * (-h).exp()).0,
            h,
        );
        assert!((by_ln_scale / slope - 1.0).abs() < 1e-6);
    }
}
