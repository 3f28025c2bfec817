//! From readings to a measurement: corrections, beam power, DSF/BSDF, uncertainty, checks.

pub mod alignment;
mod assemble;
mod assumed;
pub mod beam;
mod blank;
pub mod check;
mod clock;
pub mod dark;
pub mod error;
mod field;
mod flagging;
pub mod flags;
mod highest;
mod invert;
mod local;
pub mod measurement;
mod narrow_peak;
mod nearest;
pub mod noise;
pub mod phase;
mod process;
#[cfg(test)]
mod process_tests;
pub mod processing;
mod quadratic;
pub mod readings;
pub mod relative;
mod robust;
pub mod signature;
pub mod tabulate;
#[cfg(test)]
mod testing;
mod unresolved;
mod validate;
pub mod verdict;
mod weigh;

pub use alignment::{Alignment, Peak, align, correct_alignment};
pub use beam::{Beam, beam_power};
pub use check::{CheckOptions, CopyPair, check, copies, reciprocity, repeatability};
pub use dark::{DarkMethod, DarkOptions, DarkSummary};
pub use error::ScanError;
pub use flags::Flags;
pub use highest::{Highest, highest};
pub use local::{resolution_uncertainty, u_beside_resolution};
pub use measurement::{HemisphericalIntegral, Measurement, Slice};
pub use nearest::DirectionIndex;
pub use noise::{NoiseModel, NoiseOrigin};
pub use process::{ProcessOptions, process, process_owned};
pub use processing::Processing;
pub use readings::{Scan, ScanKind, ScanMeta};
pub use relative::{Standard, process_relative};
pub use signature::{Resolution, Signature};
pub use tabulate::{Spacing, Tabulation, tabulate};
pub use verdict::{Level, Verdict};
