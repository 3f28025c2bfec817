//! What processing found out beside the DSF.

use gonio_bsdf::Channel;

use crate::{Beam, DarkSummary, NoiseModel, Verdict};

/// The corrections as they were applied: for provenance, reports and checks.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Processing {
    /// Beam power and signature, one a channel.
    pub beams: Vec<Beam>,
    /// Noise model used, one a slice, in the unit of the readings.
    pub noise: Vec<(Channel, NoiseModel)>,
    /// What was subtracted, one a slice; `None` where no dark was given.
    pub dark: Vec<Option<DarkSummary>>,
    /// What only the raw readings could tell (blank match, reference scan), as verdicts.
    pub findings: Vec<Verdict>,
}
