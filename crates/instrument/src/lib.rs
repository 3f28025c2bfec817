//! The virtual goniophotometer: measures a scattering model and returns the records a real instrument writes.
//!
//! What it models: a beam of finite divergence focused on the detector sphere through a finite spot on the sample, a
//! detector of finite aperture at a finite distance, a detector path of rings with a refined patch, the shadow of the
//! detector in the retro direction, read-out and proportional noise, a drifting dark level, saturation, pointing error.
//! What it leaves out: stray light, gain ranges, drift of the source, over-filled samples, motion during integration.
//! The records carry what a data sheet states and nothing of the model.

pub mod campaign;
pub mod error;
pub mod optics;
pub mod path;
pub mod readout;
mod signal;

pub use campaign::{Campaign, Instrument, simulate};
pub use error::InstrumentError;
pub use optics::{Beam, BeamProfile, Detector};
pub use path::{DetectorPath, Patch};
