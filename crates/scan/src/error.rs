//! Errors of the measurement chain.

use thiserror::Error;

/// Why readings cannot be processed.
#[derive(Debug, Clone, PartialEq, Error)]
pub enum ScanError {
    /// A field outside its range or missing.
    #[error("{field}: found {found}, allowed {allowed}")]
    Domain {
        /// Name of the field as in docs/nomenclature.md.
        field: &'static str,
        /// What was found.
        found: String,
        /// What is allowed.
        allowed: String,
    },
    /// Data of one quantity, channel or kind where another is needed.
    #[error("{what}: found {found}, needed {needed}")]
    Mismatch {
        /// What disagrees.
        what: String,
        /// What was found.
        found: String,
        /// What is needed.
        needed: String,
    },
}
