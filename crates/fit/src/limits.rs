//! Intervals where the curvature at the minimum misleads, and lobes that the beam hides.

use gonio_bsdf::analytic::Role;
use gonio_geom::Component;

use crate::chart::Chart;
use crate::data::FitData;
use crate::objective::Objective;
use crate::solver::{Solution, SolverOptions, minimise};

/// Half width of a 95 % interval in standard deviations.
pub(crate) const Z95: f64 = 1.959_963_984_540_054;
/// Relative uncertainty of a positive parameter from which its interval is asymmetric.
const BROAD: f64 = 0.15;
/// Trials for one end of a profile interval.
const TRIALS: usize = 8;

/// Ends of the 95 % profile interval of variable `k`: where the cost, minimised over the others, has risen by
/// `z^2 / 2` times `ratio`, the ratio of the variance to that of the inverse Gauss–Newton matrix. An end beyond the
/// bounds is the bound.
pub(crate) fn profile_interval(
    objective: &Objective<'_>,
    best: &Solution,
    k: usize,
    (u, ratio): (f64, f64),
    (low, high): (&[f64], &[f64]),
    options: &SolverOptions<'_>,
) -> (f64, f64) {
    let rise = 0.5 * Z95 * Z95 * ratio;
    let mut fixed = options.fixed.to_vec();
    fixed[k] = true;
    let options = SolverOptions {
        fixed: &fixed,
        max_evaluations: 20,
        step_tolerance: 1e-6,
        cost_tolerance: 1e-10,
        ..options.clone()
    };
    let end = |direction: f64, bound: f64| -> f64 {
        let centre = best.x[k];
        // Root of sqrt(rise(t)) - sqrt(wanted), which is linear where the cost is quadratic.
        let (mut inside, mut outside): ((f64, f64), Option<(f64, f64)>) = ((0.0, 0.0), None);
        let mut step = Z95 * u;
        for _ in 0..TRIALS {
            let limited = step.min((bound - centre).abs());
            let mut x = best.x.clone();
            x[k] = centre + direction * limited;
            let found = minimise(objective, &x, low, high, &options);
            let value = ((found.normal.cost - best.normal.cost).max(0.0) / rise).sqrt();
            if (value - 1.0).abs() < 0.01 {
                return x[k];
            }
            if value < 1.0 {
                inside = (limited, value);
                if limited < step {
                    return bound;
                }
            } else {
                outside = Some((limited, value));
            }
            step = match outside {
                Some((t, v)) => {
                    let linear = inside.0 + (t - inside.0) * (1.0 - inside.1) / (v - inside.1);
                    let width = t - inside.0;
                    linear.clamp(inside.0 + 0.05 * width, t - 0.05 * width)
                }
                None => 2.0 * limited.max(1e-12),
            };
        }
        centre + direction * step
    };
    (end(-1.0, low[k]), end(1.0, high[k]))
}

/// Whether the quadratic interval of a variable at `x` with standard uncertainty `u` is to be mistrusted: it reaches past
/// a bound, or the parameter is known to worse than 15 % while its logarithm is what varies.
pub(crate) fn mistrusted(log: bool, x: f64, u: f64, low: f64, high: f64) -> bool {
    u > 0.0 && (x - Z95 * u < low || x + Z95 * u > high || (log && u > BROAD))
}

/// The width below which `parameter` cannot be told from the beam: a lobe is resolved when its 1/e half width is at
/// least twice the radius of the beam, 2 `alpha` in reflection, `alpha` in transmission. `None` for parameters that are
/// not a width, or without a beam profile.
pub(crate) fn resolution(chart: &Chart<'_>, data: &FitData, parameter: usize) -> Option<f64> {
    let model = chart.model;
    if model.parameters[parameter].role != Role::Width {
        return None;
    }
    let radius = data
        .profiles
        .iter()
        .flatten()
        .map(crate::Profile::radius)
        .fold(f64::NAN, f64::max);
    if !radius.is_finite() {
        return None;
    }
    let reflects = model.parts.iter().any(|p| {
        p.values.iter().any(|v| v.uses(parameter))
            && p.info().scatters.into(Component::Reflection)
            && data.slabs.iter().any(|s| s.component == Component::Reflection)
    });
    Some(if reflects { radius } else { 2.0 * radius })
}
