//! What a reduced model loses.

use std::f64::consts::PI;

use gonio_bsdf::{Bsdf, BsdfError};
use gonio_geom::{Component, Direction};

use super::{OneChannel, disk_direction};

/// Difference of a reduced model from its model at one incidence and component.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Loss {
    /// `integral |df| cos / integral f cos`.
    pub rel_l1: f64,
    /// `sqrt(integral (d dsf)^2 domega / integral dsf^2 domega)`.
    pub rel_rms: f64,
    /// Directional albedo of the model on the grid.
    pub albedo_model: f64,
    /// Directional albedo of the reduced model on the same grid.
    pub albedo_reduced: f64,
    /// Greatest value of the reduced model over that of the model, on the grid.
    pub peak_ratio: f64,
}

/// Compares the first channel of `reduced` with channel number `channel` of `model` at `wi`, on a grid of `n x n`
/// directions of equal projected solid angle. Where the model is 0 everywhere, ratios are NaN. An ideal part counts in
/// the model's albedo; what a table makes of it is a difference like any other.
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
    let (mut sum, mut sum_reduced) = (0.0, 0.0);
    let (mut peak, mut peak_reduced) = (0.0f64, 0.0f64);
    for a in 0..n {
        for b in 0..n {
            let ws = disk_direction(step * (a as f64 + 0.5), step * (b as f64 + 0.5), side);
            let (f, g) = (model.eval(wi, ws), reduced.eval_first(wi, ws));
            let cos = ws.cos_theta().abs();
            l1 += (f - g).abs();
            // dsf^2 domega = f^2 cos dOmega_projected
            square += (f - g) * (f - g) * cos;
            square_model += f * f * cos;
            sum += f;
            sum_reduced += g;
            peak = peak.max(f);
            peak_reduced = peak_reduced.max(g);
        }
    }
    let cell = PI * step * step;
    let mut shares = vec![0.0; model.model.channels().len()];
    model.model.delta(wi, component, &mut shares);
    Ok(Loss {
        rel_l1: l1 / sum,
        rel_rms: (square / square_model).sqrt(),
        albedo_model: cell * sum + shares[channel],
        albedo_reduced: cell * sum_reduced,
        peak_ratio: peak_reduced / peak,
    })
}
