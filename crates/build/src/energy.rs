//! Directional albedo of the interpolated model, and the cap that keeps it from creating light between or beyond the
//! measured incidences.

use std::f64::consts::{FRAC_PI_2, PI, TAU};

use gonio_geom::DVec3;
use rayon::prelude::*;

use crate::images::{Images, Symmetry};
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

/// Distances from the mirror direction between which it is a rule about that direction, radians, and directions on each of
/// its circles: ridges are as narrow as lobes, but reach far.
const RINGS: [(f64, usize); 9] = [
    (0.01, 24),
    (0.03, 24),
    (0.08, 32),
    (0.2, 64),
    (0.45, 96),
    (0.9, 128),
    (1.5, 128),
    (2.5, 128),
    (PI, 64),
];

/// Fraction of light that leaves when it comes from `i` (local frame): the sum over `parts` of one side.
pub(crate) fn albedo(parts: &[&Part], i: DVec3) -> f64 {
    let isotropic = parts.iter().all(|p| p.symmetry().is_isotropic());
    let (directions, weights) = if isotropic {
        about_normal(i)
    } else {
        about_mirror(i)
    };
    let each = parts.iter().map(|p| p.eval_each(i, directions.iter().copied()));
    each.map(|f| f.iter().zip(&weights).map(|(f, w)| f * w).sum::<f64>())
        .sum()
}

/// Directions and projected solid angles, in polar coordinates about the normal.
fn about_normal(i: DVec3) -> (Vec<DVec3>, Vec<f64>) {
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
    let (mut directions, mut weights) = (Vec::new(), Vec::new());
    for (theta, wt) in nodes(&thetas) {
        let (st, ct) = theta.sin_cos();
        for (phi, wp) in nodes(&phis) {
            let (sp, cp) = (phi_0 + phi).sin_cos();
            directions.push(DVec3::new(st * cp, st * sp, ct));
            weights.push(wt * wp * st * ct);
        }
    }
    (directions, weights)
}

/// The same in polar coordinates about the mirror (through) direction.
fn about_mirror(i: DVec3) -> (Vec<DVec3>, Vec<f64>) {
    let mirror = DVec3::new(-i.x, -i.y, i.z);
    let (a, b) = mirror.any_orthonormal_pair();
    let (mut directions, mut weights) = (Vec::new(), Vec::new());
    let mut from = 0.0;
    for (ring, (to, count)) in RINGS.into_iter().enumerate() {
        for (k, (gamma, wg)) in nodes(&[from, to]).enumerate() {
            let (sg, cg) = gamma.sin_cos();
            let shift = 0.618_034 * (5 * ring + k) as f64;
            for j in 0..count {
                let (sp, cp) = (TAU * (j as f64 + shift) / count as f64).sin_cos();
                let d = mirror * cg + (a * cp + b * sp) * sg;
                if d.z > 0.0 {
                    directions.push(d);
                    weights.push(wg * sg * d.z * TAU / count as f64);
                }
            }
        }
        from = to;
    }
    (directions, weights)
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
    /// The cap of one side, whose unscattered share over incidence is `direct`. The limit is 1, or the albedo that was
    /// measured at the nearest incidences when that is above 1.
    pub(crate) fn new(parts: &[&Part], direct: impl Fn(DVec3) -> f64 + Sync, isotropic: bool) -> Self {
        let albedo = |i: DVec3| albedo(parts, i) + direct(i);
        let (step, phi_step) = if isotropic { (THETA_STEP, 360) } else { COARSE_STEP };
        let (theta_count, phi_count) = (90 / step + 1, 360 / phi_step);
        let measured: Vec<(DVec3, f64)> = parts
            .iter()
            .flat_map(|p| p.nodes())
            .map(|n| (n.direction, albedo(n.direction)))
            .collect();
        // Cells that are images of others are not computed again, nor is the normal.
        let images = match parts.first().map(|p| p.symmetry()) {
            Some(Symmetry::Axes(images)) if parts.iter().all(|p| p.symmetry() == Symmetry::Axes(images)) => {
                images
            }
            _ => Images::None,
        };
        let first_like = |k: usize| {
            let (row, cell) = (k / phi_count, k % phi_count);
            let least = images.iter().map(|m| m.of_cell(cell, phi_count)).min();
            row * phi_count + if row == 0 { 0 } else { least.unwrap_or(cell) }
        };
        let computed: Vec<(f64, f64)> = (0..theta_count * phi_count)
            .into_par_iter()
            .map(|k| {
                if first_like(k) != k {
                    return (0.0, 1.0);
                }
                let theta = ((k / phi_count * step) as f64).to_radians().min(FRAC_PI_2 - 1e-3);
                let phi = TAU * (k % phi_count) as f64 / phi_count as f64;
                let i = if isotropic {
                    DVec3::new(-theta.sin(), 0.0, theta.cos())
                } else {
                    DVec3::new(theta.sin() * phi.cos(), theta.sin() * phi.sin(), theta.cos())
                };
                let value = albedo(i);
                (value, (limit(&measured, i) / value.max(1e-12)).min(1.0))
            })
            .collect();
        let cells: Vec<(f64, f64)> = (0..computed.len()).map(|k| computed[first_like(k)]).collect();
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

#[cfg(test)]
mod tests {
    use super::*;
    use gonio_geom::Direction;

    #[test]
    fn both_rules_give_the_integral_of_the_cosine_and_of_a_lobe() {
        for theta in [0.0, 30.0, 60.0, 80.0] {
            let i = Direction::from_degrees(theta, 200.0).vec();
            let mirror = DVec3::new(-i.x, -i.y, i.z);
            let lobe = |s: DVec3| (-(s - mirror).length_squared() / 0.05f64.powi(2)).exp() / s.z.max(0.2);
            let fine: f64 = {
                let n = 1200;
                let cells = (0..n * n).map(|k| {
                    let (r, p) = (
                        0.3 * ((k / n) as f64 + 0.5) / n as f64,
                        TAU * (k % n) as f64 / n as f64,
                    );
                    let (a, b) = mirror.any_orthonormal_pair();
                    let s = mirror * r.cos() + (a * p.cos() + b * p.sin()) * r.sin();
                    if s.z > 0.0 {
                        lobe(s) * s.z * r.sin() * 0.3 / n as f64 * TAU / n as f64
                    } else {
                        0.0
                    }
                });
                cells.sum()
            };
            for (directions, weights) in [about_normal(i), about_mirror(i)] {
                let sum = |f: &dyn Fn(DVec3) -> f64| -> f64 {
                    directions.iter().zip(&weights).map(|(&s, w)| w * f(s)).sum()
                };
                assert!(
                    (sum(&|_| 1.0) / PI - 1.0).abs() < 3e-3,
                    "{theta} {}",
                    sum(&|_| 1.0) / PI
                );
                assert!(
                    (sum(&lobe) / fine - 1.0).abs() < 5e-3,
                    "{theta} {} {fine}",
                    sum(&lobe)
                );
            }
        }
    }

    #[test]
    fn the_rule_about_the_mirror_direction_does_not_lose_a_narrow_ridge() {
        // Facets with slopes of 0.02 across and 0.4 along: their light at normal incidence by a fine grid of slopes.
        let i = Direction::from_degrees(5.0, 0.0).vec();
        let ridge = |s: DVec3| {
            let h = i + s;
            let e = (h.x / (0.02 * h.z)).powi(2) + (h.y / (0.4 * h.z)).powi(2);
            (-e).exp() * h.length_squared() / (PI * 0.02 * 0.4 * h.z.powi(4))
        };
        let (directions, weights) = about_mirror(i);
        let sum: f64 = directions.iter().zip(&weights).map(|(&s, w)| w * ridge(s)).sum();
        // Its albedo is 1 but for what the facets send below the horizon and the factor 2 c_s / (c_i + c_s).
        assert!((0.8..1.0).contains(&sum), "{sum}");
        let n = 700;
        let fine: f64 = (0..n * n)
            .map(|k| {
                let at = |k: usize| 6.0 * ((k as f64 + 0.5) / n as f64 - 0.5);
                let (u, v) = (at(k % n), at(k / n));
                let h = DVec3::new(0.02 * u, 0.4 * v, 1.0).normalize();
                let s = h * (2.0 * h.dot(i)) - i;
                let density = (-u * u - v * v).exp() / PI * (6.0 / n as f64).powi(2);
                if s.z > 0.0 {
                    density * 2.0 * s.z / (s.z + i.z)
                } else {
                    0.0
                }
            })
            .sum();
        assert!((sum / fine - 1.0).abs() < 0.02, "{sum} {fine}");
    }
}
