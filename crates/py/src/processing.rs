//! Processing: raw readings to a measurement.

use std::sync::Arc;

use gonio_scan as core;
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyList};

use crate::errors::{OrRaise, domain};
use crate::scan::Scan;
use crate::slice::MeasurementData;
use crate::verdict::Verdict;

impl From<&core::Verdict> for Verdict {
    fn from(v: &core::Verdict) -> Self {
        Verdict {
            id: v.id.into(),
            title: v.title.into(),
            verdict: v.level.name().into(),
            value: v.value,
            unit: v.unit.into(),
            sentence: v.sentence.clone(),
        }
    }
}

/// Copies of the records behind the Python objects.
pub(crate) fn records(scans: &[PyRef<'_, Scan>]) -> Vec<core::Scan> {
    scans.iter().map(|s| (*s.0).clone()).collect()
}

fn dark_method(name: &str) -> PyResult<core::DarkMethod> {
    use core::DarkMethod::{Auto, Direction, Level, Time};
    [Auto, Direction, Time, Level]
        .into_iter()
        .find(|m| m.name() == name)
        .ok_or_else(|| domain("dark_method", format!("{name:?}"), "auto, direction, time, level"))
}

/// Settings from keyword arguments in degrees.
fn options(
    dark_method_name: &str,
    dark_tolerance: f64,
    noise_readout: Option<f64>,
    noise_relative: Option<f64>,
    u_angle: f64,
    u_calibration: f64,
    shadow_radius: Option<f64>,
) -> PyResult<core::ProcessOptions> {
    for (field, value) in [
        ("noise_readout", noise_readout),
        ("noise_relative", noise_relative),
    ] {
        if let Some(v) = value
            && !(v.is_finite() && v >= 0.0)
        {
            return Err(domain(field, v, "a finite number >= 0"));
        }
    }
    let noise = (noise_readout.is_some() || noise_relative.is_some()).then(|| core::NoiseModel {
        readout: noise_readout.unwrap_or(0.0),
        relative: noise_relative.unwrap_or(0.0),
        origin: core::NoiseOrigin::Stated,
    });
    Ok(core::ProcessOptions {
        dark: core::DarkOptions {
            method: dark_method(dark_method_name)?,
            tolerance: dark_tolerance.to_radians(),
        },
        noise,
        u_angle: u_angle.to_radians(),
        u_calibration,
        shadow_radius: shadow_radius.map(f64::to_radians),
    })
}

/// Raw readings to DSF with uncertainty, weights and hemispherical integrals. Angles in degrees.
#[pyfunction]
#[pyo3(signature = (sample, *, beam=Vec::new(), dark=Vec::new(), dark_method="auto", dark_tolerance=0.25,
    noise_readout=None, noise_relative=None, u_angle=0.0, u_calibration=0.0, shadow_radius=None))]
#[expect(clippy::too_many_arguments, reason = "keyword-only in Python")]
fn process(
    py: Python<'_>,
    sample: Vec<PyRef<'_, Scan>>,
    beam: Vec<PyRef<'_, Scan>>,
    dark: Vec<PyRef<'_, Scan>>,
    dark_method: &str,
    dark_tolerance: f64,
    noise_readout: Option<f64>,
    noise_relative: Option<f64>,
    u_angle: f64,
    u_calibration: f64,
    shadow_radius: Option<f64>,
) -> PyResult<MeasurementData> {
    let options = options(
        dark_method,
        dark_tolerance,
        noise_readout,
        noise_relative,
        u_angle,
        u_calibration,
        shadow_radius,
    )?;
    let (sample, beam, dark) = (records(&sample), records(&beam), records(&dark));
    py.detach(|| core::process_owned(sample, &beam, &dark, &options))
        .or_raise()
        .map(MeasurementData::from)
}

/// DSF relative to a calibrated standard scanned over the sample's directions. `reference_theta` (degrees, ascending)
/// and `reflectance_factor` have one entry each for a constant.
#[pyfunction]
#[pyo3(signature = (sample, *, standard, reflectance_factor, reference_theta=vec![0.0], u_standard=0.0,
    dark=Vec::new(), dark_method="auto", dark_tolerance=0.25, noise_readout=None, noise_relative=None, u_angle=0.0,
    u_calibration=0.0, shadow_radius=None))]
#[expect(clippy::too_many_arguments, reason = "keyword-only in Python")]
fn process_relative(
    py: Python<'_>,
    sample: Vec<PyRef<'_, Scan>>,
    standard: Vec<PyRef<'_, Scan>>,
    reflectance_factor: Vec<f64>,
    reference_theta: Vec<f64>,
    u_standard: f64,
    dark: Vec<PyRef<'_, Scan>>,
    dark_method: &str,
    dark_tolerance: f64,
    noise_readout: Option<f64>,
    noise_relative: Option<f64>,
    u_angle: f64,
    u_calibration: f64,
    shadow_radius: Option<f64>,
) -> PyResult<MeasurementData> {
    if reference_theta.len() != reflectance_factor.len() {
        return Err(domain(
            "reference_theta",
            format!("{} entries", reference_theta.len()),
            &format!("{}, one a reflectance factor", reflectance_factor.len()),
        ));
    }
    let options = options(
        dark_method,
        dark_tolerance,
        noise_readout,
        noise_relative,
        u_angle,
        u_calibration,
        shadow_radius,
    )?;
    let reference = core::Standard {
        reflectance_factor: reference_theta
            .iter()
            .map(|t| t.to_radians())
            .zip(reflectance_factor)
            .collect(),
        u_relative: u_standard,
    };
    let (sample, standard, dark) = (records(&sample), records(&standard), records(&dark));
    py.detach(|| core::process_relative(sample, &standard, &dark, &reference, &options))
        .or_raise()
        .map(MeasurementData::from)
}

/// Tilt and azimuth offset of the sample from its mirror peaks, degrees.
#[pyfunction]
fn align<'py>(py: Python<'py>, measurement: &MeasurementData) -> PyResult<Bound<'py, PyDict>> {
    let found = py.detach(|| core::align(&measurement.0)).or_raise()?;
    let out = PyDict::new(py);
    let [u_x, u_y, u_a] = found.u().map(f64::to_degrees);
    out.set_item("tilt", found.tilt().to_degrees())?;
    out.set_item("tilt_x", found.tilt_x.to_degrees())?;
    out.set_item("tilt_y", found.tilt_y.to_degrees())?;
    out.set_item("azimuth", found.azimuth.to_degrees())?;
    out.set_item("u_tilt_x", u_x)?;
    out.set_item("u_tilt_y", u_y)?;
    out.set_item("u_azimuth", u_a)?;
    out.set_item("significant", found.is_significant())?;
    out.set_item("residual", found.residual.to_degrees())?;
    out.set_item("peaks", found.peaks.len())?;
    Ok(out)
}

/// The measurement turned into the frame of the sample's true normal, as `align` finds it.
#[pyfunction]
fn correct_alignment(py: Python<'_>, measurement: &MeasurementData) -> PyResult<MeasurementData> {
    let mut corrected = (*measurement.0).clone();
    py.detach(|| {
        let found = core::align(&corrected)?;
        core::correct_alignment(&mut corrected, &found)
    })
    .or_raise()?;
    Ok(corrected.into())
}

/// What the processing found out: `{"beams": [...], "noise": [...], "dark": [...]}`, angles in degrees.
pub(crate) fn processing_dict<'py>(
    py: Python<'py>,
    measurement: &Arc<core::Measurement>,
) -> PyResult<Bound<'py, PyDict>> {
    let out = PyDict::new(py);
    let beams = PyList::empty(py);
    for b in &measurement.processing.beams {
        let d = PyDict::new(py);
        let s = &b.signature;
        d.set_item("channel", b.channel.to_string())?;
        d.set_item("power", b.power)?;
        d.set_item("u_power", b.u_power())?;
        d.set_item("u_quadrature", b.u_quadrature)?;
        d.set_item("u_noise", b.u_noise)?;
        d.set_item("u_repeatability", b.u_repeatability)?;
        d.set_item("scans", b.scans)?;
        d.set_item("rim", b.rim)?;
        d.set_item("fwhm", s.fwhm.to_degrees())?;
        d.set_item("radius_50", s.radius_50.to_degrees())?;
        d.set_item("radius_90", s.radius_90.to_degrees())?;
        d.set_item("solid_angle", s.solid_angle)?;
        d.set_item("second_moment", s.second_moment.to_degrees().to_degrees())?;
        d.set_item("offset", s.offset.to_degrees())?;
        beams.append(d)?;
    }
    out.set_item("beams", beams)?;
    let noise = PyList::empty(py);
    for (channel, n) in &measurement.processing.noise {
        let d = PyDict::new(py);
        d.set_item("channel", channel.to_string())?;
        d.set_item("readout", n.readout)?;
        d.set_item("relative", n.relative)?;
        d.set_item("origin", n.origin.name())?;
        noise.append(d)?;
    }
    out.set_item("noise", noise)?;
    let dark = PyList::empty(py);
    for found in &measurement.processing.dark {
        let Some(found) = found else {
            dark.append(py.None())?;
            continue;
        };
        let d = PyDict::new(py);
        d.set_item("method", found.method.name())?;
        d.set_item("mean", found.mean)?;
        d.set_item("u_independent", found.u_independent)?;
        d.set_item("u_common", found.u_common)?;
        dark.append(d)?;
    }
    out.set_item("dark", dark)?;
    Ok(out)
}

pub(crate) fn register(m: &Bound<'_, PyModule>) -> PyResult<()> {
    m.add_function(wrap_pyfunction!(process, m)?)?;
    m.add_function(wrap_pyfunction!(process_relative, m)?)?;
    m.add_function(wrap_pyfunction!(align, m)?)?;
    m.add_function(wrap_pyfunction!(correct_alignment, m)?)
}
