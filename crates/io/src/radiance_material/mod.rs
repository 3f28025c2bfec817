//! RADIANCE scene text (`.rad`), the materials of it (docs/formats/radiance-material.md).
//!
//! An item is `modifier type id` and three counted argument lists: strings, integers, reals. The ten types of
//! [`RadianceMaterial`] become materials; every other type of RADIANCE is kept as it stands. Lines that start with `!`
//! are commands: they are refused, never run.

mod read;
#[cfg(test)]
mod tests;
mod words;
mod write;

use std::collections::HashMap;
use std::path::Path;

use gonio_bsdf::RadianceMaterial;

use crate::IoError;

pub use read::{read, read_from, scan};
pub use write::{to_text, write};

/// The modifier of an item that has none.
pub const VOID: &str = "void";
/// The modifier of an alias that takes over the modifier of what it names.
pub const INHERIT: &str = "inherit";
/// The type word of an alias.
const ALIAS: &str = "alias";

/// The other types of RADIANCE: light sources, patterns, textures, mixtures, materials gonio has no model for, and
/// surfaces.
#[rustfmt::skip]
pub const OTHER_TYPES: [&str; 45] = [
    "polygon", "cone", "sphere", "texfunc", "ring", "cylinder", "instance", "cup", "bubble", "tube", "mesh",
    "interface", "plasfunc", "metfunc", "brightfunc", "brightdata", "brighttext", "colorpict", "glow", "source",
    "light", "illum", "spotlight", "mist", "transfunc", "BRTDfunc", "BSDF", "aBSDF", "plasdata", "metdata",
    "transdata", "colorfunc", "antimatter", "colordata", "colortext", "texdata", "mixfunc", "mixdata", "mixtext",
    "mixpict", "prism1", "prism2", "spectrum", "specfile", "specfunc",
];

/// One item of a scene.
#[derive(Clone, Debug, PartialEq)]
pub struct Item {
    /// Name of the pattern, texture, material or light the item builds on, or [`VOID`].
    pub modifier: String,
    /// Its own name.
    pub id: String,
    /// What it is.
    pub body: Body,
    /// Line of its first word, counted from 1; 0 for an item that was not read from a file.
    pub line: u64,
}

/// What stands in scene text.
#[derive(Clone, Debug, PartialEq)]
#[expect(
    clippy::large_enum_variant,
    reason = "handed on one at a time, nearly all are items"
)]
pub enum Found {
    /// An item.
    Item(Item),
    /// A line that starts with `!`.
    Command {
        /// The line, the `!` included.
        text: String,
        /// Its line, counted from 1.
        line: u64,
    },
}

/// What an item is.
#[derive(Clone, Debug, PartialEq)]
pub enum Body {
    /// A material gonio knows.
    Material(RadianceMaterial),
    /// Another name for the item of this id.
    Alias(String),
    /// An item of another type.
    Other {
        /// One of [`OTHER_TYPES`].
        type_word: String,
        /// String arguments.
        strings: Vec<String>,
        /// Integer arguments.
        integers: Vec<i64>,
        /// Real arguments.
        reals: Vec<f64>,
    },
}

impl Item {
    /// A material named `id` without a modifier.
    pub fn material(id: impl Into<String>, material: impl Into<RadianceMaterial>) -> Self {
        Item {
            modifier: VOID.into(),
            id: id.into(),
            body: Body::Material(material.into()),
            line: 0,
        }
    }
}

/// A material under its name.
#[derive(Clone, Debug, PartialEq)]
pub struct NamedMaterial {
    /// Its name.
    pub id: String,
    /// The pattern or texture that changes it over the surface, or [`VOID`].
    pub modifier: String,
    /// The material.
    pub material: RadianceMaterial,
    /// Line of the item (of the alias, where the name is one), counted from 1.
    pub line: u64,
}

/// The materials among `items`, aliases of materials included, in order; a name that is given twice stands twice.
///
/// # Errors
/// [`IoError::Format`] with `path` and the line of an alias of something that does not stand above it.
pub fn materials(path: &Path, items: &[Item]) -> Result<Vec<NamedMaterial>, IoError> {
    // Per name the place among `found` of what it means now; `None` is something other than a material.
    let mut meaning: HashMap<&str, Option<usize>> = HashMap::new();
    let mut found: Vec<NamedMaterial> = Vec::new();
    for item in items {
        let (material, modifier) = match &item.body {
            Body::Material(m) => (m.clone(), item.modifier.clone()),
            Body::Other { .. } => {
                meaning.insert(&item.id, None);
                continue;
            }
            Body::Alias(of) => match meaning.get(of.as_str()) {
                Some(&Some(k)) => {
                    let inherited = item.modifier == INHERIT;
                    let modifier = if inherited {
                        &found[k].modifier
                    } else {
                        &item.modifier
                    };
                    (found[k].material.clone(), modifier.clone())
                }
                Some(None) => {
                    meaning.insert(&item.id, None);
                    continue;
                }
                None => {
                    return Err(IoError::format(
                        path,
                        item.line,
                        "alias",
                        format!("{of:?}"),
                        "the name of an item above it",
                    ));
                }
            },
        };
        meaning.insert(&item.id, Some(found.len()));
        found.push(NamedMaterial {
            id: item.id.clone(),
            modifier,
            material,
            line: item.line,
        });
    }
    Ok(found)
}
