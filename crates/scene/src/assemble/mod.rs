//! Items become what `gonio_trace` renders.

mod body;
mod bsdf;
mod field;
mod function;
mod grid;
mod image;
mod light;
mod material;
mod measured;
mod mesh;
mod mixture;
mod model_file;
mod modifier;
mod pattern;
mod polygon;
mod portal;
mod sky;
mod surface;
mod through;
mod up;

use std::collections::HashMap;
use std::path::PathBuf;
use std::sync::Arc;

use gonio_trace::camera::View;
use gonio_trace::scene::Parts;

use crate::error::{Place, SceneError, Warning};
use crate::mesh::Mesh;
use crate::text::{self, Entry, Files};
use crate::yaml;

use modifier::Modifiers;

/// A scene that has been read.
pub struct Loaded {
    /// What is rendered.
    pub parts: Parts,
    /// What is read otherwise than it stands in the text.
    pub warnings: Vec<Warning>,
    /// The view that the scene names; RADIANCE text names none.
    pub view: Option<View>,
}

/// The scene of these files, one after the other as `oconv` takes them: RADIANCE text, or YAML by its ending. What one names the
/// next may use.
/// Files that they name are looked for beside the file that names them, then in the folders `search`.
///
/// # Errors
/// [`SceneError`] naming file and line: files that are not there, text that is no scene, commands that gonio does not carry
/// out, modifiers that do not stand above, materials without a model, surfaces that are none.
pub fn read(paths: &[PathBuf], search: &[PathBuf]) -> Result<Loaded, SceneError> {
    let files = Files {
        search: search.to_vec(),
        ..Files::default()
    };
    read_with(paths, &files)
}

/// [`read`], `files` finds what the files name.
///
/// # Errors
/// As [`read`].
pub fn read_with(paths: &[PathBuf], files: &Files) -> Result<Loaded, SceneError> {
    let mut assembly = Assembly::new(files);
    let mut view = None;
    for path in paths {
        let entries = if yaml::is_yaml(path) {
            let scene = yaml::read(path, files)?;
            view = scene.view.or(view);
            scene.entries
        } else {
            text::read(path, files)?
        };
        for entry in entries {
            assembly.add(entry)?;
        }
    }
    Ok(Loaded {
        view,
        ..assembly.finish()
    })
}

/// The scene of items that have been read; `files` finds what they name.
///
/// # Errors
/// As [`read`].
pub fn assemble(entries: Vec<Entry>, files: &Files) -> Result<Loaded, SceneError> {
    let mut assembly = Assembly::new(files);
    for entry in entries {
        assembly.add(entry)?;
    }
    Ok(assembly.finish())
}

/// A scene that grows item by item.
struct Assembly<'a> {
    files: &'a Files,
    parts: Parts,
    warnings: Vec<Warning>,
    modifiers: Modifiers,
    materials: material::Materials,
    sky: sky::Heaven,
    /// Parallelograms that light comes in through, clear and scattering.
    portals: Vec<[glam::Vec3; 3]>,
    screens: Vec<[glam::Vec3; 3]>,
    /// Meshes of files.
    meshes: HashMap<PathBuf, Arc<Mesh>>,
}

impl<'a> Assembly<'a> {
    fn new(files: &'a Files) -> Self {
        Assembly {
            files,
            parts: Parts::default(),
            warnings: Vec::new(),
            modifiers: Modifiers::default(),
            materials: material::Materials::default(),
            sky: sky::Heaven::default(),
            portals: Vec::new(),
            screens: Vec::new(),
            meshes: HashMap::new(),
        }
    }

    fn warn(&mut self, place: &Place, text: impl Into<String>) {
        self.warnings.push(Warning {
            place: place.clone(),
            text: text.into(),
        });
    }

    fn add(&mut self, entry: Entry) -> Result<(), SceneError> {
        match surface::arguments(&entry) {
            Some(arguments) => self.surface(&entry, arguments),
            None => self.modifiers.define(entry),
        }
    }

    /// Refuses more triangles than memory and indices hold; lights are counted by what they take.
    fn room(&self, more: usize, place: &Place) -> Result<(), SceneError> {
        const MOST: usize = 1 << 26;
        let flat = self.parts.triangles.len().max(self.parts.vertices.len() / 3);
        let all = flat + self.parts.shapes.len() + 8 * self.parts.lights.len();
        if all.saturating_add(more) <= MOST {
            return Ok(());
        }
        Err(place.fault(
            "surfaces",
            format!(
                "{} triangles in all, lights counted eight times",
                all.saturating_add(more)
            ),
            format!("at most {MOST}"),
        ))
    }

    fn finish(mut self) -> Loaded {
        self.parts.sky = self.sky.finish();
        if self.parts.sky.is_some() {
            self.parts.portals = self.portals;
            self.parts.screens = self.screens;
        }
        Loaded {
            parts: self.parts,
            warnings: self.warnings,
            view: None,
        }
    }
}
