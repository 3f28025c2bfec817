//! The outcome of a check.

use std::fmt;

/// How a check ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum Level {
    /// The check does not apply or gives a figure without a limit.
    Info,
    /// Within the limit.
    Pass,
    /// Usable, with a reservation that the sentence names.
    Warn,
    /// Not to be used before the cause is found.
    Fail,
}

impl Level {
    /// Name used in files, Python and reports.
    pub fn name(self) -> &'static str {
        match self {
            Level::Info => "info",
            Level::Pass => "pass",
            Level::Warn => "warn",
            Level::Fail => "fail",
        }
    }
}

impl fmt::Display for Level {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}

/// One check's verdict: a level, a number and a sentence a lab engineer can act on.
#[derive(Clone, Debug, PartialEq)]
pub struct Verdict {
    /// Stable identifier, `snake_case`.
    pub id: &'static str,
    /// Title for tables.
    pub title: &'static str,
    /// How it ended.
    pub level: Level,
    /// The figure the level was decided on; `None` when there is nothing to measure.
    pub value: Option<f64>,
    /// Unit of `value` (`1`, `%`, `deg`, `1/sr`); empty without a value.
    pub unit: &'static str,
    /// What was found and what to do.
    pub sentence: String,
}

impl Verdict {
    /// A check that has nothing to judge in these data.
    pub(crate) fn not_applicable(id: &'static str, title: &'static str, sentence: impl Into<String>) -> Self {
        Verdict {
            id,
            title,
            level: Level::Info,
            value: None,
            unit: "",
            sentence: sentence.into(),
        }
    }
}

/// The level of a value that is good below `warn` and bad from `fail` on.
pub(crate) fn graded(value: f64, warn: f64, fail: f64) -> Level {
    if value >= fail {
        Level::Fail
    } else if value >= warn || value.is_nan() {
        Level::Warn
    } else {
        Level::Pass
    }
}
