//! Errors of model construction.

use thiserror::Error;

/// A model that cannot be built from what was given.
#[derive(Debug, Clone, PartialEq, Error)]
pub enum BsdfError {
    /// A parameter outside its range.
    #[error("{field}: found {found}, allowed {allowed}")]
    Domain {
        /// Name of the parameter as in docs/nomenclature.md.
        field: &'static str,
        /// What was found.
        found: String,
        /// What is allowed.
        allowed: String,
    },
}
