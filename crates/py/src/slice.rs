//! `Slice`, `HemisphericalIntegral` and `MeasurementData`: what processing gives.

use std::sync::Arc;

use gonio_bsdf::Channel;
use gonio_geom::Side;
use gonio_scan as core;
use numpy::PyArray1;
use pyo3::prelude::*;
use pyo3::types::PyDict;

use crate::arrays::{Column, FlagColumn, angles, canonical_columns, column, degrees};
use crate::errors::{OrRaise, domain};
use crate::resolution::Resolution;

/// Where a reading is the highest, its value, standard uncertainty, and the part of it that sampling leaves.
type Highest = ((f64, f64), f64, f64, f64);

/// DHR (same side as the incidence) or DHT (other side) of one slice.
#[pyclass(frozen, module = "gonio", name = "HemisphericalIntegral")]
pub(crate) struct HemisphericalIntegral(core::measurement::HemisphericalIntegral);

#[pymethods]
impl HemisphericalIntegral {
    #[new]
    #[pyo3(signature = (*, side, value, extrapolated, u, u_quadrature))]
    fn new(side: &str, value: f64, extrapolated: f64, u: f64, u_quadrature: f64) -> PyResult<Self> {
        Ok(Self(core::measurement::HemisphericalIntegral {
            side: side_of(side)?,
            value,
            extrapolated,
            u,
            u_quadrature,
        }))
    }

    /// Hemisphere of the receiver: front or back.
    #[getter]
    fn side(&self) -> String {
        self.0.side.to_string()
    }

    /// Integral of dsf over the whole hemisphere.
    #[getter]
    fn value(&self) -> f64 {
        self.0.value
    }

    /// The part of `value` in directions that were not measured.
    #[getter]
    fn extrapolated(&self) -> f64 {
        self.0.extrapolated
    }

    /// Combined standard uncertainty of `value`.
    #[getter]
    fn u(&self) -> f64 {
        self.0.u
    }

    /// Standard uncertainty of the quadrature alone.
    #[getter]
    fn u_quadrature(&self) -> f64 {
        self.0.u_quadrature
    }

    fn __repr__(&self) -> String {
        format!(
            "HemisphericalIntegral(side=\"{}\", value={:.6}, u={:.2e}, extrapolated={:.6})",
            self.0.side, self.0.value, self.0.u, self.0.extrapolated
        )
    }
}

/// `front` or `back`.
pub(crate) fn side_of(name: &str) -> PyResult<Side> {
    match name {
        "front" => Ok(Side::Front),
        "back" => Ok(Side::Back),
        _ => Err(domain("side", format!("{name:?}"), "front, back")),
    }
}

/// One processed incidence and channel: DSF with its uncertainty, one entry a reading. Arrays are copies.
#[pyclass(frozen, module = "gonio", name = "Slice")]
pub(crate) struct Slice {
    owner: Arc<core::Measurement>,
    index: usize,
}

impl Slice {
    /// The slice of the core.
    pub(crate) fn get(&self) -> &core::Slice {
        &self.owner.slices[self.index]
    }
}

#[pymethods]
impl Slice {
    #[new]
    #[pyo3(signature = (*, theta_i, phi_i, channel, theta_s, phi_s, dsf, u_dsf, omega, flags, u_common=0.0,
        integrals=Vec::new()))]
    #[expect(clippy::too_many_arguments, reason = "keyword-only in Python")]
    fn new(
        theta_i: f64,
        phi_i: f64,
        channel: &str,
        theta_s: Column<'_>,
        phi_s: Column<'_>,
        dsf: Column<'_>,
        u_dsf: Column<'_>,
        omega: Column<'_>,
        flags: FlagColumn<'_>,
        u_common: f64,
        integrals: Vec<PyRef<'_, HemisphericalIntegral>>,
    ) -> PyResult<Self> {
        let dsf = column("dsf", &dsf, None)?;
        let n = Some(dsf.len());
        let mut theta_s = column("theta_s", &theta_s, n)?;
        let mut phi_s = column("phi_s", &phi_s, n)?;
        canonical_columns(["theta_s", "phi_s"], &mut theta_s, &mut phi_s)?;
        let flags: Vec<_> = flags
            .as_array()
            .iter()
            .map(|&bits| core::Flags::from_bits(bits))
            .collect();
        if flags.len() != dsf.len() {
            return Err(domain(
                "flags",
                format!("{} entries", flags.len()),
                &format!("{}, one a reading", dsf.len()),
            ));
        }
        let slice = core::Slice {
            incidence: angles(["theta_i", "phi_i"], theta_i, phi_i)?,
            channel: channel.parse::<Channel>().or_raise()?,
            theta_s,
            phi_s,
            u_dsf: column("u_dsf", &u_dsf, n)?,
            omega: column("omega", &omega, n)?,
            dsf,
            flags,
            u_common,
            integrals: integrals.iter().map(|i| i.0).collect(),
        };
        let owner = core::Measurement {
            slices: vec![slice],
            ..Default::default()
        };
        Ok(Slice {
            owner: Arc::new(owner),
            index: 0,
        })
    }

    /// Polar angle of incidence, degrees.
    #[getter]
    fn theta_i(&self) -> f64 {
        self.get().incidence.to_degrees().0
    }

    /// Azimuth of incidence, degrees.
    #[getter]
    fn phi_i(&self) -> f64 {
        self.get().incidence.to_degrees().1
    }

    /// Spectral channel.
    #[getter]
    fn channel(&self) -> String {
        self.get().channel.to_string()
    }

    /// Receiver polar angles, degrees.
    #[getter]
    fn theta_s<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        degrees(py, &self.get().theta_s)
    }

    /// Receiver azimuths, degrees.
    #[getter]
    fn phi_s<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        degrees(py, &self.get().phi_s)
    }

    /// DSF, 1/sr; negative values are kept.
    #[getter]
    fn dsf<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        PyArray1::from_slice(py, &self.get().dsf)
    }

    /// BSDF = dsf / |cos theta_s|, 1/sr; NaN on the horizon.
    #[getter]
    fn bsdf<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        let slice = self.get();
        PyArray1::from_iter(py, (0..slice.len()).map(|j| slice.bsdf(j)))
    }

    /// Combined standard uncertainty of dsf, 1/sr.
    #[getter]
    fn u_dsf<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        PyArray1::from_slice(py, &self.get().u_dsf)
    }

    /// Solid-angle weights, sr; zero where a reading is unusable.
    #[getter]
    fn omega<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        PyArray1::from_slice(py, &self.get().omega)
    }

    /// Flag bits, uint16; `gonio.FLAGS` names them.
    #[getter]
    fn flags<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<u16>> {
        PyArray1::from_iter(py, self.get().flags.iter().map(|f| f.bits()))
    }

    /// Relative standard uncertainty common to every reading, as a fraction.
    #[getter]
    fn u_common(&self) -> f64 {
        self.get().u_common
    }

    /// Hemispherical integrals, one a hemisphere that was measured.
    #[getter]
    fn integrals(&self) -> Vec<HemisphericalIntegral> {
        self.get()
            .integrals
            .iter()
            .map(|&i| HemisphericalIntegral(i))
            .collect()
    }

    /// The highest usable reading over hemisphere `side` (front, back), None where nothing is above zero: theta_s and phi_s in
    /// degrees, its dsf, standard uncertainty of that as the height of the lobe, and the part of it from readings that stand
    /// beside the lobe's top.
    fn highest(&self, side: &str) -> PyResult<Option<Highest>> {
        let found = core::highest(self.get(), side_of(side)?);
        Ok(found.map(|h| (h.at.to_degrees(), h.value, h.u, h.u_sampling)))
    }

    fn __len__(&self) -> usize {
        self.get().len()
    }

    fn __repr__(&self) -> String {
        let slice = self.get();
        let (theta_i, phi_i) = slice.incidence.to_degrees();
        format!(
            "Slice(channel=\"{}\", theta_i={theta_i:.4}, phi_i={phi_i:.4}, readings={})",
            slice.channel,
            slice.len()
        )
    }
}

/// The native part of a `gonio.Measurement`: shared, immutable, handed to the core without a copy.
#[pyclass(frozen, module = "gonio._native", name = "MeasurementData")]
pub(crate) struct MeasurementData(pub(crate) Arc<core::Measurement>);

impl From<core::Measurement> for MeasurementData {
    fn from(measurement: core::Measurement) -> Self {
        MeasurementData(Arc::new(measurement))
    }
}

#[pymethods]
impl MeasurementData {
    #[new]
    #[pyo3(signature = (slices, *, sample_name=None, signature_fwhm=None, resolutions=Vec::new(), warnings=Vec::new()))]
    fn new(
        slices: Vec<PyRef<'_, Slice>>,
        sample_name: Option<String>,
        signature_fwhm: Option<f64>,
        resolutions: Vec<PyRef<'_, Resolution>>,
        warnings: Vec<String>,
    ) -> PyResult<Self> {
        if let Some(fwhm) = signature_fwhm
            && !(fwhm.is_finite() && fwhm > 0.0)
        {
            return Err(domain("signature_fwhm", fwhm, "degrees > 0"));
        }
        Ok(core::Measurement {
            slices: slices.iter().map(|s| s.get().clone()).collect(),
            sample_name,
            signature_fwhm: signature_fwhm.map(f64::to_radians),
            resolutions: resolutions.iter().map(|r| r.0.clone()).collect(),
            warnings,
            ..Default::default()
        }
        .into())
    }

    /// The same with another name of the sample (None keeps it) and further warnings before those it has.
    #[pyo3(signature = (*, sample_name=None, warnings=Vec::new()))]
    fn annotated(&self, sample_name: Option<String>, warnings: Vec<String>) -> Self {
        let mut data = core::Measurement::clone(&self.0);
        data.sample_name = sample_name.or(data.sample_name);
        data.warnings.splice(0..0, warnings);
        data.into()
    }

    /// Slices in the order of the input.
    #[getter]
    fn slices(&self) -> Vec<Slice> {
        (0..self.0.slices.len())
            .map(|index| Slice {
                owner: Arc::clone(&self.0),
                index,
            })
            .collect()
    }

    /// Name of the sample.
    #[getter]
    fn sample_name(&self) -> Option<&str> {
        self.0.sample_name.as_deref()
    }

    /// Full width at half maximum of the instrument signature, degrees.
    #[getter]
    fn signature_fwhm(&self) -> Option<f64> {
        self.0.signature_fwhm.map(f64::to_degrees)
    }

    /// What the readings of each channel with a beam scan resolve.
    #[getter]
    fn resolutions(&self) -> Vec<Resolution> {
        self.0.resolutions.iter().cloned().map(Resolution).collect()
    }

    /// Physics warnings.
    #[getter]
    fn warnings(&self) -> Vec<String> {
        self.0.warnings.clone()
    }

    /// Beams, noise models and darks as they were applied; empty lists when read back from a file.
    #[getter]
    fn processing<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        crate::processing::processing_dict(py, &self.0)
    }

    /// Verdicts that only the raw readings allow (blank match), made while processing.
    #[getter]
    fn findings(&self) -> Vec<crate::verdict::Verdict> {
        self.0.processing.findings.iter().map(Into::into).collect()
    }
}

/// Names of the flag bits: `{"negative": 1, …}`.
fn flag_names(py: Python<'_>) -> PyResult<Bound<'_, PyDict>> {
    let names = PyDict::new(py);
    for (flag, name) in core::Flags::NAMES {
        names.set_item(name, flag.bits())?;
    }
    Ok(names)
}

pub(crate) fn register(m: &Bound<'_, PyModule>) -> PyResult<()> {
    m.add("FLAGS", flag_names(m.py())?)?;
    m.add("UNUSABLE", core::Flags::UNUSABLE.bits())?;
    m.add_class::<HemisphericalIntegral>()?;
    m.add_class::<Slice>()?;
    m.add_class::<MeasurementData>()
}
