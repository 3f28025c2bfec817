//! File formats, one a module. Every reader gives data or an [`IoError`] that names file, line or field, what was
//! found and what is allowed; no reader guesses. Every writer writes a temporary file and renames it.

pub mod astm;
pub mod atomic;
mod column;
pub mod detect;
pub mod error;
pub mod gonio_raw;
mod grouping;
pub mod merl;
pub mod mountain;
pub mod nist_ptfe;
pub mod options;
pub mod picture;
pub mod radiance_material;
pub mod radiance_xml;
pub mod rgl;
pub mod sir;
pub mod speos;
pub mod table;
pub mod tensor_file;
mod text;
mod words;
pub mod zemax;

pub use atomic::write_atomic;
pub use column::column;
pub use detect::{Format, detect, detect_file, read_any};
pub use error::{IoError, excerpt, read_bytes};
pub use options::ReadOptions;
