//! Directional albedo of the interpolated model, and the cap that keeps it from creating light between or beyond the
//! measured incidences.

use std::f64::consts::{FRAC_PI_2, PI, TAU};

use gonio_geom::DVec3;
use rayon::prelude::*;

use crate::incidence::{Part, SAME_INCIDENCE};

/// Step of the table over the polar angle of incidence, degrees.
const THETA_STEP: usize = 1;
/// Steps of the table over incidence of an anisotropic model, degrees.
const COARSE_STEP: (usize, usize) = (5, 15);

/// Nodes and weights of the five-point Gauss-Legendre rule on [-1, 1] [AbramowitzStegun1964, table 25.4].
const GAUSS: [(f64, f64); 5] = [
    (-0.906_179_845_938_664, 0.236_926_885_056_189_1),
    (-0.538_469_310_105_683_1, 0.478_628_670_499_366_5),
    (0.0, 0.568_888_888_888_888_9),
    (0.538_469_310_105_683_1, 0.478_628_670_499_366_5),
    (0.906_179_845_938_664, 0.236_926_885_056_189_1),
];

/// Distances from the mirror direction at which the quadrature is split, radians.
const SPLITS: [f64; 6] = [0.01, 0.03, 0.08, 0.2, 0.45, 0.9];

/// Fraction of light that leaves when it comes from `i` (local frame): the sum over `parts` of one side.
pub(crate) fn albedo(parts: &[&Part], i: DVec3) -> f64 {
    let theta_0 = i.x.hypot(i.y).atan2(i.z);
    let phi_0 = (-i.y).atan2(-i.x);
    let mut thetas = vec![0.0, theta_0.min(FRAC_PI_2), FRAC_PI_2];
    let mut phis = vec![-PI, 0.0, PI];
    for d in SPLITS {
        thetas.extend([theta_0 - d, theta_0 + d]);
        phis.extend([-d, d]);
    }
    thetas.retain(|t| (0.0..=FRAC_PI_2).contains(t));
    for list in [&mut thetas, &mut phis] {
        list.sort_unstable_by(f64::total_cmp);
        list.dedup_by(|a, b| *a - *b < 1e-6);
    }
    let mut sum = 0.0;
    for (theta, wt) in nodes(&thetas) {
        let (st, ct) = theta.sin_cos();
        for (phi, wp) in nodes(&phis) {
            let (sp, cp) = (phi_0 + phi).sin_cos();
            let s = DVec3::new(st * cp, st * sp, ct);
            let f: f64 = parts.iter().map(|p| p.eval(i, s)).sum();
            sum += wt * wp * st * ct * f;
        }
    }
    sum
}

/// Gauss nodes and weights over consecutive intervals.
fn nodes(breaks: &[f64]) -> impl Iterator<Item = (f64, f64)> + '_ {
    breaks.windows(2).flat_map(|b| {
        let (centre, half) = (0.5 * (b[0] + b[1]), 0.5 * (b[1] - b[0]));
        GAUSS.map(|(x, w)| (centre + half * x, half * w))
    })
}

/// Factor on the model over incidence: 1 at measured incidences and wherever the albedo stays below the limit.
#[derive(Clone, Debug)]
pub(crate) struct Cap {
    theta_step: f64,
    phi_count: usize,
    factors: Vec<f64>,
    /// Smallest factor and the polar angle where it is, radians.
    pub(crate) worst: (f64, f64),
    /// Largest albedo before the cap, and its polar angle, radians.
    pub(crate) highest: (f64, f64),
}

impl Cap {
    /// The cap of one side. The limit is 1, or the albedo that was measured at the nearest incidences when that is
    /// above 1.
    pub(crate) fn new(parts: &[&Part], isotropic: bool) -> Self {
        let (step, phi_step) = if isotropic { (THETA_STEP, 360) } else { COARSE_STEP };
        let (theta_count, phi_count) = (90 / step + 1, 360 / phi_step);
        let measured: Vec<(DVec3, f64)> = parts
            .iter()
            .flat_map(|p| p.nodes())
            .map(|n| (n.direction, albedo(parts, n.direction)))
            .collect();
        let cells: Vec<(f64, f64)> = (0..theta_count * phi_count)
            .into_par_iter()
            .map(|k| {
                let theta = ((k / phi_count * step) as f64).to_radians().min(FRAC_PI_2 - 1e-3);
                let phi = TAU * (k % phi_count) as f64 / phi_count as f64;
                let i = if isotropic {
                    DVec3::new(-theta.sin(), 0.0, theta.cos())
                } else {
                    DVec3::new(theta.sin() * phi.cos(), theta.sin() * phi.sin(), theta.cos())
                };
                let value = albedo(parts, i);
                (value, (limit(&measured, i) / value.max(1e-12)).min(1.0))
            })
            .collect();
        let angle = |k: usize| ((k / phi_count * step) as f64).to_radians();
        let (mut worst, mut highest) = ((1.0, 0.0), (0.0, 0.0));
        for (k, &(value, factor)) in cells.iter().enumerate() {
            if factor < worst.0 {
                worst = (factor, angle(k));
            }
            if value > highest.0 {
                highest = (value, angle(k));
            }
        }
        Cap {
            theta_step: (step as f64).to_radians(),
            phi_count,
            factors: cells.into_iter().map(|c| c.1).collect(),
            worst,
            highest,
        }
    }

    /// Whether it does anything.
    pub(crate) fn acts(&self) -> bool {
        self.worst.0 < 1.0
    }

    /// The factor at a local incidence, `distance` radians from the nearest measured one.
    pub(crate) fn factor(&self, i: DVec3, distance: f64) -> f64 {
        let theta = i.x.hypot(i.y).atan2(i.z) / self.theta_step;
        let rows = self.factors.len() / self.phi_count;
        let row = (theta as usize).min(rows - 2);
        let t = (theta - row as f64).clamp(0.0, 1.0);
        let phi = i.y.atan2(i.x).rem_euclid(TAU) / TAU * self.phi_count as f64;
        let column = (phi as usize) % self.phi_count;
        let p = phi - phi.floor();
        let at = |r: usize, c: usize| self.factors[r * self.phi_count + c % self.phi_count];
        let along = |r: usize| at(r, column) + p * (at(r, column + 1) - at(r, column));
        let factor = along(row) + t * (along(row + 1) - along(row));
        1.0 - (1.0 - factor) * (distance / SAME_INCIDENCE).min(1.0)
    }
}

/// The largest albedo allowed at `i`: 1, or the inverse-distance mean of what was measured when above.
fn limit(measured: &[(DVec3, f64)], i: DVec3) -> f64 {
    let (mut sum, mut total) = (0.0, 0.0);
    for (direction, value) in measured {
        let w = 1.0 / (1.0 - direction.dot(i)).max(1e-9);
        sum += w * value;
        total += w;
    }
    (sum / total).max(1.0)
}
