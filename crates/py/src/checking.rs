//! Checks of measurements.

use std::sync::Arc;

use gonio_scan as core;
use pyo3::prelude::*;

use crate::errors::OrRaise;
use crate::slice::MeasurementData;
use crate::verdict::Verdict;

/// Every check one measurement allows. `isotropic=None`: taken as isotropic when all incidences share one azimuth.
/// `aligned`: the tilt of the sample was corrected.
#[pyfunction]
#[pyo3(signature = (measurement, *, isotropic=None, aligned=false))]
fn check(
    py: Python<'_>,
    measurement: &MeasurementData,
    isotropic: Option<bool>,
    aligned: bool,
) -> Vec<Verdict> {
    let measurement = Arc::clone(&measurement.0);
    let options = core::CheckOptions { isotropic, aligned };
    let found = py.detach(|| core::check(&measurement, &options));
    found.iter().map(Verdict::from).collect()
}

/// How well two or more measurements of one sample agree.
#[pyfunction]
#[pyo3(signature = (measurements))]
fn repeatability(py: Python<'_>, measurements: Vec<PyRef<'_, MeasurementData>>) -> PyResult<Verdict> {
    let shared: Vec<Arc<core::Measurement>> = measurements.iter().map(|m| Arc::clone(&m.0)).collect();
    let found = py.detach(|| core::repeatability(&shared.iter().map(Arc::as_ref).collect::<Vec<_>>()));
    found.or_raise().map(|v| Verdict::from(&v))
}

/// The reciprocity check alone, of the slices in `channels` (none: all).
#[pyfunction]
#[pyo3(signature = (measurement, *, channels, isotropic=None))]
fn reciprocity(
    py: Python<'_>,
    measurement: &MeasurementData,
    channels: Vec<String>,
    isotropic: Option<bool>,
) -> Verdict {
    let measurement = Arc::clone(&measurement.0);
    let wanted = |s: &&core::Slice| channels.is_empty() || channels.contains(&s.channel.to_string());
    let found = py.detach(|| {
        if channels.is_empty() {
            return core::reciprocity(&measurement.slices, isotropic);
        }
        let slices: Vec<core::Slice> = measurement.slices.iter().filter(wanted).cloned().collect();
        core::reciprocity(&slices, isotropic)
    });
    Verdict::from(&found)
}

pub(crate) fn register(m: &Bound<'_, PyModule>) -> PyResult<()> {
    m.add_function(wrap_pyfunction!(check, m)?)?;
    m.add_function(wrap_pyfunction!(reciprocity, m)?)?;
    m.add_function(wrap_pyfunction!(repeatability, m)?)
}
