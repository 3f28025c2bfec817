//! The planner of the virtual goniophotometer.

use gonio_instrument::plan::{Missed, PlannedScan};
use gonio_instrument::{Campaign, PlanOptions, PlanRegion};
use numpy::PyArray1;
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyList};

use crate::arrays::angles;
use crate::bsdf::Bsdf;
use crate::errors::OrRaise;
use crate::instrument::{add_parts, instrument};
use crate::simulate::component;

/// A planned path: `table` (theta_i, phi_i, theta_s, phi_s in degrees), `scans`, `readings`, `seconds`, `channels`. `gonio.plan` says what
/// they hold. `watch` is called with the rounds that are done and may be; an exception of its ends the search.
#[pyfunction]
#[pyo3(signature = (
    model, *, incidences, components, seed, settings, parts, beam_scans, target_integral, target_peak, seconds, largest_pitch,
    u_calibration, regions, watch
))]
#[expect(clippy::too_many_arguments, reason = "keyword-only in Python")]
fn plan<'py>(
    py: Python<'py>,
    model: &Bsdf,
    incidences: Vec<(f64, f64)>,
    components: Vec<String>,
    seed: u64,
    settings: &Bound<'py, PyDict>,
    parts: &Bound<'py, PyDict>,
    beam_scans: usize,
    target_integral: f64,
    target_peak: f64,
    seconds: Option<f64>,
    largest_pitch: f64,
    u_calibration: f64,
    regions: Vec<(f64, f64, f64, f64)>,
    watch: Py<PyAny>,
) -> PyResult<Bound<'py, PyDict>> {
    let campaign = Campaign {
        incidences: incidences
            .into_iter()
            .map(|(theta, phi)| angles(["theta_i", "phi_i"], theta, phi))
            .collect::<PyResult<_>>()?,
        components: components
            .iter()
            .map(|name| component(name))
            .collect::<PyResult<_>>()?,
        seed,
        beam_scans,
        ..Campaign::default()
    };
    let mut instrument = instrument(settings)?;
    add_parts(&mut instrument, parts)?;
    let options = PlanOptions {
        target_integral,
        target_peak,
        time: seconds,
        largest_pitch: largest_pitch.to_radians(),
        u_calibration,
        regions: regions
            .into_iter()
            .map(|(theta, phi, radius, pitch)| {
                Ok(PlanRegion {
                    at: angles(["region theta_s", "region phi_s"], theta, phi)?,
                    radius: radius.to_radians(),
                    pitch: pitch.to_radians(),
                })
            })
            .collect::<PyResult<_>>()?,
    };
    let mut raised = None;
    let found = py
        .detach(|| {
            gonio_instrument::plan(
                model.0.as_ref(),
                &instrument,
                &campaign,
                &options,
                |done, total| match Python::attach(|py| watch.call1(py, (done, total)).map(|_| ())) {
                    Ok(()) => true,
                    Err(error) => {
                        raised = Some(error);
                        false
                    }
                },
            )
        })
        .or_raise()?;
    if let Some(error) = raised {
        return Err(error);
    }
    let out = PyDict::new(py);
    let Some(found) = found else { return Ok(out) };
    let table = PyList::empty(py);
    for (incidence, line) in &found.table.lines {
        let (theta_i, phi_i) = incidence.to_degrees();
        let pairs: Vec<(f64, f64)> = line.iter().map(|d| d.angles().to_degrees()).collect();
        let theta = PyArray1::from_iter(py, pairs.iter().map(|p| p.0));
        let phi = PyArray1::from_iter(py, pairs.iter().map(|p| p.1));
        table.append((theta_i, phi_i, theta, phi))?;
    }
    out.set_item("table", table)?;
    out.set_item("readings", found.readings)?;
    out.set_item("seconds", found.seconds)?;
    let scans = PyList::empty(py);
    for s in &found.scans {
        scans.append(scan(py, s)?)?;
    }
    out.set_item("scans", scans)?;
    let channels: Vec<String> = found.channels.iter().map(ToString::to_string).collect();
    out.set_item("channels", channels)?;
    Ok(out)
}

fn scan<'py>(py: Python<'py>, s: &PlannedScan) -> PyResult<Bound<'py, PyDict>> {
    let out = PyDict::new(py);
    let (theta_i, phi_i) = s.incidence.to_degrees();
    out.set_item("theta_i", theta_i)?;
    out.set_item("phi_i", phi_i)?;
    out.set_item("component", s.component.to_string())?;
    out.set_item("readings", s.readings)?;
    out.set_item("channel_integral", s.channel_integral.to_string())?;
    out.set_item("channel_peak", s.channel_peak.to_string())?;
    for (name, value) in [
        ("seconds", s.seconds),
        ("integral", s.integral),
        ("u_integral", s.u_integral),
        ("error", s.error),
        ("u_quadrature", s.u_quadrature),
        ("u_common", s.u_common),
        ("peak", s.peak),
        ("u_peak", s.u_peak),
        ("u_sampling", s.u_sampling),
        ("flattened", s.flattened),
        ("shaded", s.shaded),
        ("beyond", s.beyond),
        ("unread", s.unread),
        ("base", s.base.to_degrees()),
    ] {
        out.set_item(name, value)?;
    }
    out.set_item("peak_at", s.peak_at.to_degrees())?;
    let lobes = PyList::empty(py);
    for l in &s.lobes {
        let widths = l.width.map(f64::to_degrees);
        let pitches = l.pitch.map(f64::to_degrees);
        lobes.append((l.at.to_degrees(), widths, pitches, l.height))?;
    }
    out.set_item("lobes", lobes)?;
    let missed = s.missed.map(|m| match m {
        Missed::Time => "time",
        Missed::Instrument => "instrument",
        Missed::Pitch => "pitch",
    });
    out.set_item("missed", missed)?;
    Ok(out)
}

pub(crate) fn register(m: &Bound<'_, PyModule>) -> PyResult<()> {
    m.add_function(wrap_pyfunction!(plan, m)?)
}
