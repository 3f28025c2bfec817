//! Modifiers become materials.

use std::collections::HashMap;
use std::path::PathBuf;
use std::sync::Arc;

use gonio_bsdf::RadianceMaterial;
use gonio_io::radiance_material::Body;
use gonio_trace::material::Material;
use gonio_trace::pattern::{Paint, Pattern, Product, Shifts, Texture};

use super::Assembly;
use super::body::{Pane, interface, radiance};
use super::light::Emission;
use super::modifier::type_word;
use crate::error::{Place, SceneError};

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
