//! Fits of simulated measurements. One program, since every program that fits holds the code of every model.

#![allow(clippy::unwrap_used)] // helpers of tests fail a test by panicking, as the tests themselves do

mod choice;
mod common;
mod coverage;
mod misfit;
mod recovery;
mod robustness;
mod sphere;
