//! Python bindings of gonio: conversion and errors, no maths. Angles are degrees on this side.

mod analytic;
mod arrays;
mod batch;
mod bsdf;
mod checking;
mod compact;
mod compact_parts;
mod device;
mod errors;
mod files;
mod fit;
mod fit_data;
mod instrument;
mod model;
mod model_files;
mod plan;
mod processing;
mod radiance;
mod radiance_export;
mod radiance_material;
mod render;
mod resolution;
mod rgl;
mod scan;
mod scene;
mod simulate;
mod slice;
mod sphere;
mod tabulate;
mod verdict;
mod weights;

use pyo3::prelude::*;

#[pymodule]
fn _native(m: &Bound<'_, PyModule>) -> PyResult<()> {
    // A panic reaches Python as an exception that carries its message; Rust's own hook would print it a second time,
    // unasked. RUST_BACKTRACE brings the place back.
    if std::env::var_os("RUST_BACKTRACE").is_none() {
        std::panic::set_hook(Box::new(|_| {}));
    }
    m.add("__version__", env!("CARGO_PKG_VERSION"))?;
    errors::register(m)?;
    files::register(m)?;
    fit::register(m)?;
    processing::register(m)?;
    checking::register(m)?;
    compact::register(m)?;
    device::register(m)?;
    radiance::register(m)?;
    radiance_export::register(m)?;
    radiance_material::register(m)?;
    rgl::register(m)?;
    scan::register(m)?;
    render::register(m)?;
    scene::register(m)?;
    resolution::register(m)?;
    slice::register(m)?;
    sphere::register(m)?;
    tabulate::register(m)?;
    verdict::register(m)?;
    bsdf::register(m)?;
    model::register(m)?;
    model_files::register(m)?;
    analytic::register(m)?;
    plan::register(m)?;
    simulate::register(m)?;
    weights::register(m)
}
