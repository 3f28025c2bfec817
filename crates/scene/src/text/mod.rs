//! RADIANCE scene text: files and the commands in them become one list of items.
//!
//! gonio carries out `xform`, `genbox`, `gensky` and `gendaylit` itself; no command is ever run.

mod command;
mod expand;
mod genbox;
mod transform;
mod xform;

pub use expand::{Entry, Files, read, read_from};
pub use transform::Change;
pub(crate) use transform::SURFACES;
pub use xform::Xform;
