//! Why a file could not be read or written.

use std::fs::File;
use std::io::Read;
use std::path::{Path, PathBuf};

use thiserror::Error;

/// Longest piece of a file that a message repeats, in bytes.
const EXCERPT: usize = 40;

/// A file that cannot be read, or does not follow its format. Names the file, the line or field, what was found
/// there and what is allowed.
#[derive(Debug, Error)]
pub enum IoError {
    /// The operating system refused (not found, permission denied, a directory, disk full).
    #[error("{}: {source}", path.display())]
    File {
        /// The file.
        path: PathBuf,
        /// What the operating system said.
        source: std::io::Error,
    },
    /// The content does not follow the format.
    #[error("{}{}: {field}: found {found}, allowed {allowed}", path.display(), at(*line))]
    Format {
        /// The file.
        path: PathBuf,
        /// Line of the file, counted from 1; `None` when the fault has no line (something is missing).
        line: Option<u64>,
        /// Name of the field, column or header key.
        field: String,
        /// What was found.
        found: String,
        /// What is allowed.
        allowed: String,
    },
}

fn at(line: Option<u64>) -> String {
    line.map_or_else(String::new, |n| format!(", line {n}"))
}

impl IoError {
    /// A refusal of the operating system.
    pub fn file(path: &Path, source: std::io::Error) -> Self {
        IoError::File {
            path: path.to_path_buf(),
            source,
        }
    }

    /// A fault of the content; `line` counts from 1.
    pub fn format(
        path: &Path,
        line: impl Into<Option<u64>>,
        field: impl Into<String>,
        found: impl Into<String>,
        allowed: impl Into<String>,
    ) -> Self {
        IoError::Format {
            path: path.to_path_buf(),
            line: line.into(),
            field: field.into(),
            found: found.into(),
            allowed: allowed.into(),
        }
    }

    /// The file the error is about.
    pub fn path(&self) -> &Path {
        match self {
            IoError::File { path, .. } | IoError::Format { path, .. } => path,
        }
    }
}

/// A piece of a file as a message shows it: quoted, escaped, cut to a readable length.
pub fn excerpt(bytes: &[u8]) -> String {
    let cut = &bytes[..bytes.len().min(EXCERPT)];
    let more = if bytes.len() > EXCERPT { "…" } else { "" };
    format!("\"{}{more}\"", cut.escape_ascii())
}

/// An open file and its size in bytes.
///
/// # Errors
/// [`IoError::File`] for everything the operating system refuses, a directory included.
pub(crate) fn open(path: &Path) -> Result<(File, u64), IoError> {
    let refused = |source| IoError::file(path, source);
    let file = File::open(path).map_err(refused)?;
    let about = file.metadata().map_err(refused)?;
    if about.is_dir() {
        return Err(refused(std::io::ErrorKind::IsADirectory.into()));
    }
    Ok((file, about.len()))
}

/// The whole file in memory.
///
/// # Errors
/// [`IoError::File`] for everything the operating system refuses, a directory included.
pub fn read_bytes(path: &Path) -> Result<Vec<u8>, IoError> {
    let (mut file, size) = open(path)?;
    let mut bytes = Vec::with_capacity(size as usize);
    file.read_to_end(&mut bytes).map_err(|e| IoError::file(path, e))?;
    Ok(bytes)
}
