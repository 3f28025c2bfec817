//! Where files are found that scenes name, and who reads models in them.

use std::fmt;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use gonio_bsdf::Bsdf;

use crate::error::{Place, SceneError};

/// Files that files name: beside the one that names them, then along a list of folders.
#[derive(Clone, Debug, Default)]
pub struct Files {
    /// Folders to search, in order.
    pub search: Vec<PathBuf>,
    /// Reads models in files of other formats than those of RADIANCE and RGL.
    pub models: Option<ModelReader>,
}

/// A reader of models that are not read here; it says in words what is wrong with a file.
#[derive(Clone)]
pub struct ModelReader(pub Arc<ReadModel>);

/// The model of a file, or what is wrong with it.
pub type ReadModel = dyn Fn(&Path) -> Result<Arc<dyn Bsdf>, String> + Send + Sync;

impl fmt::Debug for ModelReader {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("ModelReader")
    }
}

impl Files {
    /// The file `name` that stands at `place`.
    ///
    /// # Errors
    /// That it is nowhere, with the place.
    pub fn find(&self, name: &str, place: &Place) -> Result<PathBuf, SceneError> {
        self.find_for(name, "file", place)
    }

    /// [`Files::find`], for a field of another name.
    pub(crate) fn find_for(&self, name: &str, field: &str, place: &Place) -> Result<PathBuf, SceneError> {
        let name_path = Path::new(name);
        let beside = place.file.parent().unwrap_or(Path::new(""));
        let mut tried = std::iter::once(beside).chain(self.search.iter().map(PathBuf::as_path));
        tried
            .find_map(|folder| Some(folder.join(name_path)).filter(|p| p.is_file()))
            .ok_or_else(|| {
                let allowed = if self.search.is_empty() {
                    "a file beside this one".to_owned()
                } else {
                    let folders: Vec<String> = self.search.iter().map(|p| p.display().to_string()).collect();
                    format!(
                        "a file beside this one or in the folders that are searched (-I, RAYPATH): {}",
                        folders.join(":")
                    )
                };
                place.fault(field, format!("{name:?}, which is not there"), allowed)
            })
    }
}
