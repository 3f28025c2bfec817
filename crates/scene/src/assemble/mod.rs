//! Items become what `gonio_trace` renders.

mod bsdf;
mod grid;
mod light;
mod material;
mod mesh;
mod modifier;
mod pattern;
mod polygon;
mod portal;
mod sky;
mod surface;

use std::path::PathBuf;

use gonio_trace::scene::Parts;

use crate::error::{SceneError, Warning};
use crate::text::{self, Entry, Files};

use modifier::Modifiers;

/// A scene that has been read.
pub struct Loaded {
    /// What is rendered.
    pub parts: Parts,
    /// What is read otherwise than it stands in the text.
    pub warnings: Vec<Warning>,
}

/// The scene of these files of RADIANCE text, one after the other as `oconv` takes them: what one names the next may use.
/// Files that they name are looked for beside the file that names them, then in the folders `search`.
///
/// # Errors
/// [`SceneError`] naming file and line: files that are not there, text that is no scene, commands that gonio does not carry
/// out, modifiers that do not stand above, materials without a model, surfaces that are none.
pub fn read(paths: &[PathBuf], search: &[PathBuf]) -> Result<Loaded, SceneError> {
    let files = Files {
        search: search.to_vec(),
    };
    let mut assembly = Assembly::new(&files);
    for path in paths {
        for entry in text::read(path, &files)? {
            assembly.add(entry)?;
        }
    }
    Ok(assembly.finish())
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
    /// Parallelograms that light comes in through.
    openings: Vec<[glam::Vec3; 3]>,
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
            openings: Vec::new(),
        }
    }

    fn warn(&mut self, place: &crate::Place, text: impl Into<String>) {
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

    fn finish(mut self) -> Loaded {
        self.parts.sky = self.sky.finish();
        if self.parts.sky.is_some() {
            self.parts.portals = self.openings;
        }
        Loaded {
            parts: self.parts,
            warnings: self.warnings,
        }
    }
}
