//! `ashik2`: the anisotropic Phong model of Ashikhmin and Shirley as RADIANCE evaluates it.

use super::argument::Argument;
use super::{Orientation, Parameters, Rgb, check_reals, rgb};
use crate::BsdfError;

/// `void ashik2 id 4+ ux uy uz function-file transform… 0 8 dred dgreen dblue sred sgreen sblue upower vpower`.
#[derive(Clone, Debug, PartialEq)]
pub struct Ashik2 {
    /// Reflectance of the diffuse part, `[0, 1]`; not lessened by the gloss.
    pub diffuse: Rgb,
    /// Reflectance of the gloss at normal view, `[0, 1]`.
    pub specular: Rgb,
    /// Phong exponent along u, `[0, 1e7]`.
    pub power_u: f64,
    /// Phong exponent along `v = n x u`, `[0, 1e7]`.
    pub power_v: f64,
    /// The direction u.
    pub orientation: Orientation,
}

const fn power(name: &'static str, what: &'static str) -> Argument {
    Argument {
        name,
        low: 0.0,
        high: 1e7,
        what,
        optional: false,
    }
}

impl Parameters for Ashik2 {
    const TYPE: &'static str = "ashik2";
    const ARGUMENTS: &'static [Argument] = &[
        Argument::share("dred", "red of the diffuse part"),
        Argument::share("dgreen", "green of the diffuse part"),
        Argument::share("dblue", "blue of the diffuse part"),
        Argument::share("sred", "red of the gloss at normal view"),
        Argument::share("sgreen", "green of the gloss at normal view"),
        Argument::share("sblue", "blue of the gloss at normal view"),
        power("upower", "Phong exponent along u"),
        power("vpower", "Phong exponent along v = n x u"),
    ];

    fn from_arguments(strings: &[String], reals: &[f64]) -> Result<Self, BsdfError> {
        check_reals::<Self>(reals)?;
        Ok(Ashik2 {
            diffuse: rgb(reals),
            specular: rgb(&reals[3..]),
            power_u: reals[6],
            power_v: reals[7],
            orientation: Orientation::from_strings(strings)?,
        })
    }

    fn reals(&self) -> Vec<f64> {
        let mut reals = self.diffuse.to_vec();
        reals.extend(self.specular);
        reals.extend([self.power_u, self.power_v]);
        reals
    }

    fn strings(&self) -> Vec<String> {
        self.orientation.strings()
    }
}
