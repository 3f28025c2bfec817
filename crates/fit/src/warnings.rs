//! What to know before fitted parameters are used.

use gonio_bsdf::analytic::Role;

use crate::data::FitData;
use crate::fitting::Setting;
use crate::limits::resolution;
use crate::result::{Fit, SliceResidual, Warning};
use crate::{Kind, Metric};

/// Share of missing readings from which it is worth a word.
const MISSING: f64 = 0.2;
/// Correlation from which two parameters say the same.
const CORRELATED: f64 = 0.9;
/// Share of the uncertainty from which what channels have in common makes it.
const OF_COMMON: f64 = 0.7;
/// Width from which a lobe cannot be told well from the diffuse part (the correlation of their amplitudes passes -0.6).
const BROAD: f64 = 0.4;
/// Amplitudes below this many standard uncertainties are no evidence of a lobe.
const EVIDENCE: f64 = 3.0;
/// Dispersion from which the model does not describe the readings within their noise.
const MISFIT: f64 = 1.5;
/// Share of a slice's light from which a difference is worth a word.
const BIAS: f64 = 0.2;
/// Ratio of peaks from which it is.
const PEAK: f64 = 2.0;
/// Difference between metrics, in standard uncertainties, from which the model and not the noise rules.
const SPREAD: f64 = 3.0;

pub(crate) fn of(fit: &Fit, data: &FitData, setting: &Setting<'_>) -> Vec<Warning> {
    let mut all = Vec::new();
    let mut warn = |code: &'static str, text: String| all.push(Warning { code, text });
    if !fit.converged {
        warn(
            "not_converged",
            format!(
                "the search ended after {} evaluations without settling; the values may still move. Try fewer free \
                 parameters or another model",
                fit.evaluations
            ),
        );
    }
    if data.missing > MISSING {
        warn(
            "missing_readings",
            format!(
                "{:.0} % of the readings are no numbers; check the file and its reader",
                100.0 * data.missing
            ),
        );
    }
    if data.slabs.iter().any(|s| !s.law_known) {
        warn(
            "noise_unknown",
            "the measurement states no uncertainty of single readings; 5 % was assumed for their weights, and the \
             uncertainties of the parameters come from the residuals alone"
                .into(),
        );
    }
    let incidences = {
        let mut seen: Vec<usize> = data.slabs.iter().map(|s| s.incidence).collect();
        seen.sort_unstable();
        seen.dedup();
        seen.len()
    };
    if incidences < 2 {
        warn(
            "one_incidence",
            "only one direction of incidence: nothing shows whether the model holds at others; measure two or more".into(),
        );
    }
    if let Some((component, n)) = data.other_component {
        warn(
            "other_component",
            format!(
                "{n} readings of {component} are not described by {} and were left out",
                fit.model.name
            ),
        );
    }
    let scatter = fit.dispersion.unwrap_or_else(|| noise_ratio(fit).powi(2));
    if scatter > MISFIT && data.slabs.iter().all(|s| s.law_known) {
        let worst = fit
            .residuals
            .iter()
            .max_by(|a, b| a.relative_l1.total_cmp(&b.relative_l1));
        let place = worst.map_or(String::new(), |r| {
            format!(
                "; worst at theta_i = {:.1} deg, channel {}, {} ({:.1} % relative L1)",
                r.incidence.theta.to_degrees(),
                r.channel,
                r.component,
                100.0 * r.relative_l1
            )
        });
        warn(
            "misfit",
            format!(
                "residuals scatter {:.1} times as much as the stated noise{place}: {} does not describe the sample within its \
                 noise; compare other models or use a data-driven one",
                noise_ratio(fit),
                fit.model.name
            ),
        );
    }
    light(fit, &mut warn);
    estimates(fit, data, setting, &mut warn);
    energy(fit, &mut warn);
    all
}

/// Light and peaks that the model misses or adds.
fn light(fit: &Fit, warn: &mut impl FnMut(&'static str, String)) {
    let place = |r: &SliceResidual| {
        format!(
            "theta_i = {:.1} deg, channel {}, {}",
            r.incidence.theta.to_degrees(),
            r.channel,
            r.component
        )
    };
    let worst = fit
        .residuals
        .iter()
        .filter(|r| r.bias.abs() > BIAS)
        .max_by(|a, b| a.bias.abs().total_cmp(&b.bias.abs()));
    if let Some(r) = worst {
        warn(
            "bias",
            format!(
                "the model holds {:.0} % {} light than the readings at {}: a material of it is too {}; another metric, a sum of \
                 two lobes or a data-driven model may keep it",
                100.0 * r.bias.abs(),
                if r.bias < 0.0 { "less" } else { "more" },
                place(r),
                if r.bias < 0.0 { "dark" } else { "bright" },
            ),
        );
    }
    let off = |r: &SliceResidual| r.peak_ratio.ln().abs();
    let worst = fit
        .residuals
        .iter()
        .filter(|r| off(r) > PEAK.ln())
        .max_by(|a, b| off(a).total_cmp(&off(b)));
    if let Some(r) = worst {
        warn(
            "peak",
            format!(
                "the model's peak is {:.2e} of the highest reading at {}",
                r.peak_ratio,
                place(r)
            ),
        );
    }
}

/// How many times the stated noise the residuals of the median slice are. Not from the dispersion: a robust loss bounds it.
fn noise_ratio(fit: &Fit) -> f64 {
    let mut chi2: Vec<f64> = fit.residuals.iter().map(|r| r.chi2).collect();
    chi2.sort_by(f64::total_cmp);
    let n = chi2.len();
    if n == 0 {
        return f64::NAN;
    }
    (0.5 * (chi2[(n - 1) / 2] + chi2[n / 2])).sqrt()
}

fn estimates(fit: &Fit, data: &FitData, setting: &Setting<'_>, warn: &mut impl FnMut(&'static str, String)) {
    let lobes = fit.estimates.iter().any(|e| e.role == Role::Width);
    for (k, e) in fit.estimates.iter().enumerate() {
        let variable = setting.chart.variables[k];
        let parameter = &fit.model.parameters[variable.parameter];
        match e.kind {
            Kind::Undetermined => warn(
                "undetermined",
                format!(
                    "{}: the readings do not depend on it, or only together with another parameter; fix it or use a \
                     simpler model",
                    e.label()
                ),
            ),
            Kind::UpperLimit => {
                let limit = resolution(&setting.chart, data, variable.parameter).unwrap_or(e.high);
                warn(
                    "unresolved",
                    format!(
                        "{}: the beam is too wide to resolve the lobe; below {:.3} is all that can be said (resolution \
                         {limit:.3}). Measure with a narrower beam or receiver",
                        e.label(),
                        e.high
                    ),
                );
            }
            Kind::Value => {
                let x = variable.of_value(e.value);
                let span = 1e-6 * (setting.high[k] - setting.low[k]).abs();
                let (at_low, at_high) = (x - setting.low[k] <= span, setting.high[k] - x <= span);
                let is_lobe = e.role == Role::Amplitude && lobes && parameter.low == 0.0;
                if is_lobe && e.value < EVIDENCE * e.u {
                    warn(
                        "no_peak",
                        format!(
                            "{} = {:.2e} is not told from zero (u = {:.1e}): the readings show no such part, and the \
                             parameters of its shape mean nothing; use a model without it",
                            e.label(),
                            e.value,
                            e.u
                        ),
                    );
                } else if at_low || at_high {
                    let bound = if at_low { parameter.low } else { parameter.high };
                    warn(
                        "at_bound",
                        format!(
                            "{} is at its bound {bound}; another model may suit the sample better",
                            e.label()
                        ),
                    );
                }
                if e.role == Role::Width && e.value > BROAD && parameter.high <= 1.0 {
                    warn(
                        "broad_lobe",
                        format!(
                            "{} = {:.2}: a lobe this broad is hardly told from the diffuse part; fix one of the two with an \
                             integrating sphere or a known total reflectance",
                            e.label(),
                            e.value
                        ),
                    );
                }
            }
            Kind::Fixed => {}
        }
        if e.kind == Kind::Value && e.u > 0.0 && e.u_model > SPREAD * e.u && e.u_model > 0.01 * e.value.abs()
        {
            let other = fit
                .other_metrics
                .iter()
                .max_by(|a, b| {
                    (a.values[k] - e.value)
                        .abs()
                        .total_cmp(&(b.values[k] - e.value).abs())
                })
                .map_or(Metric::CubeRoot, |o| o.metric);
            warn(
                "metric_spread",
                format!(
                    "{}: {} prefers a value {:.2e} away, {:.0} standard uncertainties: the model, not the noise, limits \
                     it; quote u_model",
                    e.label(),
                    other.name(),
                    e.u_model,
                    e.u_model / e.u
                ),
            );
        }
    }
    let n = fit.estimates.len();
    for a in 0..n {
        for b in a + 1..n {
            let r = fit.correlation[a * n + b];
            // What beam power and calibration have in common is no choice between parameters.
            let shared = |k: usize| fit.estimates[k].u_common > OF_COMMON * fit.estimates[k].u;
            if r.abs() > CORRELATED && !(shared(a) && shared(b)) {
                warn(
                    "correlated",
                    format!(
                        "{} and {} are correlated ({r:+.2}): their combination is known better than either; fix one",
                        fit.estimates[a].label(),
                        fit.estimates[b].label()
                    ),
                );
            }
        }
    }
}

/// Albedo above one at a measured incidence.
fn energy(fit: &Fit, warn: &mut impl FnMut(&'static str, String)) {
    let Some(top) = fit.albedo.filter(|a| a.value > 1.0) else {
        return;
    };
    let advice = if top.exceeds_one() {
        "check the beam power, or use a model that conserves energy"
    } else {
        "it may be 1 within its uncertainty"
    };
    warn("energy", format!("the fitted model scatters {top}; {advice}"));
}
