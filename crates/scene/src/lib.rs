//! Scenes as lighting engineers write them, and what `gonio_trace` renders of them.

pub mod assemble;
pub mod cal;
pub mod error;
pub mod generate;
pub mod mesh;
pub mod sky;
pub mod text;
pub mod view;
pub mod yaml;

pub use assemble::{Loaded, read, read_with};
pub use error::{Place, SceneError, Warning};
