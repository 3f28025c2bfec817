//! Where the search begins.

use gonio_bsdf::analytic::Role;

use crate::Product;
use crate::chart::Chart;
use crate::data::FitData;
use crate::metric::{Loss, Metric};
use crate::objective::Objective;
use crate::solver::{Solution, SolverOptions, Stop, minimise};

/// Widths a lobe is tried with: from a beam's own width to a broad sheen.
const WIDTHS: [f64; 5] = [0.008, 0.025, 0.07, 0.18, 0.45];
/// Steps in which a further positive parameter that spans decades is tried.
const DECADES: usize = 4;
/// Azimuths of an anisotropic lobe's axis that are tried, radians.
const AXES: [f64; 2] = [0.0, std::f64::consts::FRAC_PI_4];
/// Indices that are tried, as shares of their range: 0.5, 1.5 and 3.5 of eta, 1, 3 and 7 of k. From an index far off, the first
/// steps end at k = 0, where the derivative by k vanishes.
const INDICES: [f64; 3] = [0.05, 0.15, 0.35];
/// Most points that are tried.
const MOST: usize = 512;
/// How many of them are followed after their amplitudes are known, and how many of those to the end.
const FOLLOWED: usize = 6;
const FINISHED: usize = 3;

/// The starting points: every combination of widths, decades and axes, with amplitudes at their default. Lobes of the same
/// family start with different widths, narrow first.
pub(crate) fn starts(
    chart: &Chart<'_>,
    low: &[f64],
    high: &[f64],
    fixed: &[bool],
    defaults: &[f64],
) -> Vec<Vec<f64>> {
    let mut all = vec![defaults.to_vec()];
    for (k, parameter) in chart.model.parameters.iter().enumerate() {
        // One value for all channels: their combinations would crowd out the widths.
        let own: Vec<usize> = (0..chart.len())
            .filter(|&v| chart.variables[v].parameter == k && !fixed[v])
            .collect();
        let Some(&v) = own.first() else { continue };
        let variable = chart.variables[v];
        let values: Vec<f64> = match parameter.role {
            Role::Width => WIDTHS.iter().map(|w| variable.of_value(*w)).collect(),
            Role::Angle => AXES.to_vec(),
            Role::Index => INDICES
                .iter()
                .map(|s| variable.of_value(parameter.low + s * (parameter.high - parameter.low)))
                .collect(),
            Role::Exponent if variable.log => (0..DECADES)
                .map(|k| low[v] + (high[v] - low[v]) * (k as f64 + 0.5) / DECADES as f64)
                .collect(),
            _ => continue,
        };
        let values: Vec<f64> = values.iter().map(|x| x.clamp(low[v], high[v])).collect();
        if all.len() * values.len() > MOST {
            continue;
        }
        all = all
            .iter()
            .flat_map(|x| {
                values.iter().map(|value| {
                    let mut x = x.clone();
                    own.iter().for_each(|&v| x[v] = *value);
                    x
                })
            })
            .collect();
    }
    all.dedup();
    all.retain(|x| ordered(chart, x));
    all
}

/// Whether the widths of lobes of the same family ascend: two lobes alike never part, and in another order the points are the
/// same sums again.
fn ordered(chart: &Chart<'_>, x: &[f64]) -> bool {
    twins(chart)
        .iter()
        .all(|(a, b)| width(chart, *a, x) < width(chart, *b, x))
}

/// Neighbouring parts of the same family that have a width.
fn twins(chart: &Chart<'_>) -> Vec<(usize, usize)> {
    let parts = &chart.model.parts;
    let name = |k: usize| parts[k].info().name;
    let has_width = |k: usize| parts[k].info().parameters.iter().any(|p| p.role == Role::Width);
    (1..parts.len())
        .filter(|&k| has_width(k))
        .filter_map(|k| Some(((0..k).rev().find(|&j| name(j) == name(k))?, k)))
        .collect()
}

/// The first width of a part; NaN without any.
fn width(chart: &Chart<'_>, part: usize, x: &[f64]) -> f64 {
    let part = &chart.model.parts[part];
    let at = part.info().parameters.iter().position(|p| p.role == Role::Width);
    at.map_or(f64::NAN, |k| part.values[k].value(&chart.parameters(x, 0)))
}

/// `x` with lobes of the same family in the order of their widths, narrow first, where each has parameters of its own and
/// none of them is `held`.
pub(crate) fn narrow_first(chart: &Chart<'_>, held: &[bool], x: &[f64]) -> Vec<f64> {
    let mut x = x.to_vec();
    let twins = twins(chart);
    // The variables of each parameter of a part; `None` where they are not its own.
    let variables = |part: usize| -> Option<Vec<usize>> {
        let mut all = Vec::new();
        for value in &chart.model.parts[part].values {
            let parameter = (0..chart.model.parameters.len()).find(|&p| *value == Product::of(p))?;
            all.extend((0..chart.len()).filter(|&v| chart.variables[v].parameter == parameter));
        }
        all.iter().all(|&v| !held[v]).then_some(all)
    };
    for _ in 0..twins.len() {
        for &(a, b) in &twins {
            if width(chart, a, &x) > width(chart, b, &x)
                && let (Some(first), Some(second)) = (variables(a), variables(b))
            {
                first.iter().zip(&second).for_each(|(&j, &k)| x.swap(j, k));
            }
        }
    }
    x
}

/// The best few minima in the cube-root metric from all starting points, best first. Cube roots compress the range of
/// the readings, so that neither the peak nor the floor rules far from the minimum. First the amplitudes alone are fitted, in
/// which the models are nearly linear, to the readings `few`; then everything to all of `data`.
pub(crate) fn search(
    chart: &Chart<'_>,
    (few, data): (&FitData, &FitData),
    points: Vec<Vec<f64>>,
    (low, high): (&[f64], &[f64]),
    options: &SolverOptions<'_>,
) -> Vec<Solution> {
    let objective = |data| Objective {
        chart,
        data,
        metric: Metric::CubeRoot,
        loss: Loss::Linear,
        by_solid_angle: false,
    };
    let held: Vec<bool> = chart
        .variables
        .iter()
        .enumerate()
        .map(|(k, v)| options.fixed[k] || chart.model.parameters[v.parameter].role != Role::Amplitude)
        .collect();
    let run = |data, points: Vec<Vec<f64>>, fixed: &[bool], most: usize, kept: usize| -> Vec<Solution> {
        let options = SolverOptions {
            fixed,
            max_evaluations: most,
            step_tolerance: 1e-5,
            ..options.clone()
        };
        let mut found: Vec<Solution> = points
            .iter()
            .map(|x| minimise(&objective(data), x, low, high, &options))
            .filter(|s| s.stop != Stop::NotFinite)
            .collect();
        found.sort_by(|a, b| a.normal.cost.total_cmp(&b.normal.cost));
        found.truncate(kept);
        found
    };
    let amplitudes = run(few, points, &held, 12, FOLLOWED);
    let points = amplitudes.into_iter().map(|s| s.x).collect();
    run(data, points, options.fixed, 80, FINISHED)
}
