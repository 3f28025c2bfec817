//! Analytic scattering models, one a file. Each holds for both sides of the sample alike.

pub mod lambert;
pub mod spectrum;
pub mod sum;
pub mod transmission_lobe;
pub mod ward_gmd;

pub use lambert::Lambert;
pub use spectrum::Spectrum;
pub use sum::Sum;
pub use transmission_lobe::{LobeNormalisation, TransmissionLobe, TransmissionLobeParameters};
pub use ward_gmd::{WardGmd, WardGmdParameters};

use crate::BsdfError;

/// `value` when it lies in `[low, high]` (both included), else the error that names `field`.
fn in_range(field: &'static str, value: f64, low: f64, high: f64) -> Result<f64, BsdfError> {
    if (low..=high).contains(&value) {
        Ok(value)
    } else {
        Err(BsdfError::Domain {
            field,
            found: value.to_string(),
            allowed: format!("{low} to {high}"),
        })
    }
}
