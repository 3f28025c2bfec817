//! The virtual goniophotometer: measures a scattering model and returns the records a real instrument writes. Beside it the
//! virtual integrating sphere ([`sphere`]).
//!
//! What it models: a lamp that drifts and flickers; a beam of finite divergence focused on the detector sphere or on the
//! sample, which it meets as a finite spot; a sample of finite size, tilted and offset on its holder; detectors of finite
//! aperture at a finite distance that see spectral channels, move while they read, change gain ranges and saturate; paths of
//! rings or half planes with refined regions, given or found by a fast scan; the shadow of the detector in the retro
//! direction; read-out, shot and proportional noise, a drifting dark level, pointing error. What it leaves out: stray light,
//! polarisation, light that passes beside the sample. The records carry what a data sheet states and nothing of the model.

mod beam_signal;
pub mod campaign;
mod campaign_check;
pub mod detector;
pub mod device;
pub mod error;
pub mod holder;
pub mod lamp;
mod nodes;
pub mod optics;
pub mod path;
pub mod plan;
pub mod profile;
mod radial;
pub mod readout;
pub mod region;
mod session;
mod signal;
pub mod sphere;
mod trial;
mod way;

pub use campaign::{Campaign, Instrument, simulate, simulate_watched};
pub use detector::{Detector, GainRange, Output};
pub use device::{Device, Extent};
pub use error::InstrumentError;
pub use holder::{Holder, Outline};
pub use lamp::Lamp;
pub use optics::{Beam, BeamProfile, Focus};
pub use path::DetectorPath;
pub use plan::{Plan, PlanOptions, PlanRegion, plan};
pub use profile::ProfileTable;
pub use region::{Around, Patch, PathTable, Prescan, Region};
