//! The Rust-to-Python map of errors: every error a user can meet is a `GonioError`.

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

pub(crate) fn register(m: &Bound<'_, PyModule>) -> PyResult<()> {
    let py = m.py();
    m.add("GonioError", py.get_type::<GonioError>())?;
    m.add("FormatError", py.get_type::<FormatError>())?;
    m.add("QuantityError", py.get_type::<QuantityError>())?;
    m.add("DomainError", py.get_type::<DomainError>())?;
    m.add("FitError", py.get_type::<FitError>())
}
