//! Words of a command line, and numbers as C prints them.

use thiserror::Error;

use crate::error::{Place, SceneError};

/// What a command line asks that the generator does not do.
#[derive(Debug, Clone, PartialEq, Error)]
pub enum GenerateError {
    /// An option that the generator does not have.
    #[error("{command}: unknown option `{option}`; the options are {allowed}")]
    UnknownOption {
        /// The generator.
        command: &'static str,
        /// The word.
        option: String,
        /// The options it has.
        allowed: &'static str,
    },
    /// A word that is missing or not what its place needs.
    #[error("{command}: {what} is {found}; it must be {allowed}")]
    BadValue {
        /// The generator.
        command: &'static str,
        /// Which value.
        what: String,
        /// What stands there.
        found: String,
        /// What may stand there.
        allowed: &'static str,
    },
}

impl GenerateError {
    /// The error of a command that stands at `place` of a scene.
    pub(crate) fn at(self, place: &Place) -> SceneError {
        match self {
            GenerateError::UnknownOption {
                command,
                option,
                allowed,
            } => place.fault(command, format!("unknown option `{option}`"), allowed),
            GenerateError::BadValue {
                command,
                what,
                found,
                allowed,
            } => place.fault(format!("{command}: {what}"), found, allowed),
        }
    }
}

pub(super) struct Words<'w> {
    pub(super) command: &'static str,
    rest: std::slice::Iter<'w, &'w str>,
}

impl<'w> Words<'w> {
    pub(super) fn new(command: &'static str, words: &'w [&'w str]) -> Self {
        Words {
            command,
            rest: words.iter(),
        }
    }

    pub(super) fn next(&mut self) -> Option<&'w str> {
        self.rest.next().copied()
    }

    pub(super) fn wrong<T>(
        &self,
        what: &str,
        found: &str,
        allowed: &'static str,
    ) -> Result<T, GenerateError> {
        Err(GenerateError::BadValue {
            command: self.command,
            what: what.into(),
            found: if found.is_empty() {
                "missing".into()
            } else {
                format!("`{found}`")
            },
            allowed,
        })
    }

    /// The next word as a finite number.
    pub(super) fn number(&mut self, what: &str) -> Result<f64, GenerateError> {
        let word = self.next().unwrap_or("");
        match word.parse::<f64>() {
            Ok(value) if value.is_finite() => Ok(value),
            _ => self.wrong(what, word, "a number"),
        }
    }

    /// The next word as an angle, degrees to radians.
    pub(super) fn angle(&mut self, what: &str) -> Result<f64, GenerateError> {
        Ok(self.number(what)?.to_radians())
    }

    /// The next word as a whole number within bounds.
    pub(super) fn whole(
        &mut self,
        what: &str,
        low: i32,
        high: i32,
        allowed: &'static str,
    ) -> Result<i32, GenerateError> {
        let word = self.next().unwrap_or("");
        match word.parse::<i32>() {
            Ok(value) if (low..=high).contains(&value) => Ok(value),
            _ => self.wrong(what, word, allowed),
        }
    }

    pub(super) fn unknown<T>(&self, option: &str, allowed: &'static str) -> Result<T, GenerateError> {
        Err(GenerateError::UnknownOption {
            command: self.command,
            option: option.into(),
            allowed,
        })
    }
}

/// As C's `%.3e`.
pub(super) fn e3(value: f64) -> String {
    let text = format!("{value:.3e}");
    match text.split_once('e') {
        Some((mantissa, exponent)) => {
            let (sign, digits) = exponent
                .strip_prefix('-')
                .map_or(('+', exponent), |digits| ('-', digits));
            format!("{mantissa}e{sign}{digits:0>2}")
        }
        None => text,
    }
}

/// Three numbers as C's `%f`, blanks between.
pub(super) fn f6(v: [f64; 3]) -> String {
    format!("{:.6} {:.6} {:.6}", v[0], v[1], v[2])
}

/// `source` and `light` of a sun.
pub(super) fn solar(radiance: &str, direction: [f64; 3], angle: &str) -> String {
    format!(
        "\nvoid light solar\n0\n0\n3 {radiance} {radiance} {radiance}\n\nsolar source sun\n0\n0\n4 {} {angle}\n",
        f6(direction)
    )
}

/// Largest altitude of the sun that the skies with a sun take, degrees.
pub(super) const HIGHEST: f64 = 87.0;
