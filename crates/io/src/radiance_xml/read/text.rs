//! Numbers and lengths of text elements, and the errors that name line and field.

use gonio_bsdf::BsdfError;

use super::super::stream::Stop;
use super::state::State;
use crate::{IoError, excerpt};

impl State<'_> {
    pub(super) fn error(
        &self,
        line: u64,
        field: &str,
        found: impl Into<String>,
        allowed: impl Into<String>,
    ) -> IoError {
        IoError::format(self.path, line, field, found, allowed)
    }

    pub(super) fn stopped(&self, stop: Stop, line: u64) -> IoError {
        match stop {
            Stop::Io(e) => IoError::file(self.path, e),
            Stop::Long(text) => self.error(
                line,
                "ScatteringData",
                excerpt(&text),
                "a number of at most 64 characters",
            ),
            Stop::Fault {
                field,
                found,
                allowed,
            } => self.error(line, field, found, allowed),
        }
    }

    pub(super) fn domain(&self, e: BsdfError, line: u64) -> IoError {
        let BsdfError::Domain {
            field,
            found,
            allowed,
        } = e;
        self.error(line, field, found, allowed)
    }

    pub(super) fn number(&self, field: &str, text: &str, line: u64) -> Result<f64, IoError> {
        text.parse::<f64>()
            .ok()
            .filter(|v| v.is_finite())
            .ok_or_else(|| self.error(line, field, excerpt(text.as_bytes()), "a number"))
    }

    /// A length in metres; empty is unknown.
    pub(super) fn length(&self, field: &str, text: &str, line: u64) -> Result<Option<f64>, IoError> {
        if text.is_empty() {
            return Ok(None);
        }
        let value = self.number(field, text, line)?;
        let metres = match self.unit.to_ascii_lowercase().as_str() {
            "" | "meter" | "metre" => value,
            "centimeter" => value / 100.0,
            "millimeter" => value / 1000.0,
            "inch" => value * 0.0254,
            "foot" => value * 0.3048,
            other => {
                let allowed = "meter, centimeter, millimeter, inch, foot";
                return Err(self.error(
                    line,
                    &format!("unit of {field}"),
                    excerpt(other.as_bytes()),
                    allowed,
                ));
            }
        };
        Ok(Some(metres))
    }
}
