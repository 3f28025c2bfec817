//! Files of models: MERL binaries and Zemax tabular BSDFs.

use std::path::PathBuf;
use std::sync::Arc;

use gonio_bsdf::HalfDifference;
use gonio_io::{merl, zemax};
use pyo3::prelude::*;

use crate::bsdf::Bsdf;
use crate::errors::OrRaise;
use crate::radiance::component_of;

/// Whether a file begins as one of the MERL database does; OSError and its kin for what the operating system refuses.
#[pyfunction]
fn is_merl(path: PathBuf) -> PyResult<bool> {
    merl::is_merl(&path).or_raise()
}

/// Read a file of the MERL database: the model and the share of its cells without a value. Raises FormatError; OSError
/// and its kin for what the operating system refuses.
#[pyfunction]
fn read_merl(py: Python<'_>, path: PathBuf) -> PyResult<(Bsdf, f64)> {
    let table = py.detach(|| merl::read(&path)).or_raise()?;
    let share = table.empty_share();
    Ok((Bsdf(Arc::new(table)), share))
}

/// Tabulate the front reflection of an isotropic model in the cells of the MERL database, write that and return it:
/// `channels` are those of the model for red, green and blue. Raises DomainError for an anisotropic model,
/// QuantityError for a channel that is not there; OSError and its kin for what the operating system refuses.
#[pyfunction]
fn write_merl(py: Python<'_>, path: PathBuf, bsdf: &Bsdf, channels: [String; 3]) -> PyResult<Bsdf> {
    let mut indices = Vec::with_capacity(3);
    for (channel, name) in merl::CHANNELS.into_iter().zip(&channels) {
        indices.push((channel, bsdf.channel_index(Some(name))?));
    }
    let model = bsdf.0.clone();
    let table = py
        .detach(|| HalfDifference::of(&*model, merl::SHAPE, &indices))
        .or_raise()?;
    py.detach(|| merl::write(&path, &table)).or_raise()?;
    Ok(Bsdf(Arc::new(table)))
}

/// Write one channel of a model as Zemax tabular BSDF: the keyword of its symmetry and the number of values. Lists of
/// angles are degrees; None keeps the writer's own. Raises FormatError for angles that are not ascending or out of range,
/// QuantityError for a channel that is not there; OSError and its kin for what the operating system refuses.
#[pyfunction]
#[pyo3(signature = (path, bsdf, *, channel=None, component="reflection", rotations=None, incidences=None, azimuths=None,
    radials=None, comments=""))]
#[expect(clippy::too_many_arguments, reason = "keyword arguments of Python")]
fn write_zemax(
    py: Python<'_>,
    path: PathBuf,
    bsdf: &Bsdf,
    channel: Option<&str>,
    component: &str,
    rotations: Option<Vec<f64>>,
    incidences: Option<Vec<f64>>,
    azimuths: Option<Vec<f64>>,
    radials: Option<Vec<f64>>,
    comments: &str,
) -> PyResult<(&'static str, usize)> {
    let own = zemax::Grid::default();
    let grid = zemax::Grid {
        rotations: rotations.unwrap_or(own.rotations),
        incidences: incidences.unwrap_or(own.incidences),
        azimuths: azimuths.unwrap_or(own.azimuths),
        radials: radials.unwrap_or(own.radials),
    };
    let component = component_of(component)?;
    let index = bsdf.channel_index(channel)?;
    let model = bsdf.0.clone();
    let written = py
        .detach(|| zemax::write(&path, &*model, index, component, &grid, comments))
        .or_raise()?;
    Ok((written.symmetry, written.values))
}

pub(crate) fn register(m: &Bound<'_, PyModule>) -> PyResult<()> {
    m.add_function(wrap_pyfunction!(is_merl, m)?)?;
    m.add_function(wrap_pyfunction!(read_merl, m)?)?;
    m.add_function(wrap_pyfunction!(write_merl, m)?)?;
    m.add_function(wrap_pyfunction!(write_zemax, m)?)
}
