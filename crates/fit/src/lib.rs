//! Analytic models from measurements: parameters, their uncertainties, and which model the data support.

pub mod normal;
pub mod solver;
