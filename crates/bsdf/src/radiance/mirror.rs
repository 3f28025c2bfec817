//! `mirror`: an ideal mirror.

use super::{Argument, Parameters, Rgb, check_reals, rgb};
use crate::BsdfError;

/// `void mirror id 1 material 0 3 red green blue` or `void mirror id 0 0 3 red green blue`.
#[derive(Clone, Debug, PartialEq)]
pub struct Mirror {
    /// Reflectance at every angle, `[0, 1]`; the back is black.
    pub color: Rgb,
    /// The material that the eye sees in its place; only light sources are then mirrored.
    pub alternate: Option<String>,
}

impl Parameters for Mirror {
    const TYPE: &'static str = "mirror";
    const ARGUMENTS: &'static [Argument] = &[
        Argument::share("red", "red reflectance"),
        Argument::share("green", "green reflectance"),
        Argument::share("blue", "blue reflectance"),
    ];

    fn from_arguments(strings: &[String], reals: &[f64]) -> Result<Self, BsdfError> {
        if strings.len() > 1 {
            return Err(BsdfError::Domain {
                field: "string arguments",
                found: strings.len().to_string(),
                allowed: "0, or 1: the material seen in its place".into(),
            });
        }
        check_reals::<Self>(reals)?;
        Ok(Mirror {
            color: rgb(reals),
            alternate: strings.first().cloned(),
        })
    }

    fn reals(&self) -> Vec<f64> {
        self.color.to_vec()
    }

    fn strings(&self) -> Vec<String> {
        self.alternate.iter().cloned().collect()
    }
}
