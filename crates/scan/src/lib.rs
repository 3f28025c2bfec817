//! From readings to a measurement: corrections, beam power, DSF/BSDF, uncertainty, checks.

pub mod error;
pub mod flags;
pub mod measurement;
pub mod readings;

pub use error::ScanError;
pub use flags::Flags;
pub use measurement::{Measurement, Slice};
pub use readings::{Scan, ScanKind, ScanMeta};
