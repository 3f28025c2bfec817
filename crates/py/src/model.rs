//! Data-driven models.

use std::sync::Arc;

use gonio_bsdf::Channel;
use gonio_build as core;
use gonio_geom::{Component, Direction};
use numpy::{PyArray1, PyArrayDyn, PyArrayMethods};
use pyo3::prelude::*;
use pyo3::types::PyDict;

use crate::arrays::angles;
use crate::bsdf::{Bsdf, Pairs};
use crate::errors::{OrRaise, domain};
use crate::slice::MeasurementData;

/// A BSDF interpolated from a measurement. Angles are degrees.
#[pyclass(frozen, extends = Bsdf, module = "gonio", name = "DataDriven")]
pub(crate) struct DataDriven(Arc<core::DataDriven>);

#[pymethods]
impl DataDriven {
    /// Error of predicting each interior incidence from the others, one dict an incidence and component: theta_i,
    /// phi_i (degrees), component, rel_rms, rel_l1 (fractions of the DSF), rel_l1_smooth (against the smoothed slice).
    #[getter]
    fn loo<'py>(&self, py: Python<'py>) -> PyResult<Vec<Bound<'py, PyDict>>> {
        self.0
            .loo()
            .iter()
            .map(|e| {
                let dict = PyDict::new(py);
                let (theta_i, phi_i) = e.incidence.to_degrees();
                dict.set_item("theta_i", theta_i)?;
                dict.set_item("phi_i", phi_i)?;
                dict.set_item("component", e.component.to_string())?;
                dict.set_item("rel_rms", e.rel_rms)?;
                dict.set_item("rel_l1", e.rel_l1)?;
                dict.set_item("rel_l1_smooth", e.rel_l1_smooth)?;
                Ok(dict)
            })
            .collect()
    }

    /// Largest `rel_rms` of `loo`; None when no incidence lies between others.
    #[getter]
    fn loo_error(&self) -> Option<f64> {
        self.0.loo().iter().map(|e| e.rel_rms).reduce(f64::max)
    }

    /// How each side and component was built: side, component, incidences, readings, table_values, bilateral, symmetry,
    /// reciprocity (relative L1 difference of exchanged readings, or None), exchange (whether that is used past the
    /// measured incidences), slices (theta_i, phi_i, the relative L1 error of each, and the
    /// spacing of its readings in narrow half widths of its lobe), candidate, base (its parametric
    /// model, or None), beyond and beyond_base (the same past the measured incidences), scores (mean relative L1 of every
    /// candidate by name), peak (None, or of a narrow peak taken apart: radius in degrees, shares as (theta_i, phi_i, share of
    /// the incident light), candidate, base).
    #[getter]
    fn summary<'py>(&self, py: Python<'py>) -> PyResult<Vec<Bound<'py, PyDict>>> {
        self.0
            .summary()
            .iter()
            .map(|s| {
                let dict = PyDict::new(py);
                dict.set_item("side", s.side.to_string())?;
                dict.set_item("component", s.component.to_string())?;
                dict.set_item("incidences", s.incidences)?;
                dict.set_item("readings", s.readings)?;
                dict.set_item("table_values", s.table_values)?;
                dict.set_item("bilateral", s.bilateral)?;
                dict.set_item("symmetry", s.symmetry)?;
                dict.set_item("reciprocity", s.reciprocity)?;
                dict.set_item("exchange", s.exchange)?;
                let peak = s.peak.as_ref().map(|p| {
                    let peak = PyDict::new(py);
                    peak.set_item("radius", p.radius.to_degrees())?;
                    let shares = p.shares.iter().map(|(incidence, share)| {
                        let (theta_i, phi_i) = incidence.to_degrees();
                        (theta_i, phi_i, *share)
                    });
                    peak.set_item("shares", shares.collect::<Vec<_>>())?;
                    peak.set_item("candidate", p.candidate.name())?;
                    peak.set_item("base", p.base.as_deref())?;
                    PyResult::Ok(peak)
                });
                dict.set_item("peak", peak.transpose()?)?;
                let slices = s.slice_errors.iter().zip(&s.spacings);
                let slices = slices.map(|((incidence, error), spacing)| {
                    let slice = PyDict::new(py);
                    let (theta_i, phi_i) = incidence.to_degrees();
                    slice.set_item("theta_i", theta_i)?;
                    slice.set_item("phi_i", phi_i)?;
                    slice.set_item("error", error)?;
                    slice.set_item("spacing", spacing)?;
                    Ok(slice)
                });
                dict.set_item("slices", slices.collect::<PyResult<Vec<_>>>()?)?;
                dict.set_item("candidate", s.candidate.name())?;
                dict.set_item("base", s.base.as_deref())?;
                dict.set_item("beyond", s.beyond.name())?;
                dict.set_item("beyond_base", s.beyond_base.as_deref())?;
                let scores = PyDict::new(py);
                for (candidate, score) in &s.scores {
                    scores.set_item(candidate.name(), score)?;
                }
                dict.set_item("scores", scores)?;
                Ok(dict)
            })
            .collect()
    }

    /// The light that leaves unscattered, one dict an incidence and component with such a peak: side, component, theta_i and
    /// phi_i (degrees), share (of the incident light), u_share, width (over that of the beam), offset (degrees), solid_angle
    /// (of the beam, sr).
    #[getter]
    fn direct<'py>(&self, py: Python<'py>) -> PyResult<Vec<Bound<'py, PyDict>>> {
        let row = |p: &core::DirectPeak| {
            let (theta_i, phi_i) = p.incidence.to_degrees();
            let dict = PyDict::new(py);
            dict.set_item("side", p.incidence.direction().side().to_string())?;
            dict.set_item("component", p.component.to_string())?;
            dict.set_item("theta_i", theta_i)?;
            dict.set_item("phi_i", phi_i)?;
            dict.set_item("share", p.share)?;
            dict.set_item("u_share", p.u_share)?;
            dict.set_item("width", p.width)?;
            dict.set_item("offset", p.offset.to_degrees())?;
            dict.set_item("solid_angle", p.solid_angle)?;
            Ok(dict)
        };
        self.0.direct().iter().map(row).collect()
    }

    /// Assumptions, components not measured, caps.
    #[getter]
    fn warnings(&self) -> Vec<String> {
        self.0.warnings().to_vec()
    }

    /// How each value is known: 0 measured, 1 interpolated, 2 extrapolated, 3 missing; broadcasts like `eval`.
    #[pyo3(signature = (*, theta_i, phi_i, theta_s, phi_s))]
    fn coverage<'py>(
        &self,
        py: Python<'py>,
        theta_i: &Bound<'py, PyAny>,
        phi_i: &Bound<'py, PyAny>,
        theta_s: &Bound<'py, PyAny>,
        phi_s: &Bound<'py, PyAny>,
    ) -> PyResult<Bound<'py, PyArrayDyn<u8>>> {
        let pairs = Pairs::broadcast(py, [theta_i, phi_i, theta_s, phi_s])?;
        let codes: Vec<u8> = py.detach(|| {
            let code = |(&wi, &ws): (&Direction, &Direction)| self.0.coverage(wi, ws) as u8;
            pairs.wi.iter().zip(&pairs.ws).map(code).collect()
        });
        PyArray1::from_vec(py, codes).reshape(pairs.shape)
    }

    /// Standard uncertainty of each value by its source, 1/sr: a dict of arrays noise, calibration, slice, incidence (NaN where
    /// it is not known), total (without what is not known); NaN where nothing was measured. Broadcasts like `eval`.
    #[pyo3(signature = (*, theta_i, phi_i, theta_s, phi_s))]
    fn uncertainty<'py>(
        &self,
        py: Python<'py>,
        theta_i: &Bound<'py, PyAny>,
        phi_i: &Bound<'py, PyAny>,
        theta_s: &Bound<'py, PyAny>,
        phi_s: &Bound<'py, PyAny>,
    ) -> PyResult<Bound<'py, PyDict>> {
        let pairs = Pairs::broadcast(py, [theta_i, phi_i, theta_s, phi_s])?;
        let mut columns = [const { Vec::new() }; 5];
        py.detach(|| {
            for (&wi, &ws) in pairs.wi.iter().zip(&pairs.ws) {
                let row = self.0.uncertainty(wi, ws).map_or([f64::NAN; 5], |u| {
                    let incidence = u.incidence.unwrap_or(f64::NAN);
                    [u.noise, u.calibration, u.slice, incidence, u.total()]
                });
                columns.iter_mut().zip(row).for_each(|(c, v)| c.push(v));
            }
        });
        let dict = PyDict::new(py);
        for (name, column) in ["noise", "calibration", "slice", "incidence", "total"]
            .into_iter()
            .zip(columns)
        {
            dict.set_item(name, PyArray1::from_vec(py, column).reshape(pairs.shape.clone())?)?;
        }
        Ok(dict)
    }

    /// The error stated at one incidence (degrees) for light into "reflection" or "transmission", fractions of the DSF
    /// (relative L1): slice, incidence (None where it is not known), total; coverage of the incidence (measured, interpolated,
    /// extrapolated), and extrapolated, the share of the light that goes where no readings stand, whose error is in none of them;
    /// None where that was not measured.
    #[pyo3(signature = (*, theta_i, phi_i, component="reflection"))]
    fn stated_error<'py>(
        &self,
        py: Python<'py>,
        theta_i: f64,
        phi_i: f64,
        component: &str,
    ) -> PyResult<Option<Bound<'py, PyDict>>> {
        let component = match component {
            "reflection" => Component::Reflection,
            "transmission" => Component::Transmission,
            _ => {
                return Err(domain(
                    "component",
                    format!("{component:?}"),
                    "reflection, transmission",
                ));
            }
        };
        let wi = angles(["theta_i", "phi_i"], theta_i, phi_i)?.direction();
        let Some(stated) = self.0.stated_error(wi, component) else {
            return Ok(None);
        };
        let dict = PyDict::new(py);
        dict.set_item("slice", stated.slice)?;
        dict.set_item("incidence", stated.incidence)?;
        dict.set_item("total", stated.total())?;
        dict.set_item("coverage", stated.coverage.name())?;
        dict.set_item("extrapolated", stated.extrapolated)?;
        Ok(Some(dict))
    }

    /// Fraction of the light from one incidence (degrees) that leaves on both sides, by quadrature (about 0.2 %).
    #[pyo3(signature = (*, theta_i, phi_i))]
    fn albedo(&self, theta_i: f64, phi_i: f64) -> PyResult<f64> {
        Ok(self
            .0
            .albedo(angles(["theta_i", "phi_i"], theta_i, phi_i)?.direction()))
    }

    fn __repr__(&self) -> String {
        let parts: Vec<String> = self
            .0
            .summary()
            .iter()
            .map(|s| {
                format!(
                    "{} {}: {} incidences, {}",
                    s.side, s.component, s.incidences, s.candidate
                )
            })
            .collect();
        format!("DataDriven({})", parts.join("; "))
    }
}

/// A handle on a build in another thread: how far it is, and the wish to stop it.
#[pyclass(frozen, module = "gonio", name = "BuildWatch")]
pub(crate) struct BuildWatch(core::Watch);

#[pymethods]
impl BuildWatch {
    #[new]
    fn new() -> Self {
        BuildWatch(core::Watch::default())
    }

    /// Name of the stage, steps done, steps in all.
    fn progress(&self) -> (&'static str, usize, usize) {
        let progress = self.0.progress();
        (progress.stage.name(), progress.done, progress.total)
    }

    /// Lets the build end with an error within a fraction of a second.
    fn stop(&self) {
        self.0.stop();
    }
}

/// The data-driven model of one channel of a measurement.
#[pyfunction]
#[pyo3(signature = (measurement, *, channel=None, symmetry="auto", smooth=true, candidate=None, direct=true, watch=None))]
#[expect(clippy::too_many_arguments, reason = "the options of a build, by name")]
fn build(
    py: Python<'_>,
    measurement: &MeasurementData,
    channel: Option<&str>,
    symmetry: &str,
    smooth: bool,
    candidate: Option<&str>,
    direct: bool,
    watch: Option<&BuildWatch>,
) -> PyResult<Py<DataDriven>> {
    let options = core::BuildOptions {
        channel: channel.map(str::parse::<Channel>).transpose().or_raise()?,
        symmetry: match symmetry {
            "auto" => core::SymmetryChoice::Auto,
            "isotropic" => core::SymmetryChoice::Isotropic,
            "anisotropic" => core::SymmetryChoice::Anisotropic,
            _ => {
                return Err(domain(
                    "symmetry",
                    format!("{symmetry:?}"),
                    "auto, isotropic, anisotropic",
                ));
            }
        },
        smooth,
        candidate: candidate.map(candidate_of).transpose()?,
        direct,
        watch: watch.map(|w| w.0.clone()).unwrap_or_default(),
        ..core::BuildOptions::default()
    };
    let data = Arc::clone(&measurement.0);
    let model = Arc::new(
        py.detach(|| core::DataDriven::build(&data, &options))
            .or_raise()?,
    );
    let shared: Arc<dyn gonio_bsdf::Bsdf> = Arc::clone(&model) as _;
    Py::new(
        py,
        PyClassInitializer::from(Bsdf(shared)).add_subclass(DataDriven(model)),
    )
}

fn candidate_of(name: &str) -> PyResult<core::Candidate> {
    let all = core::Candidate::ALL
        .map(|c| {
            [core::Order::Linear, core::Order::Cubic, core::Order::Quadratic].map(|order| c.with_order(order))
        })
        .concat();
    all.iter().find(|c| c.name() == name).copied().ok_or_else(|| {
        let names: Vec<_> = all.iter().map(|c| c.name()).collect();
        domain("candidate", format!("{name:?}"), &names.join("; "))
    })
}

pub(crate) fn register(m: &Bound<'_, PyModule>) -> PyResult<()> {
    m.add_class::<DataDriven>()?;
    m.add_class::<BuildWatch>()?;
    m.add_function(wrap_pyfunction!(build, m)?)
}
