//! `plastic`: a diffuse colour under an uncoloured gloss.

use super::argument::{BLUE, GREEN, RED, ROUGH, SPEC, no_strings};
use super::{Argument, Parameters, Rgb, check_reals, rgb};
use crate::BsdfError;

/// `void plastic id 0 0 5 red green blue spec rough`.
#[derive(Clone, Debug, PartialEq)]
pub struct Plastic {
    /// Reflectance of the diffuse part, `[0, 1]`; the light the gloss reflects does not reach it.
    pub color: Rgb,
    /// Share of the light in the gloss lobe, `[0, 1]`.
    pub specularity: f64,
    /// `alpha` of the gloss lobe, `[0, 1]`; up to 0.001 the surface is smooth and Fresnel's law applies.
    pub roughness: f64,
}

impl Plastic {
    /// A plastic of these parameters.
    ///
    /// # Errors
    /// [`BsdfError::Domain`] naming the parameter outside its range.
    pub fn new(color: Rgb, specularity: f64, roughness: f64) -> Result<Self, BsdfError> {
        Plastic {
            color,
            specularity,
            roughness,
        }
        .checked()
    }
}

impl Parameters for Plastic {
    const TYPE: &'static str = "plastic";
    const ARGUMENTS: &'static [Argument] = &[RED, GREEN, BLUE, SPEC, ROUGH];

    fn from_arguments(strings: &[String], reals: &[f64]) -> Result<Self, BsdfError> {
        no_strings(strings)?;
        check_reals::<Self>(reals)?;
        Plastic::new(rgb(reals), reals[3], reals[4])
    }

    fn reals(&self) -> Vec<f64> {
        let [r, g, b] = self.color;
        vec![r, g, b, self.specularity, self.roughness]
    }
}
