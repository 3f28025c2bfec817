//! The compact model: made, taken apart for files, and put together again; two models compared.

use std::sync::Arc;

use gonio_bsdf as core;
use gonio_bsdf::analytic::model_named;
use gonio_bsdf::compact::{BaseLobe, Codes, CompactPart, Frame, Quantised};
use gonio_bsdf::{Channel, FourComponents};
use gonio_build::reduce::{self, CompactOptions};
use gonio_geom::{Component, Side};
use numpy::{PyArray1, PyArrayDyn, PyArrayMethods, PyReadonlyArrayDyn};
use pyo3::exceptions::PyKeyError;
use pyo3::prelude::*;
use pyo3::types::PyDict;

use crate::arrays::angles;
use crate::bsdf::Bsdf;
use crate::errors::{OrRaise, domain};
use crate::radiance::{Names, component_of, components, names, side_of};

/// gonio's compact model: lobes times a table of ratios. Attributes: `components` (list of (side, component)), `report`
/// (what the reduction found: error and max_albedo; empty for a file).
#[pyclass(frozen, extends = Bsdf, module = "gonio", name = "Compact")]
pub(crate) struct Compact {
    model: Arc<core::Compact>,
    /// What is stored, in degrees.
    parts: Vec<StoredPart>,
    report: Py<PyDict>,
}

/// A part as files have it: angles in degrees, so that what is read is what was written, to the last bit.
#[derive(Clone)]
struct StoredPart {
    side: Side,
    component: Component,
    phi_x: f64,
    base: Vec<StoredLobe>,
    frame: Frame,
    table: Quantised,
}

#[derive(Clone)]
struct StoredLobe {
    model: String,
    weight: f64,
    /// Name and one value a channel, angles in degrees.
    parameters: Vec<(String, Vec<f64>)>,
}

impl StoredPart {
    fn of(side: Side, component: Component, part: &CompactPart) -> PyResult<Self> {
        let base = part.base.iter().map(StoredLobe::of).collect::<PyResult<_>>()?;
        Ok(StoredPart {
            side,
            component,
            phi_x: part.frame.phi_x.to_degrees(),
            base,
            frame: part.frame,
            table: part.table.clone(),
        })
    }

    fn part(&self, channels: usize) -> PyResult<CompactPart> {
        Ok(CompactPart {
            base: self
                .base
                .iter()
                .map(|l| l.lobe(channels))
                .collect::<PyResult<_>>()?,
            frame: Frame {
                phi_x: self.phi_x.to_radians(),
                ..self.frame
            },
            table: self.table.clone(),
        })
    }

    fn dict<'py>(&self, py: Python<'py>, channels: usize) -> PyResult<Bound<'py, PyDict>> {
        let d = PyDict::new(py);
        d.set_item("side", self.side.to_string())?;
        d.set_item("component", self.component.to_string())?;
        d.set_item("symmetry", self.frame.symmetry.name())?;
        d.set_item("width", self.frame.width)?;
        d.set_item("phi_x", self.phi_x)?;
        let base = self
            .base
            .iter()
            .map(|l| l.dict(py))
            .collect::<PyResult<Vec<_>>>()?;
        d.set_item("base", base)?;
        let [a, b, c, e] = self.frame.shape;
        let shape = [channels, a, b, c, e];
        match &self.table.codes {
            Codes::Eight(v) => d.set_item("codes", PyArray1::from_slice(py, v).reshape(shape)?)?,
            Codes::Sixteen(v) => d.set_item("codes", PyArray1::from_slice(py, v).reshape(shape)?)?,
        }
        for (name, values) in [("offset", &self.table.offset), ("step", &self.table.step)] {
            d.set_item(name, PyArray1::from_slice(py, values).reshape([channels, a])?)?;
        }
        let cosines: Vec<f64> = (0..a)
            .map(|k| {
                Frame::cos_theta_i(k as f64 / (a - 1) as f64)
                    .clamp(-1.0, 1.0)
                    .acos()
                    .to_degrees()
            })
            .collect();
        d.set_item("theta_i", PyArray1::from_vec(py, cosines))?;
        Ok(d)
    }
}

impl StoredLobe {
    fn of(lobe: &BaseLobe) -> PyResult<Self> {
        let info = model_named(&lobe.model).or_raise()?.info();
        let parameters = info
            .parameters
            .iter()
            .enumerate()
            .map(|(k, p)| {
                let unit = |v: f64| if p.unit == "rad" { v.to_degrees() } else { v };
                let values = lobe.parameters.iter().map(|row| unit(row[k])).collect();
                (p.name.to_owned(), values)
            })
            .collect();
        Ok(StoredLobe {
            model: lobe.model.clone(),
            weight: lobe.weight,
            parameters,
        })
    }

    fn lobe(&self, channels: usize) -> PyResult<BaseLobe> {
        let info = model_named(&self.model).or_raise()?.info();
        let expected: Vec<&str> = info.parameters.iter().map(|p| p.name).collect();
        let mut rows = vec![Vec::with_capacity(expected.len()); channels];
        if self.parameters.len() != expected.len() {
            let found: Vec<&str> = self.parameters.iter().map(|p| p.0.as_str()).collect();
            return Err(domain("parameters", found.join(", "), &expected.join(", ")));
        }
        for p in info.parameters {
            let given = self.parameters.iter().find(|(name, _)| name == p.name);
            let values = given.map(|(_, v)| v).ok_or_else(|| {
                domain(
                    "parameters",
                    format!("no {}", p.name),
                    &format!("{} of {}", expected.join(", "), self.model),
                )
            })?;
            if values.len() != channels {
                let allowed = format!("{channels}, one a channel");
                return Err(domain(p.name, format!("{} values", values.len()), &allowed));
            }
            for (row, v) in rows.iter_mut().zip(values) {
                row.push(if p.unit == "rad" { v.to_radians() } else { *v });
            }
        }
        Ok(BaseLobe {
            model: self.model.clone(),
            parameters: rows,
            weight: self.weight,
        })
    }

    fn dict<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let d = PyDict::new(py);
        d.set_item("model", &self.model)?;
        d.set_item("weight", self.weight)?;
        let parameters = PyDict::new(py);
        for (name, values) in &self.parameters {
            parameters.set_item(name, values)?;
        }
        d.set_item("parameters", parameters)?;
        Ok(d)
    }
}

#[pymethods]
impl Compact {
    /// The components that are there: list of (side of incidence, component).
    #[getter]
    fn components(&self) -> Names {
        names(self.parts.iter().map(|p| (p.side, p.component)))
    }

    /// error (dict (side, component) -> relative L1 of each channel, mean over incidences), max_albedo; empty for a file.
    #[getter]
    fn report(&self, py: Python<'_>) -> Py<PyDict> {
        self.report.clone_ref(py)
    }

    /// What is stored, one dict a component: side, component, symmetry, width, phi_x (degrees), base, codes (int8 or int16 of
    /// shape (channel, theta_i, phi_i, u, phi_h)), offset and step (float32, (channel, theta_i)), theta_i of the nodes
    /// (degrees).
    fn parts<'py>(&self, py: Python<'py>) -> PyResult<Vec<Bound<'py, PyDict>>> {
        let channels = core::Bsdf::channels(&*self.model).len();
        self.parts.iter().map(|p| p.dict(py, channels)).collect()
    }

    /// Bytes of the table of one channel of each component.
    #[getter]
    fn bytes_per_channel<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let d = PyDict::new(py);
        for (side, component, part) in self.model.parts().iter() {
            d.set_item(
                (side.to_string(), component.to_string()),
                part.bytes_per_channel(),
            )?;
        }
        Ok(d)
    }

    fn __repr__(&self) -> String {
        let parts: Vec<String> = self
            .parts
            .iter()
            .map(|p| {
                format!(
                    "{} {}: {}, {:?}",
                    p.side,
                    p.component,
                    p.frame.symmetry.name(),
                    p.frame.shape
                )
            })
            .collect();
        format!("Compact({})", parts.join("; "))
    }
}

fn wrap(
    py: Python<'_>,
    channels: Vec<Channel>,
    stored: Vec<StoredPart>,
    energy_conserving: bool,
    report: Bound<'_, PyDict>,
) -> PyResult<Py<Compact>> {
    let mut parts = FourComponents::default();
    for part in &stored {
        if parts
            .set(part.side, part.component, Some(part.part(channels.len())?))
            .is_some()
        {
            return Err(domain(
                "parts",
                format!("{} {} twice", part.side, part.component),
                "each component once",
            ));
        }
    }
    let model = Arc::new(core::Compact::new(channels, parts, energy_conserving).or_raise()?);
    let compact = Compact {
        model: model.clone(),
        parts: stored,
        report: report.unbind(),
    };
    Py::new(py, PyClassInitializer::from(Bsdf(model)).add_subclass(compact))
}

/// Reduce a model to the compact one: all `channels` and scattering `components` unless some are named. `target`: relative L1
/// error, mean over incidences; `max_bytes` of the table of a channel and component; `bits` 8 or 16. Raises DomainError, and
/// QuantityError for a channel that is not there.
#[pyfunction]
#[pyo3(signature = (bsdf, *, channels=None, components=None, target=None, max_bytes=None, bits=None))]
fn to_compact(
    py: Python<'_>,
    bsdf: &Bsdf,
    channels: Option<Vec<String>>,
    components: Option<Names>,
    target: Option<f64>,
    max_bytes: Option<usize>,
    bits: Option<u32>,
) -> PyResult<Py<Compact>> {
    let own = CompactOptions::default();
    let options = CompactOptions {
        channels: channels
            .map(|list| {
                list.iter()
                    .map(|c| bsdf.channel_index(Some(c)))
                    .collect::<PyResult<_>>()
            })
            .transpose()?,
        components: self::components(components)?,
        target: target.unwrap_or(own.target),
        max_bytes,
        bits,
    };
    let model = bsdf.0.clone();
    let r = py.detach(|| reduce::to_compact(&*model, &options)).or_raise()?;
    let report = PyDict::new(py);
    let error = PyDict::new(py);
    for (s, c, e) in r.error.iter() {
        error.set_item((s.to_string(), c.to_string()), e)?;
    }
    report.set_item("error", error)?;
    report.set_item("max_albedo", r.max_albedo)?;
    let stored = r
        .model
        .parts()
        .iter()
        .map(|(side, component, part)| StoredPart::of(side, component, part))
        .collect::<PyResult<_>>()?;
    let energy = core::Bsdf::properties(&r.model).energy_conserving;
    wrap(
        py,
        core::Bsdf::channels(&r.model).to_vec(),
        stored,
        energy,
        report,
    )
}

/// The compact model of stored parts, as `Compact.parts` gives them. Raises DomainError for what does not fit together.
#[pyfunction]
#[pyo3(signature = (channels, parts, *, energy_conserving))]
fn compact_of(
    py: Python<'_>,
    channels: Vec<String>,
    parts: Vec<Bound<'_, PyDict>>,
    energy_conserving: bool,
) -> PyResult<Py<Compact>> {
    let mut own: Vec<Channel> = Vec::new();
    for name in &channels {
        let channel = name.parse::<Channel>().or_raise()?;
        if own.contains(&channel) {
            return Err(domain(
                "channels",
                format!("{channel} twice"),
                "each channel once",
            ));
        }
        own.push(channel);
    }
    let stored = parts.iter().map(stored).collect::<PyResult<_>>()?;
    wrap(py, own, stored, energy_conserving, PyDict::new(py))
}

fn item<'py>(dict: &Bound<'py, PyDict>, key: &str) -> PyResult<Bound<'py, PyAny>> {
    dict.get_item(key)?
        .ok_or_else(|| PyKeyError::new_err(key.to_owned()))
}

fn stored(part: &Bound<'_, PyDict>) -> PyResult<StoredPart> {
    let text = |key: &str| -> PyResult<String> { item(part, key)?.extract() };
    let codes = item(part, "codes")?;
    let (codes, shape) = if let Ok(array) = codes.cast::<PyArrayDyn<i8>>() {
        let view = array.readonly();
        (
            Codes::Eight(view.as_array().iter().copied().collect()),
            view.as_array().shape().to_vec(),
        )
    } else if let Ok(array) = codes.cast::<PyArrayDyn<i16>>() {
        let view = array.readonly();
        (
            Codes::Sixteen(view.as_array().iter().copied().collect()),
            view.as_array().shape().to_vec(),
        )
    } else {
        return Err(domain("codes", codes.get_type(), "an array of int8 or int16"));
    };
    let [_, n0, n1, n2, n3] = shape[..] else {
        return Err(domain("codes", format!("shape {shape:?}"), "five dimensions"));
    };
    let singles = |key: &str| -> PyResult<Vec<f32>> {
        let view: PyReadonlyArrayDyn<'_, f32> = item(part, key)?.extract()?;
        Ok(view.as_array().iter().copied().collect())
    };
    let width: [f64; 2] = item(part, "width")?.extract()?;
    let lobes: Vec<Bound<'_, PyDict>> = item(part, "base")?.extract()?;
    let base = lobes
        .iter()
        .map(|lobe| {
            let parameters = item(lobe, "parameters")?;
            let parameters = parameters.cast::<PyDict>()?;
            Ok(StoredLobe {
                model: item(lobe, "model")?.extract()?,
                weight: item(lobe, "weight")?.extract()?,
                parameters: parameters
                    .iter()
                    .map(|(k, v)| Ok((k.extract()?, v.extract()?)))
                    .collect::<PyResult<_>>()?,
            })
        })
        .collect::<PyResult<_>>()?;
    Ok(StoredPart {
        side: side_of(&text("side")?)?,
        component: component_of(&text("component")?)?,
        phi_x: item(part, "phi_x")?.extract()?,
        base,
        frame: Frame {
            symmetry: text("symmetry")?.parse().or_raise()?,
            width,
            phi_x: 0.0,
            shape: [n0, n1, n2, n3],
        },
        table: Quantised {
            codes,
            offset: singles("offset")?,
            step: singles("step")?,
        },
    })
}

/// Two models at one incidence (degrees), over directions dense about the mirror or unbent direction: dict of rel_l1, rel_rms
/// (of b from a), albedo_a, albedo_b, peak_a, peak_b (largest DSF, 1/sr), peak_shift (degrees), reciprocity_a, reciprocity_b
/// (mean relative difference of f from f with the directions swapped). Raises DomainError, and QuantityError for a channel
/// that is not there.
#[pyfunction]
#[pyo3(signature = (a, b, *, theta_i, phi_i=0.0, component="reflection", channel_a=None, channel_b=None))]
#[expect(clippy::too_many_arguments, reason = "keyword arguments of Python")]
fn compare_models<'py>(
    py: Python<'py>,
    a: &Bsdf,
    b: &Bsdf,
    theta_i: f64,
    phi_i: f64,
    component: &str,
    channel_a: Option<&str>,
    channel_b: Option<&str>,
) -> PyResult<Bound<'py, PyDict>> {
    let wi = angles(["theta_i", "phi_i"], theta_i, phi_i)?.direction();
    let component = component_of(component)?;
    let channels = [a.channel_index(channel_a)?, b.channel_index(channel_b)?];
    let (a, b) = (a.0.clone(), b.0.clone());
    let found = py
        .detach(|| reduce::compare((&*a, channels[0]), (&*b, channels[1]), wi, component))
        .or_raise()?;
    let d = PyDict::new(py);
    d.set_item("rel_l1", found.rel_l1)?;
    d.set_item("rel_rms", found.rel_rms)?;
    for (k, name) in ["a", "b"].into_iter().enumerate() {
        d.set_item(format!("albedo_{name}"), found.albedo[k])?;
        d.set_item(format!("peak_{name}"), found.peak[k])?;
        d.set_item(format!("reciprocity_{name}"), found.reciprocity[k])?;
    }
    d.set_item("peak_shift", found.peak_shift.to_degrees())?;
    Ok(d)
}

/// Models of different channels as one of them all. Raises DomainError for none, and for a channel that two have.
#[pyfunction]
fn side_by_side(models: Vec<Bound<'_, Bsdf>>) -> PyResult<Bsdf> {
    let models = models.iter().map(|m| m.get().0.clone()).collect();
    Ok(Bsdf(Arc::new(gonio_build::SideBySide::new(models).or_raise()?)))
}

pub(crate) fn register(m: &Bound<'_, PyModule>) -> PyResult<()> {
    m.add_class::<Compact>()?;
    m.add_function(wrap_pyfunction!(to_compact, m)?)?;
    m.add_function(wrap_pyfunction!(compact_of, m)?)?;
    m.add_function(wrap_pyfunction!(side_by_side, m)?)?;
    m.add_function(wrap_pyfunction!(compare_models, m)?)
}
