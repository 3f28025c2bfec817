//! What a minimum says of the parameters: values, intervals, covariance.

use gonio_bsdf::analytic::Role;
use nalgebra::DMatrix;

use crate::covariance::Covariance;
use crate::data::FitData;
use crate::fitting::Setting;
use crate::limits::{Z95, mistrusted, profile_interval, resolution};
use crate::solver::Solution;
use crate::{Estimate, FitOptions, Interval, Kind};

/// The estimates of all variables with their intervals.
pub(crate) fn estimates(
    setting: &Setting<'_>,
    data: &FitData,
    solution: &Solution,
    spread: Option<&Covariance>,
    options: &FitOptions<'_>,
) -> Vec<Estimate> {
    let model = setting.chart.model;
    (0..setting.chart.len())
        .map(|k| {
            let variable = setting.chart.variables[k];
            let parameter = &model.parameters[variable.parameter];
            let (x, value) = (solution.x[k], variable.value(solution.x[k]));
            let slope = variable.slope(value);
            let known = spread.filter(|s| s.free[k]);
            let u_x = known.map_or(0.0, |s| s.matrix[(k, k)].max(0.0).sqrt());
            let common = known.map_or(0.0, |s| s.common[k].abs());
            let kind = if setting.held[k] {
                Kind::Fixed
            } else if known.is_none() {
                Kind::Undetermined
            } else {
                Kind::Value
            };
            let mut estimate = Estimate {
                name: parameter.name.clone(),
                unit: parameter.unit.clone(),
                role: parameter.role,
                channel: variable.channel.map(|c| data.channels[c]),
                value,
                u: u_x * slope,
                u_common: common * slope,
                u_model: 0.0,
                low: variable.value((x - Z95 * u_x).max(setting.low[k])),
                high: variable.value((x + Z95 * u_x).min(setting.high[k])),
                kind,
                interval: Interval::Quadratic,
                open: None,
            };
            if let Some(s) = known {
                let doubtful = mistrusted(variable.log, x, u_x, setting.low[k], setting.high[k]);
                let own = (u_x * u_x - common * common).max(0.0);
                if options.profile
                    && options.sphere.is_empty()
                    && doubtful
                    && own > 0.0
                    && s.bread[(k, k)] > 0.0
                {
                    let ratio = own / s.bread[(k, k)];
                    let (low, high) = profile_interval(
                        &setting.goal.objective(&setting.chart, data),
                        solution,
                        k,
                        (own.sqrt(), ratio),
                        setting.bounds(),
                        &setting.solver(options),
                    );
                    let widen = |end: f64| x + (end - x).signum() * (end - x).hypot(Z95 * common);
                    estimate.low = variable.value(widen(low).max(setting.low[k]));
                    estimate.high = variable.value(widen(high).min(setting.high[k]));
                    estimate.interval = Interval::Profile;
                }
                let limit = resolution(&setting.chart, data, variable.parameter);
                if let Some(limit) = limit.filter(|l| value < *l && parameter.role == Role::Width) {
                    estimate.kind = Kind::UpperLimit;
                    estimate.high = estimate.high.max(limit);
                    estimate.low = parameter.low;
                }
            } else if kind == Kind::Undetermined {
                (estimate.low, estimate.high) = (parameter.low, parameter.high);
            }
            let near = 1e-6 * (setting.high[k] - setting.low[k]).abs();
            let at_end = x - setting.low[k] <= near || setting.high[k] - x <= near;
            estimate.open = estimate.openness(parameter.low, parameter.high, at_end);
            estimate
        })
        .collect()
}

/// Covariance and correlation of the estimates.
pub(crate) fn in_parameters(
    setting: &Setting<'_>,
    estimates: &[Estimate],
    spread: Option<&Covariance>,
) -> (Vec<f64>, Vec<f64>) {
    let n = estimates.len();
    let slope = |k: usize| setting.chart.variables[k].slope(estimates[k].value);
    let matrix = spread.map_or_else(
        || DMatrix::zeros(n, n),
        |s| DMatrix::from_fn(n, n, |a, b| s.matrix[(a, b)] * slope(a) * slope(b)),
    );
    let u: Vec<f64> = (0..n).map(|k| matrix[(k, k)].max(0.0).sqrt()).collect();
    let row_major =
        |f: &dyn Fn(usize, usize) -> f64| -> Vec<f64> { (0..n * n).map(|k| f(k / n, k % n)).collect() };
    let correlation = row_major(&|a, b| {
        let scale = u[a] * u[b];
        if scale > 0.0 { matrix[(a, b)] / scale } else { 0.0 }
    });
    (row_major(&|a, b| matrix[(a, b)]), correlation)
}
