//! Which quantity a number is.

use std::fmt;
use std::str::FromStr;

use crate::BsdfError;

/// The quantity of a data set: a type, never a guess.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Quantity {
    /// Raw detector reading in any linear unit.
    Signal,
    /// `f = dL_s/dE_i` [1/sr], no cosine inside.
    Bsdf,
    /// `f |cos theta_s|` [1/sr].
    Dsf,
    /// `pi f` [1] (reflectance or radiance factor).
    ReflectanceFactor,
}

impl Quantity {
    /// Name used in files and Python attributes.
    pub fn name(self) -> &'static str {
        match self {
            Quantity::Signal => "signal",
            Quantity::Bsdf => "bsdf",
            Quantity::Dsf => "dsf",
            Quantity::ReflectanceFactor => "reflectance_factor",
        }
    }

    /// Factor that turns a value of this quantity at `cos_theta_s` into a DSF; `None` for a raw signal, which needs
    /// a beam power or a standard first.
    pub fn to_dsf(self, cos_theta_s: f64) -> Option<f64> {
        match self {
            Quantity::Signal => None,
            Quantity::Bsdf => Some(cos_theta_s.abs()),
            Quantity::Dsf => Some(1.0),
            Quantity::ReflectanceFactor => Some(cos_theta_s.abs() / std::f64::consts::PI),
        }
    }
}

impl fmt::Display for Quantity {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}

impl FromStr for Quantity {
    type Err = BsdfError;

    /// Case-insensitive; `brdf` and `btdf` are `bsdf`, `brf` is `reflectance_factor`.
    fn from_str(s: &str) -> Result<Self, Self::Err> {
        match s.to_ascii_lowercase().as_str() {
            "signal" => Ok(Quantity::Signal),
            "bsdf" | "brdf" | "btdf" => Ok(Quantity::Bsdf),
            "dsf" => Ok(Quantity::Dsf),
            "reflectance_factor" | "brf" => Ok(Quantity::ReflectanceFactor),
            _ => Err(BsdfError::Domain {
                field: "quantity",
                found: format!("{s:?}"),
                allowed: "signal, bsdf, dsf, reflectance_factor".into(),
            }),
        }
    }
}
