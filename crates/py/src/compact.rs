//! The compact model: made, taken apart for files, and put together again; two models compared.

use std::sync::Arc;

use gonio_bsdf as core;
use gonio_bsdf::{Channel, FourComponents};
use gonio_build::reduce::{self, CompactOptions};
use pyo3::prelude::*;
use pyo3::types::PyDict;

use crate::arrays::angles;
use crate::bsdf::Bsdf;
use crate::compact_parts::{StoredIdeal, StoredPart, stored, stored_ideal};
use crate::errors::{OrRaise, domain};
use crate::radiance::{Names, component_of, components, names};

/// gonio's compact model: lobes times a table of ratios. Attributes: `components` (list of (side, component)), `report`
/// (what the reduction found: error and max_albedo; empty for a file).
#[pyclass(frozen, extends = Bsdf, module = "gonio", name = "Compact")]
pub(crate) struct Compact {
    model: Arc<core::Compact>,
    /// What is stored, in degrees.
    parts: Vec<StoredPart>,
    ideal: Vec<StoredIdeal>,
    report: Py<PyDict>,
}

#[pymethods]
impl Compact {
    /// The components that are there: list of (side of incidence, component).
    #[getter]
    fn components(&self) -> Names {
        let has = |(side, component): &(_, _)| {
            self.model.parts().get(*side, *component).is_some()
                || self.model.ideal().get(*side, *component).is_some()
        };
        names(FourComponents::<()>::KEYS.into_iter().filter(has))
    }

    /// error (dict (side, component) -> relative L1 of each channel, mean over incidences), ideal_error (largest difference of a
    /// share of light that does not spread), max_albedo; empty for a file.
    #[getter]
    fn report(&self, py: Python<'_>) -> Py<PyDict> {
        self.report.clone_ref(py)
    }

    /// What is stored, one dict a component: side, component, symmetry, width, phi_x (degrees), base, codes (int16 of shape
    /// (channel, theta_i, phi_i, u, phi_h)), offset and step (float32, (channel, theta_i)), theta_i of the nodes (degrees);
    /// shape and coded (a dict of bytes, offset and step a channel), the same as files have it.
    fn parts<'py>(&self, py: Python<'py>) -> PyResult<Vec<Bound<'py, PyDict>>> {
        let channels = core::Bsdf::channels(&*self.model).len();
        self.parts.iter().map(|p| p.dict(py, channels)).collect()
    }

    /// Light that does not spread, one dict a component: side, component, symmetry, phi_x (degrees), shares (float32,
    /// (channel, theta_i, phi_i)), theta_i of the nodes (degrees).
    fn ideal_parts<'py>(&self, py: Python<'py>) -> PyResult<Vec<Bound<'py, PyDict>>> {
        let channels = core::Bsdf::channels(&*self.model).len();
        self.ideal.iter().map(|p| p.dict(py, channels)).collect()
    }

    /// Bytes of one channel of each component as stored: of its table, and of the shares of light that does not spread.
    #[getter]
    fn bytes_per_channel<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let d = PyDict::new(py);
        for (side, component) in FourComponents::<()>::KEYS {
            let table = self.model.parts().get(side, component);
            let ideal = self.model.ideal().get(side, component);
            let bytes =
                table.map_or(0, |p| p.bytes_per_channel()) + ideal.map_or(0, |p| p.bytes_per_channel());
            if bytes > 0 {
                d.set_item((side.to_string(), component.to_string()), bytes)?;
            }
        }
        Ok(d)
    }

    fn __repr__(&self) -> String {
        let mut parts: Vec<String> = self
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
        for p in &self.ideal {
            parts.push(format!(
                "{} {}: unscattered, {:?}",
                p.side, p.component, p.part.shape
            ));
        }
        format!("Compact({})", parts.join("; "))
    }
}

fn wrap(
    py: Python<'_>,
    channels: Vec<Channel>,
    stored: Vec<StoredPart>,
    ideal: Vec<StoredIdeal>,
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
    let mut shares = FourComponents::default();
    for part in &ideal {
        if shares.set(part.side, part.component, Some(part.part())).is_some() {
            return Err(domain(
                "ideal",
                format!("{} {} twice", part.side, part.component),
                "each component once",
            ));
        }
    }
    let model = core::Compact::with_ideal(channels, parts, shares, energy_conserving).or_raise()?;
    let model = Arc::new(model);
    let compact = Compact {
        model: model.clone(),
        parts: stored,
        ideal,
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
    let error = PyDict::new(py);
    for (s, c, e) in r.ideal_error.iter() {
        error.set_item((s.to_string(), c.to_string()), e)?;
    }
    report.set_item("ideal_error", error)?;
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
        r.model
            .ideal()
            .iter()
            .map(|(side, component, part)| StoredIdeal::of(side, component, part))
            .collect(),
        energy,
        report,
    )
}

/// The compact model of stored parts, as `Compact.parts` (coded, or codes alone) and `Compact.ideal_parts` give them. Raises DomainError for what does not fit together.
#[pyfunction]
#[pyo3(signature = (channels, parts, *, energy_conserving, ideal=None))]
fn compact_of(
    py: Python<'_>,
    channels: Vec<String>,
    parts: Vec<Bound<'_, PyDict>>,
    energy_conserving: bool,
    ideal: Option<Vec<Bound<'_, PyDict>>>,
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
    let ideal = ideal.unwrap_or_default();
    let ideal = ideal.iter().map(stored_ideal).collect::<PyResult<_>>()?;
    wrap(py, own, stored, ideal, energy_conserving, PyDict::new(py))
}

/// Two models at one incidence (degrees), over directions dense about the mirror or unbent direction: dict of rel_l1, rel_rms
/// (of b from a), albedo_a, albedo_b, ideal_a, ideal_b (share of the light without spread, or what a table holds of it), peak_a, peak_b (largest DSF, 1/sr), peak_shift (degrees), reciprocity_a, reciprocity_b
/// (mean relative difference of f from f with the directions swapped; NaN where nothing is known of light the other way). Raises DomainError, and QuantityError for a channel
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
        d.set_item(format!("ideal_{name}"), found.ideal[k])?;
        d.set_item(format!("peak_{name}"), found.peak[k])?;
        d.set_item(format!("reciprocity_{name}"), found.reciprocity[k])?;
    }
    d.set_item("peak_shift", found.peak_shift.to_degrees())?;
    Ok(d)
}

/// Mean relative difference of f from f with the directions swapped at one incidence (degrees), as `compare_models` has it: NaN
/// where nothing scatters, and where nothing is known of light the other way. Raises DomainError, QuantityError.
#[pyfunction]
#[pyo3(signature = (bsdf, *, theta_i, phi_i=0.0, component="reflection", channel=None))]
fn model_reciprocity(
    py: Python<'_>,
    bsdf: &Bsdf,
    theta_i: f64,
    phi_i: f64,
    component: &str,
    channel: Option<&str>,
) -> PyResult<f64> {
    let wi = angles(["theta_i", "phi_i"], theta_i, phi_i)?.direction();
    let component = component_of(component)?;
    let channel = bsdf.channel_index(channel)?;
    let model = bsdf.0.clone();
    py.detach(|| reduce::reciprocity((&*model, channel), wi, component))
        .or_raise()
}

/// The largest share of the light that leaves a model on both sides, over incidences every 5 degrees: dict of value, error
/// (standard error of the sampling), channel, theta_i, phi_i (degrees).
#[pyfunction]
fn largest_albedo<'py>(py: Python<'py>, bsdf: &Bsdf) -> PyResult<Bound<'py, PyDict>> {
    let model = bsdf.0.clone();
    let found = py.detach(|| reduce::largest_albedo(&*model));
    let (theta, phi) = found.at.to_degrees();
    let d = PyDict::new(py);
    d.set_item("value", found.value)?;
    d.set_item("error", found.error)?;
    d.set_item("channel", bsdf.0.channels()[found.channel].to_string())?;
    d.set_item("theta_i", theta)?;
    d.set_item("phi_i", phi)?;
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
    m.add_function(wrap_pyfunction!(compare_models, m)?)?;
    m.add_function(wrap_pyfunction!(model_reciprocity, m)?)?;
    m.add_function(wrap_pyfunction!(largest_albedo, m)?)
}
