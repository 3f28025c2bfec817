//! Materials as scattering models.

mod ashikhmin;
mod fresnel;
mod ideal;
mod smooth;
#[cfg(test)]
mod tests;

use gonio_geom::Component;

use self::ashikhmin::{AshikDiffuse, AshikGloss};
pub use self::fresnel::Release;
use self::fresnel::{Interface, SMOOTH};
use self::ideal::{Ideal, Law};
use self::smooth::SmoothDiffuse;
use super::{Ashik2, Dielectric, Glass, Orientation, RadianceMaterial, Rgb};
use crate::analytic::{
    Analytic, AnisotropicTransmissionLobe, Lambert, Spectrum, Sum, TransmissionLobe, WardGmd,
};
use crate::{Bsdf, BsdfError, Channel};

/// The channels of every Radiance material.
const CHANNELS: [Channel; 3] = [Channel::Red, Channel::Green, Channel::Blue];

impl RadianceMaterial {
    /// The material as a model with the channels red, green and blue, as RADIANCE 6.1 evaluates it in its direct
    /// calculation. [`RadianceMaterial::bsdf_of`] says what that means.
    ///
    /// # Errors
    /// Those of [`RadianceMaterial::bsdf_of`].
    pub fn bsdf(&self) -> Result<Box<dyn Bsdf>, BsdfError> {
        self.bsdf_of(Release::default())
    }

    /// The material as a model with the channels red, green and blue.
    ///
    /// A rough surface is a sum of Lambertian parts and Gaussian lobes of width `alpha = rough`, without Fresnel's
    /// law. A roughness of at most 0.001 is smooth: an ideal part ([`Bsdf::delta`]) that follows the approximation of
    /// Fresnel's law in `release` from a specularity of .018 on, as the diffuse part then does. u of the anisotropic
    /// types is a vector of the sample's frame. Left out of the model are what RADIANCE does for speed or by
    /// construction: sources widen its lobes, values below 1e-6 are dropped, the cosine of view is at least 0.001.
    ///
    /// # Errors
    /// [`BsdfError::Domain`] for a parameter outside its range and an orientation that is not made of numbers.
    pub fn bsdf_of(&self, release: Release) -> Result<Box<dyn Bsdf>, BsdfError> {
        self.check()?;
        match self {
            RadianceMaterial::Plastic(m) => Surface {
                color: m.color,
                gloss: [1.0; 3],
                specularity: m.specularity,
                lobe: Width::round(m.roughness),
                ..Surface::default()
            }
            .model(release),
            RadianceMaterial::Metal(m) => Surface {
                color: m.color,
                gloss: m.color,
                specularity: m.specularity,
                lobe: Width::round(m.roughness),
                ..Surface::default()
            }
            .model(release),
            RadianceMaterial::Trans(m) => Surface {
                color: m.color,
                gloss: [1.0; 3],
                specularity: m.specularity,
                lobe: Width::round(m.roughness),
                transmissivity: m.transmissivity,
                transmitted_specularity: m.transmitted_specularity,
            }
            .model(release),
            RadianceMaterial::Plastic2(m) => Surface {
                color: m.color,
                gloss: [1.0; 3],
                specularity: m.specularity,
                lobe: Width::of(m.roughness_u, m.roughness_v, &m.orientation)?,
                ..Surface::default()
            }
            .model(release),
            RadianceMaterial::Metal2(m) => Surface {
                color: m.color,
                gloss: m.color,
                specularity: m.specularity,
                lobe: Width::of(m.roughness_u, m.roughness_v, &m.orientation)?,
                ..Surface::default()
            }
            .model(release),
            RadianceMaterial::Trans2(m) => Surface {
                color: m.color,
                gloss: [1.0; 3],
                specularity: m.specularity,
                lobe: Width::of(m.roughness_u, m.roughness_v, &m.orientation)?,
                transmissivity: m.transmissivity,
                transmitted_specularity: m.transmitted_specularity,
            }
            .model(release),
            RadianceMaterial::Ashik2(m) => ashik2(m),
            RadianceMaterial::Glass(m) => {
                pair(Law::PaneReflection(m.clone()), Law::PaneTransmission(m.clone()))
            }
            RadianceMaterial::Mirror(m) => Ok(Box::new(Ideal(Law::Mirror(m.color)))),
            RadianceMaterial::Dielectric(m) => {
                pair(Law::BodyReflection(m.clone()), Law::BodyRefraction(m.clone()))
            }
        }
    }
}

/// Width of the lobes.
#[derive(Clone, Copy, Debug, Default)]
enum Width {
    /// None: the lobes are ideal.
    #[default]
    Smooth,
    Round(f64),
    /// Along u, across, azimuth of u.
    Oval(f64, f64, f64),
}

impl Width {
    fn round(roughness: f64) -> Self {
        if roughness <= SMOOTH {
            Width::Smooth
        } else {
            Width::Round(roughness)
        }
    }

    /// A u that stands on the surface has no azimuth; the lobe is then round, of the rms of both widths.
    fn of(u: f64, v: f64, orientation: &Orientation) -> Result<Self, BsdfError> {
        Ok(match orientation.azimuth()? {
            Some(_) if u == v => Width::Round(u),
            Some(phi) => Width::Oval(u, v, phi),
            None => Width::Round((0.5 * (u * u + v * v)).sqrt()),
        })
    }
}

/// Plastic, metal, trans and their anisotropic kin.
#[derive(Clone, Copy, Debug, Default)]
struct Surface {
    color: Rgb,
    /// Colour of the reflected gloss.
    gloss: Rgb,
    specularity: f64,
    lobe: Width,
    transmissivity: f64,
    transmitted_specularity: f64,
}

impl Surface {
    fn model(&self, release: Release) -> Result<Box<dyn Bsdf>, BsdfError> {
        let interface = Interface::new(self.specularity, release);
        let smooth = matches!(self.lobe, Width::Smooth);
        // Of what enters.
        let through = self.transmissivity * self.transmitted_specularity;
        let diffuse = [
            (Component::Reflection, 1.0 - self.transmissivity),
            (
                Component::Transmission,
                self.transmissivity * (1.0 - self.transmitted_specularity),
            ),
        ];
        let mut parts: Vec<Part> = Vec::new();
        for (component, share) in diffuse {
            if share <= 0.0 {
                continue;
            }
            let weight = share * (1.0 - self.specularity) * mean(self.color);
            let albedo = spectrum(self.color, share * (1.0 - self.specularity))?;
            let part: Box<dyn Bsdf> = match component {
                _ if smooth && interface.has_fresnel() => Box::new(SmoothDiffuse {
                    color: self.color.map(|c| c * share),
                    interface,
                    component,
                }),
                Component::Reflection => Box::new(Lambert::reflection(&albedo)?),
                Component::Transmission => Box::new(Lambert::transmission(&albedo)?),
            };
            parts.push((part, weight));
        }
        if self.specularity > 0.0 {
            let rho = spectrum(self.gloss, self.specularity)?;
            let part: Box<dyn Bsdf> = match self.lobe {
                Width::Smooth => Box::new(Ideal(Law::Gloss(self.gloss, interface))),
                Width::Round(alpha) => Box::new(WardGmd::isotropic(&rho, alpha)?),
                Width::Oval(u, v, phi) => Box::new(WardGmd::anisotropic(&rho, u, v, phi)?),
            };
            parts.push((part, self.specularity * mean(self.gloss)));
        }
        if through > 0.0 && self.specularity < 1.0 {
            let tau = spectrum(self.color, through * (1.0 - self.specularity))?;
            let part: Box<dyn Bsdf> = match self.lobe {
                Width::Smooth => Box::new(Ideal(Law::Through(self.color.map(|c| c * through), interface))),
                Width::Round(alpha) => Box::new(Analytic::<TransmissionLobe>::of(&tau, &[alpha])?),
                Width::Oval(u, v, phi) => {
                    Box::new(Analytic::<AnisotropicTransmissionLobe>::of(&tau, &[u, v, phi])?)
                }
            };
            parts.push((part, through * (1.0 - self.specularity) * mean(self.color)));
        }
        // The shares add up to one at most, and each part keeps to its share but the transmitted lobes.
        sum(parts, smooth || through == 0.0)
    }
}

fn ashik2(m: &Ashik2) -> Result<Box<dyn Bsdf>, BsdfError> {
    let (power_u, power_v, azimuth) = match m.orientation.azimuth()? {
        Some(phi) => (m.power_u, m.power_v, phi),
        // RADIANCE's harmonic mean for a u that stands on the surface.
        None => {
            let mean = 2.0 / (1.0 / (m.power_u + 1e-5) + 1.0 / (m.power_v + 1e-5));
            (mean, mean, 0.0)
        }
    };
    let gloss = AshikGloss {
        specular: m.specular,
        power_u,
        power_v,
        azimuth,
    };
    let parts: Vec<Part> = vec![
        (Box::new(AshikDiffuse(m.diffuse)), mean(m.diffuse)),
        (Box::new(gloss), mean(m.specular)),
    ];
    // The gloss takes nothing off the diffuse part.
    sum(parts, false)
}

/// Reflection and transmission of a transparent thing.
fn pair(reflection: Law, transmission: Law) -> Result<Box<dyn Bsdf>, BsdfError> {
    let parts: Vec<Part> = vec![
        (Box::new(Ideal(reflection)), 0.3),
        (Box::new(Ideal(transmission)), 0.7),
    ];
    sum(parts, true)
}

fn spectrum(color: Rgb, factor: f64) -> Result<Spectrum, BsdfError> {
    let values: Vec<_> = CHANNELS
        .iter()
        .zip(color)
        .map(|(&channel, c)| (channel, c * factor))
        .collect();
    Spectrum::new("color", &values)
}

/// A part and how often to draw from it, relative to the others.
type Part = (Box<dyn Bsdf>, f64);

fn mean(color: Rgb) -> f64 {
    color.iter().sum::<f64>() / 3.0
}

/// The one part, or the sum of several.
fn sum(mut parts: Vec<Part>, energy_conserving: bool) -> Result<Box<dyn Bsdf>, BsdfError> {
    match parts.len() {
        0 => Ok(Box::new(Lambert::reflection(&spectrum([0.0; 3], 0.0)?)?)),
        1 => Ok(parts.remove(0).0),
        _ => Ok(Box::new(Sum::weighted(parts, energy_conserving)?)),
    }
}
