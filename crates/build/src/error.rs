//! Errors of model building.

use gonio_geom::{Component, Side};
use thiserror::Error;

/// Why no model can be built from a measurement.
#[derive(Debug, Clone, PartialEq, Error)]
pub enum BuildError {
    /// A measurement without any slice of the wanted channel.
    #[error("channel (--channel): found {found}, allowed one of the measured channels: {allowed}")]
    Channel {
        /// The channel asked for, or "none" when the measurement has several and none was named.
        found: String,
        /// The channels of the measurement.
        allowed: String,
    },
    /// Fewer incidences than an interpolation over incidence needs.
    #[error("incidences: found {found} with usable readings, needed at least {needed}")]
    TooFewIncidences {
        /// Distinct directions of incidence with usable readings.
        found: usize,
        /// The least number.
        needed: usize,
    },
    /// A slice whose readings do not span a surface.
    #[error(
        "readings at incidence ({theta_i:.3}, {phi_i:.3}) deg, {side} {component}: found {found}, needed {needed}"
    )]
    Readings {
        /// Polar angle of incidence, degrees.
        theta_i: f64,
        /// Azimuth of incidence, degrees.
        phi_i: f64,
        /// Side of incidence.
        side: Side,
        /// Component the readings belong to.
        component: Component,
        /// What was found.
        found: String,
        /// What is needed.
        needed: String,
    },
    /// A candidate that needs a parametric base, where none could be fitted.
    #[error(
        "candidate: found {candidate} for {side} {component}, where no parametric base could be fitted; allowed one without a model"
    )]
    NoBase {
        /// Side of incidence.
        side: Side,
        /// Component.
        component: Component,
        /// The candidate asked for.
        candidate: &'static str,
    },
    /// A build that was asked to stop.
    #[error("build: stopped before it was done")]
    Stopped,
    /// A part of a base that the registry of analytic models lacks.
    #[error(transparent)]
    Bsdf(#[from] gonio_bsdf::BsdfError),
    /// Columns of a slice that differ in length.
    #[error("{field}: found {found} values, needed {needed} as in dsf")]
    Columns {
        /// Name of the column.
        field: &'static str,
        /// Its length.
        found: usize,
        /// Length of the DSF column.
        needed: usize,
    },
}
