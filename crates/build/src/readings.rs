//! The readings of one incidence and one component, in the local frame of the model.

use std::f64::consts::PI;

use gonio_geom::{Angles, DVec3, Direction, Side};
use gonio_scan::{Flags, Slice};

use crate::plane::{Point, to_plane};

/// Readings closer to the sample plane than this cosine are left out: dividing their DSF by the cosine gives noise.
const LEAST_COSINE: f64 = 0.01;

/// Two readings whose images in the plane agree to this are one direction.
const SAME_POINT: f64 = 1e-7;

/// BSDF readings over the upper hemisphere of the local frame, one entry a distinct direction.
#[derive(Clone, Debug, Default)]
pub(crate) struct Readings {
    pub(crate) points: Vec<Point>,
    /// BSDF, 1/sr.
    pub(crate) value: Vec<f64>,
    /// Independent standard uncertainty of `value`, 1/sr; 0 when unknown.
    pub(crate) sigma: Vec<f64>,
}

/// The local frame: both directions are taken to the upper hemisphere (`z` to `|z|`), so that mirror and through
/// direction fall on one point. With `turn`, everything is rotated about the normal by it.
pub(crate) fn local(direction: Direction, turn: f64) -> DVec3 {
    let v = direction.rotated(turn).vec();
    DVec3::new(v.x, v.y, v.z.abs())
}

/// The rotation that takes an incidence azimuth to pi, so that the mirror direction has azimuth 0.
pub(crate) fn turn_to_pi(incidence: Angles) -> f64 {
    PI - incidence.phi
}

impl Readings {
    /// The usable readings of `slices` (one incidence) that lie on `side`, rotated by `turn`; directions read more
    /// than once are averaged.
    pub(crate) fn collect(slices: &[&Slice], side: Side, turn: f64) -> Self {
        let mut all = Readings::default();
        for slice in slices {
            for j in 0..slice.len() {
                let flags = slice.flags[j];
                let direction = slice.direction(j);
                let cosine = direction.cos_theta().abs();
                if !flags.usable()
                    || flags.intersects(Flags::HORIZON)
                    || cosine < LEAST_COSINE
                    || direction.side() != side
                    || !slice.dsf[j].is_finite()
                {
                    continue;
                }
                let common = slice.u_common * slice.dsf[j];
                let variance = slice.u_dsf[j] * slice.u_dsf[j] - common * common;
                all.points.push(to_plane(local(direction, turn)));
                all.value.push(slice.dsf[j] / cosine);
                all.sigma.push(if variance > 0.0 {
                    variance.sqrt() / cosine
                } else {
                    0.0
                });
            }
        }
        all.merged()
    }

    /// Adds one.
    pub(crate) fn push(&mut self, point: Point, value: f64, sigma: f64) {
        self.points.push(point);
        self.value.push(value);
        self.sigma.push(sigma);
    }

    pub(crate) fn len(&self) -> usize {
        self.value.len()
    }

    /// These readings together with their mirror images at the plane of incidence (`y = 0`).
    pub(crate) fn with_mirror_images(&self) -> Self {
        let mut both = self.clone();
        for k in 0..self.len() {
            let p = self.points[k];
            both.points.push([p[0], -p[1]]);
            both.value.push(self.value[k]);
            both.sigma.push(self.sigma[k]);
        }
        both.merged()
    }

    /// One entry a distinct point.
    fn merged(self) -> Self {
        let key = |p: Point| p.map(|x| (x / SAME_POINT).round() as i64);
        let mut order: Vec<usize> = (0..self.len()).collect();
        order.sort_unstable_by_key(|&k| key(self.points[k]));
        let mut out = Readings::default();
        let mut k = 0;
        while k < order.len() {
            let first = order[k];
            let (mut sum, mut variance, mut count) = (0.0, 0.0, 0.0);
            while k < order.len() && key(self.points[order[k]]) == key(self.points[first]) {
                sum += self.value[order[k]];
                variance += self.sigma[order[k]] * self.sigma[order[k]];
                count += 1.0;
                k += 1;
            }
            out.points.push(self.points[first]);
            out.value.push(sum / count);
            out.sigma.push(f64::sqrt(variance) / count);
        }
        out
    }

    /// Least root-mean-square extent of the points in any direction of the plane: near zero for readings of one
    /// scattering plane only.
    pub(crate) fn least_extent(&self) -> f64 {
        let n = self.len() as f64;
        let mean = |f: &dyn Fn(Point) -> f64| self.points.iter().map(|&p| f(p)).sum::<f64>() / n;
        let (mx, my) = (mean(&|p| p[0]), mean(&|p| p[1]));
        let xx = mean(&|p| (p[0] - mx).powi(2));
        let yy = mean(&|p| (p[1] - my).powi(2));
        let xy = mean(&|p| (p[0] - mx) * (p[1] - my));
        let half = 0.5 * (xx + yy);
        (half - (0.25 * (xx - yy).powi(2) + xy * xy).sqrt())
            .max(0.0)
            .sqrt()
    }
}
