//! Samplers against their densities and albedos, for every registered model.
//!
//! `GONIO_MODELS=name,name` restricts the tests of this program to some models, `GONIO_SAMPLES` sets the number of samples
//! a case. All seeds are fixed: a verdict is the same on every run.

#![allow(clippy::unwrap_used, clippy::panic)] // helpers outside #[test] fail a test by panicking, as the tests do

#[path = "../common/mod.rs"]
mod common;

mod chi_square;
mod judge;
mod partition;
mod registry;
mod tables;
mod trial;
