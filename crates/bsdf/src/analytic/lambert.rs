//! Ideal diffuse reflection and transmission.

use std::f64::consts::PI;

use gonio_geom::{Component, DVec3, Direction};

use super::Spectrum;
use crate::{Bsdf, Channel, Lobe, Properties, Sample};

/// Lambertian scattering: `f = albedo / pi` on one side, the same for light from the front and from the back.
#[derive(Clone, Debug, PartialEq)]
pub struct Lambert {
    albedo: Spectrum,
    component: Component,
}

impl Lambert {
    /// Reflects `albedo` of the light, evenly in radiance.
    pub fn reflection(albedo: Spectrum) -> Self {
        Lambert {
            albedo,
            component: Component::Reflection,
        }
    }

    /// Transmits `albedo` of the light, evenly in radiance.
    pub fn transmission(albedo: Spectrum) -> Self {
        Lambert {
            albedo,
            component: Component::Transmission,
        }
    }

    /// The directional-hemispherical reflectance or transmittance of each channel.
    pub fn albedo(&self) -> &Spectrum {
        &self.albedo
    }

    /// The component it scatters into.
    pub fn component(&self) -> Component {
        self.component
    }
}

impl Bsdf for Lambert {
    fn channels(&self) -> &[Channel] {
        self.albedo.channels()
    }

    fn properties(&self) -> Properties {
        Properties {
            reciprocal: true,
            energy_conserving: true,
            isotropic: true,
        }
    }

    fn eval(&self, wi: Direction, ws: Direction, f: &mut [f64]) {
        let lit = wi.cos_theta() != 0.0
            && ws.cos_theta() != 0.0
            && Component::between(wi.side(), ws.side()) == self.component;
        self.albedo.scaled_into(if lit { 1.0 / PI } else { 0.0 }, f);
    }

    /// `|cos| / pi` on the side it scatters to.
    fn pdf(&self, w: Direction, sampled: Direction) -> f64 {
        if Component::between(w.side(), sampled.side()) == self.component {
            sampled.cos_theta().abs() / PI
        } else {
            0.0
        }
    }

    fn sample(&self, w: Direction, u: [f64; 3]) -> Option<Sample> {
        let albedo = self.albedo.values()[0];
        let (r, phi) = (u[0].sqrt(), 2.0 * PI * u[1]);
        let z = (1.0 - u[0]).max(0.0).sqrt();
        if albedo <= 0.0 || z <= 0.0 || w.cos_theta() == 0.0 {
            return None;
        }
        let side = self.component.scattered_side(w.side());
        Some(Sample {
            direction: Direction::new(DVec3::new(r * phi.cos(), r * phi.sin(), side.sign() * z))?,
            weight: albedo,
            pdf: z / PI,
            lobe: Lobe::Diffuse,
        })
    }
}
