//! Files of models: MERL binaries, Zemax tabular BSDFs, RGL materials written, RADIANCE's interpolants.

use std::path::PathBuf;
use std::sync::Arc;

use gonio_bsdf::rgl::{RglOptions, RglTables};
use gonio_bsdf::{Channel, HalfDifference, Rgl};
use gonio_io::{merl, rgl, sir, zemax};
use pyo3::prelude::*;
use pyo3::types::PyDict;

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

/// Tabulate the front reflection of a model as an RGL material, write that and return it. `channels` are pairs of a
/// channel of the file (red, green, blue, or wavelengths) and of the model. `theta_i` (degrees) and `resolution` replace
/// the writer's own incidences and nodes along a side of the square. Raises DomainError for sizes out of range,
/// QuantityError for a channel that is not there, FormatError for channels that the format does not have; OSError and
/// its kin for what the operating system refuses.
#[pyfunction]
#[pyo3(signature = (path, bsdf, channels, *, description="", theta_i=None, resolution=None))]
fn write_rgl(
    py: Python<'_>,
    path: PathBuf,
    bsdf: &Bsdf,
    channels: Vec<(String, String)>,
    description: &str,
    theta_i: Option<Vec<f64>>,
    resolution: Option<usize>,
) -> PyResult<Bsdf> {
    let mut pairs = Vec::with_capacity(channels.len());
    for (name, from) in &channels {
        pairs.push((
            name.parse::<Channel>().or_raise()?,
            bsdf.channel_index(Some(from))?,
        ));
    }
    let model = bsdf.0.clone();
    let mut options = RglOptions::of(&*model);
    if let Some(degrees) = theta_i {
        options.theta_i = degrees.into_iter().map(f64::to_radians).collect();
    }
    options.resolution = resolution.unwrap_or(options.resolution);
    let tables = py
        .detach(|| RglTables::of(&*model, &pairs, &options))
        .or_raise()?;
    py.detach(|| rgl::write(&path, &tables, description)).or_raise()?;
    Ok(Bsdf(Arc::new(Rgl::new(tables).or_raise()?)))
}

/// Whether a file begins as an interpolant of RADIANCE does; OSError and its kin for what the operating system refuses.
#[pyfunction]
fn is_sir(path: PathBuf) -> PyResult<bool> {
    sir::is_sir(&path).or_raise()
}

/// Read an interpolant of RADIANCE: the model and a dict of name, manufacturer, side, component, incidences (list of
/// (theta_i, phi_i), degrees), lobes, transports, floor (1/sr), albedo_min, albedo_max (over the incidences). Raises
/// FormatError; OSError and its kin for what the operating system refuses.
#[pyfunction]
fn read_sir(py: Python<'_>, path: PathBuf) -> PyResult<(Bsdf, Bound<'_, PyDict>)> {
    let (model, albedos) = py
        .detach(|| {
            sir::read(&path).map(|m| {
                let albedos = m.albedos();
                (m, albedos)
            })
        })
        .or_raise()?;
    let d = PyDict::new(py);
    d.set_item("name", model.name())?;
    d.set_item("manufacturer", model.manufacturer())?;
    let (side, component) = model.component();
    d.set_item("side", side.to_string())?;
    d.set_item("component", component.to_string())?;
    let incidences: Vec<(f64, f64)> = model.incidences().map(|w| w.angles().to_degrees()).collect();
    d.set_item("incidences", incidences)?;
    d.set_item("lobes", model.lobes())?;
    d.set_item("transports", model.transports())?;
    d.set_item("floor", model.floor())?;
    d.set_item("albedo_min", albedos[0])?;
    d.set_item("albedo_max", albedos[1])?;
    Ok((Bsdf(Arc::new(model)), d))
}

pub(crate) fn register(m: &Bound<'_, PyModule>) -> PyResult<()> {
    m.add_function(wrap_pyfunction!(is_merl, m)?)?;
    m.add_function(wrap_pyfunction!(is_sir, m)?)?;
    m.add_function(wrap_pyfunction!(read_sir, m)?)?;
    m.add_function(wrap_pyfunction!(read_merl, m)?)?;
    m.add_function(wrap_pyfunction!(write_merl, m)?)?;
    m.add_function(wrap_pyfunction!(write_rgl, m)?)?;
    m.add_function(wrap_pyfunction!(write_zemax, m)?)
}
