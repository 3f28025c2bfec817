//! Columns across the seam: numpy arrays in degrees outside, vectors in radians inside.

use gonio_geom::{Angles, EXTENDED_THETA};
use numpy::{PyArray1, PyArrayLike1, PyArrayLikeDyn, TypeMustMatch};
use pyo3::prelude::*;

use crate::errors::domain;

/// Anything numpy can turn into a 1-D float64 array.
pub(crate) type Column<'py> = PyArrayLike1<'py, f64, numpy::AllowTypeChange>;

/// A 1-D array that must have its type already (flags: a float column would be a mistake).
pub(crate) type FlagColumn<'py> = PyArrayLike1<'py, u16, TypeMustMatch>;

/// Anything numpy can turn into a float64 array of any shape.
pub(crate) type Block<'py> = PyArrayLikeDyn<'py, f64, numpy::AllowTypeChange>;

/// A column as a vector, of `length` entries when that is given.
pub(crate) fn column(field: &str, values: &Column<'_>, length: Option<usize>) -> PyResult<Vec<f64>> {
    let values: Vec<f64> = values.as_array().iter().copied().collect();
    match length {
        Some(n) if n != values.len() => Err(domain(
            field,
            format!("{} entries", values.len()),
            &format!("{n}, one a reading"),
        )),
        _ => Ok(values),
    }
}

/// Canonical radians of a direction in degrees: `theta` in [0, 180], any finite `phi`.
pub(crate) fn angles(fields: [&str; 2], theta: f64, phi: f64) -> PyResult<Angles> {
    if !(0.0..=180.0).contains(&theta) {
        return Err(domain(fields[0], theta, "0 to 180 degrees"));
    }
    if !phi.is_finite() {
        return Err(domain(fields[1], phi, "a finite angle in degrees"));
    }
    Ok(Angles::from_degrees(theta, phi))
}

/// [`angles`] of whole columns, in place; an error names the reading (counted from 1).
pub(crate) fn canonical_columns(fields: [&str; 2], theta: &mut [f64], phi: &mut [f64]) -> PyResult<()> {
    for (j, (t, p)) in theta.iter_mut().zip(phi.iter_mut()).enumerate() {
        if !(0.0..=180.0).contains(t) {
            let field = format!("{} of reading {}", fields[0], j + 1);
            return Err(domain(&field, *t, "0 to 180 degrees"));
        }
        if !p.is_finite() {
            let field = format!("{} of reading {}", fields[1], j + 1);
            return Err(domain(&field, *p, "a finite angle in degrees"));
        }
        let a = Angles::from_degrees(*t, *p);
        (*t, *p) = (a.theta, a.phi);
    }
    Ok(())
}

/// Canonical radians of a direction that a reading states: `theta` in [-180, 270] (extended: beyond [0, 180] on the
/// opposite azimuth), `phi` in [-360, 720].
pub(crate) fn stated_angles(fields: [&str; 2], theta: f64, phi: f64) -> PyResult<Angles> {
    Angles::from_stated_degrees(theta, phi).ok_or_else(|| {
        if EXTENDED_THETA.contains(&theta) {
            domain(fields[1], phi, "-360 to 720 degrees")
        } else {
            domain(fields[0], theta, "-180 to 270 degrees")
        }
    })
}

/// [`stated_angles`] of whole columns, in place; an error names the reading (counted from 1).
pub(crate) fn stated_columns(fields: [&str; 2], theta: &mut [f64], phi: &mut [f64]) -> PyResult<()> {
    for (j, (t, p)) in theta.iter_mut().zip(phi.iter_mut()).enumerate() {
        let a = match Angles::from_stated_degrees(*t, *p) {
            Some(a) => a,
            None => {
                let [theta, phi] = fields.map(|f| format!("{f} of reading {}", j + 1));
                stated_angles([&theta, &phi], *t, *p)?
            }
        };
        (*t, *p) = (a.theta, a.phi);
    }
    Ok(())
}

/// A new numpy array of degrees.
pub(crate) fn degrees<'py>(py: Python<'py>, radians: &[f64]) -> Bound<'py, PyArray1<f64>> {
    let mut values = gonio_io::column(radians.len());
    values.extend(radians.iter().map(|&a| gonio_geom::degrees(a)));
    PyArray1::from_vec(py, values)
}

/// A new numpy array of a column.
pub(crate) fn copied<'py>(py: Python<'py>, values: &[f64]) -> Bound<'py, PyArray1<f64>> {
    let mut copy = gonio_io::column(values.len());
    copy.extend_from_slice(values);
    PyArray1::from_vec(py, copy)
}
