//! Fits with readings of an integrating sphere: beside those of a goniometer, and alone.

use gonio_bsdf::Channel;
use gonio_geom::Angles;
use nalgebra::DVector;

use crate::covariance::Covariance;
use crate::data::FitData;
use crate::estimates::{estimates, in_parameters};
use crate::fitting::Setting;
use crate::metric::{Loss, Metric};
use crate::solver::{Stop, minimise};
use crate::sphere::{Alone, Sphere, SphereComparison};
use crate::start::starts;
use crate::{Fit, FitError, FitModel, FitOptions, Weights, albedo};

/// Lets the readings of a sphere count: moves the minima `x` and `others`, and what is known of them.
pub(crate) fn add_sphere(
    setting: &Setting<'_>,
    data: &FitData,
    x: &mut [f64],
    spread: Option<&mut Covariance>,
    others: &mut [(Metric, Vec<f64>)],
    options: &FitOptions<'_>,
) -> Result<Vec<SphereComparison>, FitError> {
    let sphere = Sphere::new(&setting.chart, &data.channels, &options.sphere, setting.bounds())?;
    let Some(spread) = spread else {
        return sphere.compared(x, None);
    };
    let start = DVector::from_column_slice(x);
    let mut prior = spread.matrix.clone();
    for (_, other) in others.iter() {
        let apart = DVector::from_fn(
            x.len(),
            |k, _| if spread.free[k] { other[k] - start[k] } else { 0.0 },
        );
        prior += &apart * apart.transpose();
    }
    let update = sphere.combine(x, &prior, &spread.free)?;
    spread.matrix = update.posterior(&prior);
    spread.common = update.left(&spread.common);
    for (_, other) in others {
        let left = update.left(&(DVector::from_column_slice(other) - &start));
        for (k, value) in other.iter_mut().enumerate() {
            *value = (x[k] + left[k]).clamp(setting.low[k], setting.high[k]);
        }
    }
    sphere.compared(x, Some(&update.before))
}

/// Fits `model` to readings of an integrating sphere alone, which fix few parameters: hold the others (`options.fixed`).
///
/// # Errors
/// [`FitError`]: no more readings than parameters that are free, a model that does not scatter the light that was read, a
/// search that finds no minimum.
pub fn fit_sphere(model: &FitModel, options: &FitOptions<'_>) -> Result<Fit, FitError> {
    let mut channels: Vec<Channel> = Vec::new();
    for reading in &options.sphere.readings {
        if !channels.contains(&reading.channel) {
            channels.push(reading.channel);
        }
    }
    let data = FitData::without_readings(channels);
    let setting = Setting::new(model, &data, options)?;
    let parameters = setting.held.iter().filter(|h| !**h).count();
    let found = options.sphere.readings.len();
    if found < parameters || found == 0 {
        return Err(FitError::TooFewReadings {
            model: model.name.clone(),
            found,
            needed: parameters.max(1),
            parameters,
            excluded:
                "none; hold parameters that another instrument knows (--fix), or add goniometer readings"
                    .into(),
        });
    }
    let sphere = Sphere::new(&setting.chart, &data.channels, &options.sphere, setting.bounds())?;
    let problem = Alone {
        sphere: &sphere,
        free: setting.held.iter().map(|h| !h).collect(),
    };
    let points = starts(
        &setting.chart,
        &setting.low,
        &setting.high,
        &setting.held,
        &setting.defaults,
    );
    let solver = setting.solver(options);
    let best = points
        .iter()
        .map(|x| minimise(&problem, x, &setting.low, &setting.high, &solver))
        .filter(|s| s.stop != Stop::NotFinite)
        .min_by(|a, b| a.normal.cost.total_cmp(&b.normal.cost));
    let solution = best.ok_or_else(|| setting.not_converged(0))?;
    let (matrix, free) = sphere.alone(&solution.x, &problem.free)?;
    let n = setting.chart.len();
    let spread = Covariance {
        matrix: matrix.clone(),
        common: DVector::zeros(n),
        bread: matrix,
        free,
        design_effect: 1.0,
        cells: 0,
        dispersion: None,
        predicted: Vec::new(),
    };
    let estimates = estimates(&setting, &data, &solution, Some(&spread), options);
    let (covariance, correlation) = in_parameters(&setting, &estimates, Some(&spread));
    let compared = sphere.compared(&solution.x, None)?;
    let mut fit = Fit {
        model: model.clone(),
        metric: Metric::Chi2,
        loss: Loss::Linear,
        weights: Weights::Stated,
        channels: data.channels.clone(),
        estimates,
        covariance,
        correlation,
        other_metrics: Vec::new(),
        readings: found,
        excluded: Vec::new(),
        blocks: found,
        cost: solution.normal.cost,
        dispersion: None,
        design_effect: 1.0,
        aicc: f64::INFINITY,
        evaluations: solution.evaluations,
        converged: solution.stop.converged(),
        residuals: Vec::new(),
        predicted: Vec::new(),
        albedo: None,
        sphere: compared,
        warnings: Vec::new(),
    };
    let mut incidences: Vec<Angles> = Vec::new();
    for reading in &options.sphere.readings {
        if !incidences.contains(&reading.incidence) {
            incidences.push(reading.incidence);
        }
    }
    fit.albedo = albedo::largest(&fit, &incidences);
    Ok(fit)
}
