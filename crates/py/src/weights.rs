//! Weights and hemispherical integrals of scattered directions.

use gonio_geom::integrate::{IntegralError, IntegralOptions, hemisphere_integral as integrate};
use gonio_geom::weights::{WeightsError, hemisphere_cells};
use gonio_geom::{DVec3, Direction, Side};
use numpy::PyArray1;
use pyo3::prelude::*;
use pyo3::types::PyDict;

use crate::arrays::{Column, angles, column};
use crate::errors::{DomainError, OrRaise, Raise, domain};

impl Raise for WeightsError {
    fn raise(self) -> PyErr {
        DomainError::new_err(self.to_string())
    }
}

impl Raise for IntegralError {
    fn raise(self) -> PyErr {
        DomainError::new_err(self.to_string())
    }
}

fn side_of(name: &str) -> PyResult<Side> {
    match name {
        "front" => Ok(Side::Front),
        "back" => Ok(Side::Back),
        _ => Err(domain("side", format!("{name:?}"), "front, back")),
    }
}

/// Unit vectors of columns of degrees. Neither column is copied.
fn directions(theta_s: &Column<'_>, phi_s: &Column<'_>) -> PyResult<Vec<DVec3>> {
    let (theta, phi) = (theta_s.as_array(), phi_s.as_array());
    if theta.len() != phi.len() {
        let found = format!("{} entries", phi.len());
        return Err(domain(
            "phi_s",
            found,
            &format!("{}, one a direction", theta.len()),
        ));
    }
    theta
        .iter()
        .zip(&phi)
        .enumerate()
        .map(|(j, (&t, &p))| {
            if !(0.0..=180.0).contains(&t) {
                let field = format!("theta_s of direction {}", j + 1);
                return Err(domain(&field, t, "0 to 180 degrees"));
            }
            if !p.is_finite() {
                let field = format!("phi_s of direction {}", j + 1);
                return Err(domain(&field, p, "a finite angle in degrees"));
            }
            Ok(Direction::from_degrees(t, p).vec())
        })
        .collect()
}

/// `(omega, omega_projected, reach)` of directions on one side; sr, sr, degrees.
#[pyfunction]
#[pyo3(signature = (theta_s, phi_s, *, side))]
#[allow(clippy::type_complexity, reason = "a tuple of arrays")]
fn hemisphere_weights<'py>(
    py: Python<'py>,
    theta_s: Column<'py>,
    phi_s: Column<'py>,
    side: &str,
) -> PyResult<(
    Bound<'py, PyArray1<f64>>,
    Bound<'py, PyArray1<f64>>,
    Bound<'py, PyArray1<f64>>,
)> {
    let side = side_of(side)?;
    let points = directions(&theta_s, &phi_s)?;
    let cells = py.detach(|| hemisphere_cells(&points, side)).or_raise()?;
    let projected = (0..cells.len()).map(|i| cells.omega_projected(i));
    Ok((
        PyArray1::from_slice(py, &cells.omega),
        PyArray1::from_iter(py, projected),
        PyArray1::from_iter(py, cells.reach.iter().map(|r| r.to_degrees())),
    ))
}

/// The integral of `dsf` over one hemisphere as a dict.
#[pyfunction]
#[pyo3(signature = (theta_s, phi_s, dsf, *, side, incidence=None, u_dsf=None, reach=None))]
#[allow(clippy::too_many_arguments, reason = "keyword arguments of Python")]
fn hemisphere_integral<'py>(
    py: Python<'py>,
    theta_s: Column<'py>,
    phi_s: Column<'py>,
    dsf: Column<'py>,
    side: &str,
    incidence: Option<(f64, f64)>,
    u_dsf: Option<Column<'py>>,
    reach: Option<f64>,
) -> PyResult<Bound<'py, PyDict>> {
    let side = side_of(side)?;
    let points = directions(&theta_s, &phi_s)?;
    let dsf = column("dsf", &dsf, Some(points.len()))?;
    let sigma = u_dsf
        .map(|u| column("u_dsf", &u, Some(points.len())))
        .transpose()?;
    if let Some(r) = reach
        && !(r > 0.0 && r <= 180.0)
    {
        return Err(domain("reach", r, "above 0, up to 180 degrees"));
    }
    let options = IntegralOptions {
        wi: incidence
            .map(|(theta, phi)| angles(["theta_i", "phi_i"], theta, phi))
            .transpose()?
            .map(gonio_geom::Angles::direction),
        reach: reach.map(f64::to_radians),
        ..IntegralOptions::default()
    };
    let r = py
        .detach(|| integrate(&points, &dsf, sigma.as_deref(), None, side, &options))
        .or_raise()?;
    let out = PyDict::new(py);
    out.set_item("value", r.value)?;
    out.set_item("extrapolated", r.extrapolated)?;
    out.set_item("u_noise", r.u_noise)?;
    out.set_item("u_quadrature", r.u_quadrature)?;
    out.set_item("u_extrapolated", r.u_extrapolated)?;
    out.set_item("u_peaks", r.u_peaks)?;
    out.set_item("measured_omega", r.measured_omega)?;
    out.set_item("reach", r.reach.to_degrees())?;
    Ok(out)
}

pub(crate) fn register(m: &Bound<'_, PyModule>) -> PyResult<()> {
    m.add_function(wrap_pyfunction!(hemisphere_weights, m)?)?;
    m.add_function(wrap_pyfunction!(hemisphere_integral, m)?)
}
