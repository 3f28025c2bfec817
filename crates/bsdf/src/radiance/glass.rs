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

    /// Transmittance of the pane, all passages between its faces summed, at an angle of cosine `cos` in `(0, 1]` on
    /// either side: per polarisation `(1 - r)^2 t / (1 - r^2 t^2)` with `r` of one face by Fresnel's law and
    /// `t = transmissivity^(1 / cos')`, `cos'` inside the pane [Radiance, rt/glass.c]. The light goes on unbent.
    pub fn transmittance(&self, cos: f64) -> Rgb {
        let (faces, inside) = self.faces(cos);
        self.transmissivity.map(|tn| {
            let t = tn.powf(1.0 / inside);
            mean(faces.map(|r| (1.0 - r).powi(2) * t / (1.0 - r * r * t * t)))
        })
    }

    /// Reflectance of the pane at an angle of cosine `cos` in `(0, 1]` on either side: per polarisation
    /// `r (1 + (1 - 2r) t^2) / (1 - r^2 t^2)`, symbols as in [`Glass::transmittance`].
    pub fn reflectance(&self, cos: f64) -> Rgb {
        let (faces, inside) = self.faces(cos);
        self.transmissivity.map(|tn| {
            let t2 = tn.powf(2.0 / inside);
            mean(faces.map(|r| r * (1.0 + (1.0 - 2.0 * r) * t2) / (1.0 - r * r * t2)))
        })
    }

    /// Reflectance of one face in both polarisations and the cosine inside.
    fn faces(&self, cos: f64) -> ([f64; 2], f64) {
        let n = self.index();
        let inside = (1.0 - (1.0 - cos * cos) / (n * n)).sqrt();
        let r = |a: f64, b: f64| ((a - b) / (a + b)).powi(2);
        ([r(cos, n * inside), r(inside, n * cos)], inside)
    }
}

fn mean([a, b]: [f64; 2]) -> f64 {
    0.5 * (a + b)
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
            optional: true,
        },
    ];

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
