//! Data-driven models: from a processed measurement to a `Bsdf` without a formula in between.

mod base;
mod builder;
mod choice;
mod direct;
mod energy;
mod hold_out;
mod images;
mod incidence;
mod intake;
mod layout;
mod local_error;
mod mesh;
mod node;
mod plane;
mod profile;
mod readings;
mod reciprocity;
mod sampling;
mod smoothing;
mod stated;
mod table;
mod uncertainty;
mod unknowable;
mod weights;

pub mod across;
pub mod channels;
pub mod cubic;
mod data_driven;
pub mod error;
pub mod leave_one_out;
pub mod reduce;
pub mod slice_surface;
pub mod symmetry;

pub use across::{Candidate, Frame, Method, Order};
pub use channels::SideBySide;
pub use data_driven::{BuildOptions, DataDriven, PartSummary};
pub use direct::DirectPeak;
pub use error::BuildError;
pub use leave_one_out::LooError;
pub use slice_surface::Coverage;
pub use stated::StatedError;
pub use symmetry::SymmetryChoice;
pub use uncertainty::Uncertainty;
