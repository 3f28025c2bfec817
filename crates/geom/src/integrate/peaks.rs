//! Uncertainty from peaks that the readings hardly resolve.

use crate::weights::{Cell, Diagram};

/// A peak counts from this share of the integral on.
const SHARE: f64 = 1e-3;
/// A peak stands out of its noise by this factor.
const NOISE: f64 = 5.0;
/// A neighbour below this fraction of the peak says no more about its width.
const FLOOR: f64 = 1e-6;
/// Two neighbours stand on opposite sides of a reading when the cosine between them is below this.
const OPPOSITE: f64 = -0.8;

/// Standard uncertainty of the sum from readings that stand alone on a peak, in the unit of `f` times `weights`.
///
/// The rules of a cell cannot see it: over a regular raster their corrections add up to nothing, whatever the width of
/// the peak. By Poisson's sum formula, lines at a distance `h` take a Gaussian of standard deviation `s` for
/// `1 + 2 exp(-2 pi^2 s^2 / h^2) cos(phase)` of its area. Around every reading higher than all its neighbours, the pair
/// of opposite neighbours that falls off most gives `h^2 / (2 s^2)` as the drop of `ln f` over one step; the
/// contribution of the reading and its neighbours takes part with the rms over the phase (at most its whole).
/// A reading within five of its standard uncertainties (`variance`, none without) is no peak.
pub(super) fn unresolved(
    diagram: &Diagram<'_>,
    f: &[f64],
    variance: Option<&[f64]>,
    weights: &[f64],
    total: f64,
) -> f64 {
    let mut cell = Cell::default();
    let mut square = 0.0;
    for (i, &top) in f.iter().enumerate() {
        let noise = variance.map_or(0.0, |v| v[i].sqrt());
        if top * weights[i] <= 0.0 || top < NOISE * noise || !diagram.cell(i, &mut cell) {
            continue;
        }
        if cell.neighbours.iter().any(|&j| f[j as usize] > top) {
            continue;
        }
        let lobe: f64 = std::iter::once(i)
            .chain(cell.neighbours.iter().map(|&j| j as usize))
            .map(|j| (f[j] * weights[j]).max(0.0))
            .sum();
        if lobe > SHARE * total.abs() {
            square += (lobe * ripple(steepest(diagram, f, i, &cell.neighbours, noise))).powi(2);
        }
    }
    square.sqrt()
}

/// Rms relative error of a sum whose terms fall by `exp(-drop)` from the top over one step.
fn ripple(drop: f64) -> f64 {
    if drop <= 0.0 {
        return 0.0;
    }
    let amplitude = 2.0 * (-std::f64::consts::PI.powi(2) / drop).exp();
    (std::f64::consts::FRAC_1_SQRT_2 * amplitude).min(1.0)
}

/// Largest drop of `ln f` from reading `i` over one step: between neighbours on opposite sides, or half of that to one.
fn steepest(diagram: &Diagram<'_>, f: &[f64], i: usize, neighbours: &[u32], noise: f64) -> f64 {
    let p = diagram.point(i);
    let floor = noise.max(FLOOR * f[i]);
    let around: Vec<_> = neighbours
        .iter()
        .filter_map(|&j| {
            let step = diagram.point(j as usize) - p;
            let length = step.length();
            let drop = (f[i] / f[j as usize].max(floor)).ln();
            (length > 0.0).then(|| (step / length, length, drop))
        })
        .collect();
    // A reading on the flank of a peak falls off on one side only, by less than twice the drop from the top.
    let mut largest = around.iter().map(|n| 0.5 * n.2).fold(0.0, f64::max);
    for (a, &(towards, da, la)) in around.iter().enumerate() {
        for &(other, db, lb) in &around[a + 1..] {
            if towards.dot(other) > OPPOSITE {
                continue;
            }
            // ln f = -curvature x^2 + slope x through both neighbours.
            let curvature = (la / da + lb / db) / (da + db);
            largest = largest.max(curvature * (0.5 * (da + db)).powi(2));
        }
    }
    largest
}
