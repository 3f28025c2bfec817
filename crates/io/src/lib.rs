//! File formats, one a module. Every reader gives data or an [`IoError`] that names file, line or field, what was
//! found and what is allowed; no reader guesses. Every writer writes a temporary file and renames it.

pub mod atomic;
pub mod error;

pub use atomic::write_atomic;
pub use error::{IoError, excerpt, read_bytes};
