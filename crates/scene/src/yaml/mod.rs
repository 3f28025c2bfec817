//! Scenes without RADIANCE text: meshes, materials by name and a sky in one YAML file (docs/formats/scene-yaml.md).
//!
//! The file becomes the items of RADIANCE text that say the same, each with the place of its field.

mod material;
mod node;
mod object;
mod sky;
#[cfg(test)]
mod tests;

use std::collections::HashSet;
use std::path::Path;

use gonio_io::radiance_material::{Body, Item, VOID};
use gonio_io::read_bytes;
use gonio_trace::camera::View;

use crate::error::{Place, SceneError};
use crate::text::{self, Entry, Files};
use crate::view;

use node::Field;

/// What a file holds.
#[derive(Clone, Debug)]
pub struct YamlScene {
    /// As items of RADIANCE text.
    pub entries: Vec<Entry>,
    /// The view that it names.
    pub view: Option<View>,
}

/// Whether a file is read as YAML: by its ending, `.yaml` or `.yml`.
pub fn is_yaml(path: &Path) -> bool {
    path.extension()
        .is_some_and(|e| e.eq_ignore_ascii_case("yaml") || e.eq_ignore_ascii_case("yml"))
}

/// The scene of a YAML file; what it names is looked for beside it and along the list of `files`.
///
/// # Errors
/// [`SceneError`] naming file, line and field: text that is no YAML, unknown fields, values out of range, files that are not
/// there or cannot be read, materials that are not defined.
pub fn read(path: &Path, files: &Files) -> Result<YamlScene, SceneError> {
    read_from(path, &read_bytes(path)?, files)
}

/// [`read`] of bytes in memory; `path` appears in errors, and files are found as beside it.
///
/// # Errors
/// As [`read`].
pub fn read_from(path: &Path, bytes: &[u8], files: &Files) -> Result<YamlScene, SceneError> {
    node::parse(path, bytes, |root| scene(&root, files))
}

/// Units of length in metres.
const UNITS: [(&str, f64); 5] = [
    ("m", 1.0),
    ("cm", 0.01),
    ("mm", 0.001),
    ("in", 0.0254),
    ("ft", 0.3048),
];

/// Materials that a message names, at most.
const MOST_NAMED: usize = 12;

/// Which axis of a mesh points up.
const UP: [(&str, Up); 2] = [("z", Up::Z), ("y", Up::Y)];

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Up {
    Y,
    Z,
}

/// What the files of meshes are read with.
#[derive(Clone, Copy)]
struct Axes {
    metres: f64,
    up: Up,
}

impl Axes {
    /// Of the fields `units` and `up`, where they are given.
    fn of(units: Option<&Field<'_>>, up: Option<&Field<'_>>, otherwise: Axes) -> Result<Self, SceneError> {
        Ok(Axes {
            metres: units.map_or(Ok(otherwise.metres), |f| f.one_of(&UNITS))?,
            up: up.map_or(Ok(otherwise.up), |f| f.one_of(&UP))?,
        })
    }
}

fn scene(root: &Field<'_>, files: &Files) -> Result<YamlScene, SceneError> {
    let record = root.record(&["units", "up", "radiance", "materials", "objects", "sky", "view"])?;
    let plain = Axes {
        metres: 1.0,
        up: Up::Z,
    };
    let axes = Axes::of(record.get("units"), record.get("up"), plain)?;
    let mut entries = Vec::new();
    if let Some(list) = record.get("radiance") {
        for field in list.entries("a list of files of Radiance text")? {
            let name = field.text("a file of Radiance text")?;
            let path = files.find_for(&name, &field.name, &field.place())?;
            entries.extend(text::read(&path, files)?);
        }
    }
    let objects = match record.get("objects") {
        Some(field) => object::read(field, axes, files)?,
        None => Vec::new(),
    };
    let materials = match record.get("materials") {
        Some(field) => field.fields("names and their materials")?,
        None => Vec::new(),
    };
    // What objects ask for comes first: a lamp whose name is misspelt at its object would else be blamed for having no area.
    let above = entries.iter().map(|e| e.item.id.as_str());
    let known: HashSet<String> = above
        .chain(materials.iter().map(|(name, _)| name.as_str()))
        .map(str::to_owned)
        .collect();
    let mut aliases = Vec::new();
    let mut needed = HashSet::new();
    for (name, field, place) in objects.iter().flat_map(object::Object::needs) {
        if name == VOID || !needed.insert(name) {
            continue;
        }
        if !known.contains(name) {
            let mut names: Vec<&str> = materials.iter().map(|(name, _)| name.as_str()).collect();
            names.truncate(MOST_NAMED);
            names.push(VOID);
            let allowed = format!("the name of a material of this scene: {}", names.join(", "));
            return Err(place.fault(field, format!("{name:?}"), allowed));
        }
        aliases.push(alias(&object::kept(name), name, &place));
    }
    drop(needed);
    for (name, field) in &materials {
        entries.push(material::read(name, field, &objects)?);
    }
    entries.extend(aliases);
    for object in objects {
        object.entries(&mut entries);
    }
    if let Some(field) = record.get("sky") {
        entries.extend(sky::read(field)?);
    }
    let view = match record.get("view") {
        None => None,
        Some(field) => {
            let text = field.text("options of a view, such as -vtv -vp 0 0 1 -vd 0 1 0 -vh 60 -vv 40")?;
            let words: Vec<&str> = text.split_whitespace().collect();
            let made = view::parse(view::STANDARD, &words);
            Some(made.map_err(|e| field.fault(format!("{text:?}: {e}"), "options of a view"))?)
        }
    };
    Ok(YamlScene { entries, view })
}

/// An item that is no material of its own.
fn item(
    modifier: &str,
    type_word: &str,
    id: &str,
    strings: Vec<String>,
    reals: Vec<f64>,
    place: &Place,
) -> Entry {
    Entry {
        item: Item {
            modifier: modifier.into(),
            id: id.into(),
            body: Body::Other {
                type_word: type_word.into(),
                strings,
                integers: vec![],
                reals,
            },
            line: place.line,
        },
        place: place.clone(),
    }
}

/// Another name.
fn alias(id: &str, of: &str, place: &Place) -> Entry {
    Entry {
        item: Item {
            modifier: VOID.into(),
            id: id.into(),
            body: Body::Alias(of.into()),
            line: place.line,
        },
        place: place.clone(),
    }
}
