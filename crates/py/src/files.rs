//! Reading and writing files of readings.

use std::collections::BTreeMap;
use std::path::PathBuf;

use gonio_io::table::TableMapping;
use gonio_io::{Format, ReadOptions};
use numpy::{PyArray1, PyArray3, PyArrayMethods};
use pyo3::prelude::*;

use crate::errors::{DomainError, OrRaise, domain};
use crate::scan::Scan;

/// Read the records of a file of readings.
///
/// The format is recognised by content unless `format` names it. `kind`, `quantity` and `channel` state what the file
/// does not; what the file states itself may not be contradicted. `upphi` (degrees) replaces the `#upphi` of a
/// Mountain file; 90 keeps its azimuths as written. `columns` maps gonio's names of columns to those of a table.
///
/// Raises FormatError naming file, line or field, what was found and what is allowed; OSError and its kin for what
/// the operating system refuses.
#[pyfunction]
#[pyo3(signature = (path, format=None, *, kind=None, quantity=None, channel=None, upphi=None,
    columns=None))]
#[expect(clippy::too_many_arguments, reason = "keyword-only in Python")]
fn read_file(
    py: Python<'_>,
    path: PathBuf,
    format: Option<&str>,
    kind: Option<&str>,
    quantity: Option<&str>,
    channel: Option<&str>,
    upphi: Option<f64>,
    columns: Option<BTreeMap<String, String>>,
) -> PyResult<Vec<Scan>> {
    if let Some(up) = upphi.filter(|up| !up.is_finite()) {
        return Err(domain("upphi", up, "a finite angle in degrees"));
    }
    let format = format.map(str::parse::<Format>).transpose();
    let options = ReadOptions {
        format: format.map_err(|e| DomainError::new_err(e.to_string()))?,
        kind: kind
            .map(str::parse::<gonio_scan::ScanKind>)
            .transpose()
            .or_raise()?,
        quantity: quantity
            .map(str::parse::<gonio_bsdf::Quantity>)
            .transpose()
            .or_raise()?,
        channel: channel
            .map(str::parse::<gonio_bsdf::Channel>)
            .transpose()
            .or_raise()?,
        upphi,
        table: TableMapping(columns.unwrap_or_default()),
    };
    let scans = py.detach(|| gonio_io::read_any(&path, &options)).or_raise()?;
    Ok(scans.into_iter().map(Scan::from).collect())
}

/// The readings of the NIST PTFE table with their Mueller matrices: per scan, the scan and an array of shape
/// (readings, 4, 4), normalised to m11 = 1. Errors as in `read_file`.
#[pyfunction]
fn read_mueller(py: Python<'_>, path: PathBuf) -> PyResult<Vec<(Scan, Bound<'_, PyArray3<f64>>)>> {
    let both = py
        .detach(|| gonio_io::nist_ptfe::read_mueller(&path, &ReadOptions::default()))
        .or_raise()?;
    both.into_iter()
        .map(|(scan, matrices)| {
            let flat: Vec<f64> = matrices.iter().flatten().flatten().copied().collect();
            let array = PyArray1::from_vec(py, flat).reshape([matrices.len(), 4, 4])?;
            Ok((Scan::from(scan), array))
        })
        .collect()
}

/// Name of the format that the beginning of a file shows; errors as in `read_file`.
#[pyfunction]
fn detect_format(path: PathBuf) -> PyResult<&'static str> {
    Ok(gonio_io::detect_file(&path).or_raise()?.name())
}

/// Write one scan as pab-opto Mountain text; the file appears whole or not at all.
#[pyfunction]
fn write_mountain(py: Python<'_>, path: PathBuf, scan: &Scan) -> PyResult<()> {
    let scan = scan.0.clone();
    py.detach(|| gonio_io::mountain::write(&path, &scan)).or_raise()
}

/// Write scans as records of one gonio raw file; the file appears whole or not at all.
#[pyfunction]
fn write_raw(py: Python<'_>, path: PathBuf, scans: Vec<PyRef<'_, Scan>>) -> PyResult<()> {
    let scans: Vec<_> = scans.iter().map(|s| s.0.clone()).collect();
    py.detach(|| gonio_io::gonio_raw::write(&path, &scans)).or_raise()
}

pub(crate) fn register(m: &Bound<'_, PyModule>) -> PyResult<()> {
    m.add_function(wrap_pyfunction!(read_file, m)?)?;
    m.add_function(wrap_pyfunction!(detect_format, m)?)?;
    m.add_function(wrap_pyfunction!(read_mueller, m)?)?;
    m.add_function(wrap_pyfunction!(write_mountain, m)?)?;
    m.add_function(wrap_pyfunction!(write_raw, m)?)
}
