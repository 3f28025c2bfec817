//! Models of measurements: one program, for each links the whole library.
#![allow(clippy::unwrap_used, missing_docs)]

mod across;
mod axes;
mod common;
mod direct;
mod refusals;
mod repeats;
mod stated;
mod synthetic;
mod uncertainty;
mod watch;
