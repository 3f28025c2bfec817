//! The one interface of every scattering model.

use std::f64::consts::PI;

use gonio_geom::{Component, DVec3, Direction, Side};

use crate::Channel;
use crate::batch::{Directions, SampleColumns, eval_each, sample_each};

/// What a model promises; a model that breaks a law by design says so here.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Properties {
    /// `f(wi, ws) = f(ws, wi)` holds (transmission: with the sides swapped).
    pub reciprocal: bool,
    /// Directional-hemispherical reflectance plus transmittance never exceeds 1.
    pub energy_conserving: bool,
    /// Depends on `phi_s - phi_i` only.
    pub isotropic: bool,
}

/// Which part of a model a sample came from.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Lobe {
    /// A broad part, finite density everywhere.
    Diffuse,
    /// A directed part of finite width.
    Glossy,
    /// An ideal direction without density (mirror, unbent transmission).
    Delta,
}

/// A sampled direction.
#[derive(Clone, Copy, Debug)]
pub struct Sample {
    /// The sampled direction; leaves the surface.
    pub direction: Direction,
    /// `f |cos| / pdf` of the first channel, cos of the sampled direction; of an ideal direction its share of the
    /// light over the probability.
    pub weight: f64,
    /// Density of `direction` per unit solid angle, 1/sr; the probability of an ideal direction ([`Lobe::Delta`]).
    pub pdf: f64,
    /// The part of the model it came from.
    pub lobe: Lobe,
}

/// A scattering model. `wi` leaves towards the source, `ws` towards the receiver.
pub trait Bsdf: Send + Sync {
    /// The channels [`Bsdf::eval`] answers for, in order.
    fn channels(&self) -> &[Channel];

    /// What the model promises.
    fn properties(&self) -> Properties;

    /// `f(wi, ws)` in 1/sr, no cosine, one value a channel into `f` (length = `channels().len()`). Zero where the
    /// model does not scatter, at the horizon of `ws`, and never NaN.
    fn eval(&self, wi: Direction, ws: Direction, f: &mut [f64]);

    /// `f` of the first channel.
    fn eval_first(&self, wi: Direction, ws: Direction) -> f64 {
        let n = self.channels().len();
        if n == 1 {
            let mut f = [0.0];
            self.eval(wi, ws, &mut f);
            f[0]
        } else {
            let mut f = vec![0.0; n];
            self.eval(wi, ws, &mut f);
            f[0]
        }
    }

    /// The ideal part of the model, which [`Bsdf::eval`] and [`Bsdf::pdf`] leave out: the direction that light from
    /// `w` takes without spreading (mirrored, straight through, refracted) and, into `shares`, the share of it that
    /// does, one value a channel. `None` and zeros where there is no such part, and for `w` on the horizon.
    ///
    /// Shares are of the flux: the integral of `f |cos theta_s|` over the ideal direction. Radiance that crosses into
    /// a medium of another index scales by the squared ratio of the indices on top of it.
    fn delta(&self, _w: Direction, _component: Component, shares: &mut [f64]) -> Option<Direction> {
        shares.fill(0.0);
        None
    }

    /// Whether the model has an ideal part for light at 30 degrees on either side.
    fn has_delta(&self) -> bool {
        let mut shares = vec![0.0; self.channels().len()];
        [30.0, 150.0].into_iter().any(|theta| {
            [Component::Reflection, Component::Transmission]
                .into_iter()
                .any(|c| {
                    self.delta(Direction::from_degrees(theta, 0.0), c, &mut shares)
                        .is_some()
                })
        })
    }

    /// Whether a table may hold light that leaves without spreading in `ideal` in what it answers for `ws`: both lie in
    /// one cell or, where cells are fine, in neighbours. `false` for models that have no cells.
    fn holds(&self, _wi: Direction, _ideal: Direction, _ws: Direction) -> bool {
        false
    }

    /// Whether `f(wi, ws)` rests on data. An analytic model answers `true` everywhere, a measured one `false` where it
    /// extrapolates or has nothing.
    fn has_data(&self, _wi: Direction, _ws: Direction) -> bool {
        true
    }

    /// Density per unit solid angle with which [`Bsdf::sample`] returns `sampled`, given `w`; ideal directions apart.
    fn pdf(&self, _w: Direction, sampled: Direction) -> f64 {
        0.5 * sampled.cos_theta().abs() / PI
    }

    /// Samples the other direction given `w` (the model is evaluated as `f(w, sampled)`) with `u` in `[0, 1)^3`.
    /// `None` is a failed sample: no channel has any light in it. The default draws a cosine-weighted direction on either side:
    /// correct for every model, efficient only for broad ones.
    fn sample(&self, w: Direction, u: [f64; 3]) -> Option<Sample> {
        let side = if u[2] < 0.5 { Side::Front } else { Side::Back };
        let (r, phi) = (u[0].sqrt(), 2.0 * PI * u[1]);
        let z = (1.0 - u[0]).max(0.0).sqrt();
        let direction = Direction::new(DVec3::new(r * phi.cos(), r * phi.sin(), side.sign() * z))?;
        let pdf = Bsdf::pdf(self, w, direction);
        if pdf <= 0.0 {
            return None;
        }
        let weight = self.eval_first(w, direction) * direction.cos_theta().abs() / pdf;
        (weight > 0.0).then_some(Sample {
            direction,
            weight,
            pdf,
            lobe: Lobe::Diffuse,
        })
    }

    /// [`Bsdf::eval`] of many pairs in single precision: one row of `f` a channel, one entry a pair. Lengths that do
    /// not match panic.
    ///
    /// Analytic models are within 2e-6 relative (times one more than the exponent of the lobe, where that is large) of
    /// double precision at the same vectors; the default goes through [`Bsdf::eval`] and rounds.
    fn eval_f32(&self, wi: Directions<'_, f32>, ws: Directions<'_, f32>, f: &mut [&mut [f32]]) {
        eval_each(self, wi, ws, f);
    }

    /// [`Bsdf::eval_f32`] in double precision.
    fn eval_f64(&self, wi: Directions<'_, f64>, ws: Directions<'_, f64>, f: &mut [&mut [f64]]) {
        eval_each(self, wi, ws, f);
    }

    /// [`Bsdf::sample`] for columns of uniform numbers `u`, with the weight of every channel (of the first alone for an
    /// ideal direction; NaN for the others). The same `u` give the same directions as one by one, up to rounding.
    fn sample_f32(&self, w: Directions<'_, f32>, u: [&[f32]; 3], out: &mut SampleColumns<'_, f32>) {
        sample_each(self, w, u, out);
    }

    /// [`Bsdf::sample_f32`] in double precision.
    fn sample_f64(&self, w: Directions<'_, f64>, u: [&[f64]; 3], out: &mut SampleColumns<'_, f64>) {
        sample_each(self, w, u, out);
    }
}
