//! The diffuse part below a smooth surface.

use std::f64::consts::PI;

use gonio_geom::{Component, Direction};

use super::fresnel::Interface;
use super::{CHANNELS, Rgb};
use crate::analytic::lambert::{cosine_density, cosine_direction};
use crate::{Bsdf, Channel, Lobe, Properties, Sample};

/// `f = color (1 - spec) (1 - F(cos_i)) (1 - F(cos_s)) / pi` into one component: what enters and what leaves a smooth
/// surface follow Fresnel's law [Radiance, rt/normal.c].
#[derive(Clone, Debug)]
pub(super) struct SmoothDiffuse {
    pub(super) color: Rgb,
    pub(super) interface: Interface,
    pub(super) component: Component,
}

impl SmoothDiffuse {
    fn lit(&self, a: Direction, b: Direction) -> bool {
        a.cos_theta() * b.cos_theta() != 0.0 && Component::between(a.side(), b.side()) == self.component
    }
}

impl Bsdf for SmoothDiffuse {
    fn channels(&self) -> &[Channel] {
        &CHANNELS
    }

    fn properties(&self) -> Properties {
        Properties {
            reciprocal: true,
            energy_conserving: true,
            isotropic: true,
        }
    }

    fn eval(&self, wi: Direction, ws: Direction, f: &mut [f64]) {
        if !self.lit(wi, ws) {
            f.fill(0.0);
            return;
        }
        let [ci, cs] = [wi, ws].map(|d| d.cos_theta().abs());
        let common = self.interface.entering(ci) * (1.0 - self.interface.fresnel(cs)) / PI;
        f.iter_mut().zip(self.color).for_each(|(f, c)| *f = c * common);
    }

    fn pdf(&self, w: Direction, sampled: Direction) -> f64 {
        if self.lit(w, sampled) {
            sampled.cos_theta().abs() / PI
        } else {
            0.0
        }
    }

    fn sample(&self, w: Direction, u: [f64; 3]) -> Option<Sample> {
        let up = cosine_direction(u)?;
        let front = self.component.scattered_side(w.side()) == gonio_geom::Side::Front;
        let direction = if front { up } else { up.flipped() };
        let weight = self.eval_first(w, direction) * PI;
        Some(Sample {
            direction,
            weight,
            pdf: cosine_density(up),
            lobe: Lobe::Diffuse,
        })
    }
}
