//! What names mean: the chain of modifiers behind a surface.

use std::collections::HashMap;
use std::sync::Arc;

use gonio_io::radiance_material::{Body, INHERIT, VOID};

use crate::error::{Place, SceneError};
use crate::text::Entry;

/// A modifier and the one it builds on.
#[derive(Clone, Debug)]
pub(super) struct Modifier {
    pub(super) id: String,
    pub(super) body: Arc<Body>,
    pub(super) place: Place,
    pub(super) parent: Option<usize>,
}

/// What a type of modifier does.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Class {
    /// It says how light is scattered or emitted.
    Material,
    /// It changes colour.
    Pattern,
    /// It turns the normal.
    Texture,
    /// gonio has no model for it.
    Unknown,
}

/// Patterns and textures behind a surface, at most.
const MOST: usize = 64;

/// All modifiers so far; a name means the last one above.
#[derive(Debug, Default)]
pub(super) struct Modifiers {
    all: Vec<Modifier>,
    names: HashMap<String, usize>,
}

impl Modifiers {
    pub(super) fn get(&self, k: usize) -> &Modifier {
        &self.all[k]
    }

    /// The modifier of this name, `None` for [`VOID`].
    pub(super) fn find(&self, name: &str, field: &str, place: &Place) -> Result<Option<usize>, SceneError> {
        if name == VOID {
            return Ok(None);
        }
        match self.names.get(name) {
            Some(k) => Ok(Some(*k)),
            None => Err(place.fault(
                field,
                format!("{name:?}"),
                "void or the name of a modifier that stands above",
            )),
        }
    }

    /// The modifier of this name that stands above modifier `k`, `None` for [`VOID`].
    pub(super) fn find_above(
        &self,
        k: usize,
        name: &str,
        field: &str,
        place: &Place,
    ) -> Result<Option<usize>, SceneError> {
        match self.all[..k].iter().rposition(|m| m.id == name) {
            Some(found) => Ok(Some(found)),
            None if name == VOID => Ok(None),
            None => Err(place.fault(
                field,
                format!("{name:?}"),
                "void or the name of a modifier that stands above",
            )),
        }
    }

    pub(super) fn define(&mut self, entry: Entry) -> Result<(), SceneError> {
        let Entry { item, place } = entry;
        // What an alias names stands where it stands: its arguments, and the files beside it.
        let (body, parent, place) = match &item.body {
            Body::Alias(of) => {
                let Some(target) = self.find(of, "alias", &place)? else {
                    return Err(place.fault(
                        "alias",
                        format!("{of:?}"),
                        "the name of a modifier that stands above",
                    ));
                };
                let target = &self.all[target];
                let parent = if item.modifier == INHERIT {
                    target.parent
                } else {
                    self.find(&item.modifier, "modifier", &place)?
                };
                (target.body.clone(), parent, target.place.clone())
            }
            _ => {
                let parent = self.find(&item.modifier, "modifier", &place)?;
                (Arc::new(item.body), parent, place)
            }
        };
        self.names.insert(item.id.clone(), self.all.len());
        self.all.push(Modifier {
            id: item.id,
            body,
            place,
            parent,
        });
        Ok(())
    }

    /// The material behind a modifier and the patterns and textures on the way and behind it.
    pub(super) fn chain(&self, first: usize) -> Result<Chain, SceneError> {
        let mut chain = Chain::default();
        let mut next = Some(first);
        while let Some(k) = next {
            let modifier = &self.all[k];
            match class(&modifier.body) {
                Class::Material if chain.material.is_some() => {
                    return Err(modifier.place.fault(
                        "modifier",
                        format!("{:?}, a second material", modifier.id),
                        "one material behind a surface",
                    ));
                }
                Class::Material => chain.material = Some(k),
                Class::Pattern | Class::Texture if chain.patterns.len() + chain.textures.len() >= MOST => {
                    return Err(modifier.place.fault(
                        "modifier",
                        format!("{:?}, one more pattern or texture", modifier.id),
                        format!("at most {MOST} behind a surface"),
                    ));
                }
                Class::Pattern => chain.patterns.push(k),
                Class::Texture => chain.textures.push(k),
                Class::Unknown => {
                    return Err(modifier.place.fault(
                        "type",
                        type_word(&modifier.body),
                        "a material, light or pattern that gonio renders (docs/formats/radiance-scene.md)",
                    ));
                }
            }
            next = modifier.parent;
        }
        Ok(chain)
    }
}

/// What stands behind a surface.
#[derive(Clone, Debug, Default)]
pub(super) struct Chain {
    pub(super) material: Option<usize>,
    pub(super) patterns: Vec<usize>,
    pub(super) textures: Vec<usize>,
}

pub(super) fn type_word(body: &Body) -> &str {
    match body {
        Body::Material(m) => m.type_word(),
        Body::Alias(_) => "alias",
        Body::Other { type_word, .. } => type_word,
    }
}

fn class(body: &Body) -> Class {
    match body {
        Body::Material(_) => Class::Material,
        Body::Alias(_) => Class::Unknown,
        Body::Other { type_word, .. } => match type_word.as_str() {
            "light" | "illum" | "glow" | "spotlight" | "BSDF" | "aBSDF" | "interface" | "mixfunc"
            | "mixdata" | "mixpict" | "mixtext" => Class::Material,
            word if super::function::TYPES.contains(&word) => Class::Material,
            "brightfunc" | "colorfunc" | "brightdata" | "colordata" | "brighttext" | "colortext"
            | "colorpict" => Class::Pattern,
            "texfunc" | "texdata" => Class::Texture,
            _ => Class::Unknown,
        },
    }
}
