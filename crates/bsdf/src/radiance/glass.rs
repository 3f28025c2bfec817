//! `glass`: a thin pane as one surface.

use super::argument::no_strings;
use super::{Argument, Parameters, Rgb, check_reals, rgb};
use crate::BsdfError;

/// `void glass id 0 0 3 rtn gtn btn` or `… 4 rtn gtn btn n`.
#[derive(Clone, Debug, PartialEq)]
pub struct Glass {
    /// Transmissivity: the share that one passage through the pane at normal incidence leaves, without the
    /// reflections at its two faces, `[0, 1]`.
    pub transmissivity: Rgb,
    /// Refractive index, `[1, 10]`; [`Glass::DEFAULT_INDEX`] when the file does not give it.
    pub refractive_index: Option<f64>,
}

impl Glass {
    /// The refractive index RADIANCE takes when there is none in the file.
    pub const DEFAULT_INDEX: f64 = 1.52;

    /// The refractive index.
    pub fn index(&self) -> f64 {
        self.refractive_index.unwrap_or(Self::DEFAULT_INDEX)
    }
}

impl Parameters for Glass {
    const TYPE: &'static str = "glass";
    const ARGUMENTS: &'static [Argument] = &[
        Argument::share("rtn", "red transmissivity of one passage at normal incidence"),
        Argument::share("gtn", "green transmissivity of one passage at normal incidence"),
        Argument::share("btn", "blue transmissivity of one passage at normal incidence"),
        Argument {
            name: "n",
            low: 1.0,
            high: 10.0,
            what: "refractive index, 1.52 when left out",
        },
    ];
    const OPTIONAL: usize = 1;

    fn from_arguments(strings: &[String], reals: &[f64]) -> Result<Self, BsdfError> {
        no_strings(strings)?;
        check_reals::<Self>(reals)?;
        Ok(Glass {
            transmissivity: rgb(reals),
            refractive_index: reals.get(3).copied(),
        })
    }

    fn reals(&self) -> Vec<f64> {
        let mut reals = self.transmissivity.to_vec();
        reals.extend(self.refractive_index);
        reals
    }
}
