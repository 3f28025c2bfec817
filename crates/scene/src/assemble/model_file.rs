//! Models in files of other formats than those of RADIANCE and RGL: gonio's own.

use std::path::Path;
use std::sync::Arc;

use gonio_bsdf::{Bsdf, Channel};

use super::Assembly;
use crate::error::{Place, SceneError};

/// Endings that are read here.
const OWN: [&str; 2] = ["xml", "bsdf"];

impl Assembly<'_> {
    /// The model of a file that the caller's reader takes, `None` for one that is read here.
    pub(super) fn foreign(&self, path: &Path, place: &Place) -> Result<Option<Arc<dyn Bsdf>>, SceneError> {
        let extension = path.extension().map(|e| e.to_string_lossy().to_ascii_lowercase());
        let Some(reader) = &self.files.models else {
            return Ok(None);
        };
        if extension.is_some_and(|e| OWN.contains(&e.as_str())) {
            return Ok(None);
        }
        let found = || format!("{:?}", path.display().to_string());
        let model =
            (reader.0)(path).map_err(|e| place.fault("BSDF", format!("{}: {e}", found()), "a model"))?;
        let channels = model.channels();
        if channels.len() != 1 && channels != [Channel::Red, Channel::Green, Channel::Blue] {
            let names: Vec<String> = channels.iter().map(ToString::to_string).collect();
            let found = format!("{} of {}", found(), names.join(", "));
            return Err(place.fault("BSDF", found, "a model of one channel, or of red, green, blue"));
        }
        Ok(Some(model))
    }
}
