//! Real arguments of a material as data: names, ranges, meaning.

use std::ops::RangeInclusive;

use crate::BsdfError;

/// A real argument of a material type.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Argument {
    /// Name as in the RADIANCE manual.
    pub name: &'static str,
    /// Smallest value allowed.
    pub low: f64,
    /// Largest value allowed.
    pub high: f64,
    /// What it is.
    pub what: &'static str,
    /// Whether it may be left out; such arguments come last.
    pub optional: bool,
}

impl Argument {
    /// A share of the light, `[0, 1]`.
    pub(super) const fn share(name: &'static str, what: &'static str) -> Self {
        Argument {
            name,
            low: 0.0,
            high: 1.0,
            what,
            optional: false,
        }
    }

    /// The error for `value` unless it lies in `[low, high]`.
    pub(super) fn check(&self, value: f64) -> Result<(), BsdfError> {
        if (self.low..=self.high).contains(&value) {
            return Ok(());
        }
        Err(BsdfError::Domain {
            field: self.name,
            found: value.to_string(),
            allowed: format!("{} to {}", self.low, self.high),
        })
    }
}

pub(super) const RED: Argument = Argument::share("red", "red of the colour");
pub(super) const GREEN: Argument = Argument::share("green", "green of the colour");
pub(super) const BLUE: Argument = Argument::share("blue", "blue of the colour");
pub(super) const SPEC: Argument =
    Argument::share("spec", "specularity: share of the light in the gloss lobe");
pub(super) const ROUGH: Argument = Argument::share(
    "rough",
    "alpha of the lobes (rms slope times sqrt 2); up to 0.001 is smooth",
);
pub(super) const TRANS: Argument = Argument::share(
    "trans",
    "share of the light that is not glossily reflected which goes through",
);
pub(super) const TSPEC: Argument =
    Argument::share("tspec", "share of the transmitted light in the through lobe");
pub(super) const UROUGH: Argument = width("urough", "alpha along u");
pub(super) const VROUGH: Argument = width("vrough", "alpha along v = n x u");

const fn width(name: &'static str, what: &'static str) -> Argument {
    Argument {
        name,
        low: 1e-3,
        high: 1.0,
        what,
        optional: false,
    }
}

/// How many reals a list may have.
pub(super) fn counts(arguments: &[Argument]) -> RangeInclusive<usize> {
    let needed = arguments.iter().filter(|a| !a.optional).count();
    needed..=arguments.len()
}

/// The error for a list of reals of the wrong length.
pub(super) fn wrong_count(arguments: &[Argument], found: usize) -> BsdfError {
    let names: Vec<&str> = arguments.iter().map(|a| a.name).collect();
    let counts: Vec<String> = counts(arguments).map(|n| n.to_string()).collect();
    BsdfError::Domain {
        field: "real arguments",
        found: found.to_string(),
        allowed: format!("{}: {}", counts.join(" or "), names.join(" ")),
    }
}

/// The error for string arguments where there are none.
pub(super) fn no_strings(strings: &[String]) -> Result<(), BsdfError> {
    if strings.is_empty() {
        return Ok(());
    }
    Err(BsdfError::Domain {
        field: "string arguments",
        found: strings.len().to_string(),
        allowed: "0".into(),
    })
}
