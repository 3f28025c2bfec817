//! `dielectric`: the boundary of a solid transparent body.

use super::argument::no_strings;
use super::{Argument, Parameters, Rgb, check_reals, rgb};
use crate::BsdfError;

/// `void dielectric id 0 0 5 rtn gtn btn n hc`. The body is behind the surface: its normal points out of it.
#[derive(Clone, Debug, PartialEq)]
pub struct Dielectric {
    /// Share of the light that a unit length of the body leaves, `[0, 1]`; the unit is that of the scene.
    pub transmissivity: Rgb,
    /// Refractive index of the body in air, `[0.1, 10]`; below 1 the body is a bubble.
    pub refractive_index: f64,
    /// Hartmann's constant, nm, `[-1000, 1000]`: the index at wavelength `l` is `n + hartmann / l`.
    pub hartmann: f64,
}

impl Dielectric {
    /// Wavelength at which RADIANCE refracts, nm.
    pub const MEAN_WAVELENGTH: f64 = 500.0;

    /// The refractive index at [`Dielectric::MEAN_WAVELENGTH`].
    pub fn index(&self) -> f64 {
        self.refractive_index + self.hartmann / Self::MEAN_WAVELENGTH
    }
}

impl Parameters for Dielectric {
    const TYPE: &'static str = "dielectric";
    const ARGUMENTS: &'static [Argument] = &[
        Argument::share("rtn", "red transmissivity of a unit length"),
        Argument::share("gtn", "green transmissivity of a unit length"),
        Argument::share("btn", "blue transmissivity of a unit length"),
        Argument {
            name: "n",
            low: 0.1,
            high: 10.0,
            what: "refractive index of the body in air",
        },
        Argument {
            name: "hc",
            low: -1000.0,
            high: 1000.0,
            what: "Hartmann's constant in nm, 0 without dispersion",
        },
    ];

    fn from_arguments(strings: &[String], reals: &[f64]) -> Result<Self, BsdfError> {
        no_strings(strings)?;
        check_reals::<Self>(reals)?;
        Dielectric {
            transmissivity: rgb(reals),
            refractive_index: reals[3],
            hartmann: reals[4],
        }
        .checked()
    }

    fn reals(&self) -> Vec<f64> {
        let mut reals = self.transmissivity.to_vec();
        reals.extend([self.refractive_index, self.hartmann]);
        reals
    }

    fn check(&self) -> Result<(), BsdfError> {
        check_reals::<Self>(&self.reals())?;
        if self.index() < 0.1 {
            return Err(BsdfError::Domain {
                field: "hc",
                found: self.hartmann.to_string(),
                allowed: "n + hc/500 of at least 0.1".into(),
            });
        }
        Ok(())
    }
}
