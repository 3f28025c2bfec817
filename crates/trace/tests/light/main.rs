//! Light of scenes: one program, for each links the whole library.
#![allow(clippy::unwrap_used, missing_docs)]

mod closed_forms;
mod common;
mod glint;
mod lamps;
mod sensors;
mod shared;
mod unbiased;
mod veil;
