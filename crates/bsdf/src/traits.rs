//! The one interface of every scattering model.

use std::f64::consts::PI;

use gonio_geom::{DVec3, Direction, Side};

use crate::Channel;

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
    /// `f |cos| / pdf` of the first channel, cos of the sampled direction.
    pub weight: f64,
    /// Density of `direction` per unit solid angle, 1/sr.
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

    /// Density per unit solid angle with which [`Bsdf::sample`] returns `sampled`, given `w`.
    fn pdf(&self, _w: Direction, sampled: Direction) -> f64 {
        0.5 * sampled.cos_theta().abs() / PI
    }

    /// Samples the other direction given `w` (the model is evaluated as `f(w, sampled)`) with `u` in `[0, 1)^3`.
    /// `None` is a failed sample of weight zero. The default draws a cosine-weighted direction on either side:
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
}
