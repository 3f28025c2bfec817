//! The two parts of `ashik2`.

use std::f64::consts::PI;

use gonio_geom::{DVec3, Direction, Side};

use super::{CHANNELS, Rgb};
use crate::analytic::lambert::{cosine_density, cosine_direction};
use crate::{Bsdf, Channel, Lobe, Properties, Sample};

/// Neither part is reciprocal; see docs/models/radiance.md for how far.
const PROPERTIES: Properties = Properties {
    reciprocal: false,
    energy_conserving: true,
    isotropic: true,
};

/// `(1 - cos)^5`.
fn schlick(cos: f64) -> f64 {
    (1.0 - cos).powi(5)
}

/// Both directions as seen with `w` in front; `None` unless they are on one side and off the horizon.
fn in_front(w: Direction, s: Direction) -> Option<(DVec3, DVec3)> {
    let (mut w, mut s) = (w.vec(), s.vec());
    if w.z * s.z <= 0.0 {
        return None;
    }
    (w.z, s.z) = (w.z.abs(), s.z.abs());
    Some((w, s))
}

/// `f = diffuse (1 - (1 - cos_i)^5) / pi`: the factor of the angle of view that [AshikhminShirley2000, eq. 5] has is absent.
#[derive(Clone, Debug)]
pub(super) struct AshikDiffuse(pub(super) Rgb);

impl Bsdf for AshikDiffuse {
    fn channels(&self) -> &[Channel] {
        &CHANNELS
    }

    fn properties(&self) -> Properties {
        PROPERTIES
    }

    fn eval(&self, wi: Direction, ws: Direction, f: &mut [f64]) {
        let common = match in_front(wi, ws) {
            Some((i, _)) => (1.0 - schlick(i.z)) / PI,
            None => 0.0,
        };
        f.iter_mut().zip(self.0).for_each(|(f, c)| *f = c * common);
    }

    fn pdf(&self, w: Direction, sampled: Direction) -> f64 {
        in_front(w, sampled).map_or(0.0, |(_, s)| s.z / PI)
    }

    fn sample(&self, w: Direction, u: [f64; 3]) -> Option<Sample> {
        let up = cosine_direction(u)?;
        let direction = if w.side() == Side::Front { up } else { up.flipped() };
        let weight = self.eval_first(w, direction) * PI;
        Some(Sample {
            direction,
            weight,
            pdf: cosine_density(up),
            lobe: Lobe::Diffuse,
        })
    }
}

/// `f = sqrt((nu + 1)(nv + 1)) / (8 pi) h_z^((nu h_u^2 + nv h_v^2) / (1 - h_z^2)) / ((h.i) max(cos_i, cos_s)) F`,
/// `F = spec + (1 - spec)(1 - cos_s)^5`: [AshikhminShirley2000, eq. 4] with the angle of view in place of the angle to the
/// half vector `h` [Radiance, rt/ashikhmin.c].
#[derive(Clone, Debug)]
pub(super) struct AshikGloss {
    pub(super) specular: Rgb,
    pub(super) power_u: f64,
    pub(super) power_v: f64,
    /// Azimuth of u, radians.
    pub(super) azimuth: f64,
}

impl AshikGloss {
    /// Density of half vectors per unit solid angle, for the unit vector `h`.
    fn density(&self, h: DVec3) -> f64 {
        let (s, c) = self.azimuth.sin_cos();
        let (u, v) = (c * h.x + s * h.y, c * h.y - s * h.x);
        let sin2 = u * u + v * v;
        // ln(h_z) / sin^2, whose limit at the normal is -1/2.
        let slope = if sin2 > 1e-12 {
            0.5 * (-sin2.min(1.0)).ln_1p() / sin2
        } else {
            -0.5
        };
        let fall = (self.power_u * u * u + self.power_v * v * v) * slope;
        let fall = if fall.is_nan() { 0.0 } else { fall };
        ((self.power_u + 1.0) * (self.power_v + 1.0)).sqrt() / (2.0 * PI) * fall.exp()
    }
}

impl Bsdf for AshikGloss {
    fn channels(&self) -> &[Channel] {
        &CHANNELS
    }

    fn properties(&self) -> Properties {
        Properties {
            isotropic: self.power_u == self.power_v,
            ..PROPERTIES
        }
    }

    fn eval(&self, wi: Direction, ws: Direction, f: &mut [f64]) {
        let half = in_front(wi, ws).and_then(|(i, s)| Some((i, s, (i + s).try_normalize()?)));
        let Some((i, s, h)) = half else {
            f.fill(0.0);
            return;
        };
        let lobe = self.density(h) / (4.0 * h.dot(i) * i.z.max(s.z));
        let fresnel = schlick(s.z);
        for (f, c) in f.iter_mut().zip(self.specular) {
            // RADIANCE has no gloss at all where every channel of it is zero.
            *f = if self.specular == [0.0; 3] {
                0.0
            } else {
                lobe * (c + (1.0 - c) * fresnel)
            };
        }
    }

    fn pdf(&self, w: Direction, sampled: Direction) -> f64 {
        in_front(w, sampled)
            .and_then(|(i, s)| Some((i, (i + s).try_normalize()?)))
            .map_or(0.0, |(i, h)| self.density(h) / (4.0 * h.dot(i)))
    }

    /// Draws the half vector [AshikhminShirley2000, eq. 9 and 10] and mirrors `w` in it.
    fn sample(&self, w: Direction, u: [f64; 3]) -> Option<Sample> {
        let (sin, cos) = (2.0 * PI * u[1]).sin_cos();
        let (a, b) = (
            (self.power_v + 1.0).sqrt() * cos,
            (self.power_u + 1.0).sqrt() * sin,
        );
        let r = a.hypot(b);
        let (a, b) = (a / r, b / r);
        let power = self.power_u * a * a + self.power_v * b * b;
        let z = (1.0 - u[0]).powf(1.0 / (power + 1.0));
        let sin = (1.0 - z * z).max(0.0).sqrt();
        let (s, c) = self.azimuth.sin_cos();
        let side = w.side().sign();
        let h = DVec3::new(sin * (c * a - s * b), sin * (s * a + c * b), side * z);
        let facing = w.vec().dot(h);
        if facing <= 0.0 {
            return None;
        }
        let direction = Direction::new(2.0 * facing * h - w.vec())?;
        let pdf = Bsdf::pdf(self, w, direction);
        let weight = self.eval_first(w, direction) * direction.cos_theta().abs() / pdf;
        (pdf > 0.0 && weight.is_finite()).then_some(Sample {
            direction,
            weight,
            pdf,
            lobe: Lobe::Glossy,
        })
    }
}
