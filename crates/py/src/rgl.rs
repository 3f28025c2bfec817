//! Measured RGL materials.

use std::path::PathBuf;
use std::sync::Arc;

use gonio_bsdf::{Bsdf as _, Rgl as CoreRgl};
use gonio_io::rgl;
use numpy::PyArray1;
use pyo3::prelude::*;
use pyo3::types::PyDict;

use crate::arrays::degrees;
use crate::bsdf::Bsdf;
use crate::errors::OrRaise;

/// A measured material of the RGL database. It reflects light that arrives on the front.
#[pyclass(frozen, extends = Bsdf, module = "gonio", name = "Rgl")]
pub(crate) struct Rgl {
    model: Arc<CoreRgl>,
    description: String,
    negative_share: Vec<f64>,
}

#[pymethods]
impl Rgl {
    /// What the file says of the material; empty when it says nothing.
    #[getter]
    fn description(&self) -> &str {
        &self.description
    }

    /// Polar angles of incidence of the tables, degrees.
    #[getter]
    fn theta_i<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        degrees(py, self.model.theta_i())
    }

    /// Those of `theta_i` that were measured; beyond the last one the tables repeat it.
    #[getter]
    fn measured_theta_i<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        degrees(py, self.model.measured_theta_i())
    }

    /// Azimuths of incidence of the tables, degrees, -180 to 180; one for an isotropic material.
    #[getter]
    fn phi_i<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        degrees(py, self.model.phi_i())
    }

    /// Nodes of the tables a channel and incidence, (azimuthal, polar).
    #[getter]
    fn resolution(&self) -> (usize, usize) {
        self.model.resolution()
    }

    /// Share of negative values in the tables of each channel, which `eval` raises to 0.
    #[getter]
    fn negative_share<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let dict = PyDict::new(py);
        for (channel, share) in self.model.channels().iter().zip(&self.negative_share) {
            dict.set_item(channel.to_string(), share)?;
        }
        Ok(dict)
    }
}

/// Whether a file begins as a tensor file does; OSError and its kin for what the operating system refuses.
#[pyfunction]
fn is_tensor_file(path: PathBuf) -> PyResult<bool> {
    gonio_io::tensor_file::is_tensor_file(&path).or_raise()
}

/// Read an RGL material (tensor file, RGB or spectral). Raises FormatError naming the field; OSError and its kin for what
/// the operating system refuses.
#[pyfunction]
fn read_rgl(py: Python<'_>, path: PathBuf) -> PyResult<Py<Rgl>> {
    let file = py.detach(|| rgl::read(&path)).or_raise()?;
    let model = Arc::new(file.model);
    let base = PyClassInitializer::from(Bsdf(model.clone()));
    let sub = Rgl {
        model,
        description: file.description,
        negative_share: file.negative_share,
    };
    Py::new(py, base.add_subclass(sub))
}

pub(crate) fn register(m: &Bound<'_, PyModule>) -> PyResult<()> {
    m.add_class::<Rgl>()?;
    m.add_function(wrap_pyfunction!(is_tensor_file, m)?)?;
    m.add_function(wrap_pyfunction!(read_rgl, m)?)
}
