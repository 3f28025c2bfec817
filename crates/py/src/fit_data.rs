//! `FitData`: what a fit found.

use std::sync::Arc;

use gonio_fit as core;
use numpy::PyArray1;
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyList};

use crate::analytic::role_name;
use crate::bsdf::Bsdf;
use crate::errors::OrRaise;

/// A fitted analytic model; angles are degrees.
#[pyclass(frozen, module = "gonio", name = "FitData")]
pub(crate) struct FitData(pub(crate) core::Fit);

/// Factor from the unit of the core to that of Python, and that unit.
pub(crate) fn shown(unit: &str) -> (f64, &str) {
    if unit == "rad" {
        (1f64.to_degrees(), "degree")
    } else {
        (1.0, unit)
    }
}

#[pymethods]
impl FitData {
    /// Name of the model.
    #[getter]
    fn model(&self) -> &str {
        &self.0.model.name
    }

    /// Name of the model in sentences.
    #[getter]
    fn title(&self) -> &str {
        &self.0.model.title
    }

    /// Names of the channels.
    #[getter]
    fn channels(&self) -> Vec<String> {
        self.0.channels.iter().map(ToString::to_string).collect()
    }

    /// One dict a parameter: name, unit, role, channel (None: all), value, u, u_common, u_model, low, high, kind,
    /// interval, open, meaning.
    #[getter]
    fn estimates<'py>(&self, py: Python<'py>) -> PyResult<Vec<Bound<'py, PyDict>>> {
        self.0
            .estimates
            .iter()
            .map(|e| {
                let (factor, unit) = shown(&e.unit);
                let dict = PyDict::new(py);
                dict.set_item("name", &e.name)?;
                dict.set_item("unit", unit)?;
                dict.set_item("role", role_name(e.role))?;
                dict.set_item("channel", e.channel.map(|c| c.to_string()))?;
                dict.set_item("value", factor * e.value)?;
                dict.set_item("u", factor * e.u)?;
                dict.set_item("u_common", factor * e.u_common)?;
                dict.set_item("u_model", factor * e.u_model)?;
                dict.set_item("low", factor * e.low)?;
                dict.set_item("high", factor * e.high)?;
                dict.set_item("kind", e.kind.name())?;
                dict.set_item("interval", e.interval.name())?;
                dict.set_item("open", e.open.map(core::Open::name))?;
                let meaning = self.0.model.parameters.iter().find(|p| p.name == e.name);
                dict.set_item("meaning", meaning.map_or("", |p| p.meaning.as_str()))?;
                Ok(dict)
            })
            .collect()
    }

    /// Correlation of the estimates, row after row.
    #[getter]
    fn correlation(&self) -> Vec<Vec<f64>> {
        rows(&self.0.correlation, self.0.estimates.len())
    }

    /// Covariance of the estimates, row after row; angles in degrees.
    #[getter]
    fn covariance(&self) -> Vec<Vec<f64>> {
        let factors: Vec<f64> = self.0.estimates.iter().map(|e| shown(&e.unit).0).collect();
        let mut found = rows(&self.0.covariance, factors.len());
        for (row, a) in found.iter_mut().zip(&factors) {
            for (v, b) in row.iter_mut().zip(&factors) {
                *v *= a * b;
            }
        }
        found
    }

    /// Values that other metrics prefer, in the order of `estimates`, by name of the metric.
    #[getter]
    fn other_metrics<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let dict = PyDict::new(py);
        for other in &self.0.other_metrics {
            let values: Vec<f64> = other
                .values
                .iter()
                .zip(&self.0.estimates)
                .map(|(v, e)| v * shown(&e.unit).0)
                .collect();
            dict.set_item(other.metric.name(), values)?;
        }
        Ok(dict)
    }

    /// One dict a slice and component: slice, theta_i, phi_i (degrees), channel, component, readings, chi2,
    /// relative_l1, bias, peak_ratio.
    #[getter]
    fn residuals<'py>(&self, py: Python<'py>) -> PyResult<Vec<Bound<'py, PyDict>>> {
        self.0.residuals.iter().map(|r| residual(py, r)).collect()
    }

    /// Predicted DSF of every reading, one array a slice; NaN where a reading did not take part.
    #[getter]
    fn predicted<'py>(&self, py: Python<'py>) -> Vec<Bound<'py, PyArray1<f64>>> {
        self.0
            .predicted
            .iter()
            .map(|p| PyArray1::from_slice(py, p))
            .collect()
    }

    /// What was minimised and what came of it: metric, loss, weights, readings, excluded (reason to count), blocks,
    /// cost, dispersion, design_effect, aicc, evaluations, converged.
    #[getter]
    fn figures<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let f = &self.0;
        let dict = PyDict::new(py);
        dict.set_item("metric", f.metric.name())?;
        dict.set_item(
            "loss",
            match f.loss {
                core::Loss::SoftL1 => "soft-l1",
                core::Loss::Linear => "linear",
            },
        )?;
        dict.set_item(
            "weights",
            match f.weights {
                core::Weights::Predicted => "predicted",
                core::Weights::Stated => "stated",
            },
        )?;
        dict.set_item("readings", f.readings)?;
        let excluded = PyDict::new(py);
        for e in &f.excluded {
            excluded.set_item(e.reason.name(), e.count)?;
        }
        dict.set_item("excluded", excluded)?;
        dict.set_item("blocks", f.blocks)?;
        dict.set_item("cost", f.cost)?;
        dict.set_item("dispersion", f.dispersion)?;
        dict.set_item("design_effect", f.design_effect)?;
        dict.set_item("aicc", f.aicc)?;
        dict.set_item("evaluations", f.evaluations)?;
        dict.set_item("converged", f.converged)?;
        Ok(dict)
    }

    /// The largest directional albedo at the measured incidences: value, u, theta_i, phi_i (degrees), channel; or None.
    #[getter]
    fn albedo<'py>(&self, py: Python<'py>) -> PyResult<Option<Bound<'py, PyDict>>> {
        let Some(top) = self.0.albedo else {
            return Ok(None);
        };
        let (theta_i, phi_i) = top.incidence.to_degrees();
        let dict = PyDict::new(py);
        dict.set_item("value", top.value)?;
        dict.set_item("u", top.u)?;
        dict.set_item("theta_i", theta_i)?;
        dict.set_item("phi_i", phi_i)?;
        dict.set_item("channel", top.channel.to_string())?;
        Ok(Some(dict))
    }

    /// (code, text) of each thing to know before the parameters are used.
    #[getter]
    fn warnings(&self) -> Vec<(&'static str, String)> {
        self.0.warnings.iter().map(|w| (w.code, w.text.clone())).collect()
    }

    /// One dict a reading of a sphere: channel, theta_i, phi_i (degrees), component, part, half_angle (degrees, None of a total),
    /// value, u, predicted, before and u_before (the model without the sphere; None where there was nothing else).
    #[getter]
    fn sphere<'py>(&self, py: Python<'py>) -> PyResult<Vec<Bound<'py, PyDict>>> {
        self.0
            .sphere
            .iter()
            .map(|c| {
                let (part, half) = match c.reading.part {
                    core::SpherePart::Total => ("total", None),
                    core::SpherePart::Port(half) => ("port", Some(half)),
                    core::SpherePart::Rest(half) => ("diffuse", Some(half)),
                };
                let (theta_i, phi_i) = c.reading.incidence.to_degrees();
                let dict = PyDict::new(py);
                dict.set_item("channel", c.reading.channel.to_string())?;
                dict.set_item("theta_i", theta_i)?;
                dict.set_item("phi_i", phi_i)?;
                dict.set_item("component", c.reading.component.to_string())?;
                dict.set_item("part", part)?;
                dict.set_item("half_angle", half.map(f64::to_degrees))?;
                dict.set_item("value", c.reading.value)?;
                dict.set_item("u", c.u)?;
                dict.set_item("predicted", c.predicted)?;
                dict.set_item("before", c.before.map(|b| b.0))?;
                dict.set_item("u_before", c.before.map(|b| b.1))?;
                Ok(dict)
            })
            .collect()
    }

    /// The parameters of each channel by name, angles in degrees.
    #[getter]
    fn parameters<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let dict = PyDict::new(py);
        for (channel, values) in self.0.parameters() {
            let of = PyDict::new(py);
            for (p, v) in self.0.model.parameters.iter().zip(values) {
                of.set_item(&p.name, v * shown(&p.unit).0)?;
            }
            dict.set_item(channel.to_string(), of)?;
        }
        Ok(dict)
    }

    /// The parts of the sum as `analytic` takes them: `model` and its parameters, each a dict from channel to number.
    #[getter]
    fn parts<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyList>> {
        let list = PyList::empty(py);
        let parameters = self.0.parameters();
        for part in &self.0.model.parts {
            let dict = PyDict::new(py);
            dict.set_item("model", part.info().name)?;
            for (product, info) in part.values.iter().zip(part.info().parameters) {
                let of = PyDict::new(py);
                for (channel, q) in &parameters {
                    of.set_item(channel.to_string(), product.value(q) * shown(info.unit).0)?;
                }
                dict.set_item(info.name, of)?;
            }
            list.append(dict)?;
        }
        Ok(list)
    }

    /// The fitted scattering model.
    fn bsdf(&self) -> PyResult<Bsdf> {
        Ok(Bsdf(Arc::from(self.0.bsdf().or_raise()?)))
    }
}

fn rows(flat: &[f64], n: usize) -> Vec<Vec<f64>> {
    flat.chunks(n.max(1)).map(<[f64]>::to_vec).collect()
}

pub(crate) fn residual<'py>(
    py: Python<'py>,
    r: &core::result::SliceResidual,
) -> PyResult<Bound<'py, PyDict>> {
    let dict = PyDict::new(py);
    let (theta_i, phi_i) = r.incidence.to_degrees();
    dict.set_item("slice", r.slice)?;
    dict.set_item("theta_i", theta_i)?;
    dict.set_item("phi_i", phi_i)?;
    dict.set_item("channel", r.channel.to_string())?;
    dict.set_item("component", r.component.to_string())?;
    dict.set_item("readings", r.readings)?;
    dict.set_item("chi2", r.chi2)?;
    dict.set_item("relative_l1", r.relative_l1)?;
    dict.set_item("bias", r.bias)?;
    dict.set_item("peak_ratio", r.peak_ratio)?;
    Ok(dict)
}
