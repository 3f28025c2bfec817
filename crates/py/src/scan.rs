//! `Scan`: the readings of one incidence and one channel.

use std::collections::BTreeMap;
use std::sync::Arc;

use gonio_bsdf::{Channel, Quantity};
use gonio_scan as core;
use numpy::PyArray1;
use pyo3::prelude::*;
use pyo3::types::PyDict;

use crate::arrays::{Column, column, copied, degrees, stated_angles, stated_columns};
use crate::errors::{OrRaise, domain};

/// One record as an instrument wrote it: the readings of one incidence and one channel.
///
/// Angles are degrees, theta in [0, 180] from the front normal, phi in [0, 360). The constructor also takes theta in
/// [-180, 270] (a negative one, or one past 180, lies on the opposite azimuth) and phi in [-360, 720]. `value` is in the unit of
/// `quantity`; NaN means no data. Arrays are copies.
#[pyclass(frozen, module = "gonio", name = "Scan")]
pub(crate) struct Scan(pub(crate) Arc<core::Scan>);

impl From<core::Scan> for Scan {
    fn from(scan: core::Scan) -> Self {
        Scan(Arc::new(scan))
    }
}

#[pymethods]
impl Scan {
    #[new]
    #[pyo3(signature = (*, kind="sample", quantity="signal", channel="photopic", theta_i, phi_i, theta_s, phi_s,
        value, time=None, meta=None))]
    #[expect(clippy::too_many_arguments, reason = "keyword-only in Python")]
    fn new(
        kind: &str,
        quantity: &str,
        channel: &str,
        theta_i: f64,
        phi_i: f64,
        theta_s: Column<'_>,
        phi_s: Column<'_>,
        value: Column<'_>,
        time: Option<Column<'_>>,
        meta: Option<&Bound<'_, PyDict>>,
    ) -> PyResult<Self> {
        let value = column("value", &value, None)?;
        let n = Some(value.len());
        let mut theta_s = column("theta_s", &theta_s, n)?;
        let mut phi_s = column("phi_s", &phi_s, n)?;
        stated_columns(["theta_s", "phi_s"], &mut theta_s, &mut phi_s)?;
        Ok(core::Scan {
            kind: kind.parse::<core::ScanKind>().or_raise()?,
            quantity: quantity.parse::<Quantity>().or_raise()?,
            channel: channel.parse::<Channel>().or_raise()?,
            incidence: stated_angles(["theta_i", "phi_i"], theta_i, phi_i)?,
            theta_s,
            phi_s,
            value,
            time: time.map(|t| column("time", &t, n)).transpose()?,
            meta: meta.map(meta_from).transpose()?.unwrap_or_default(),
        }
        .into())
    }

    /// sample, beam, dark or standard.
    #[getter]
    fn kind(&self) -> &'static str {
        self.0.kind.name()
    }

    /// signal, bsdf, dsf or reflectance_factor.
    #[getter]
    fn quantity(&self) -> &'static str {
        self.0.quantity.name()
    }

    /// photopic, red, green, blue or a wavelength such as 532nm.
    #[getter]
    fn channel(&self) -> String {
        self.0.channel.to_string()
    }

    /// Polar angle of incidence, degrees.
    #[getter]
    fn theta_i(&self) -> f64 {
        self.0.incidence.to_degrees().0
    }

    /// Azimuth of incidence, degrees.
    #[getter]
    fn phi_i(&self) -> f64 {
        self.0.incidence.to_degrees().1
    }

    /// Receiver polar angles, degrees.
    #[getter]
    fn theta_s<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        degrees(py, &self.0.theta_s)
    }

    /// Receiver azimuths, degrees.
    #[getter]
    fn phi_s<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        degrees(py, &self.0.phi_s)
    }

    /// Readings in the unit of `quantity`.
    #[getter]
    fn value<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        copied(py, &self.0.value)
    }

    /// Seconds since `meta["started"]`, or None when no times were recorded.
    #[getter]
    fn time<'py>(&self, py: Python<'py>) -> Option<Bound<'py, PyArray1<f64>>> {
        self.0.time.as_deref().map(|t| copied(py, t))
    }

    /// What is known beside the readings; unknown fields are left out.
    #[getter]
    fn meta<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        meta_to(py, &self.0.meta)
    }

    fn __len__(&self) -> usize {
        self.0.len()
    }

    fn __repr__(&self) -> String {
        let (theta_i, phi_i) = self.0.incidence.to_degrees();
        format!(
            "Scan(kind={:?}, quantity={:?}, channel=\"{}\", theta_i={theta_i:.4}, phi_i={phi_i:.4}, readings={})",
            self.0.kind.name(),
            self.0.quantity.name(),
            self.0.channel,
            self.0.len()
        )
    }
}

/// Numeric fields of `ScanMeta`: name, what is allowed beyond finite.
const POSITIVE: [&str; 3] = ["distance", "receiver_solid_angle", "beam_diameter"];

/// `ScanMeta` as a dict of the known fields.
pub(crate) fn meta_to<'py>(py: Python<'py>, meta: &core::ScanMeta) -> PyResult<Bound<'py, PyDict>> {
    let dict = PyDict::new(py);
    let text = [
        ("sample_name", &meta.sample_name),
        ("instrument", &meta.instrument),
        ("started", &meta.started),
        ("source", &meta.source),
    ];
    for (name, value) in text {
        if let Some(value) = value {
            dict.set_item(name, value)?;
        }
    }
    let numbers = [
        ("distance", meta.distance),
        ("receiver_solid_angle", meta.receiver_solid_angle),
        ("beam_diameter", meta.beam_diameter),
        ("noise_readout", meta.noise_readout),
        ("noise_relative", meta.noise_relative),
        ("integration", meta.integration),
        ("saturation", meta.saturation),
    ];
    for (name, value) in numbers {
        if let Some(value) = value {
            dict.set_item(name, value)?;
        }
    }
    if !meta.other.is_empty() {
        dict.set_item("other", &meta.other)?;
    }
    Ok(dict)
}

/// The inverse of [`meta_to`]; an unknown key is an error, not a guess.
pub(crate) fn meta_from(dict: &Bound<'_, PyDict>) -> PyResult<core::ScanMeta> {
    let mut meta = core::ScanMeta::default();
    for (key, value) in dict {
        let key: String = key.extract()?;
        if value.is_none() {
            continue;
        }
        match key.as_str() {
            "sample_name" => meta.sample_name = Some(value.extract()?),
            "instrument" => meta.instrument = Some(value.extract()?),
            "started" => meta.started = Some(value.extract()?),
            "source" => meta.source = Some(value.extract()?),
            "other" => meta.other = value.extract::<BTreeMap<String, String>>()?,
            name => {
                let slot = match name {
                    "distance" => &mut meta.distance,
                    "receiver_solid_angle" => &mut meta.receiver_solid_angle,
                    "beam_diameter" => &mut meta.beam_diameter,
                    "noise_readout" => &mut meta.noise_readout,
                    "noise_relative" => &mut meta.noise_relative,
                    "integration" => &mut meta.integration,
                    "saturation" => &mut meta.saturation,
                    _ => {
                        return Err(domain(
                            "meta",
                            format!("{name:?}"),
                            "sample_name, instrument, distance, receiver_solid_angle, beam_diameter, noise_readout, \
                             noise_relative, integration, saturation, started, source, other",
                        ));
                    }
                };
                let number: f64 = value.extract()?;
                let strict = POSITIVE.contains(&name);
                let share = name == "integration";
                if !number.is_finite() || number < 0.0 || (strict && number == 0.0) || (share && number > 1.0)
                {
                    let allowed = match (strict, share) {
                        (true, _) => "a number > 0",
                        (_, true) => "a number of 0 to 1",
                        _ => "a number >= 0",
                    };
                    return Err(domain(name, number, allowed));
                }
                *slot = Some(number);
            }
        }
    }
    Ok(meta)
}

pub(crate) fn register(m: &Bound<'_, PyModule>) -> PyResult<()> {
    m.add_class::<Scan>()
}
