//! Quantised logarithms of ratios, and their interpolation.

use crate::BsdfError;

use super::domain;
use super::frame::Frame;

/// Codes of 8 or 16 bits, `[channel][x][p_i][u][p_h]`.
#[derive(Clone, Debug, PartialEq)]
pub enum Codes {
    /// One byte each.
    Eight(Vec<i8>),
    /// Two bytes each.
    Sixteen(Vec<i16>),
}

impl Codes {
    /// Number of codes.
    pub fn len(&self) -> usize {
        match self {
            Codes::Eight(v) => v.len(),
            Codes::Sixteen(v) => v.len(),
        }
    }

    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// Bits of a code.
    pub fn bits(&self) -> u32 {
        match self {
            Codes::Eight(_) => 8,
            Codes::Sixteen(_) => 16,
        }
    }

    fn at(&self, k: usize) -> f64 {
        match self {
            Codes::Eight(v) => f64::from(v[k]),
            Codes::Sixteen(v) => f64::from(v[k]),
        }
    }
}

/// Largest logarithm of a ratio that a table may hold, either sign.
pub const LARGEST: f64 = 30.0;

/// Logarithms of ratios at the nodes of a frame: `offset + step code`, one offset and step for each channel and `x`.
#[derive(Clone, Debug, PartialEq)]
pub struct Quantised {
    /// The codes.
    pub codes: Codes,
    /// `[channel][x]`.
    pub offset: Vec<f32>,
    /// `[channel][x]`, positive or 0.
    pub step: Vec<f32>,
}

impl Quantised {
    /// Quantises `values` (`[channel][node]`, of `frame`) to 8 or 16 `bits`: the range of each channel and `x` is divided
    /// evenly, and values are within half a step. Values beyond [`LARGEST`] are drawn to it.
    ///
    /// # Errors
    /// [`BsdfError::Domain`] for other numbers of bits, and values that are not as many as the frame says or not finite.
    pub fn of(frame: &Frame, values: &[f64], bits: u32) -> Result<Self, BsdfError> {
        frame.check()?;
        let row = frame.len() / frame.shape[0];
        if values.is_empty() || !values.len().is_multiple_of(frame.len()) {
            let allowed = format!("a multiple of {} nodes", frame.len());
            return Err(domain("values", format!("{} values", values.len()), allowed));
        }
        if let Some(bad) = values.iter().find(|v| !v.is_finite()) {
            return Err(domain("values", bad.to_string(), "finite numbers"));
        }
        let half = match bits {
            8 => 127.0,
            16 => 32767.0,
            _ => return Err(domain("bits", bits.to_string(), "8 or 16")),
        };
        let (mut offset, mut step, mut codes) = (Vec::new(), Vec::new(), Vec::new());
        for row in values.chunks(row) {
            let drawn = row.iter().map(|v| v.clamp(-LARGEST, LARGEST));
            let (low, high) = drawn
                .clone()
                .fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), v| {
                    (a.min(v), b.max(v))
                });
            // rounded first, so that codes belong to the numbers that are kept
            let centre = (0.5 * (low + high)) as f32;
            let width = ((high - low) / (2.0 * half)) as f32;
            codes.extend(drawn.map(|v| {
                let code = if width > 0.0 {
                    (v - f64::from(centre)) / f64::from(width)
                } else {
                    0.0
                };
                code.round().clamp(-half, half)
            }));
            offset.push(centre);
            step.push(width);
        }
        Ok(Quantised {
            codes: if bits == 8 {
                Codes::Eight(codes.iter().map(|c| *c as i8).collect())
            } else {
                Codes::Sixteen(codes.iter().map(|c| *c as i16).collect())
            },
            offset,
            step,
        })
    }

    /// Checks lengths and ranges for `channels` channels of `frame`.
    pub(super) fn check(&self, frame: &Frame, channels: usize) -> Result<(), BsdfError> {
        let lengths = [
            ("codes", self.codes.len(), frame.len() * channels),
            ("offset", self.offset.len(), frame.shape[0] * channels),
            ("step", self.step.len(), frame.shape[0] * channels),
        ];
        for (field, found, needed) in lengths {
            if found != needed {
                let allowed = format!("{needed} for {channels} channels of {:?} nodes", frame.shape);
                return Err(domain(field, format!("{found} values"), allowed));
            }
        }
        let half = if self.codes.bits() == 8 { 128.0 } else { 32768.0 };
        for (offset, step) in self.offset.iter().zip(&self.step) {
            let largest = f64::from(offset.abs()) + half * f64::from(*step);
            // false for NaN
            if !(*step >= 0.0 && largest <= 2.1 * LARGEST) {
                let found = format!("offset {offset}, step {step}");
                return Err(domain(
                    "offset",
                    found,
                    format!("logarithms up to {}", 2.0 * LARGEST),
                ));
            }
        }
        Ok(())
    }

    /// The values, `[channel][node]`.
    pub fn values(&self, frame: &Frame) -> Vec<f64> {
        let row = frame.len() / frame.shape[0];
        (0..self.codes.len())
            .map(|k| f64::from(self.offset[k / row]) + f64::from(self.step[k / row]) * self.codes.at(k))
            .collect()
    }
}
