//! The BSDF of parts that exist as geometry.

use std::path::PathBuf;
use std::sync::Arc;

use gonio_bsdf::klems::{Klems, KlemsBasis, KlemsMatrix};
use gonio_bsdf::tensor_tree::{Rank, TensorTree, Tree};
use gonio_bsdf::{Channel, FourComponents};
use gonio_instrument::device::{
    self, Effort, Extent, PatchTable, PruneOptions, Pruned, patch_tables, tensor_trees,
};
use gonio_io::radiance_xml::Tabulated;
use gonio_trace::path::Limits;
use numpy::{PyArray1, PyArrayMethods};
use pyo3::exceptions::PyKeyboardInterrupt;
use pyo3::prelude::*;
use pyo3::types::PyDict;

use crate::errors::{OrRaise, domain};
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

    /// Klems models of the luminance and of its standard errors, and by side of incidence and component the means of red, green and blue and the
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
    ) -> PyResult<(Py<PyAny>, Py<PyAny>, Py<PyDict>)> {
        let basis = KlemsBasis::by_name(basis).or_raise()?;
        let effort = effort(rays, [front, back], bounces, seed);
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
        let model = klems(&basis, &tables, PatchTable::luminance).or_raise()?;
        let errors = klems(&basis, &tables, |table, k| table.errors[k]).or_raise()?;
        let alone = |model| without_report(py, Tabulated::Klems(model));
        Ok((alone(model)?, alone(errors)?, arrays.unbind()))
    }

    /// Tensor trees of the luminance and of its standard errors, and by side of incidence and component the mean BSDF, the root
    /// mean square of the deviations from the truth, and the share that merging beyond errors changes.
    #[pyo3(signature = (*, rank, levels, rays, front, back, bounces, seed, tolerance, max_cells, watch))]
    #[expect(clippy::too_many_arguments, reason = "keyword arguments of Python")]
    fn trees(
        &self,
        py: Python<'_>,
        rank: u8,
        levels: u8,
        rays: u32,
        front: bool,
        back: bool,
        bounces: u32,
        seed: u64,
        tolerance: f64,
        max_cells: usize,
        watch: &RenderWatch,
    ) -> PyResult<(Py<PyAny>, Py<PyAny>, Py<PyDict>)> {
        let rank = match rank {
            3 => Rank::Three,
            4 => Rank::Four,
            _ => return Err(domain("rank", rank.to_string(), "3, 4")),
        };
        let effort = effort(rays, [front, back], bounces, seed);
        let options = PruneOptions { tolerance, max_cells };
        let found = py.detach(|| {
            let report = |done: f64| watch.hear_of(done);
            tensor_trees(
                &self.0,
                (rank, levels),
                &effort,
                &options,
                watch.stop_flag(),
                &report,
            )
        });
        let found = found
            .or_raise()?
            .ok_or_else(|| PyKeyboardInterrupt::new_err("stopped"))?;
        let stated = PyDict::new(py);
        for (side, component, tree) in found.iter() {
            let row = (tree.mean, tree.deviation, tree.merged);
            stated.set_item((side.to_string(), component.to_string()), row)?;
        }
        let alone = |tree: fn(&Pruned) -> &Tree| {
            let trees = found.map(|_, _, pruned| tree(pruned).clone());
            without_report(
                py,
                Tabulated::TensorTree(TensorTree::new(Channel::Photopic, trees)),
            )
        };
        Ok((alone(|p| &p.tree)?, alone(|p| &p.errors)?, stated.unbind()))
    }
}

fn effort(rays: u32, sides: [bool; 2], bounces: u32, seed: u64) -> Effort {
    Effort {
        rays,
        sides,
        limits: Limits {
            bounces,
            ..Limits::default()
        },
        seed,
    }
}

fn without_report(py: Python<'_>, model: Tabulated) -> PyResult<Py<PyAny>> {
    wrap(py, model, PyDict::new(py).unbind(), PyDict::new(py).unbind())
}

/// A model of what `value` says of each pair of patches.
fn klems(
    basis: &KlemsBasis,
    tables: &FourComponents<PatchTable>,
    value: impl Fn(&PatchTable, usize) -> f64,
) -> Result<Klems, gonio_bsdf::BsdfError> {
    let mut matrices = FourComponents::default();
    for (side, component, table) in tables.iter() {
        let values = (0..table.values.len()).map(|k| value(table, k) as f32).collect();
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
