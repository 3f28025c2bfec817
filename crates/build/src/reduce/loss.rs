//! What a reduced model loses.

use std::f64::consts::PI;

use gonio_bsdf::{Bsdf, BsdfError};
use gonio_geom::{Component, Direction};

use super::apart::{Apart, Sums};
use super::{OneChannel, disk_direction};

/// Difference of a reduced model from its model at one incidence and component.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Loss {
    /// `integral |df| cos / integral f cos` of the scattered light.
    pub rel_l1: f64,
    /// `sqrt(integral (d dsf)^2 domega / integral dsf^2 domega)`.
    pub rel_rms: f64,
    /// Directional albedo of the model, its ideal part included.
    pub albedo_model: f64,
    /// Directional albedo of the reduced model.
    pub albedo_reduced: f64,
    /// Greatest value of the reduced model over that of the model, on the grid.
    pub peak_ratio: f64,
    /// Share of the light that the model leaves without spread.
    pub ideal_model: f64,
    /// The share of it that the reduced model has or holds in its cells.
    pub ideal_reduced: f64,
}

/// Compares the first channel of `reduced` with channel number `channel` of `model` at `wi`, on a grid of `n x n`
/// directions of equal projected solid angle. Where the model is 0 everywhere, ratios are NaN. Scattered light is compared
/// with scattered light: cells of a table that hold the ideal part of the model ([`Bsdf::holds`]) are left out, and what
/// they hold beyond the scattered light of the model is compared with the share of the ideal part.
///
/// # Errors
/// [`BsdfError::Domain`] for a channel the model does not have or a grid of fewer than 2 directions a side.
pub fn loss(
    model: &dyn Bsdf,
    channel: usize,
    reduced: &dyn Bsdf,
    wi: Direction,
    component: Component,
    n: usize,
) -> Result<Loss, BsdfError> {
    let model = OneChannel::with_ideal(model, channel)?;
    if n < 2 {
        return Err(BsdfError::Domain {
            field: "n",
            found: n.to_string(),
            allowed: "2 or more".into(),
        });
    }
    let side = component.scattered_side(wi.side());
    let step = 1.0 / n as f64;
    let (mut l1, mut square, mut square_model) = (0.0, 0.0, 0.0);
    let apart = Apart::new([(model.model, channel), (reduced, 0)], wi, component);
    let cell = PI * step * step;
    let mut sums = Sums::default();
    let (mut peak, mut peak_reduced) = (0.0f64, 0.0f64);
    for a in 0..n {
        for b in 0..n {
            let ws = disk_direction(step * (a as f64 + 0.5), step * (b as f64 + 0.5), side);
            let (f, g) = (model.eval(wi, ws), reduced.eval_first(wi, ws));
            if apart.held(ws) {
                sums.held[0] += cell * f;
                sums.held[1] += cell * g;
                continue;
            }
            let cos = ws.cos_theta().abs();
            l1 += (f - g).abs();
            // dsf^2 domega = f^2 cos dOmega_projected
            square += (f - g) * (f - g) * cos;
            square_model += f * f * cos;
            sums.compared[0] += cell * f;
            sums.compared[1] += cell * g;
            peak = peak.max(f);
            peak_reduced = peak_reduced.max(g);
        }
    }
    let light = apart.light(&sums);
    Ok(Loss {
        rel_l1: cell * l1 / sums.compared[0],
        rel_rms: (square / square_model).sqrt(),
        albedo_model: light.albedo[0],
        albedo_reduced: light.albedo[1],
        peak_ratio: peak_reduced / peak,
        ideal_model: light.ideal[0],
        ideal_reduced: light.ideal[1],
    })
}
