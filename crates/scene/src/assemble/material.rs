//! Modifiers become materials.

use std::collections::HashMap;
use std::path::PathBuf;
use std::sync::Arc;

use glam::{DVec3, Vec3};
use gonio_bsdf::radiance::Orientation;
use gonio_bsdf::{Bsdf, BsdfError, RadianceMaterial};
use gonio_io::radiance_material::Body;
use gonio_trace::material::Material;
use gonio_trace::pattern::{Paint, Pattern, Product};

use super::Assembly;
use super::light::Emission;
use crate::error::{Place, SceneError};
use crate::text::Xform;

/// How surfaces of one modifier look.
#[derive(Clone)]
pub(super) struct Look {
    /// Index of the material; `None` where there is nothing to see.
    pub(super) material: Option<u32>,
    pub(super) paint: Option<u32>,
    pub(super) emission: Option<Emission>,
    /// Whether light comes through as through a window.
    pub(super) pane: bool,
    /// The surface that all of this look share, unless it emits.
    pub(super) surface: Option<u32>,
}

/// What has been made so far.
#[derive(Default)]
pub(super) struct Materials {
    looks: HashMap<usize, Look>,
    /// Models of BSDF files.
    pub(super) files: HashMap<PathBuf, Arc<dyn Bsdf>>,
    black: Option<u32>,
}

impl Materials {
    pub(super) fn share(&mut self, modifier: usize, surface: u32) {
        if let Some(look) = self.looks.get_mut(&modifier) {
            look.surface = Some(surface);
        }
    }
}

/// A material as it is without emission and patterns.
pub(super) struct Body0 {
    pub(super) material: Material,
    /// The part that patterns leave.
    pub(super) bare: Option<Arc<dyn Bsdf>>,
    pub(super) pane: bool,
}

impl Assembly<'_> {
    /// The look of surfaces of this modifier.
    pub(super) fn look(&mut self, modifier: usize) -> Result<Look, SceneError> {
        if let Some(look) = self.materials.looks.get(&modifier) {
            return Ok(look.clone());
        }
        let look = self.make_look(modifier, true)?;
        self.materials.looks.insert(modifier, look.clone());
        Ok(look)
    }

    fn make_look(&mut self, modifier: usize, may_emit: bool) -> Result<Look, SceneError> {
        let chain = self.modifiers.chain(modifier)?;
        for k in &chain.textures {
            let texture = self.modifiers.get(*k).clone();
            self.warn(
                &texture.place,
                format!("texture {:?} is left out: surfaces stay smooth", texture.id),
            );
        }
        let mut look = Look {
            material: None,
            paint: None,
            emission: None,
            pane: false,
            surface: None,
        };
        let Some(k) = chain.material else {
            let place = self.modifiers.get(modifier).place.clone();
            self.warn(
                &place,
                "no material behind this modifier: surfaces of it are not there",
            );
            return Ok(look);
        };
        let patterns = self.patterns(&chain.patterns)?;
        let (body, place) = {
            let m = self.modifiers.get(k);
            (m.body.clone(), m.place.clone())
        };
        if let Some(emission) = super::light::emission(&body, &place)? {
            if !may_emit {
                return Err(place.fault("alternate material", "a light", "a material that does not emit"));
            }
            if let Some(name) = emission.alternate.clone() {
                match self.modifiers.find(&name, "alternate material", &place)? {
                    None => look.material = Some(self.push(Material::Nothing)),
                    Some(other) => {
                        let alternate = self.make_look(other, false)?;
                        look.material = alternate.material.or_else(|| Some(self.push(Material::Nothing)));
                        look.paint = alternate.paint;
                    }
                }
            } else {
                look.material = Some(self.black());
            }
            look.emission = Some(Emission {
                pattern: patterns,
                ..emission
            });
            return Ok(look);
        }
        let made = match &*body {
            Body::Material(m) => radiance(m, patterns.is_some(), &place)?,
            Body::Other {
                type_word,
                strings,
                reals,
                ..
            } => self.bsdf(type_word, strings, reals, &place)?,
            Body::Alias(_) => return Ok(look),
        };
        if let Body::Material(m) = &*body {
            self.remark(m, &place);
        }
        look.pane = made.pane;
        look.material = Some(self.push(made.material));
        look.paint = patterns.map(|pattern| {
            self.parts.paints.push(Paint {
                pattern,
                bare: made.bare,
            });
            (self.parts.paints.len() - 1) as u32
        });
        Ok(look)
    }

    /// What is read of a material otherwise than RADIANCE does.
    fn remark(&mut self, m: &RadianceMaterial, place: &Place) {
        match m {
            RadianceMaterial::Dielectric(_) if m.reals().iter().take(3).any(|t| *t < 1.0) => {
                self.warn(place, "light is not absorbed inside this dielectric");
            }
            RadianceMaterial::Mirror(_) if !m.strings().is_empty() => {
                self.warn(place, "the other material of this mirror is left out");
            }
            _ => {}
        }
    }

    /// The product of patterns, `None` without any.
    fn patterns(&mut self, all: &[usize]) -> Result<Option<Arc<dyn Pattern>>, SceneError> {
        let mut made: Vec<Arc<dyn Pattern>> = Vec::with_capacity(all.len());
        for k in all {
            let modifier = self.modifiers.get(*k).clone();
            made.push(super::pattern::pattern(&modifier, self.files)?);
        }
        Ok(match made.len() {
            0 => None,
            1 => made.pop(),
            _ => Some(Arc::new(Product(made))),
        })
    }

    fn push(&mut self, material: Material) -> u32 {
        self.parts.materials.push(material);
        (self.parts.materials.len() - 1) as u32
    }

    fn black(&mut self) -> u32 {
        match self.materials.black {
            Some(k) => k,
            None => {
                let k = self.push(Material::Black);
                self.materials.black = Some(k);
                k
            }
        }
    }
}

pub(super) fn colour(rgb: [f64; 3]) -> Vec3 {
    DVec3::from_array(rgb).as_vec3()
}

/// The part of the arguments of anisotropic materials and BSDFs that says which way is up: `ux uy uz file transform…`.
pub(super) fn direction(strings: &[String], place: &Place) -> Result<DVec3, SceneError> {
    let [x, y, z, _, transform @ ..] = strings else {
        return Err(place.fault(
            "string arguments",
            strings.len().to_string(),
            "ux uy uz file transform…",
        ));
    };
    let number = |text: &String| {
        let value = text.parse::<f64>().ok().filter(|v| v.is_finite());
        value.ok_or_else(|| {
            place.fault(
                "ux uy uz",
                format!("{text:?}"),
                "numbers: a direction that changes over the surface is not followed",
            )
        })
    };
    let u = DVec3::new(number(x)?, number(y)?, number(z)?);
    let (xform, used) = Xform::parse(transform).map_err(|(f, a)| place.fault("transform", f, a))?;
    match transform.get(used) {
        None => Ok(xform.vector(u)),
        Some(word) => Err(place.fault("transform", format!("{word:?}"), "options of xform")),
    }
}

fn radiance(m: &RadianceMaterial, patterned: bool, place: &Place) -> Result<Body0, SceneError> {
    let plain = |color, pane| Body0 {
        material: Material::Diffuse {
            reflectance: colour(color),
        },
        bare: None,
        pane,
    };
    match m {
        RadianceMaterial::Plastic(p) if p.specularity == 0.0 => return Ok(plain(p.color, false)),
        RadianceMaterial::Metal(p) if p.specularity == 0.0 => return Ok(plain(p.color, false)),
        RadianceMaterial::Trans(p) if p.specularity == 0.0 && p.transmissivity == 0.0 => {
            return Ok(plain(p.color, false));
        }
        _ => {}
    }
    let wrong = |e: BsdfError| place.fault(m.type_word(), e.to_string(), "a material with a model");
    // RADIANCE's u is a direction of the world; the model's lies in the surface, along its y.
    let mut local = m.clone();
    let along_y = Orientation::from_azimuth(std::f64::consts::FRAC_PI_2).map_err(wrong)?;
    let strings = m.strings();
    let mut up = None;
    let aside = match &mut local {
        RadianceMaterial::Plastic2(p) => Some(&mut p.orientation),
        RadianceMaterial::Metal2(p) => Some(&mut p.orientation),
        RadianceMaterial::Trans2(p) => Some(&mut p.orientation),
        RadianceMaterial::Ashik2(p) => Some(&mut p.orientation),
        _ => None,
    };
    if let Some(orientation) = aside {
        *orientation = along_y;
        up = Some(direction(&strings, place)?.as_vec3());
    }
    let model: Arc<dyn Bsdf> = local.bsdf().map_err(wrong)?.into();
    let bare = match patterned {
        true => bare(&local)
            .map(|b| b.bsdf().map_err(wrong))
            .transpose()?
            .map(Arc::from),
        false => None,
    };
    Ok(Body0 {
        material: Material::model(model, up),
        bare,
        pane: matches!(m, RadianceMaterial::Glass(_)),
    })
}

/// The material with a black pattern, where that leaves something: patterns colour all of a metal, but not the gloss of
/// plastic [Radiance, rt/normal.c].
fn bare(m: &RadianceMaterial) -> Option<RadianceMaterial> {
    let mut bare = m.clone();
    match &mut bare {
        RadianceMaterial::Plastic(p) => p.color = [0.0; 3],
        RadianceMaterial::Plastic2(p) => p.color = [0.0; 3],
        RadianceMaterial::Trans(p) => p.color = [0.0; 3],
        RadianceMaterial::Trans2(p) => p.color = [0.0; 3],
        RadianceMaterial::Ashik2(p) => p.diffuse = [0.0; 3],
        _ => return None,
    }
    Some(bare)
}
