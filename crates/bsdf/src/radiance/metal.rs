//! `metal`: a gloss in the colour of the metal.

use super::argument::{BLUE, GREEN, RED, ROUGH, SPEC, no_strings};
use super::{Argument, Parameters, Rgb, check_reals, rgb};
use crate::BsdfError;

/// `void metal id 0 0 5 red green blue spec rough`.
#[derive(Clone, Debug, PartialEq)]
pub struct Metal {
    /// Colour of the gloss and of the diffuse part, `[0, 1]`.
    pub color: Rgb,
    /// Share of the light in the gloss lobe, `[0, 1]`.
    pub specularity: f64,
    /// `alpha` of the gloss lobe, `[0, 1]`; up to 0.001 the surface is smooth and Fresnel's law applies.
    pub roughness: f64,
}

impl Metal {
    /// A metal of these parameters.
    ///
    /// # Errors
    /// [`BsdfError::Domain`] naming the parameter outside its range.
    pub fn new(color: Rgb, specularity: f64, roughness: f64) -> Result<Self, BsdfError> {
        Metal {
            color,
            specularity,
            roughness,
        }
        .checked()
    }
}

impl Parameters for Metal {
    const TYPE: &'static str = "metal";
    const ARGUMENTS: &'static [Argument] = &[RED, GREEN, BLUE, SPEC, ROUGH];

    fn from_arguments(strings: &[String], reals: &[f64]) -> Result<Self, BsdfError> {
        no_strings(strings)?;
        check_reals::<Self>(reals)?;
        Metal::new(rgb(reals), reals[3], reals[4])
    }

    fn reals(&self) -> Vec<f64> {
        let [r, g, b] = self.color;
        vec![r, g, b, self.specularity, self.roughness]
    }
}
