//! Which model the readings support.

use gonio_bsdf::analytic::{Role, families};
use gonio_geom::{Angles, Component};
use gonio_scan::Measurement;
use rayon::prelude::*;

use crate::data::FitData;
use crate::fitting::Setting;
use crate::ranking::{Ranked, order, sentence};
use crate::refine::{fold_in_beam, refine};
use crate::report::residuals;
use crate::result::{Fit, SliceResidual};
use crate::solver::Stop;
use crate::{FitError, FitModel, FitOptions, Selection, fit, fit_models};

/// Readings that a fit without one incidence looks at, at most.
const FOLD_READINGS: usize = 8000;

/// Error at an incidence that the fit did not see.
#[derive(Clone, Debug, PartialEq)]
pub struct HeldOut {
    /// Direction of incidence.
    pub incidence: Angles,
    /// Residuals of each of its slices and components.
    pub residuals: Vec<SliceResidual>,
    /// Mean of their `relative_l1`.
    pub relative_l1: f64,
}

/// The models, best first.
#[derive(Clone, Debug)]
pub struct Choice {
    /// Every model that could be fitted, best first.
    pub ranking: Vec<Ranked>,
    /// Models with smaller errors that the first was preferred to, and what speaks against each.
    pub passed_over: Vec<(String, String)>,
    /// Those that could not, and why.
    pub failed: Vec<(String, FitError)>,
    /// What the comparison says, in a sentence or two.
    pub sentence: String,
}

/// Fit models that describe the components with readings and no other: those of [`fit_models`], and where light is both
/// reflected and transmitted also each reflecting family with each transmitting one, diffuse parts included. Models with an
/// axis only where the incidences lie in more than one plane.
///
/// # Errors
/// [`FitError`] when the selection names an unknown channel or the list of models is broken.
pub fn candidates(measurement: &Measurement, selection: &Selection) -> Result<Vec<FitModel>, FitError> {
    let data = FitData::new(measurement, selection, |_| true, false)?;
    let has = |c| data.slabs.iter().any(|s| s.component == c);
    let (reflects, transmits) = (has(Component::Reflection), has(Component::Transmission));
    // Incidences of one plane cannot tell the sample's axis from that plane.
    let turned = data.incidences.iter().any(|a| {
        let a = a.direction().vec();
        let across = |b: &Angles| {
            let b = b.direction().vec();
            (a.x * b.y - a.y * b.x).abs() > 1e-3
        };
        data.incidences.iter().any(across)
    });
    let has_axis = |m: &FitModel| m.parameters.iter().any(|p| p.role == Role::Angle);
    // A model of a component without readings carries parameters that nothing determines.
    let fits = |m: &FitModel| {
        reflects == m.scatters_into(Component::Reflection)
            && transmits == m.scatters_into(Component::Transmission)
            && (turned || !has_axis(m))
    };
    let mut models: Vec<FitModel> = fit_models()?.into_iter().filter(fits).collect();
    if reflects && transmits {
        let lobes = |component| {
            families().iter().copied().filter(move |f| {
                let info = f.info();
                info.scatters.into(component)
                    && info.scatters != gonio_bsdf::analytic::Scatters::Both
                    && info.parameters.len() > 1
                    && info.parameters.iter().all(|p| p.role != Role::Angle)
            })
        };
        for r in lobes(Component::Reflection) {
            for t in lobes(Component::Transmission) {
                let name = format!("lambert+{}+lambert-transmission+{}", r.info().name, t.info().name);
                models.push(crate::fit_model(&name)?);
            }
        }
    }
    Ok(models)
}

/// Fits every model and ranks them: by the error at incidences left out in turn, models within 1 % of one another by
/// Akaike's criterion; with a single incidence by the criterion alone. Errors below 1e-4 count as that: no instrument
/// reads so well. Where that is equal too (to 0.01), models without flaws come first ([`Ranked::flaws`]), then those with
/// fewer parameters, then in the order of [`fit_models`], sums last.
///
/// A model with flaws is passed over for the best one without, where that has an error of at most 1.1 times its own; with a
/// single incidence, a criterion of Akaike of at most 2 above its own.
///
/// # Errors
/// [`FitError::Cancelled`], or the first error when no model can be fitted at all.
pub fn select(
    measurement: &Measurement,
    models: &[FitModel],
    options: &FitOptions<'_>,
) -> Result<Choice, FitError> {
    let outcomes: Vec<Result<Ranked, (String, FitError)>> = models
        .par_iter()
        .map(|model| {
            fit(measurement, model, options)
                .and_then(|found| ranked(measurement, found, options))
                .map_err(|e| (model.name.clone(), e))
        })
        .collect();
    let (mut ranking, mut failed) = (Vec::new(), Vec::new());
    for outcome in outcomes {
        match outcome {
            Ok(ranked) => ranking.push(ranked),
            Err((_, FitError::Cancelled)) => return Err(FitError::Cancelled),
            Err(other) => failed.push(other),
        }
    }
    if ranking.is_empty() {
        return Err(failed.into_iter().next().map_or_else(
            || FitError::Model {
                found: "no model to compare".into(),
                allowed: "at least one".into(),
            },
            |(_, e)| e,
        ));
    }
    let names: Vec<String> = fit_models()?.into_iter().map(|m| m.name).collect();
    let passed_over = order(&mut ranking, &names);
    let sentence = sentence(&ranking, &passed_over);
    Ok(Choice {
        ranking,
        passed_over,
        failed,
        sentence,
    })
}

fn ranked(measurement: &Measurement, found: Fit, options: &FitOptions<'_>) -> Result<Ranked, FitError> {
    let held_out = leave_one_incidence_out(measurement, &found, options)?;
    let mean = held_out.iter().map(|h| h.relative_l1).sum::<f64>() / held_out.len() as f64;
    Ok(Ranked {
        fit: found,
        held_out_error: mean,
        held_out,
    })
}

/// Fits again without each incidence in turn and predicts its readings. Empty with fewer than two incidences.
///
/// # Errors
/// As [`fit`].
pub fn leave_one_incidence_out(
    measurement: &Measurement,
    found: &Fit,
    options: &FitOptions<'_>,
) -> Result<Vec<HeldOut>, FitError> {
    let model = &found.model;
    let described = |c| model.scatters_into(c);
    let data = FitData::new(measurement, &options.selection, described, options.signature)?;
    let setting = Setting::new(model, &data, options)?;
    let measured: Vec<usize> = (0..data.incidences.len())
        .filter(|&i| data.slabs.iter().any(|s| s.incidence == i))
        .collect();
    if measured.len() < 2 {
        return Ok(Vec::new());
    }
    let values: Vec<Vec<f64>> = found.parameters().into_iter().map(|(_, q)| q).collect();
    let start = setting.chart.variables_of(&values);
    let part = data.thinned(FOLD_READINGS);
    measured
        .par_iter()
        .map(|&i| {
            let mut rest = part.of_incidences(|k| k != i);
            let solver = setting.solver(options);
            let solution = refine(
                &setting.chart,
                &mut rest,
                setting.goal,
                &start,
                setting.bounds(),
                &solver,
            );
            match solution.stop {
                Stop::Cancelled => return Err(FitError::Cancelled),
                Stop::NotFinite => return Err(setting.not_converged(solution.evaluations)),
                _ => {}
            }
            let mut left_out = data.of_incidences(|k| k == i);
            fold_in_beam(&setting.chart, &mut left_out, &solution.x);
            let predicted = setting
                .goal
                .objective(&setting.chart, &left_out)
                .predict(&solution.x);
            left_out.reweigh(&predicted, false);
            let residuals = residuals(&left_out, &predicted);
            let mean = residuals.iter().map(|r| r.relative_l1).sum::<f64>() / residuals.len() as f64;
            Ok(HeldOut {
                incidence: data.incidences[i],
                residuals,
                relative_l1: mean,
            })
        })
        .collect()
}
