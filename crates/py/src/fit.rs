//! Fits of analytic models.

use std::sync::Arc;

use gonio_bsdf::Channel;
use gonio_bsdf::analytic::Role;
use gonio_fit as core;
use gonio_geom::Component;
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyList};

use crate::analytic::role_name;
use crate::arrays::angles;
use crate::bsdf::Bsdf;
use crate::errors::{DomainError, FitError, OrRaise, QuantityError, Raise, domain};
use crate::fit_data::{FitData, residual, shown};
use crate::simulate::component;
use crate::slice::MeasurementData;

impl Raise for core::FitError {
    fn raise(self) -> PyErr {
        use core::FitError as E;
        let text = self.to_string();
        match self {
            E::Channel { .. } => QuantityError::new_err(text),
            E::Model { .. } | E::Domain { .. } | E::Columns { .. } | E::Bsdf(_) => DomainError::new_err(text),
            _ => FitError::new_err(text),
        }
    }
}

fn metric(name: &str) -> PyResult<core::Metric> {
    core::Metric::ALL
        .into_iter()
        .find(|m| m.name() == name)
        .ok_or_else(|| {
            let names = core::Metric::ALL.map(core::Metric::name).join(", ");
            domain("metric", format!("{name:?}"), &names)
        })
}

/// The options of `settings` in place of the defaults: metric, loss, weights, by_solid_angle, channels, component,
/// max_theta_s and retro_radius (degrees), signature, fixed (dict; angles in degrees), compare, profile.
fn options(settings: &Bound<'_, PyDict>, models: &[core::FitModel]) -> PyResult<core::FitOptions<'static>> {
    let mut o = core::FitOptions::default();
    for (key, value) in settings {
        let key: String = key.extract()?;
        match key.as_str() {
            "metric" => o.metric = metric(&value.extract::<String>()?)?,
            "loss" => {
                o.loss = match value.extract::<String>()?.as_str() {
                    "soft-l1" => core::Loss::SoftL1,
                    "linear" => core::Loss::Linear,
                    other => return Err(domain("loss", format!("{other:?}"), "soft-l1, linear")),
                }
            }
            "weights" => {
                o.weights = match value.extract::<String>()?.as_str() {
                    "predicted" => core::Weights::Predicted,
                    "stated" => core::Weights::Stated,
                    other => return Err(domain("weights", format!("{other:?}"), "predicted, stated")),
                }
            }
            "by_solid_angle" => o.by_solid_angle = value.extract()?,
            "channels" => {
                o.selection.channels = value
                    .extract::<Vec<String>>()?
                    .iter()
                    .map(|c| c.parse::<Channel>().or_raise())
                    .collect::<PyResult<_>>()?;
            }
            "component" => {
                o.selection.component = match value.extract::<Option<String>>()?.as_deref() {
                    None => None,
                    Some("reflection") => Some(Component::Reflection),
                    Some("transmission") => Some(Component::Transmission),
                    Some(other) => {
                        return Err(domain(
                            "component",
                            format!("{other:?}"),
                            "reflection, transmission",
                        ));
                    }
                }
            }
            "max_theta_s" => o.selection.max_theta_s = value.extract::<f64>()?.to_radians(),
            "retro_radius" => o.selection.retro_radius = value.extract::<f64>()?.to_radians(),
            "signature" => o.signature = value.extract()?,
            "fixed" => {
                for (name, held) in value.cast::<PyDict>()? {
                    let (name, held): (String, f64) = (name.extract()?, held.extract()?);
                    let angle = models
                        .iter()
                        .flat_map(|m| &m.parameters)
                        .any(|p| p.name == name && p.role == Role::Angle);
                    o.fixed.push((name, if angle { held.to_radians() } else { held }));
                }
            }
            "compare" => {
                o.compare = value
                    .extract::<Vec<String>>()?
                    .iter()
                    .map(|m| metric(m))
                    .collect::<PyResult<_>>()?;
            }
            "profile" => o.profile = value.extract()?,
            "sphere" => o.sphere = sphere(&value)?,
            other => {
                return Err(domain(
                    "fit option",
                    format!("{other:?}"),
                    "metric, loss, weights, by_solid_angle, channels, component, max_theta_s, retro_radius, signature, \
                     fixed, compare, profile, sphere",
                ));
            }
        }
    }
    Ok(o)
}

/// A reading of a sphere: channel, (theta_i, phi_i), component, part, half angle of the cone (degrees; 0 for all), value.
type SphereRow = (String, (f64, f64), String, String, f64, f64);

/// Readings of a sphere with their covariance, row after row.
fn sphere(value: &Bound<'_, PyAny>) -> PyResult<core::SphereData> {
    let (rows, covariance): (Vec<SphereRow>, Vec<f64>) = value.extract()?;
    let readings = rows
        .into_iter()
        .map(|(channel, (theta_i, phi_i), side, part, half_angle, value)| {
            let half = half_angle.to_radians();
            Ok(core::SphereReading {
                channel: channel.parse::<Channel>().or_raise()?,
                incidence: angles(["theta_i", "phi_i"], theta_i, phi_i)?,
                component: component(&side)?,
                part: match part.as_str() {
                    "total" => core::SpherePart::Total,
                    "port" => core::SpherePart::Port(half),
                    "diffuse" => core::SpherePart::Rest(half),
                    other => {
                        return Err(domain(
                            "sphere.part",
                            format!("{other:?}"),
                            "total, port, diffuse",
                        ));
                    }
                },
                value,
            })
        })
        .collect::<PyResult<_>>()?;
    Ok(core::SphereData { readings, covariance })
}

/// Fits one model to readings of a sphere alone.
#[pyfunction]
#[pyo3(signature = (*, model, settings))]
fn fit_sphere(py: Python<'_>, model: &str, settings: &Bound<'_, PyDict>) -> PyResult<FitData> {
    let model = core::fit_model(model).or_raise()?;
    let options = options(settings, std::slice::from_ref(&model))?;
    Ok(FitData(
        py.detach(|| core::fit_sphere(&model, &options)).or_raise()?,
    ))
}

/// Fits one model.
#[pyfunction]
#[pyo3(signature = (measurement, *, model, settings))]
fn fit(
    py: Python<'_>,
    measurement: &MeasurementData,
    model: &str,
    settings: &Bound<'_, PyDict>,
) -> PyResult<FitData> {
    let model = core::fit_model(model).or_raise()?;
    let options = options(settings, std::slice::from_ref(&model))?;
    let data = Arc::clone(&measurement.0);
    Ok(FitData(
        py.detach(|| core::fit(&data, &model, &options)).or_raise()?,
    ))
}

/// Errors at each incidence that a fit did not see: a list of dicts theta_i, phi_i, relative_l1, residuals.
#[pyfunction]
#[pyo3(signature = (measurement, fit, *, settings))]
fn held_out<'py>(
    py: Python<'py>,
    measurement: &MeasurementData,
    fit: &FitData,
    settings: &Bound<'py, PyDict>,
) -> PyResult<Vec<Bound<'py, PyDict>>> {
    let options = options(settings, std::slice::from_ref(&fit.0.model))?;
    let data = Arc::clone(&measurement.0);
    let found = py
        .detach(|| core::leave_one_incidence_out(&data, &fit.0, &options))
        .or_raise()?;
    found.iter().map(|h| held(py, h)).collect()
}

fn held<'py>(py: Python<'py>, h: &core::HeldOut) -> PyResult<Bound<'py, PyDict>> {
    let dict = PyDict::new(py);
    let (theta_i, phi_i) = h.incidence.to_degrees();
    dict.set_item("theta_i", theta_i)?;
    dict.set_item("phi_i", phi_i)?;
    dict.set_item("relative_l1", h.relative_l1)?;
    let residuals: PyResult<Vec<_>> = h.residuals.iter().map(|r| residual(py, r)).collect();
    dict.set_item("residuals", residuals?)?;
    Ok(dict)
}

/// Fits and ranks models (those named, or all that suit the data): ranking (list of (FitData, held-out errors)),
/// failed (name to reason), passed_over (name to reason), sentence.
#[pyfunction]
#[pyo3(signature = (measurement, *, models, settings))]
fn select<'py>(
    py: Python<'py>,
    measurement: &MeasurementData,
    models: Vec<String>,
    settings: &Bound<'py, PyDict>,
) -> PyResult<Bound<'py, PyDict>> {
    let named = models
        .iter()
        .map(|m| core::fit_model(m).or_raise())
        .collect::<PyResult<Vec<_>>>()?;
    let options = options(settings, &named)?;
    let data = Arc::clone(&measurement.0);
    let choice = py
        .detach(|| {
            let models = if named.is_empty() {
                core::candidates(&data, &options.selection)?
            } else {
                named
            };
            core::select(&data, &models, &options)
        })
        .or_raise()?;
    let dict = PyDict::new(py);
    dict.set_item("sentence", &choice.sentence)?;
    let failed = PyDict::new(py);
    for (name, error) in &choice.failed {
        failed.set_item(name, error.to_string())?;
    }
    dict.set_item("failed", failed)?;
    let passed_over = PyDict::new(py);
    for (name, flaws) in &choice.passed_over {
        passed_over.set_item(name, flaws)?;
    }
    dict.set_item("passed_over", passed_over)?;
    let ranking = PyList::empty(py);
    for r in choice.ranking {
        let errors: PyResult<Vec<_>> = r.held_out.iter().map(|h| held(py, h)).collect();
        ranking.append((Py::new(py, FitData(r.fit))?, r.held_out_error, errors?))?;
    }
    dict.set_item("ranking", ranking)?;
    Ok(dict)
}

/// Every fit model as data: name, title, parameters (name, unit, low, high, default, role, per_channel, meaning), parts.
#[pyfunction]
fn fit_models(py: Python<'_>) -> PyResult<Bound<'_, PyList>> {
    let list = PyList::empty(py);
    for m in core::fit_models().or_raise()? {
        let dict = PyDict::new(py);
        dict.set_item("name", &m.name)?;
        dict.set_item("title", &m.title)?;
        let parameters = PyList::empty(py);
        for p in &m.parameters {
            let (factor, unit) = shown(&p.unit);
            let row = PyDict::new(py);
            row.set_item("name", &p.name)?;
            row.set_item("unit", unit)?;
            row.set_item("low", factor * p.low)?;
            row.set_item("high", factor * p.high)?;
            row.set_item("default", factor * p.default)?;
            row.set_item("role", role_name(p.role))?;
            row.set_item("per_channel", p.per_channel)?;
            row.set_item("meaning", &p.meaning)?;
            parameters.append(row)?;
        }
        dict.set_item("parameters", parameters)?;
        let parts: Vec<&str> = m.parts.iter().map(|p| p.info().name).collect();
        dict.set_item("parts", parts)?;
        list.append(dict)?;
    }
    Ok(list)
}

/// The sum that a fit model is with the given parameters: a dict from channel to a dict of parameters by name (angles
/// in degrees).
#[pyfunction]
fn fit_model_bsdf(model: &str, parameters: &Bound<'_, PyDict>) -> PyResult<Bsdf> {
    let model = core::fit_model(model).or_raise()?;
    let mut channels = Vec::new();
    for (channel, given) in parameters {
        let channel: Channel = channel.extract::<String>()?.parse().or_raise()?;
        let given = given.cast_into::<PyDict>()?;
        let mut values = Vec::new();
        for p in &model.parameters {
            let Some(v) = given.get_item(&p.name)? else {
                return Err(domain(&p.name, "nothing", "a value"));
            };
            values.push(v.extract::<f64>()? / shown(&p.unit).0);
        }
        channels.push((channel, values));
    }
    Ok(Bsdf(Arc::from(model.bsdf(&channels).or_raise()?)))
}

pub(crate) fn register(m: &Bound<'_, PyModule>) -> PyResult<()> {
    m.add_class::<FitData>()?;
    m.add_function(wrap_pyfunction!(fit, m)?)?;
    m.add_function(wrap_pyfunction!(fit_sphere, m)?)?;
    m.add_function(wrap_pyfunction!(held_out, m)?)?;
    m.add_function(wrap_pyfunction!(select, m)?)?;
    m.add_function(wrap_pyfunction!(fit_models, m)?)?;
    m.add_function(wrap_pyfunction!(fit_model_bsdf, m)?)
}
