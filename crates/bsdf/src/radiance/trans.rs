//! `trans`: plastic that also transmits, straight through or diffusely.

use super::argument::{BLUE, GREEN, RED, ROUGH, SPEC, TRANS, TSPEC, no_strings};
use super::{Argument, Parameters, Rgb, check_reals, rgb};
use crate::BsdfError;

/// `void trans id 0 0 7 red green blue spec rough trans tspec`.
#[derive(Clone, Debug, PartialEq)]
pub struct Trans {
    /// Colour of everything but the reflected gloss, `[0, 1]`.
    pub color: Rgb,
    /// Share of the light in the reflected gloss, which is uncoloured, `[0, 1]`.
    pub specularity: f64,
    /// `alpha` of both lobes, `[0, 1]`; up to 0.001 the surface is smooth and Fresnel's law applies.
    pub roughness: f64,
    /// Share of the light past the gloss that goes through, `[0, 1]`.
    pub transmissivity: f64,
    /// Share of the transmitted light in the through lobe, `[0, 1]`; the rest is diffuse.
    pub transmitted_specularity: f64,
}

impl Parameters for Trans {
    const TYPE: &'static str = "trans";
    const ARGUMENTS: &'static [Argument] = &[RED, GREEN, BLUE, SPEC, ROUGH, TRANS, TSPEC];

    fn from_arguments(strings: &[String], reals: &[f64]) -> Result<Self, BsdfError> {
        no_strings(strings)?;
        check_reals::<Self>(reals)?;
        Ok(Trans {
            color: rgb(reals),
            specularity: reals[3],
            roughness: reals[4],
            transmissivity: reals[5],
            transmitted_specularity: reals[6],
        })
    }

    fn reals(&self) -> Vec<f64> {
        let [r, g, b] = self.color;
        vec![
            r,
            g,
            b,
            self.specularity,
            self.roughness,
            self.transmissivity,
            self.transmitted_specularity,
        ]
    }
}
