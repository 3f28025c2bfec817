//! Reduction of any model to Klems matrices and tensor trees, and Radiance BSDF XML of them.

use std::path::PathBuf;

use gonio_bsdf::klems::{Klems as CoreKlems, KlemsBasis};
use gonio_bsdf::tensor_tree::{Rank, TensorTree as CoreTree};
use gonio_bsdf::{Channel, FourComponents};
use gonio_build::reduce::{self, KlemsOptions, TreeOptions};
use gonio_io::radiance_xml::{self, Material, RadianceXml, Tabulated};
use pyo3::prelude::*;
use pyo3::types::PyDict;

use crate::bsdf::Bsdf;
use crate::errors::{OrRaise, domain};
use crate::radiance::{Klems, Names, TensorTree, component_of, components, wrap};

/// Reduce a model to Klems matrices by averaging over pairs of patches.
///
/// `basis`: "full", "half" or "quarter". `components`: list of (side, component), or None for all that scatter.
/// `tolerance`: mean deviation inside a cell, as a share of the albedo, above which it is halved. `cap_albedo`: scale incident patches above albedo 1
/// back to 1; `report["capped"]` lists them. Raises DomainError.
#[pyfunction]
#[pyo3(signature = (bsdf, *, basis="full", components=None, channel=None, tolerance=0.0001, cap_albedo=false))]
fn to_klems(
    py: Python<'_>,
    bsdf: &Bsdf,
    basis: &str,
    components: Option<Names>,
    channel: Option<&str>,
    tolerance: f64,
    cap_albedo: bool,
) -> PyResult<Py<PyAny>> {
    let options = KlemsOptions {
        basis: KlemsBasis::by_name(basis).or_raise()?,
        components: self::components(components)?,
        channel: bsdf.channel_index(channel)?,
        tolerance,
        cap_albedo,
        ..KlemsOptions::default()
    };
    let model = bsdf.0.clone();
    let r = py.detach(|| reduce::to_klems(&*model, &options)).or_raise()?;
    let report = PyDict::new(py);
    report.set_item("max_albedo", r.max_albedo)?;
    let capped: Vec<_> = r.capped.iter().map(|(s, i, a)| (s.to_string(), *i, *a)).collect();
    report.set_item("capped", capped)?;
    report.set_item("evaluations", r.evaluations)?;
    report.set_item("unsettled", r.unsettled)?;
    wrap(
        py,
        Tabulated::Klems(r.model),
        report.unbind(),
        PyDict::new(py).unbind(),
    )
}

/// Reduce a model to tensor trees, halving cells where the model varies most.
///
/// `rank`: 3 (isotropic), 4, or None for what the model needs. Refinement stops at the relative L1 error `target`, at
/// `max_cells` cells or `max_bytes` bytes of a file (no limit of cells then) a component, or at cells of side 2**-max_depth.
/// Raises DomainError.
#[pyfunction]
#[pyo3(signature = (bsdf, *, rank=None, components=None, channel=None, max_depth=None, target=None, max_cells=None,
                    max_bytes=None))]
#[expect(clippy::too_many_arguments, reason = "keyword arguments of Python")]
fn to_tensor_tree(
    py: Python<'_>,
    bsdf: &Bsdf,
    rank: Option<u8>,
    components: Option<Names>,
    channel: Option<&str>,
    max_depth: Option<u8>,
    target: Option<f64>,
    max_cells: Option<usize>,
    max_bytes: Option<usize>,
) -> PyResult<Py<PyAny>> {
    let rank = match rank {
        None => None,
        Some(3) => Some(Rank::Three),
        Some(4) => Some(Rank::Four),
        Some(other) => return Err(domain("rank", other, "3, 4")),
    };
    let default = TreeOptions::default();
    let options = TreeOptions {
        rank,
        components: self::components(components)?,
        channel: bsdf.channel_index(channel)?,
        max_depth: max_depth.unwrap_or(default.max_depth),
        // a budget is used up unless a target is met first
        target: target.unwrap_or(if max_bytes.is_some() { 0.0 } else { default.target }),
        max_cells: max_cells.unwrap_or(match max_bytes {
            // a cell takes three bytes at least
            Some(bytes) => (bytes / 3).clamp(16, 1 << 26),
            None => default.max_cells,
        }),
        max_bytes,
    };
    let model = bsdf.0.clone();
    let r = py
        .detach(|| reduce::to_tensor_tree(&*model, &options))
        .or_raise()?;
    let report = PyDict::new(py);
    report.set_item("max_albedo", r.max_albedo)?;
    let error = PyDict::new(py);
    for (s, c, e) in r.error.iter() {
        error.set_item((s.to_string(), c.to_string()), e)?;
    }
    report.set_item("error", error)?;
    let bytes = PyDict::new(py);
    for (s, c, n) in r.bytes.iter() {
        bytes.set_item((s.to_string(), c.to_string()), n)?;
    }
    report.set_item("bytes", bytes)?;
    report.set_item("evaluations", r.evaluations)?;
    wrap(
        py,
        Tabulated::TensorTree(r.model),
        report.unbind(),
        PyDict::new(py).unbind(),
    )
}

/// Write a `Klems` or `TensorTree` as Radiance BSDF XML; the file appears whole or not at all.
///
/// Lengths in metres. `as_visible` labels the data Visible whatever its channel: Radiance renders nothing else.
/// Raises FormatError when the format has no word for the model's channel, DomainError for another kind of model.
#[pyfunction]
#[pyo3(signature = (path, bsdf, *, name="", manufacturer="", device_type="Other", thickness=None, width=None,
                    height=None, as_visible=false))]
#[expect(clippy::too_many_arguments, reason = "keyword arguments of Python")]
fn write_radiance_xml(
    py: Python<'_>,
    path: PathBuf,
    bsdf: &Bound<'_, PyAny>,
    name: &str,
    manufacturer: &str,
    device_type: &str,
    thickness: Option<f64>,
    width: Option<f64>,
    height: Option<f64>,
    as_visible: bool,
) -> PyResult<()> {
    let lengths = [("thickness", thickness), ("width", width), ("height", height)];
    for (field, length) in lengths {
        if let Some(bad) = length.filter(|l| !(l.is_finite() && *l >= 0.0)) {
            return Err(domain(field, bad, "0 or more metres"));
        }
    }
    for (field, text) in [
        ("name", name),
        ("manufacturer", manufacturer),
        ("device_type", device_type),
    ] {
        if text.chars().any(|c| c.is_control()) {
            return Err(domain(
                field,
                format!("{text:?}"),
                "text without control characters",
            ));
        }
    }
    let relabel = |own: Channel| if as_visible { Channel::Photopic } else { own };
    let model = if let Ok(k) = bsdf.cast::<Klems>() {
        let k = &k.get().model;
        let channel = relabel(gonio_bsdf::Bsdf::channels(&**k)[0]);
        Tabulated::Klems(CoreKlems::new(channel, copy(k.matrices())))
    } else if let Ok(t) = bsdf.cast::<TensorTree>() {
        let t = &t.get().model;
        let channel = relabel(gonio_bsdf::Bsdf::channels(&**t)[0]);
        Tabulated::TensorTree(CoreTree::new(channel, copy(t.trees())))
    } else {
        return Err(domain(
            "bsdf",
            bsdf.get_type(),
            "a Klems or TensorTree (see to_klems, to_tensor_tree)",
        ));
    };
    let xml = RadianceXml {
        material: Material {
            name: name.into(),
            manufacturer: manufacturer.into(),
            device_type: device_type.into(),
            thickness,
            width,
            height,
        },
        model,
    };
    py.detach(|| radiance_xml::write(&path, &xml)).or_raise()
}

fn copy<T: Clone>(four: &FourComponents<T>) -> FourComponents<T> {
    four.map(|_, _, v| v.clone())
}

/// What `reduced` loses of `bsdf` at one incidence (degrees): dict of rel_l1, rel_rms, albedo_model, albedo_reduced,
/// peak_ratio on a grid of `grid` x `grid` directions of equal projected solid angle, ideal_model and ideal_reduced (share of
/// the light without spread; scattered light is compared with scattered light). Raises DomainError.
#[pyfunction]
#[pyo3(signature = (bsdf, reduced, *, theta_i, phi_i=0.0, component="reflection", channel=None, grid=200))]
#[expect(clippy::too_many_arguments, reason = "keyword arguments of Python")]
fn reduction_loss<'py>(
    py: Python<'py>,
    bsdf: &Bsdf,
    reduced: &Bsdf,
    theta_i: f64,
    phi_i: f64,
    component: &str,
    channel: Option<&str>,
    grid: usize,
) -> PyResult<Bound<'py, PyDict>> {
    let wi = crate::arrays::angles(["theta_i", "phi_i"], theta_i, phi_i)?.direction();
    if grid > 10_000 {
        return Err(domain("grid", grid, "2 to 10000"));
    }
    let component = component_of(component)?;
    let index = bsdf.channel_index(channel)?;
    let (a, b) = (bsdf.0.clone(), reduced.0.clone());
    let l = py
        .detach(|| reduce::loss(&*a, index, &*b, wi, component, grid))
        .or_raise()?;
    let d = PyDict::new(py);
    d.set_item("rel_l1", l.rel_l1)?;
    d.set_item("rel_rms", l.rel_rms)?;
    d.set_item("albedo_model", l.albedo_model)?;
    d.set_item("albedo_reduced", l.albedo_reduced)?;
    d.set_item("peak_ratio", l.peak_ratio)?;
    d.set_item("ideal_model", l.ideal_model)?;
    d.set_item("ideal_reduced", l.ideal_reduced)?;
    Ok(d)
}

pub(crate) fn register(m: &Bound<'_, PyModule>) -> PyResult<()> {
    m.add_function(wrap_pyfunction!(to_klems, m)?)?;
    m.add_function(wrap_pyfunction!(to_tensor_tree, m)?)?;
    m.add_function(wrap_pyfunction!(write_radiance_xml, m)?)?;
    m.add_function(wrap_pyfunction!(reduction_loss, m)?)
}
