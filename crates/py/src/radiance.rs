//! Klems and tensor-tree models, their reduction from any model, and Radiance BSDF XML.

use std::path::PathBuf;
use std::sync::Arc;

use gonio_bsdf::Channel;
use gonio_bsdf::klems::Klems as CoreKlems;
use gonio_bsdf::tensor_tree::TensorTree as CoreTree;
use gonio_geom::{Component, Side};
use gonio_io::radiance_xml::{self, Material, Tabulated};
use numpy::{PyArray1, PyArray2, PyArrayMethods};
use pyo3::prelude::*;
use pyo3::types::PyDict;

use crate::bsdf::Bsdf;
use crate::errors::{OrRaise, QuantityError, domain};

/// A Klems model: matrices over pairs of patches. Attributes: `components` (list of (side, component) strings),
/// `report` (what the reduction found) and `material` (what the file says), both dicts, empty where they do not apply.
#[pyclass(frozen, extends = Bsdf, module = "gonio", name = "Klems")]
pub(crate) struct Klems {
    pub(crate) model: Arc<CoreKlems>,
    report: Py<PyDict>,
    material: Py<PyDict>,
}

/// A tensor-tree model. Attributes as those of `Klems`, and `rank`, 3 or 4.
#[pyclass(frozen, extends = Bsdf, module = "gonio", name = "TensorTree")]
pub(crate) struct TensorTree {
    pub(crate) model: Arc<CoreTree>,
    report: Py<PyDict>,
    material: Py<PyDict>,
}

pub(crate) fn side_of(name: &str) -> PyResult<Side> {
    match name {
        "front" => Ok(Side::Front),
        "back" => Ok(Side::Back),
        other => Err(domain("side", format!("{other:?}"), "front, back")),
    }
}

pub(crate) fn component_of(name: &str) -> PyResult<Component> {
    match name {
        "reflection" => Ok(Component::Reflection),
        "transmission" => Ok(Component::Transmission),
        other => Err(domain(
            "component",
            format!("{other:?}"),
            "reflection, transmission",
        )),
    }
}

pub(crate) type Names = Vec<(String, String)>;

pub(crate) fn names(keys: impl Iterator<Item = (Side, Component)>) -> Names {
    keys.map(|(s, c)| (s.to_string(), c.to_string())).collect()
}

pub(crate) fn components(asked: Option<Names>) -> PyResult<Option<Vec<(Side, Component)>>> {
    asked
        .map(|list| {
            list.iter()
                .map(|(s, c)| Ok((side_of(s)?, component_of(c)?)))
                .collect()
        })
        .transpose()
}

#[pymethods]
impl Klems {
    /// The components that are there: list of (side of incidence, component).
    #[getter]
    fn components(&self) -> Names {
        names(self.model.matrices().iter().map(|(s, c, _)| (s, c)))
    }

    /// max_albedo, capped (list of (side, incident patch, albedo before)), evaluations, unsettled; empty for a file.
    #[getter]
    fn report(&self, py: Python<'_>) -> Py<PyDict> {
        self.report.clone_ref(py)
    }

    /// name, manufacturer, device_type, thickness, width, height (metres or None); empty for a reduced model.
    #[getter]
    fn material(&self, py: Python<'_>) -> Py<PyDict> {
        self.material.clone_ref(py)
    }

    /// Greatest directional albedo, reflection and transmission of one side together, over the incident patches.
    #[getter]
    fn max_albedo(&self) -> f64 {
        self.model.max_albedo()
    }

    /// The matrix of one component in 1/sr, shape (exit patches, incident patches), float32.
    #[pyo3(signature = (*, side="front", component="reflection"))]
    fn matrix<'py>(
        &self,
        py: Python<'py>,
        side: &str,
        component: &str,
    ) -> PyResult<Bound<'py, PyArray2<f32>>> {
        let (s, c) = (side_of(side)?, component_of(component)?);
        let m = self
            .model
            .matrix(s, c)
            .ok_or_else(|| QuantityError::new_err(format!("component: found no {side} {component}")))?;
        PyArray1::from_slice(py, m.values()).reshape([m.exit().len(), m.incident().len()])
    }

    /// Names of the angle bases of one component: (incident, exit).
    #[pyo3(signature = (*, side="front", component="reflection"))]
    fn bases(&self, side: &str, component: &str) -> PyResult<(String, String)> {
        let (s, c) = (side_of(side)?, component_of(component)?);
        let m = self
            .model
            .matrix(s, c)
            .ok_or_else(|| QuantityError::new_err(format!("component: found no {side} {component}")))?;
        Ok((m.incident().name().to_owned(), m.exit().name().to_owned()))
    }

    /// Directional albedo of each incident patch of one component.
    #[pyo3(signature = (*, side="front", component="reflection"))]
    fn albedo<'py>(
        &self,
        py: Python<'py>,
        side: &str,
        component: &str,
    ) -> PyResult<Bound<'py, PyArray1<f64>>> {
        let (s, c) = (side_of(side)?, component_of(component)?);
        let m = self
            .model
            .matrix(s, c)
            .ok_or_else(|| QuantityError::new_err(format!("component: found no {side} {component}")))?;
        let values = (0..m.incident().len()).map(|i| m.albedo(i)).collect();
        Ok(PyArray1::from_vec(py, values))
    }
}

#[pymethods]
impl TensorTree {
    /// The components that are there: list of (side of incidence, component).
    #[getter]
    fn components(&self) -> Names {
        names(self.model.trees().iter().map(|(s, c, _)| (s, c)))
    }

    /// max_albedo, error (dict (side, component) -> relative L1), evaluations; empty for a file.
    #[getter]
    fn report(&self, py: Python<'_>) -> Py<PyDict> {
        self.report.clone_ref(py)
    }

    /// As `Klems.material`.
    #[getter]
    fn material(&self, py: Python<'_>) -> Py<PyDict> {
        self.material.clone_ref(py)
    }

    /// 3 or 4.
    #[getter]
    fn rank(&self) -> usize {
        self.model
            .trees()
            .iter()
            .next()
            .map_or(0, |(_, _, t)| t.rank().dimensions())
    }

    /// Directional albedo of one component at one incidence (degrees); 0 where it is not there.
    #[pyo3(signature = (*, theta_i, phi_i=0.0, component="reflection"))]
    fn albedo(&self, theta_i: f64, phi_i: f64, component: &str) -> PyResult<f64> {
        let wi = crate::arrays::angles(["theta_i", "phi_i"], theta_i, phi_i)?.direction();
        Ok(self.model.directional_albedo(wi, component_of(component)?))
    }

    /// Greatest directional albedo, reflection and transmission of one side together, over the incident cells.
    #[getter]
    fn max_albedo(&self, py: Python<'_>) -> f64 {
        py.detach(|| self.model.max_albedo())
    }

    /// Number of cells of all components.
    #[getter]
    fn cells(&self) -> usize {
        self.model.trees().iter().map(|(_, _, t)| t.len()).sum()
    }
}

fn material_dict(py: Python<'_>, m: &Material) -> PyResult<Py<PyDict>> {
    let d = PyDict::new(py);
    d.set_item("name", &m.name)?;
    d.set_item("manufacturer", &m.manufacturer)?;
    d.set_item("device_type", &m.device_type)?;
    d.set_item("thickness", m.thickness)?;
    d.set_item("width", m.width)?;
    d.set_item("height", m.height)?;
    Ok(d.unbind())
}

pub(crate) fn wrap(
    py: Python<'_>,
    model: Tabulated,
    report: Py<PyDict>,
    material: Py<PyDict>,
) -> PyResult<Py<PyAny>> {
    match model {
        Tabulated::Klems(k) => {
            let model = Arc::new(k);
            let base = PyClassInitializer::from(Bsdf(model.clone()));
            let sub = Klems {
                model,
                report,
                material,
            };
            Ok(Py::new(py, base.add_subclass(sub))?.into_any())
        }
        Tabulated::TensorTree(t) => {
            let model = Arc::new(t);
            let base = PyClassInitializer::from(Bsdf(model.clone()));
            let sub = TensorTree {
                model,
                report,
                material,
            };
            Ok(Py::new(py, base.add_subclass(sub))?.into_any())
        }
    }
}

/// Read one channel of a Radiance or WINDOW BSDF XML file as a `Klems` or `TensorTree`.
///
/// `channel`: "photopic" is the file's Visible, "solar" its Solar, "550nm" a wavelength. Raises FormatError naming line
/// and field; OSError and its kin for what the operating system refuses.
#[pyfunction]
#[pyo3(signature = (path, *, channel="photopic"))]
fn read_radiance_xml(py: Python<'_>, path: PathBuf, channel: &str) -> PyResult<Py<PyAny>> {
    let channel: Channel = channel.parse().or_raise()?;
    let xml = py.detach(|| radiance_xml::read(&path, channel)).or_raise()?;
    let material = material_dict(py, &xml.material)?;
    wrap(py, xml.model, PyDict::new(py).unbind(), material)
}

/// Names of the channels that a BSDF XML file has scattering data for; errors as in `read_radiance_xml`.
#[pyfunction]
fn radiance_xml_channels(py: Python<'_>, path: PathBuf) -> PyResult<Vec<String>> {
    let found = py.detach(|| radiance_xml::channels(&path)).or_raise()?;
    Ok(found.iter().map(ToString::to_string).collect())
}

pub(crate) fn register(m: &Bound<'_, PyModule>) -> PyResult<()> {
    m.add_class::<Klems>()?;
    m.add_class::<TensorTree>()?;
    m.add_function(wrap_pyfunction!(read_radiance_xml, m)?)?;
    m.add_function(wrap_pyfunction!(radiance_xml_channels, m)?)
}
