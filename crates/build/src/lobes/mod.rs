//! The lobes of a slice that move on their own: Gaussians over direction cosines, and how each moves with the incidence.

mod find;
mod moved;
mod tracks;

use gonio_geom::DVec3;

use crate::images::Image;

pub(crate) use find::find;
pub(crate) use moved::Moved;
pub(crate) use tracks::Tracks;

/// A Gaussian over the direction cosines of scattering.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Lobe {
    pub(crate) centre: [f64; 2],
    pub(crate) covariance: Symmetric,
    /// BSDF at the centre, 1/sr.
    pub(crate) height: f64,
}

impl Lobe {
    /// The BSDF at direction cosines `p`, 1/sr.
    #[inline]
    pub(crate) fn value(&self, p: [f64; 2]) -> f64 {
        let d = [p[0] - self.centre[0], p[1] - self.centre[1]];
        let q = self.covariance.inverse_form(d);
        if q > 80.0 {
            0.0
        } else {
            self.height * (-0.5 * q).exp()
        }
    }

    /// Its share of the incident light.
    pub(crate) fn mass(&self) -> f64 {
        self.height * std::f64::consts::TAU * self.covariance.determinant().sqrt()
    }

    /// Its image.
    fn of(&self, image: Image) -> Self {
        let [x, y] = image.of_point([1.0, 1.0]);
        Lobe {
            centre: image.of_point(self.centre),
            covariance: Symmetric {
                xy: x * y * self.covariance.xy,
                ..self.covariance
            },
            ..*self
        }
    }
}

/// A symmetric 2 x 2 matrix.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Symmetric {
    pub(crate) xx: f64,
    pub(crate) xy: f64,
    pub(crate) yy: f64,
}

impl Symmetric {
    pub(crate) fn diagonal(v: f64) -> Self {
        Symmetric {
            xx: v,
            xy: 0.0,
            yy: v,
        }
    }

    pub(crate) fn determinant(&self) -> f64 {
        self.xx * self.yy - self.xy * self.xy
    }

    /// `d' M^-1 d`.
    #[inline]
    fn inverse_form(&self, d: [f64; 2]) -> f64 {
        let form = self.yy * d[0] * d[0] - 2.0 * self.xy * d[0] * d[1] + self.xx * d[1] * d[1];
        form / self.determinant()
    }

    /// The positive root of a positive matrix.
    fn root(&self) -> Self {
        let s = self.determinant().max(0.0).sqrt();
        let t = (self.xx + self.yy + 2.0 * s).sqrt().max(1e-300);
        Symmetric {
            xx: (self.xx + s) / t,
            xy: self.xy / t,
            yy: (self.yy + s) / t,
        }
    }

    /// The same axes with eigenvalues in `low..=high`.
    fn clamped(&self, low: f64, high: f64) -> Self {
        let (mean, half) = (0.5 * (self.xx + self.yy), 0.5 * (self.xx - self.yy));
        let radius = half.hypot(self.xy);
        let (a, b) = ((mean + radius).clamp(low, high), (mean - radius).clamp(low, high));
        if radius <= 0.0 {
            return Symmetric::diagonal(a);
        }
        let (mean, scale) = (0.5 * (a + b), 0.5 * (a - b) / radius);
        Symmetric {
            xx: mean + scale * half,
            xy: scale * self.xy,
            yy: mean - scale * half,
        }
    }
}

/// Lobes over a floor, what a slice is divided by where a base of all incidences does not follow its peaks.
#[derive(Clone, Debug)]
pub(crate) struct Lobes {
    pub(crate) floor: f64,
    pub(crate) lobes: Vec<Lobe>,
}

impl Lobes {
    /// The BSDF, 1/sr.
    #[inline]
    pub(crate) fn eval(&self, s: DVec3) -> f64 {
        self.floor + self.lobes.iter().map(|l| l.value([s.x, s.y])).sum::<f64>()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_root_squares_to_the_matrix_and_images_turn_the_axes() {
        let m = Symmetric {
            xx: 0.04,
            xy: 0.01,
            yy: 0.02,
        };
        let r = m.root();
        assert!((r.xx * r.xx + r.xy * r.xy - m.xx).abs() < 1e-15);
        assert!((r.xx * r.xy + r.xy * r.yy - m.xy).abs() < 1e-15);
        let c = m.clamped(0.025, 0.03);
        assert!((c.xx + c.yy - 0.055).abs() < 1e-12 && c.determinant() > 0.0);
        let lobe = Lobe {
            centre: [0.2, 0.1],
            covariance: m,
            height: 2.0,
        };
        let image = lobe.of(Image::FLIP_X);
        assert!((image.value([-0.3, 0.2]) - lobe.value([0.3, 0.2])).abs() < 1e-12);
    }
}
