//! Scenes as lighting engineers write them, and what `gonio_trace` renders of them.

pub mod cal;
pub mod generate;
pub mod text;
