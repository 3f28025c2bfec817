//! The BSDF of parts that exist as geometry.

use std::path::PathBuf;
use std::sync::Arc;

use gonio_bsdf::klems::{Klems, KlemsBasis, KlemsMatrix};
use gonio_bsdf::{Channel, FourComponents};
use gonio_instrument::device::{self, Effort, Extent, PatchTable, patch_tables};
use gonio_io::radiance_xml::Tabulated;
use gonio_trace::path::Limits;
use numpy::{PyArray1, PyArrayMethods};
use pyo3::exceptions::PyKeyboardInterrupt;
use pyo3::prelude::*;
use pyo3::types::PyDict;

use crate::errors::OrRaise;
use crate::radiance::wrap;
use crate::render::RenderWatch;
use crate::scene::load;

/// A part whose scattering is asked; `gonio.simulate_geometry` says how.
#[pyclass(frozen, module = "gonio", name = "Device")]
pub(crate) struct Device(pub(crate) Arc<device::Device>);

/// The part that the surfaces of scene files are, and what it is read without.
#[pyfunction]
#[pyo3(signature = (paths, search, *, model, window, periodic))]
fn read_device(
    py: Python<'_>,
    paths: Vec<PathBuf>,
    search: Vec<PathBuf>,
    model: Py<PyAny>,
    window: Option<[f32; 4]>,
    periodic: bool,
) -> PyResult<(Device, Vec<String>)> {
    py.detach(|| {
        let (loaded, warnings) = load(&paths, search, model)?;
        let extent = Extent { window, periodic };
        let device = device::Device::new(loaded.parts, extent).or_raise()?;
        Ok((Device(Arc::new(device)), warnings))
    })
}

#[pymethods]
impl Device {
    /// The rectangle that rays are sent through: x_low, y_low, x_high, y_high.
    #[getter]
    fn window(&self) -> [f32; 4] {
        let [[x0, y0], [x1, y1]] = self.0.window();
        [x0, y0, x1, y1]
    }

    /// A Klems model of the luminance, and by side of incidence and component the means of red, green and blue and the
    /// standard errors, `[exit][incident]`.
    #[pyo3(signature = (*, basis, rays, front, back, bounces, seed, watch))]
    #[expect(clippy::too_many_arguments, reason = "keyword arguments of Python")]
    fn patches(
        &self,
        py: Python<'_>,
        basis: &str,
        rays: u32,
        front: bool,
        back: bool,
        bounces: u32,
        seed: u64,
        watch: &RenderWatch,
    ) -> PyResult<(Py<PyAny>, Py<PyDict>)> {
        let basis = KlemsBasis::by_name(basis).or_raise()?;
        let effort = Effort {
            rays,
            sides: [front, back],
            limits: Limits {
                bounces,
                ..Limits::default()
            },
            seed,
        };
        let tables = py.detach(|| {
            let report = |done: f64| watch.hear_of(done);
            patch_tables(&self.0, &basis, &effort, watch.stop_flag(), &report)
        });
        let tables = tables.ok_or_else(|| PyKeyboardInterrupt::new_err("stopped"))?;
        let arrays = PyDict::new(py);
        for (side, component, table) in tables.iter() {
            let n = basis.len();
            let values = PyArray1::from_iter(py, table.values.iter().flatten().copied());
            let errors = PyArray1::from_slice(py, &table.errors);
            let pair = (values.reshape([n, n, 3])?, errors.reshape([n, n])?);
            arrays.set_item((side.to_string(), component.to_string()), pair)?;
        }
        let model = klems(&basis, &tables).or_raise()?;
        let model = wrap(
            py,
            Tabulated::Klems(model),
            PyDict::new(py).unbind(),
            PyDict::new(py).unbind(),
        )?;
        Ok((model, arrays.unbind()))
    }
}

fn klems(basis: &KlemsBasis, tables: &FourComponents<PatchTable>) -> Result<Klems, gonio_bsdf::BsdfError> {
    let mut matrices = FourComponents::default();
    for (side, component, table) in tables.iter() {
        let values = (0..table.values.len())
            .map(|k| table.luminance(k) as f32)
            .collect();
        let matrix = KlemsMatrix::new(basis.clone(), basis.clone(), values)?;
        matrices.set(side, component, Some(matrix));
    }
    Ok(Klems::new(Channel::Photopic, matrices))
}

/// Projected solid angles of the patches of a basis, sr.
#[pyfunction]
fn klems_solid_angles<'py>(py: Python<'py>, basis: &str) -> PyResult<Bound<'py, PyArray1<f64>>> {
    let basis = KlemsBasis::by_name(basis).or_raise()?;
    Ok(PyArray1::from_slice(py, basis.lambda()))
}

/// What a number of rays from each patch is rounded up to.
#[pyfunction]
fn rounded_rays(rays: u32) -> u32 {
    Effort::rounded(rays)
}

pub(crate) fn register(m: &Bound<'_, PyModule>) -> PyResult<()> {
    m.add_class::<Device>()?;
    m.add_function(wrap_pyfunction!(klems_solid_angles, m)?)?;
    m.add_function(wrap_pyfunction!(read_device, m)?)?;
    m.add_function(wrap_pyfunction!(rounded_rays, m)?)
}
