//! The fit from readings to parameters.

use gonio_geom::Component;
use gonio_scan::Measurement;

use crate::canonical::canonical;
use crate::chart::Chart;
use crate::covariance::covariance;
use crate::data::FitData;
use crate::estimates::{estimates, in_parameters};
use crate::limits::resolution;
use crate::metric::Metric;
use crate::refine::{Goal, refine, settle};
use crate::result::{Fit, OtherMetric};
use crate::selection::phrase;
use crate::solver::{Solution, SolverOptions, Stop};
use crate::sphere::disagreements;
use crate::sphere_fit::add_sphere;
use crate::start::{narrow_first, search, starts};
use crate::{FitError, FitModel, FitOptions, albedo, report, warnings};

/// Highest reading in standard deviations of the noise floor, and share of readings above three of them, from which a
/// channel carries a signal.
const SIGNAL: f64 = 6.0;
const SIGNAL_SHARE: f64 = 0.005;
/// A lobe's half width in beam radii that a search does not go below: rules of quadrature resolve no less.
const LEAST_WIDTH: f64 = 1.0 / 6.0;

/// Fits `model` to `measurement`: jointly over all incidences and channels, in the DSF.
///
/// The search runs over the logarithm of widths from many starting points on a part of the readings, then to the minimum over
/// all of them. Standard deviations of chi-square come from each slice's noise law at the predicted DSF. The beam profile of
/// the measurement is folded into the model where it changes a prediction. Readings that are unusable, or beyond
/// `max_theta_s`, are left out and counted. NaN readings do no harm.
///
/// # Errors
/// [`FitError`]: an unknown channel or option, too few readings, readings of another component than the model's, no
/// signal, or a search that finds no minimum. Anything short of that is a [`crate::result::Warning`].
pub fn fit(measurement: &Measurement, model: &FitModel, options: &FitOptions<'_>) -> Result<Fit, FitError> {
    let described = |c| model.scatters_into(c);
    let mut data = FitData::new(measurement, &options.selection, described, options.signature)?;
    let setting = Setting::new(model, &data, options)?;
    check(&data, model, &setting)?;
    let known = setting.known(&data, options.start.as_deref())?;
    let start = setting.start(&data, known.as_deref())?;
    let solution = refine(
        &setting.chart,
        &mut data,
        setting.goal,
        &start,
        setting.bounds(),
        &setting.solver(options),
    );
    if solution.stop == Stop::Cancelled {
        return Err(FitError::Cancelled);
    }
    if solution.stop == Stop::NotFinite || solution.x.iter().any(|v| !v.is_finite()) {
        return Err(setting.not_converged(solution.evaluations));
    }
    let mut solution = canonical(&setting, &mut data, solution, options);
    let objective = setting.goal.objective(&setting.chart, &data);
    let mut spread = covariance(&objective, &solution.x, &solution.normal, &setting.held);
    let mut predicted = match &mut spread {
        Some(spread) => std::mem::take(&mut spread.predicted),
        None => objective.predict(&solution.x),
    };
    let mut others = other_metrics(&setting, &mut data, &solution, options)?;
    let mut sphere = Vec::new();
    if !options.sphere.is_empty() {
        sphere = add_sphere(
            &setting,
            &data,
            &mut solution.x,
            spread.as_mut(),
            &mut others,
            options,
        )?;
        predicted = setting.goal.objective(&setting.chart, &data).predict(&solution.x);
    }
    let other_metrics = in_values(&setting, others);
    let mut estimates = estimates(&setting, &data, &solution, spread.as_ref(), options);
    for (k, e) in estimates.iter_mut().enumerate() {
        e.u_model = other_metrics
            .iter()
            .map(|o| (o.values[k] - e.value).abs())
            .fold(0.0, f64::max);
    }
    let (covariance, correlation) = in_parameters(&setting, &estimates, spread.as_ref());
    let mut fit = Fit {
        model: model.clone(),
        metric: setting.goal.metric,
        loss: setting.goal.loss,
        weights: setting.goal.weights,
        channels: data.channels.clone(),
        covariance,
        correlation,
        other_metrics,
        readings: data.len(),
        excluded: data.excluded.clone(),
        blocks: spread.as_ref().map_or(0, |s| s.cells),
        cost: solution.normal.cost,
        dispersion: spread.as_ref().and_then(|s| s.dispersion),
        design_effect: spread.as_ref().map_or(1.0, |s| s.design_effect),
        aicc: f64::NAN,
        evaluations: solution.evaluations,
        converged: solution.stop.converged(),
        residuals: report::residuals(&data, &predicted),
        predicted: report::by_slice(measurement, &data, &predicted),
        albedo: None,
        sphere,
        warnings: Vec::new(),
        estimates,
    };
    fit.aicc = report::aicc(&fit, &data);
    if options.warnings {
        fit.albedo = albedo::largest(&fit, &data.incidences);
        fit.warnings = warnings::of(&fit, &data, &setting);
        fit.warnings.extend(disagreements(model, &fit.sphere));
    }
    Ok(fit)
}

/// A model over the channels of some data, with bounds and what is held.
pub(crate) struct Setting<'a> {
    pub(crate) chart: Chart<'a>,
    pub(crate) goal: Goal,
    pub(crate) low: Vec<f64>,
    pub(crate) high: Vec<f64>,
    /// Variables that the user holds.
    pub(crate) held: Vec<bool>,
    pub(crate) defaults: Vec<f64>,
    start_readings: usize,
    cancel: Option<&'a std::sync::atomic::AtomicBool>,
}

impl<'a> Setting<'a> {
    pub(crate) fn new(
        model: &'a FitModel,
        data: &FitData,
        options: &FitOptions<'a>,
    ) -> Result<Self, FitError> {
        let chart = Chart::new(model, data.channels.len());
        let (mut low, mut high) = chart.bounds();
        let mut held = vec![false; chart.len()];
        let mut defaults: Vec<f64> = chart
            .variables
            .iter()
            .map(|v| v.of_value(model.parameters[v.parameter].default))
            .collect();
        for (name, value) in &options.fixed {
            let known = model.position(name).ok_or_else(|| FitError::Model {
                found: format!("fixed parameter {name:?}"),
                allowed: names(model),
            })?;
            let p = &model.parameters[known];
            if !(p.low..=p.high).contains(value) {
                return Err(FitError::Model {
                    found: format!("{name} fixed at {value}"),
                    allowed: format!("{} to {}", p.low, p.high),
                });
            }
            for (k, v) in chart
                .variables
                .iter()
                .enumerate()
                .filter(|(_, v)| v.parameter == known)
            {
                defaults[k] = v.of_value(*value);
                (low[k], high[k]) = (defaults[k], defaults[k]);
                held[k] = true;
            }
        }
        for k in 0..chart.len() {
            let variable = chart.variables[k];
            if let (false, Some(width)) = (held[k], resolution(&chart, data, variable.parameter)) {
                low[k] = low[k].max(variable.of_value(LEAST_WIDTH * width)).min(high[k]);
            }
        }
        if options.start_readings < 50 {
            return Err(FitError::Domain {
                field: "start_readings",
                found: options.start_readings.to_string(),
                allowed: "at least 50",
            });
        }
        Ok(Setting {
            chart,
            goal: Goal {
                metric: options.metric,
                loss: options.loss,
                by_solid_angle: options.by_solid_angle,
                weights: options.weights,
            },
            low,
            high,
            held,
            defaults,
            start_readings: options.start_readings,
            cancel: options.cancel,
        })
    }

    pub(crate) fn bounds(&self) -> (&[f64], &[f64]) {
        (&self.low, &self.high)
    }

    pub(crate) fn solver(&self, options: &FitOptions<'a>) -> SolverOptions<'_> {
        SolverOptions {
            fixed: &self.held,
            cancel: options.cancel,
            ..SolverOptions::default()
        }
    }

    pub(crate) fn not_converged(&self, evaluations: usize) -> FitError {
        FitError::NotConverged {
            model: self.chart.model.name.clone(),
            found: "no finite cost".into(),
            evaluations,
        }
    }

    /// The variables of parameters that the search is to begin with, within their bounds.
    fn known(&self, data: &FitData, start: Option<&[Vec<f64>]>) -> Result<Option<Vec<f64>>, FitError> {
        let Some(start) = start else { return Ok(None) };
        let (channels, parameters) = (data.channels.len(), self.chart.model.parameters.len());
        if start.len() != channels || start.iter().any(|q| q.len() != parameters) {
            return Err(FitError::Domain {
                field: "start",
                found: format!("{:?} values", start.iter().map(Vec::len).collect::<Vec<_>>()),
                allowed: "one value a parameter for every channel",
            });
        }
        let mut x = self.chart.variables_of(start);
        for (x, (low, high)) in x.iter_mut().zip(self.low.iter().zip(&self.high)) {
            *x = x.clamp(*low, *high);
        }
        Ok(Some(x))
    }

    /// The best point on a part of the readings; from `known` alone when it is given.
    pub(crate) fn start(&self, data: &FitData, known: Option<&[f64]>) -> Result<Vec<f64>, FitError> {
        let mut part = data.thinned(self.start_readings);
        let rough = SolverOptions {
            fixed: &self.held,
            cancel: self.cancel,
            max_evaluations: 80,
            step_tolerance: 1e-6,
            ..SolverOptions::default()
        };
        let candidates = match known {
            Some(x) => vec![x.to_vec()],
            None => {
                let points = starts(&self.chart, &self.low, &self.high, &self.held, &self.defaults);
                let few = part.thinned(self.start_readings / 3);
                search(&self.chart, (&few, &part), points, self.bounds(), &rough)
                    .into_iter()
                    .map(|s| s.x)
                    .collect()
            }
        };
        // Of candidates with different weights the costs are no measure, the likelihoods are.
        let best = candidates
            .iter()
            .map(|x| {
                let found = settle(&self.chart, &mut part, self.goal, x, self.bounds(), &rough);
                let level = report::level(self.goal.metric, found.normal.cost, &part);
                (found, level)
            })
            .filter(|(s, _)| s.stop != Stop::NotFinite)
            .min_by(|a, b| a.1.total_cmp(&b.1));
        if self
            .cancel
            .is_some_and(|c| c.load(std::sync::atomic::Ordering::Relaxed))
        {
            return Err(FitError::Cancelled);
        }
        best.map(|(s, _)| narrow_first(&self.chart, &self.held, &s.x))
            .ok_or_else(|| self.not_converged(0))
    }
}

fn names(model: &FitModel) -> String {
    model
        .parameters
        .iter()
        .map(|p| p.name.as_str())
        .collect::<Vec<_>>()
        .join(", ")
}

/// What makes a fit impossible from the outset.
fn check(data: &FitData, model: &FitModel, setting: &Setting<'_>) -> Result<(), FitError> {
    let parameters = setting.held.iter().filter(|h| !**h).count();
    if let (0, Some((component, found))) = (data.len(), data.other_component) {
        let allowed = [Component::Reflection, Component::Transmission]
            .into_iter()
            .filter(|c| model.scatters_into(*c))
            .map(|c| c.to_string())
            .collect::<Vec<_>>()
            .join(" and ");
        return Err(FitError::WrongSide {
            model: model.name.clone(),
            allowed,
            component: component.to_string(),
            found,
        });
    }
    if data.len() <= parameters {
        return Err(FitError::TooFewReadings {
            model: model.name.clone(),
            found: data.len(),
            needed: parameters + 1,
            parameters,
            excluded: phrase(&data.excluded),
        });
    }
    for (c, channel) in data.channels.iter().enumerate() {
        let (mut above, mut n) = (0, 0);
        let (mut best, mut top) = (f64::NEG_INFINITY, 0.0_f64);
        for slab in data.slabs.iter().filter(|s| s.channel == c) {
            let floor = slab.law.constant.sqrt();
            n += slab.y.len();
            above += slab.y.iter().filter(|y| **y > 3.0 * floor).count();
            let highest = slab.y.iter().fold(f64::NEG_INFINITY, |b, y| b.max(*y));
            (best, top) = (best.max(highest / floor), top.max(highest));
        }
        if n == 0 || top <= 0.0 || (best < SIGNAL && (above as f64) <= SIGNAL_SHARE * n as f64) {
            return Err(FitError::NoSignal {
                channel: channel.to_string(),
                found: if n == 0 {
                    "no usable reading".into()
                } else {
                    format!("highest of {n} readings {top:.3e} 1/sr")
                },
            });
        }
    }
    Ok(())
}

/// The minima in the metrics to compare with.
fn other_metrics(
    setting: &Setting<'_>,
    data: &mut FitData,
    solution: &Solution,
    options: &FitOptions<'_>,
) -> Result<Vec<(Metric, Vec<f64>)>, FitError> {
    let mut out = Vec::new();
    let mut compared: Vec<Metric> = options.compare.clone();
    compared.retain(|m| *m != options.metric);
    if compared.is_empty() && !options.compare.is_empty() {
        // What was to be compared with is what was asked for.
        compared.push(Metric::Chi2);
    }
    for metric in compared {
        let goal = Goal {
            metric,
            ..setting.goal
        };
        let solver = SolverOptions {
            max_evaluations: 40,
            step_tolerance: 1e-5,
            cost_tolerance: 1e-9,
            ..setting.solver(options)
        };
        let found = settle(&setting.chart, data, goal, &solution.x, setting.bounds(), &solver);
        if found.stop == Stop::Cancelled {
            return Err(FitError::Cancelled);
        }
        out.push((metric, found.x));
    }
    Ok(out)
}

/// Minima in other metrics as values of the parameters.
fn in_values(setting: &Setting<'_>, minima: Vec<(Metric, Vec<f64>)>) -> Vec<OtherMetric> {
    let variables = &setting.chart.variables;
    minima
        .into_iter()
        .map(|(metric, x)| OtherMetric {
            metric,
            values: x.iter().zip(variables).map(|(x, v)| v.value(*x)).collect(),
        })
        .collect()
}
