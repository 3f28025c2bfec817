//! Laws of scattering, one test a law, over every registered model and over sums of them.
//!
//! `GONIO_MODELS=name,name` restricts the tests of this program to some models.

#![allow(clippy::unwrap_used, clippy::panic)] // helpers outside #[test] fail a test by panicking, as the tests do

#[path = "../common/mod.rs"]
mod common;

mod cases;
mod energy;
mod exemptions;
mod finite;
mod reciprocity;
mod sampling;
