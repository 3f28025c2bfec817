//! Why a scene cannot be read, and what it is read without.

use std::fmt;
use std::path::Path;
use std::sync::Arc;

use gonio_io::IoError;

/// A scene that cannot be read.
#[derive(Debug, thiserror::Error)]
pub enum SceneError {
    /// A file that is not there, or text that does not say what it should; names file and line.
    #[error(transparent)]
    Text(#[from] IoError),
    /// A scene whose parts do not fit together.
    #[error(transparent)]
    Parts(#[from] gonio_trace::scene::SceneError),
    /// A view that shows nothing.
    #[error(transparent)]
    View(#[from] gonio_trace::camera::ViewError),
}

/// Where something stands.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Place {
    /// The file.
    pub file: Arc<Path>,
    /// Its line, counted from 1.
    pub line: u64,
}

impl Place {
    /// The error for what stands there.
    pub fn fault(
        &self,
        field: impl Into<String>,
        found: impl Into<String>,
        allowed: impl Into<String>,
    ) -> SceneError {
        IoError::format(&self.file, self.line, field, found, allowed).into()
    }
}

impl fmt::Display for Place {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}, line {}", self.file.display(), self.line)
    }
}

/// What a scene is read without, or read otherwise than it stands there.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Warning {
    /// Where.
    pub place: Place,
    /// What.
    pub text: String,
}

impl fmt::Display for Warning {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}: {}", self.place, self.text)
    }
}
