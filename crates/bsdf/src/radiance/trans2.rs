//! `trans2`: trans of two roughnesses.

use super::argument::{BLUE, GREEN, RED, SPEC, TRANS, TSPEC, UROUGH, VROUGH};
use super::{Argument, Orientation, Parameters, Rgb, check_reals, rgb};
use crate::BsdfError;

/// `void trans2 id 4+ ux uy uz function-file transform… 0 8 red green blue spec urough vrough trans tspec`.
#[derive(Clone, Debug, PartialEq)]
pub struct Trans2 {
    /// Colour of everything but the reflected gloss, `[0, 1]`.
    pub color: Rgb,
    /// Share of the light in the reflected gloss, which is uncoloured, `[0, 1]`.
    pub specularity: f64,
    /// `alpha` of both lobes along u, `[0.001, 1]`.
    pub roughness_u: f64,
    /// `alpha` of both lobes along `v = n x u`, `[0.001, 1]`.
    pub roughness_v: f64,
    /// Share of the light past the gloss that goes through, `[0, 1]`.
    pub transmissivity: f64,
    /// Share of the transmitted light in the through lobe, `[0, 1]`; the rest is diffuse.
    pub transmitted_specularity: f64,
    /// The direction u.
    pub orientation: Orientation,
}

impl Parameters for Trans2 {
    const TYPE: &'static str = "trans2";
    const ARGUMENTS: &'static [Argument] = &[RED, GREEN, BLUE, SPEC, UROUGH, VROUGH, TRANS, TSPEC];

    fn from_arguments(strings: &[String], reals: &[f64]) -> Result<Self, BsdfError> {
        check_reals::<Self>(reals)?;
        Ok(Trans2 {
            color: rgb(reals),
            specularity: reals[3],
            roughness_u: reals[4],
            roughness_v: reals[5],
            transmissivity: reals[6],
            transmitted_specularity: reals[7],
            orientation: Orientation::from_strings(strings)?,
        })
    }

    fn reals(&self) -> Vec<f64> {
        let [r, g, b] = self.color;
        vec![
            r,
            g,
            b,
            self.specularity,
            self.roughness_u,
            self.roughness_v,
            self.transmissivity,
            self.transmitted_specularity,
        ]
    }

    fn strings(&self) -> Vec<String> {
        self.orientation.strings()
    }
}
