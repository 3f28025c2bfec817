//! Solid-angle weights and hemispherical integrals of a slice.

use std::f64::consts::TAU;

use gonio_geom::integrate::{IntegralError, IntegralOptions, hemisphere_integral};
use gonio_geom::weights::{WeightsError, hemisphere_cells, patch_weights};
use gonio_geom::{DVec3, Side};

use crate::measurement::HemisphericalIntegral;
use crate::{ScanError, Slice};

fn weights_error(error: &WeightsError) -> ScanError {
    ScanError::Domain {
        field: "directions",
        found: error.to_string(),
        allowed: "unit vectors that span a patch or a hemisphere".into(),
    }
}

/// Solid angles of the readings of a bounded raster, sr.
pub(crate) fn patch_omega(points: &[DVec3]) -> Result<Vec<f64>, ScanError> {
    let weights = patch_weights(points).map_err(|e| weights_error(&e))?;
    Ok(weights.omega)
}

/// Part of a hemisphere's solid angle that readings must lie near for its integral to be a measurement.
pub(crate) const MEASURED: f64 = 0.1;

/// Sets `omega` and `integrals` of a slice whose `u_dsf` holds the independent and the common relative part.
/// `u_offset` is the absolute standard uncertainty that all values share, 1/sr.
///
/// `u^2(rho) = (u_c rho)^2 + (2 pi u_0)^2 + u_noise^2 + u_quadrature^2`: the last holds the extrapolated part's.
pub(crate) fn weigh(slice: &mut Slice, u_offset: f64) -> Result<(), ScanError> {
    slice.integrals.clear();
    slice.omega = vec![0.0; slice.len()];
    let options = IntegralOptions {
        wi: Some(slice.incidence.direction()),
        ..IntegralOptions::default()
    };
    for side in Side::BOTH {
        let members: Vec<u32> = (0..slice.len())
            .filter(|&j| slice.flags[j].usable() && slice.direction(j).side() == side)
            .map(|j| j as u32)
            .collect();
        if members.is_empty() {
            continue;
        }
        let points: Vec<DVec3> = members
            .iter()
            .map(|&j| slice.direction(j as usize).vec())
            .collect();
        let cells = hemisphere_cells(&points, side).map_err(|e| weights_error(&e))?;
        for (&j, &omega) in members.iter().zip(&cells.omega) {
            slice.omega[j as usize] = omega;
        }
        drop(cells);
        let dsf: Vec<f64> = members.iter().map(|&j| slice.dsf[j as usize]).collect();
        let sigma: Vec<f64> = members.iter().map(|&j| slice.u_independent(j as usize)).collect();
        let found = match hemisphere_integral(&points, &dsf, Some(&sigma), None, side, &options) {
            Ok(found) => found,
            Err(IntegralError::NothingUsable { .. }) => continue,
            Err(error) => {
                return Err(ScanError::Domain {
                    field: "dsf",
                    found: error.to_string(),
                    allowed: "finite values over a hemisphere".into(),
                });
            }
        };
        if found.measured_omega < MEASURED * TAU {
            continue;
        }
        let common = (slice.u_common * found.value).hypot(u_offset * TAU);
        slice.integrals.push(HemisphericalIntegral {
            side,
            value: found.value,
            extrapolated: found.extrapolated,
            u: common.hypot(found.u_noise).hypot(found.u_quadrature),
            u_quadrature: found.u_quadrature,
        });
    }
    Ok(())
}
