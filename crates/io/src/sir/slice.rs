//! The scattered light of one incidence: a sum of Gaussian lobes.

use std::f64::consts::{PI, TAU};

use gonio_geom::DVec3;

use super::grid::moderated;

/// Exponent below which a lobe counts as nothing.
const FAR: f64 = -30.0;

/// One lobe: `peak exp((d . axis - 1) / radius^2)`, 1/sr.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Lobe {
    pub(super) peak: f64,
    pub(super) radius: f64,
    pub(super) axis: DVec3,
}

/// A DSF as a sum of lobes, over a least BSDF.
#[derive(Clone, Debug, Default)]
pub(super) struct Slice {
    /// Columns: axis, peak, `1 / radius^2`.
    x: Vec<f64>,
    y: Vec<f64>,
    z: Vec<f64>,
    peak: Vec<f64>,
    sharpness: Vec<f64>,
    /// Sums of the light of the lobes up to each.
    light: Vec<f64>,
    /// Least BSDF, 1/sr.
    floor: f64,
}

impl Slice {
    pub(super) fn new(lobes: &[Lobe], floor: f64) -> Self {
        let mut slice = Slice {
            floor,
            ..Slice::default()
        };
        let mut sum = 0.0;
        for lobe in lobes {
            let sharpness = 1.0 / (lobe.radius * lobe.radius);
            slice.x.push(lobe.axis.x);
            slice.y.push(lobe.axis.y);
            slice.z.push(lobe.axis.z);
            slice.peak.push(lobe.peak);
            slice.sharpness.push(sharpness);
            sum += TAU * lobe.peak / sharpness * (1.0 - (-2.0 * sharpness).exp());
            slice.light.push(sum);
        }
        slice
    }

    pub(super) fn len(&self) -> usize {
        self.peak.len()
    }

    /// The sum of the lobes, 1/sr.
    fn dsf(&self, d: DVec3) -> f64 {
        let mut sum = 0.0;
        for k in 0..self.len() {
            let cos = d.x * self.x[k] + d.y * self.y[k] + d.z * self.z[k];
            let exponent = (cos - 1.0) * self.sharpness[k];
            if exponent > FAR {
                sum += self.peak[k] * exponent.exp();
            }
        }
        sum
    }

    /// The BSDF, 1/sr.
    pub(super) fn value(&self, d: DVec3) -> f64 {
        (self.dsf(d) / moderated(d.z)).max(self.floor)
    }

    /// Light of all lobes over the whole sphere and of the floor over the hemisphere.
    fn total(&self) -> f64 {
        self.light.last().copied().unwrap_or(0.0) + PI * self.floor
    }

    /// Density of [`Slice::sample`], 1/sr: exactly the lobes and the floor.
    pub(super) fn pdf(&self, d: DVec3) -> f64 {
        let total = self.total();
        if total > 0.0 {
            (self.dsf(d) + self.floor * d.z.abs()) / total
        } else {
            0.0
        }
    }

    /// A direction of a lobe chosen by its light, or of the floor; `None` past the horizon. `sign` is that of `z` on the
    /// lit hemisphere.
    pub(super) fn sample(&self, u: [f64; 3], sign: f64) -> Option<DVec3> {
        let wanted = u[2] * self.total();
        let phi = TAU * u[1];
        let k = self.light.partition_point(|sum| *sum <= wanted);
        if k == self.len() {
            let r = u[0].sqrt();
            let z = (1.0 - u[0]).sqrt();
            return Some(DVec3::new(r * phi.cos(), r * phi.sin(), sign * z));
        }
        let sharpness = self.sharpness[k];
        let cos = (1.0 + (-u[0] * (1.0 - (-2.0 * sharpness).exp())).ln_1p() / sharpness).clamp(-1.0, 1.0);
        let sin = (1.0 - cos * cos).sqrt();
        let axis = DVec3::new(self.x[k], self.y[k], self.z[k]);
        let (a, b) = axis.any_orthonormal_pair();
        let d = (cos * axis + sin * (phi.cos() * a + phi.sin() * b)).normalize();
        (d.z * sign > 0.0).then_some(d)
    }
}
