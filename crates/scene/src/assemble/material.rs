//! Modifiers become materials.

use std::collections::HashMap;
use std::path::PathBuf;
use std::sync::Arc;

use glam::{DVec3, Vec3};
use gonio_bsdf::radiance::{Dielectric, Orientation};
use gonio_bsdf::{Bsdf, BsdfError, RadianceMaterial};
use gonio_io::radiance_material::Body;
use gonio_trace::material::Material;
use gonio_trace::pattern::{Paint, Pattern, Product, Shifts, Texture};
use gonio_trace::scene::Upward;
use gonio_trace::travel::Body as Inside;

use super::Assembly;
use super::light::Emission;
use super::modifier::type_word;
use super::up::Up;
use crate::error::{Place, SceneError};
use crate::text::{Files, Xform};

/// How surfaces of one modifier look.
#[derive(Clone, Default)]
pub(super) struct Look {
    /// Index of the material; `None` where there is nothing to see.
    pub(super) material: Option<u32>,
    pub(super) paint: Option<u32>,
    pub(super) texture: Option<u32>,
    pub(super) mixture: Option<u32>,
    pub(super) emission: Option<Emission>,
    /// Index of what turns the material from place to place.
    pub(super) up: Option<u32>,
    /// Index of the body that its surfaces bound.
    pub(super) body: Option<u32>,
    /// Thickness of the geometry that it stands for.
    pub(super) proxy: f32,
    /// How light comes through, if it does as through a window.
    pub(super) pane: Option<Pane>,
    /// The surface that all of this look share, unless it emits.
    pub(super) surface: Option<u32>,
}

/// What stands before a modifier on the way from the surface.
#[derive(Clone, Default)]
pub(super) struct Above {
    pub(super) patterns: Vec<usize>,
    pub(super) textures: Vec<usize>,
    /// How many mixtures.
    pub(super) mixtures: usize,
    /// Whether it is the other material of a light.
    pub(super) alternate: bool,
}

/// What has been made so far.
#[derive(Default)]
pub(super) struct Materials {
    looks: HashMap<usize, Look>,
    /// Models of BSDF files.
    pub(super) files: HashMap<PathBuf, super::bsdf::File>,
    black: Option<u32>,
    nothing: Option<u32>,
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
    pub(super) pane: Option<Pane>,
    /// What turns it from place to place.
    pub(super) up: Option<Arc<dyn Upward>>,
    pub(super) body: Option<Inside>,
    pub(super) proxy: f32,
}

impl From<Material> for Body0 {
    fn from(material: Material) -> Self {
        Body0 {
            material,
            bare: None,
            pane: None,
            up: None,
            body: None,
            proxy: 0.0,
        }
    }
}

/// How a window lets light through.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Pane {
    /// Straight, as glass does.
    Clear,
    /// Scattered, as a blind does.
    Scattering,
}

impl Assembly<'_> {
    /// The look of surfaces of this modifier.
    pub(super) fn look(&mut self, modifier: usize) -> Result<Look, SceneError> {
        if let Some(look) = self.materials.looks.get(&modifier) {
            return Ok(look.clone());
        }
        let look = self.make_look(modifier, Above::default())?;
        self.materials.looks.insert(modifier, look.clone());
        Ok(look)
    }

    pub(super) fn make_look(&mut self, modifier: usize, mut above: Above) -> Result<Look, SceneError> {
        let chain = self.modifiers.chain(modifier)?;
        above.patterns.extend(&chain.patterns);
        above.textures.extend(&chain.textures);
        let mut look = Look::default();
        let Some(k) = chain.material else {
            let place = self.modifiers.get(modifier).place.clone();
            self.warn(
                &place,
                "no material behind this modifier: surfaces of it are not there",
            );
            return Ok(look);
        };
        let (body, place) = {
            let m = self.modifiers.get(k);
            (m.body.clone(), m.place.clone())
        };
        if type_word(&body).starts_with("mix") {
            return self.mixture(k, above);
        }
        if above.mixtures > 0 && super::mixture::bends(&body) {
            let allowed = "a material that light passes straight or not at all";
            return Err(place.fault("mixture", type_word(&body), allowed));
        }
        let patterns = self.patterns(&above.patterns)?;
        if let Some(emission) = super::light::emission(&body, &place)? {
            if above.alternate || above.mixtures > 0 {
                let field = if above.alternate {
                    "alternate material"
                } else {
                    "mixture"
                };
                return Err(place.fault(field, "a light", "a material that does not emit"));
            }
            if let Some(name) = emission.alternate.clone() {
                match self.modifiers.find(&name, "alternate material", &place)? {
                    None => look.material = Some(self.nothing()),
                    Some(other) => {
                        let alternate = Above {
                            alternate: true,
                            ..Above::default()
                        };
                        let alternate = self.make_look(other, alternate)?;
                        look = Look {
                            material: alternate.material.or_else(|| Some(self.nothing())),
                            surface: None,
                            proxy: 0.0,
                            pane: None,
                            ..alternate
                        };
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
            Body::Material(m) => radiance(m, patterns.is_some(), &place, self.files)?,
            Body::Other {
                type_word,
                strings,
                reals,
                ..
            } if type_word == "interface" => interface(strings, reals, &place)?,
            Body::Other {
                type_word,
                strings,
                reals,
                ..
            } if super::function::TYPES.contains(&type_word.as_str()) => {
                super::function::material(type_word, strings, reals, &place, self.files)?.into()
            }
            Body::Other {
                type_word,
                strings,
                reals,
                ..
            } => self.bsdf(type_word, strings, reals, patterns.is_some(), &place)?,
            Body::Alias(_) => return Ok(look),
        };
        if let Body::Material(m) = &*body {
            self.remark(m, &place);
        }
        look.texture = self.textures(&above.textures)?;
        look.pane = made.pane;
        look.proxy = made.proxy;
        if let Some(up) = made.up {
            self.parts.ups.push(up);
            look.up = Some((self.parts.ups.len() - 1) as u32);
        }
        if let Some(body) = made.body {
            self.parts.bodies.push(body);
            look.body = Some((self.parts.bodies.len() - 1) as u32);
        }
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

    /// The index of the sum of textures, `None` without any.
    fn textures(&mut self, all: &[usize]) -> Result<Option<u32>, SceneError> {
        let mut made: Vec<Arc<dyn Texture>> = Vec::with_capacity(all.len());
        for k in all {
            let modifier = self.modifiers.get(*k).clone();
            made.push(super::pattern::texture(&modifier, self.files)?);
        }
        let texture: Arc<dyn Texture> = match made.len() {
            0 => return Ok(None),
            1 => made.remove(0),
            _ => Arc::new(Shifts(made)),
        };
        self.parts.textures.push(texture);
        Ok(Some((self.parts.textures.len() - 1) as u32))
    }

    /// What light passes as if it were not there.
    pub(super) fn nothing(&mut self) -> u32 {
        match self.materials.nothing {
            Some(k) => k,
            None => {
                let k = self.push(Material::Nothing);
                self.materials.nothing = Some(k);
                k
            }
        }
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
        value.ok_or_else(|| place.fault("ux uy uz", format!("{text:?}"), "finite numbers, or functions"))
    };
    let u = DVec3::new(number(x)?, number(y)?, number(z)?);
    let (xform, used) = Xform::parse(transform).map_err(|(f, a)| place.fault("transform", f, a))?;
    let up = xform.vector(u).normalize_or_zero();
    if up == DVec3::ZERO {
        let found = format!("{x} {y} {z} {}", transform.join(" "));
        return Err(place.fault("ux uy uz", found, "a direction that is not zero"));
    }
    match transform.get(used) {
        None => Ok(up),
        Some(word) => Err(place.fault("transform", format!("{word:?}"), "options of xform")),
    }
}

fn radiance(
    m: &RadianceMaterial,
    patterned: bool,
    place: &Place,
    files: &Files,
) -> Result<Body0, SceneError> {
    let plain = |color| {
        Body0::from(Material::Diffuse {
            reflectance: colour(color),
        })
    };
    match m {
        RadianceMaterial::Plastic(p) if p.specularity == 0.0 => return Ok(plain(p.color)),
        RadianceMaterial::Metal(p) if p.specularity == 0.0 => return Ok(plain(p.color)),
        RadianceMaterial::Trans(p) if p.specularity == 0.0 && p.transmissivity == 0.0 => {
            return Ok(plain(p.color));
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
        up = Some(Up::read(&strings, &m.reals(), place, files)?);
    }
    let body = match m {
        RadianceMaterial::Dielectric(d) => Some(Inside {
            inside: extinction(d.transmissivity),
            outside: None,
            index: d.index() as f32,
        }),
        _ => None,
    };
    let model: Arc<dyn Bsdf> = local.bsdf().map_err(wrong)?.into();
    let bare = match patterned {
        true => bare(&local)
            .map(|b| b.bsdf().map_err(wrong))
            .transpose()?
            .map(Arc::from),
        false => None,
    };
    Ok(Body0 {
        bare,
        pane: matches!(m, RadianceMaterial::Glass(_)).then_some(Pane::Clear),
        up: up.clone().and_then(Up::field),
        body,
        ..Body0::from(Material::model(model, up.and_then(|u| u.fixed())))
    })
}

/// Extinction of a transmissivity of unit length; black media let nothing through that can be told from it.
fn extinction(transmissivity: [f64; 3]) -> Vec3 {
    colour(transmissivity.map(|t| if t < 1e-40 { 100.0 } else { -t.min(1.0).ln() }))
}

/// `interface`: the boundary of a dielectric that lies in another [Radiance, rt/dielectric.c].
fn interface(strings: &[String], reals: &[f64], place: &Place) -> Result<Body0, SceneError> {
    let [r1, g1, b1, n1, r2, g2, b2, n2] = *reals else {
        return Err(place.fault(
            "real arguments",
            reals.len().to_string(),
            "8: transmissivity and index behind the surface, and before it",
        ));
    };
    if !strings.is_empty() {
        return Err(place.fault("string arguments", strings.len().to_string(), "0"));
    }
    if let Some(bad) = [r1, g1, b1, r2, g2, b2]
        .iter()
        .find(|t| !(0.0..=1.0).contains(*t))
    {
        return Err(place.fault("transmissivity", bad.to_string(), "0 to 1"));
    }
    if let Some(bad) = [n1, n2].iter().find(|n| !(0.1..=10.0).contains(*n)) {
        return Err(place.fault("index", bad.to_string(), "0.1 to 10"));
    }
    let boundary = RadianceMaterial::Dielectric(Dielectric {
        transmissivity: [1.0; 3],
        refractive_index: n1 / n2,
        hartmann: 0.0,
    });
    let wrong = |e: BsdfError| place.fault("interface", e.to_string(), "indices of a ratio from 0.1 to 10");
    let model: Arc<dyn Bsdf> = boundary.bsdf().map_err(wrong)?.into();
    Ok(Body0 {
        body: Some(Inside {
            inside: extinction([r1, g1, b1]),
            outside: Some(extinction([r2, g2, b2])),
            index: (n1 / n2) as f32,
        }),
        ..Body0::from(Material::model(model, None))
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
