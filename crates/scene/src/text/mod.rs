//! RADIANCE scene text: files and the commands in them become one list of items.
//!
//! gonio carries out `xform`, `gensky`, `gendaylit` and the generators of surfaces itself; no command is ever run.

mod command;
mod expand;
mod files;
mod genbox;
mod generated;
mod generators;
mod transform;
mod xform;

pub use expand::{Entry, read, read_from};
pub use files::{Files, ModelReader, ReadModel};
pub use transform::Change;
pub(crate) use transform::SURFACES;
pub use xform::Xform;
