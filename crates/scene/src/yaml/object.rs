//! Objects: meshes in files, where they stand, what they are made of.

use gonio_io::radiance_material::VOID;

use super::node::Field;
use super::{Axes, Up, alias, item};
use crate::error::{Place, SceneError};
use crate::mesh::{self, Mesh};
use crate::text::{Entry, Files, Xform};

/// A mesh of a file.
pub(super) struct Object {
    id: String,
    /// As the scene names it.
    file: String,
    mesh: Mesh,
    xform: Xform,
    /// The transform as words.
    words: Vec<String>,
    material: Stuff,
    place: Place,
}

/// What an object is made of.
enum Stuff {
    /// One material.
    One(String),
    /// For the names in the file, names of the scene, with their places; others stand for themselves.
    Named(Vec<(String, String, Place)>),
}

pub(super) fn read(field: &Field<'_>, axes: Axes, files: &Files) -> Result<Vec<Object>, SceneError> {
    let entries = field.entries("a list of objects: {file: …, material: …}")?;
    let mut out = Vec::with_capacity(entries.len());
    for entry in entries {
        out.push(object(&entry, axes, files)?);
    }
    Ok(out)
}

fn object(field: &Field<'_>, axes: Axes, files: &Files) -> Result<Object, SceneError> {
    let record = field.record(&["file", "material", "materials", "units", "up", "transform"])?;
    let named = record.need("file")?;
    let file = named.text("a mesh .obj .ply .stl .gltf .glb")?;
    let path = files.find_for(&file, &named.name, &named.place())?;
    let lower = file.to_ascii_lowercase();
    // glTF says itself: metres, and its reader has turned it upright.
    let otherwise = if lower.ends_with(".gltf") || lower.ends_with(".glb") {
        Axes {
            metres: 1.0,
            up: Up::Z,
        }
    } else {
        axes
    };
    let axes = Axes::of(record.get("units"), record.get("up"), otherwise)?;
    let mut words: Vec<String> = Vec::new();
    if axes.metres != 1.0 {
        words.extend(["-s".into(), axes.metres.to_string()]);
    }
    if axes.up == Up::Y {
        words.extend(["-rx".into(), "90".into()]);
    }
    if let Some(field) = record.get("transform") {
        let text = field.text("options of xform, such as -rz 30 -t 1 2 0")?;
        let given: Vec<&str> = text.split_whitespace().collect();
        let (_, used) = Xform::parse(&given).map_err(|(found, allowed)| field.fault(found, allowed))?;
        if let Some(word) = given.get(used) {
            return Err(field.fault(format!("{word:?}"), "options of xform"));
        }
        words.extend(given.iter().map(|w| (*w).to_owned()));
    }
    let (xform, _) = Xform::parse(&words).map_err(|(found, allowed)| field.fault(found, allowed))?;
    let material = match (record.get("material"), record.get("materials")) {
        (Some(one), None) => Stuff::One(one.text("the name of a material")?),
        (Some(_), Some(_)) => {
            return Err(field.fault("both", "material, for all of it, or materials, by name"));
        }
        (None, None) => Stuff::Named(Vec::new()),
        (None, Some(map)) => {
            let mut all = Vec::new();
            for (name, field) in map.fields("names in the file and names of materials")? {
                all.push((name, field.text("the name of a material")?, field.place()));
            }
            Stuff::Named(all)
        }
    };
    let mesh = mesh::read(&path)?;
    let names: Vec<&str> = mesh.parts.iter().map(|p| p.material.as_str()).collect();
    if let Stuff::Named(all) = &material {
        if names.is_empty() {
            return Err(field.fault("a mesh without materials", "material: the name of one"));
        }
        if let Some((name, _, place)) = all.iter().find(|(name, ..)| !names.contains(&name.as_str())) {
            let allowed = format!("a material of the file: {}", names.join(", "));
            return Err(place.fault(format!("{}.materials", field.name), format!("{name:?}"), allowed));
        }
        // A part without name has nothing to stand for itself.
        if names.contains(&"") && !all.iter().any(|(name, ..)| name.is_empty()) {
            let allowed = "materials: {\"\": the material of surfaces without one, …}";
            return Err(field.fault("surfaces without material in the file", allowed));
        }
    }
    Ok(Object {
        id: field.name.clone(),
        file,
        mesh,
        xform,
        words,
        material,
        place: named.place(),
    })
}

impl Object {
    /// Area that is made of a material, m2.
    pub(super) fn area(&self, material: &str) -> f64 {
        let all = 0..self.mesh.triangles.len();
        let ranges: Vec<_> = match &self.material {
            Stuff::One(name) if name == material => vec![all],
            Stuff::One(_) => return 0.0,
            Stuff::Named(map) => {
                let meant = |name: &str| {
                    let mapped = map.iter().find(|(n, ..)| n == name);
                    mapped.map_or(name == material, |(_, m, _)| m == material)
                };
                let pieces = self.mesh.pieces().filter(|(name, _)| meant(name));
                pieces.map(|(_, range)| range).collect()
            }
        };
        let corner = |k: u32| self.mesh.points[k as usize];
        let area = |[a, b, c]: [u32; 3]| 0.5 * (corner(b) - corner(a)).cross(corner(c) - corner(a)).length();
        let triangles = ranges.into_iter().flat_map(|r| &self.mesh.triangles[r]);
        triangles.map(|t| area(*t)).sum::<f64>() * self.xform.scale * self.xform.scale
    }

    /// Names of materials that it needs, and the field of each.
    pub(super) fn needs(&self) -> Vec<(&str, String, Place)> {
        match &self.material {
            Stuff::One(name) => vec![(name.as_str(), format!("{}.material", self.id), self.place.clone())],
            Stuff::Named(map) => {
                let mut all: Vec<_> = map
                    .iter()
                    .map(|(name, of, place)| {
                        (
                            of.as_str(),
                            format!("{}.materials.{name}", self.id),
                            place.clone(),
                        )
                    })
                    .collect();
                for part in &self.mesh.parts {
                    if !map.iter().any(|(name, ..)| *name == part.material) {
                        let field = format!("{}.materials.{}", self.id, part.material);
                        all.push((part.material.as_str(), field, self.place.clone()));
                    }
                }
                all
            }
        }
    }

    /// The items that it stands for; materials have the names of [`kept`].
    pub(super) fn entries(self, out: &mut Vec<Entry>) {
        let strings: Vec<String> = std::iter::once(self.file).chain(self.words).collect();
        let modifier = match &self.material {
            Stuff::One(name) => kept(name),
            Stuff::Named(map) => {
                // The names of the file mean for this object what it says.
                let mut done: Vec<&str> = Vec::new();
                for name in self.mesh.parts.iter().map(|p| p.material.as_str()) {
                    if name != VOID && !done.contains(&name) {
                        let mapped = map.iter().find(|(n, ..)| n == name);
                        let (of, place) = mapped.map_or((name, &self.place), |(_, of, place)| (of, place));
                        out.push(alias(name, &kept(of), place));
                        done.push(name);
                    }
                }
                VOID.into()
            }
        };
        out.push(item(&modifier, "mesh", &self.id, strings, vec![], &self.place));
    }
}

/// The name under which a material of the scene stays known, whatever objects call theirs.
pub(super) fn kept(name: &str) -> String {
    if name == VOID {
        return VOID.into();
    }
    format!("{name} of the scene")
}
