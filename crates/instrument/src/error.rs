//! Errors of the virtual instrument.

use thiserror::Error;

/// An instrument or a campaign that cannot be simulated.
#[derive(Debug, Clone, PartialEq, Error)]
pub enum InstrumentError {
    /// A parameter outside its range.
    #[error("{field}: found {found}, allowed {allowed}")]
    Domain {
        /// Name of the parameter.
        field: &'static str,
        /// What was found.
        found: String,
        /// What is allowed.
        allowed: String,
    },
}

/// `value` when it is finite and lies in `[low, high]`, else the error that names `field`; `unit` follows the limits.
pub(crate) fn in_range(
    field: &'static str,
    value: f64,
    low: f64,
    high: f64,
    unit: &str,
) -> Result<(), InstrumentError> {
    if (low..=high).contains(&value) {
        Ok(())
    } else {
        Err(InstrumentError::Domain {
            field,
            found: format!("{value}{unit}"),
            allowed: format!("{low} to {high}{unit}"),
        })
    }
}
