//! Directions drawn from a table over half and difference angles.

use std::f64::consts::{FRAC_PI_2, PI, TAU};

use gonio_geom::{DVec3, Direction};

use crate::Lobe;

/// Least share of cosine-weighted directions, which reach what the half vectors seldom do.
const LEAST: f64 = 0.05;

/// A mixture of cosine-weighted directions and reflections about half vectors, the latter with a density that is
/// constant over each cell of `theta_h`.
#[derive(Clone, Debug)]
pub(super) struct Proposal {
    /// Share of cosine-weighted directions.
    broad: f64,
    /// `sin^2(theta_h / 2)` at the edges of the cells: proportional to the solid angle up to there.
    edges: Vec<f64>,
    /// Probability of the half vector up to each edge.
    cumulative: Vec<f64>,
}

impl Proposal {
    /// Of the table's mean over difference angles and channels: its least value over `theta_h` makes the broad part,
    /// what stands above that the density of half vectors.
    pub(super) fn new(shape: [usize; 3], values: &[f64]) -> Self {
        let (n, inner) = (shape[0], shape[1] * shape[2]);
        let mut sums = vec![(0.0, 0usize); n];
        for (k, block) in values.chunks(inner).enumerate() {
            for &v in block.iter().filter(|v| **v >= 0.0) {
                sums[k % n].0 += v;
                sums[k % n].1 += 1;
            }
        }
        let mean = |(sum, count): (f64, usize)| (count > 0).then(|| sum / count as f64);
        let floor = sums.iter().filter_map(|s| mean(*s)).fold(f64::INFINITY, f64::min);
        let floor = if floor.is_finite() { floor } else { 0.0 };
        let theta = |k: usize| FRAC_PI_2 * (k as f64 / n as f64).powi(2);
        let edges: Vec<f64> = (0..=n).map(|k| (0.5 * theta(k)).sin().powi(2)).collect();
        let mut cumulative = vec![0.0];
        let mut sum = 0.0;
        for (k, s) in sums.iter().enumerate() {
            let solid_angle = 2.0 * TAU * (edges[k + 1] - edges[k]);
            let cosine = (0.5 * (theta(k) + theta(k + 1))).cos();
            // the light that this cell reflects at normal incidence, where 4 cos(theta_h) half vectors make a direction
            sum += (mean(*s).unwrap_or(0.0) - floor).max(0.0) * solid_angle * 4.0 * cosine;
            cumulative.push(sum);
        }
        let broad = if sum > 0.0 {
            (PI * floor / (PI * floor + sum)).clamp(LEAST, 1.0 - LEAST)
        } else {
            1.0
        };
        if sum > 0.0 {
            cumulative.iter_mut().for_each(|c| *c /= sum);
        }
        Proposal {
            broad,
            edges,
            cumulative,
        }
    }

    /// Density of the half vector whose `sin^2(theta_h / 2)` is `s`, per unit solid angle of half vectors.
    fn half_density(&self, s: f64) -> f64 {
        let k = self
            .edges
            .partition_point(|e| *e <= s)
            .clamp(1, self.edges.len() - 1);
        let solid_angle = 2.0 * TAU * (self.edges[k] - self.edges[k - 1]);
        (self.cumulative[k] - self.cumulative[k - 1]) / solid_angle
    }

    /// Density per unit solid angle with which [`Proposal::sample`] gives `sampled`.
    pub(super) fn pdf(&self, w: Direction, sampled: Direction) -> f64 {
        if !(w.cos_theta() > 0.0 && sampled.cos_theta() > 0.0) {
            return 0.0;
        }
        let broad = self.broad * sampled.cos_theta() / PI;
        if self.broad >= 1.0 {
            return broad;
        }
        let Some(h) = (w.vec() + sampled.vec()).try_normalize() else {
            return broad;
        };
        // half the angle from its sine near the pole, where the cosine has no digits left
        let s = 0.5 * (h.x * h.x + h.y * h.y) / (1.0 + h.z);
        broad + (1.0 - self.broad) * self.half_density(s) / (4.0 * w.vec().dot(h))
    }

    /// A vector along the drawn direction; `None` below the horizon of either direction.
    pub(super) fn sample(&self, w: Direction, u: [f64; 3]) -> Option<(DVec3, Lobe)> {
        if w.cos_theta() <= 0.0 {
            return None;
        }
        let (sin_p, cos_p) = (TAU * u[1]).sin_cos();
        if u[2] < self.broad {
            let (r, z) = (u[0].sqrt(), (1.0 - u[0]).max(0.0).sqrt());
            return (z > 0.0).then_some((DVec3::new(r * cos_p, r * sin_p, z), Lobe::Diffuse));
        }
        let k = self.cumulative.partition_point(|c| *c <= u[0]);
        let k = k.clamp(1, self.edges.len() - 1);
        let (low, high) = (self.cumulative[k - 1], self.cumulative[k]);
        let t = if high > low {
            (u[0] - low) / (high - low)
        } else {
            0.5
        };
        let s = self.edges[k - 1] + t * (self.edges[k] - self.edges[k - 1]);
        let (r, z) = (2.0 * (s * (1.0 - s)).sqrt(), 1.0 - 2.0 * s);
        let h = DVec3::new(r * cos_p, r * sin_p, z);
        let cosine = w.vec().dot(h);
        let v = 2.0 * cosine * h - w.vec();
        (cosine > 0.0 && v.z > 0.0).then_some((v, Lobe::Glossy))
    }
}
