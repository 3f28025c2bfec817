//! `plastic2`: plastic of two roughnesses.

use super::argument::{BLUE, GREEN, RED, SPEC, UROUGH, VROUGH};
use super::{Argument, Orientation, Parameters, Rgb, check_reals, rgb};
use crate::BsdfError;

/// `void plastic2 id 4+ ux uy uz function-file transform… 0 6 red green blue spec urough vrough`.
#[derive(Clone, Debug, PartialEq)]
pub struct Plastic2 {
    /// Reflectance of the diffuse part, `[0, 1]`; the light the gloss reflects does not reach it.
    pub color: Rgb,
    /// Share of the light in the gloss lobe, `[0, 1]`.
    pub specularity: f64,
    /// `alpha` along u, `[0.001, 1]`.
    pub roughness_u: f64,
    /// `alpha` along `v = n x u`, `[0.001, 1]`.
    pub roughness_v: f64,
    /// The direction u.
    pub orientation: Orientation,
}

impl Parameters for Plastic2 {
    const TYPE: &'static str = "plastic2";
    const ARGUMENTS: &'static [Argument] = &[RED, GREEN, BLUE, SPEC, UROUGH, VROUGH];

    fn from_arguments(strings: &[String], reals: &[f64]) -> Result<Self, BsdfError> {
        check_reals::<Self>(reals)?;
        Ok(Plastic2 {
            color: rgb(reals),
            specularity: reals[3],
            roughness_u: reals[4],
            roughness_v: reals[5],
            orientation: Orientation::from_strings(strings)?,
        })
    }

    fn reals(&self) -> Vec<f64> {
        let [r, g, b] = self.color;
        vec![r, g, b, self.specularity, self.roughness_u, self.roughness_v]
    }

    fn strings(&self) -> Vec<String> {
        self.orientation.strings()
    }
}
