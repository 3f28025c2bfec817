//! The Rust-to-Python map of errors: every error a user can meet is a `GonioError` or a built-in `OSError`.
//!
//! The orphan rule forbids `From<ScanError> for PyErr`, so each crate's error enum implements [`Raise`] here, and a
//! binding writes `gonio_scan::process(…).or_raise()?`.

use gonio_bsdf::BsdfError;
use gonio_scan::ScanError;
use pyo3::create_exception;
use pyo3::exceptions::PyException;
use pyo3::prelude::*;

create_exception!(
    _native,
    GonioError,
    PyException,
    "Base of every error gonio raises on purpose."
);
create_exception!(
    _native,
    FormatError,
    GonioError,
    "A file that does not follow its format; names file and line or field."
);
create_exception!(
    _native,
    QuantityError,
    GonioError,
    "Data of one quantity, channel or kind where another is needed."
);
create_exception!(
    _native,
    DomainError,
    GonioError,
    "A value outside its allowed range."
);
create_exception!(
    _native,
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
