//! The Rust-to-Python map of errors: every error a user can meet is a `GonioError` or a built-in `OSError`.
//!
//! The orphan rule forbids `From<ScanError> for PyErr`, so each crate's error enum implements [`Raise`] here, and a
//! binding writes `gonio_scan::process(…).or_raise()?`.

use std::io;
use std::path::Path;

use gonio_bsdf::BsdfError;
use gonio_build::BuildError;
use gonio_io::IoError;
use gonio_scan::ScanError;
use pyo3::create_exception;
use pyo3::exceptions::{PyException, PyOSError};
use pyo3::prelude::*;

create_exception!(
    gonio,
    GonioError,
    PyException,
    "Base of every error gonio raises on purpose."
);
create_exception!(
    gonio,
    FormatError,
    GonioError,
    "A file that does not follow its format; names file and line or field."
);
create_exception!(
    gonio,
    QuantityError,
    GonioError,
    "Data of one quantity, channel or kind where another is needed."
);
create_exception!(
    gonio,
    DomainError,
    GonioError,
    "A value outside its allowed range."
);
create_exception!(
    gonio,
    FitError,
    GonioError,
    "A model that the data cannot determine."
);

/// An error of the core that has a Python exception.
pub(crate) trait Raise {
    /// The exception a user sees, with the message of `self`.
    fn raise(self) -> PyErr;
}

/// `?` across the seam.
pub(crate) trait OrRaise<T> {
    /// The value, or the Python exception of the error.
    fn or_raise(self) -> PyResult<T>;
}

impl<T, E: Raise> OrRaise<T> for Result<T, E> {
    fn or_raise(self) -> PyResult<T> {
        self.map_err(Raise::raise)
    }
}

impl Raise for BsdfError {
    fn raise(self) -> PyErr {
        match self {
            BsdfError::Domain { .. } => DomainError::new_err(self.to_string()),
        }
    }
}

impl Raise for ScanError {
    fn raise(self) -> PyErr {
        match self {
            ScanError::Domain { .. } => DomainError::new_err(self.to_string()),
            ScanError::Mismatch { .. } => QuantityError::new_err(self.to_string()),
        }
    }
}

impl Raise for BuildError {
    fn raise(self) -> PyErr {
        match self {
            BuildError::Channel { .. } => QuantityError::new_err(self.to_string()),
            BuildError::Columns { .. } | BuildError::NoBase { .. } | BuildError::Bsdf(_) => {
                DomainError::new_err(self.to_string())
            }
            BuildError::Stopped => GonioError::new_err(self.to_string()),
            BuildError::TooFewIncidences { .. } | BuildError::Readings { .. } => {
                FitError::new_err(self.to_string())
            }
        }
    }
}

impl Raise for IoError {
    fn raise(self) -> PyErr {
        match self {
            IoError::File { path, source } => os_error(&path, &source),
            other => FormatError::new_err(other.to_string()),
        }
    }
}

/// `OSError(errno, text, file name)`, which Python turns into `FileNotFoundError` and its like by the number.
fn os_error(path: &Path, source: &io::Error) -> PyErr {
    // Numbers that Unix and Windows share, for errors that did not come from a system call.
    let number = source.raw_os_error().or(match source.kind() {
        io::ErrorKind::NotFound => Some(2),
        io::ErrorKind::PermissionDenied => Some(13),
        io::ErrorKind::AlreadyExists => Some(17),
        io::ErrorKind::NotADirectory => Some(20),
        io::ErrorKind::IsADirectory => Some(21),
        io::ErrorKind::StorageFull => Some(28),
        _ => None,
    });
    match number {
        Some(number) => {
            let text = source.to_string();
            let text = text.split(" (os error").next().unwrap_or_default().to_owned();
            PyOSError::new_err((number, text, path.display().to_string()))
        }
        None => PyOSError::new_err(format!("{}: {source}", path.display())),
    }
}

/// A [`DomainError`] in the wording of the core: `field: found …, allowed …`.
pub(crate) fn domain(field: &str, found: impl std::fmt::Display, allowed: &str) -> PyErr {
    DomainError::new_err(format!("{field}: found {found}, allowed {allowed}"))
}

pub(crate) fn register(m: &Bound<'_, PyModule>) -> PyResult<()> {
    let py = m.py();
    m.add("GonioError", py.get_type::<GonioError>())?;
    m.add("FormatError", py.get_type::<FormatError>())?;
    m.add("QuantityError", py.get_type::<QuantityError>())?;
    m.add("DomainError", py.get_type::<DomainError>())?;
    m.add("FitError", py.get_type::<FitError>())
}
