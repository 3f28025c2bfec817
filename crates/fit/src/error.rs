//! Why a fit is impossible.

use thiserror::Error;

/// No parameters can be had; the message says what to do about it.
#[derive(Debug, Clone, PartialEq, Error)]
pub enum FitError {
    /// A model that is not in the list, or a composition that makes no sense.
    #[error("model: found {found}, allowed {allowed}")]
    Model {
        /// What was asked for.
        found: String,
        /// What there is.
        allowed: String,
    },
    /// A channel the measurement does not have.
    #[error("channel: found {found}, allowed one of the measured channels: {allowed}")]
    Channel {
        /// What was asked for.
        found: String,
        /// What there is.
        allowed: String,
    },
    /// An option out of its range.
    #[error("{field}: found {found}, allowed {allowed}")]
    Domain {
        /// Name of the option.
        field: &'static str,
        /// Its value.
        found: String,
        /// Its range.
        allowed: &'static str,
    },
    /// Columns of a slice that differ in length.
    #[error("{field} of slice {slice}: found {found} values, needed {needed} as in dsf")]
    Columns {
        /// Name of the column.
        field: &'static str,
        /// Position of the slice.
        slice: usize,
        /// Length of the column.
        found: usize,
        /// Length of the DSF column.
        needed: usize,
    },
    /// Too few usable readings are left.
    #[error(
        "readings: found {found} that can be used, needed at least {needed} for the {parameters} parameters of \
         {model}; left out: {excluded}. Use a model with fewer parameters or measure more directions"
    )]
    TooFewReadings {
        /// Name of the model.
        model: String,
        /// Usable readings.
        found: usize,
        /// Least number.
        needed: usize,
        /// Free parameters.
        parameters: usize,
        /// What was left out and why.
        excluded: String,
    },
    /// All readings lie on a side that the model does not scatter to.
    #[error(
        "model {model} scatters into {allowed} only, and all {found} usable readings lie in {component}; fit a model \
         of {component}, or check the convention of theta_s (90 to 180 deg is the side away from the source)"
    )]
    WrongSide {
        /// Name of the model.
        model: String,
        /// Component the model describes.
        allowed: String,
        /// Component of the data.
        component: String,
        /// Number of readings.
        found: usize,
    },
    /// Not a single reading stands out of the noise.
    #[error(
        "dsf: no reading of channel {channel} is above its noise ({found}); there is nothing to fit. Check the dark \
         subtraction and the beam power, or measure a brighter sample"
    )]
    NoSignal {
        /// Channel.
        channel: String,
        /// What was found.
        found: String,
    },
    /// The search ended without a minimum.
    #[error(
        "fit of {model}: {found} after {evaluations} evaluations; try another model, fewer free parameters, or inspect \
         the readings with `gonio check`"
    )]
    NotConverged {
        /// Name of the model.
        model: String,
        /// How it ended.
        found: String,
        /// Evaluations of the normal equations.
        evaluations: usize,
    },
    /// The cancel flag was set.
    #[error("fit cancelled")]
    Cancelled,
    /// A model refused its parameters.
    #[error(transparent)]
    Bsdf(#[from] gonio_bsdf::BsdfError),
}
