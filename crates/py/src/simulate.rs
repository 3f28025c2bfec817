//! Analytic models and the virtual goniophotometer.

use gonio_bsdf as core;
use gonio_geom::{Angles, Component};
use gonio_instrument::device::{self, ReadingEffort};
use gonio_instrument::{Campaign, Instrument, InstrumentError};
use pyo3::prelude::*;
use pyo3::types::PyDict;

use crate::arrays::angles;
use crate::bsdf::Bsdf;
use crate::device::Device;
use crate::errors::{OrRaise, QuantityError, Raise, domain};
use crate::instrument::{add_parts, instrument};
use crate::scan::Scan;

impl Raise for InstrumentError {
    fn raise(self) -> PyErr {
        let InstrumentError::Domain {
            field,
            found,
            allowed,
        } = self;
        domain(field, found, &allowed)
    }
}

pub(crate) fn component(name: &str) -> PyResult<Component> {
    match name {
        "reflection" => Ok(Component::Reflection),
        "transmission" => Ok(Component::Transmission),
        _ => Err(domain(
            "component",
            format!("{name:?}"),
            "reflection, transmission",
        )),
    }
}

/// Directional-hemispherical reflectance or transmittance of `model` by adaptive quadrature.
#[pyfunction]
#[pyo3(signature = (model, *, theta_i, phi_i, component, channel=None))]
fn directional_albedo(
    py: Python<'_>,
    model: &Bsdf,
    theta_i: f64,
    phi_i: f64,
    component: &str,
    channel: Option<&str>,
) -> PyResult<f64> {
    let wi = angles(["theta_i", "phi_i"], theta_i, phi_i)?.direction();
    let component = self::component(component)?;
    let names: Vec<String> = model.0.channels().iter().map(ToString::to_string).collect();
    let index = match channel {
        None => 0,
        Some(name) => names.iter().position(|n| n == name).ok_or_else(|| {
            QuantityError::new_err(format!(
                "channel: found {name:?}, needed one of {}",
                names.join(", ")
            ))
        })?,
    };
    Ok(py.detach(|| core::directional_albedo(model.0.as_ref(), wi, component, index)))
}

/// What a campaign is asked for.
#[expect(clippy::too_many_arguments, reason = "keyword-only in Python")]
fn campaign(
    incidences: Vec<(f64, f64)>,
    components: &[String],
    seed: u64,
    sample_name: Option<String>,
    started: Option<String>,
    settings: &Bound<'_, PyDict>,
    parts: Option<&Bound<'_, PyDict>>,
    beam_scans: usize,
) -> PyResult<(Campaign, Instrument)> {
    let campaign = Campaign {
        incidences: incidences
            .into_iter()
            .map(|(theta, phi)| angles(["theta_i", "phi_i"], theta, phi))
            .collect::<PyResult<Vec<Angles>>>()?,
        components: components
            .iter()
            .map(|name| component(name))
            .collect::<PyResult<Vec<_>>>()?,
        seed,
        sample_name,
        started,
        beam_scans,
        ..Campaign::default()
    };
    let mut instrument = instrument(settings)?;
    if let Some(parts) = parts {
        add_parts(&mut instrument, parts)?;
    }
    Ok((campaign, instrument))
}

/// Calls `watch` of Python and keeps the exception that ends the campaign.
fn watching(watch: Option<&Py<PyAny>>, raised: &mut Option<PyErr>, done: usize, total: usize) -> bool {
    let Some(watch) = watch else { return true };
    match Python::attach(|py| watch.call1(py, (done, total)).map(|_| ())) {
        Ok(()) => true,
        Err(error) => {
            *raised = Some(error);
            false
        }
    }
}

/// Records of a virtual campaign, in the order they are taken. `watch` is called with the incidences that are done and all;
/// an exception of its ends the campaign.
#[pyfunction]
#[pyo3(signature = (
    model, *, incidences, components, seed, sample_name=None, started=None, settings, parts=None, beam_scans=3, watch=None
))]
#[expect(clippy::too_many_arguments, reason = "keyword-only in Python")]
fn simulate(
    py: Python<'_>,
    model: &Bsdf,
    incidences: Vec<(f64, f64)>,
    components: Vec<String>,
    seed: u64,
    sample_name: Option<String>,
    started: Option<String>,
    settings: &Bound<'_, PyDict>,
    parts: Option<&Bound<'_, PyDict>>,
    beam_scans: usize,
    watch: Option<Py<PyAny>>,
) -> PyResult<Vec<Scan>> {
    let (campaign, instrument) = campaign(
        incidences,
        &components,
        seed,
        sample_name,
        started,
        settings,
        parts,
        beam_scans,
    )?;
    let mut raised = None;
    let records = py
        .detach(|| {
            gonio_instrument::simulate_watched(model.0.as_ref(), &instrument, &campaign, |done, total| {
                watching(watch.as_ref(), &mut raised, done, total)
            })
        })
        .or_raise()?;
    match raised {
        Some(error) => Err(error),
        None => Ok(records.unwrap_or_default().into_iter().map(Scan::from).collect()),
    }
}

/// Rays joined, rays met, and standard error of each reading over its noise, of a path over the sample.
type Known = (u32, u32, Vec<f32>);

/// The same of a part that is geometry, and how well its readings are known.
#[pyfunction]
#[pyo3(signature = (
    device, *, unit, share, joined, met, incidences, components, seed, sample_name=None, started=None, settings, parts=None,
    beam_scans=3, watch=None
))]
#[expect(clippy::too_many_arguments, reason = "keyword-only in Python")]
fn simulate_device(
    py: Python<'_>,
    device: &Device,
    unit: f64,
    share: f64,
    joined: u32,
    met: u32,
    incidences: Vec<(f64, f64)>,
    components: Vec<String>,
    seed: u64,
    sample_name: Option<String>,
    started: Option<String>,
    settings: &Bound<'_, PyDict>,
    parts: Option<&Bound<'_, PyDict>>,
    beam_scans: usize,
    watch: Option<Py<PyAny>>,
) -> PyResult<(Vec<Scan>, Vec<Known>)> {
    let (campaign, instrument) = campaign(
        incidences,
        &components,
        seed,
        sample_name,
        started,
        settings,
        parts,
        beam_scans,
    )?;
    let effort = ReadingEffort {
        unit,
        share,
        joined,
        met,
        ..ReadingEffort::default()
    };
    let mut raised = None;
    let found = py
        .detach(|| {
            device::simulate_device(&device.0, &effort, &instrument, &campaign, |done, total| {
                watching(watch.as_ref(), &mut raised, done, total)
            })
        })
        .or_raise()?;
    match raised {
        Some(error) => Err(error),
        None => {
            let (records, known) = found.unwrap_or_default();
            let known = known.into_iter().map(|k| (k.joined, k.met, k.error_over_noise));
            Ok((records.into_iter().map(Scan::from).collect(), known.collect()))
        }
    }
}

pub(crate) fn register(m: &Bound<'_, PyModule>) -> PyResult<()> {
    m.add_function(wrap_pyfunction!(directional_albedo, m)?)?;
    m.add_function(wrap_pyfunction!(simulate, m)?)?;
    m.add_function(wrap_pyfunction!(simulate_device, m)?)
}
