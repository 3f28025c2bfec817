//! Quantised logarithms of ratios.

use crate::BsdfError;

use super::coding::{self, MOST, Weights};
use super::domain;
use super::frame::Frame;

/// Largest logarithm of a ratio that a table may hold, either sign.
pub const LARGEST: f64 = 30.0;

/// Logarithms of ratios at the nodes of a frame: `offset + step code`, one offset and step for each channel and `x`.
#[derive(Clone, Debug, PartialEq)]
pub struct Quantised {
    codes: Vec<i16>,
    offset: Vec<f32>,
    step: Vec<f32>,
    /// What predicts a code from its neighbours, one a channel; it counts for the stored bytes alone.
    weights: Vec<Weights>,
}

/// A stored channel of a table.
#[derive(Clone, Debug, PartialEq)]
pub struct Coded {
    /// The codes, [`Quantised::coded`].
    pub bytes: Vec<u8>,
    /// Offsets: one for each `x`, or one for all.
    pub offset: Vec<f32>,
    /// Steps: as many.
    pub step: Vec<f32>,
}

impl Coded {
    /// Stored bytes: codes, offsets and steps.
    pub fn len(&self) -> usize {
        self.bytes.len() + 4 * (self.offset.len() + self.step.len())
    }

    /// Whether nothing is stored.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }
}

impl Quantised {
    /// Quantises `values` (`[channel][node]`, of `frame`) to 8 or 16 `bits`: the range of each channel and `x` is divided
    /// evenly, and values are within half a step. Values beyond [`LARGEST`] are drawn to it.
    ///
    /// # Errors
    /// [`BsdfError::Domain`] for other numbers of bits, and values that are not as many as the frame says or not finite.
    pub fn of(frame: &Frame, values: &[f64], bits: u32) -> Result<Self, BsdfError> {
        check_values(frame, values)?;
        let half = match bits {
            8 => 127.0,
            16 => 32767.0,
            _ => return Err(domain("bits", bits.to_string(), "8 or 16")),
        };
        let (mut offset, mut step, mut codes) = (Vec::new(), Vec::new(), Vec::new());
        for row in values.chunks(frame.len() / frame.shape[0]) {
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
                code.round().clamp(-half, half) as i16
            }));
            offset.push(centre);
            step.push(width);
        }
        Self::of_codes(frame, codes, offset, step)
    }

    /// Quantises `values` (`[channel][node]`, of `frame`) in steps of `step`, each within half a step or within the `slack` of
    /// its node (half widths, in logarithms, as many as values), whichever is more; within its slack a value takes what needs
    /// the fewest bytes.
    ///
    /// # Errors
    /// [`BsdfError::Domain`] for a step that is not between 0.0025 and 2, and values or slacks that are not as many as the
    /// frame says or not finite.
    pub fn near(frame: &Frame, values: &[f64], step: f64, slack: &[f64]) -> Result<Self, BsdfError> {
        check_values(frame, values)?;
        if !(0.0025..=2.0).contains(&step) {
            return Err(domain("step", step.to_string(), "0.0025 to 2"));
        }
        if slack.len() != values.len() || slack.iter().any(|s| !s.is_finite()) {
            let found = format!("{} values", slack.len());
            return Err(domain("slack", found, format!("{} finite numbers", values.len())));
        }
        let step = step as f32;
        let wide = f64::from(step);
        let (mut codes, mut weights) = (Vec::new(), Vec::new());
        for (values, slack) in values.chunks(frame.len()).zip(slack.chunks(frame.len())) {
            let values: Vec<f64> = values.iter().map(|v| v.clamp(-LARGEST, LARGEST)).collect();
            let own = coding::weights(frame.shape, &values);
            let near = coding::near(frame.shape, &own, &values, wide, |k| slack[k] / wide);
            codes.extend(near.iter().map(|c| *c as i16));
            weights.push(own);
        }
        let rows = weights.len() * frame.shape[0];
        Ok(Quantised {
            codes,
            offset: vec![0.0; rows],
            step: vec![step; rows],
            weights,
        })
    }

    /// The table of known codes (`[channel][node]`), offsets and steps (`[channel][x]`).
    ///
    /// # Errors
    /// [`BsdfError::Domain`] for numbers that are not as many as the frame says, and logarithms beyond twice [`LARGEST`].
    pub fn of_codes(
        frame: &Frame,
        codes: Vec<i16>,
        offset: Vec<f32>,
        step: Vec<f32>,
    ) -> Result<Self, BsdfError> {
        frame.check()?;
        if codes.is_empty() || !codes.len().is_multiple_of(frame.len()) {
            let allowed = format!("a multiple of {} nodes", frame.len());
            return Err(domain("codes", format!("{} values", codes.len()), allowed));
        }
        let weights = codes
            .chunks(frame.len())
            .map(|codes| {
                let values: Vec<f64> = codes.iter().map(|c| f64::from(*c)).collect();
                coding::weights(frame.shape, &values)
            })
            .collect();
        let table = Quantised {
            codes,
            offset,
            step,
            weights,
        };
        table.check(frame, table.weights.len())?;
        Ok(table)
    }

    /// The table of stored channels.
    ///
    /// # Errors
    /// As [`Quantised::of_codes`], and for bytes that are no codes of the frame.
    pub fn of_coded(frame: &Frame, channels: &[Coded]) -> Result<Self, BsdfError> {
        frame.check()?;
        let mut table = Quantised {
            codes: Vec::new(),
            offset: Vec::new(),
            step: Vec::new(),
            weights: Vec::new(),
        };
        for channel in channels {
            let (weights, codes) = coding::decode(frame.shape, &channel.bytes)?;
            table.codes.extend(codes.iter().map(|c| *c as i16));
            table.weights.push(weights);
            for (rows, given) in [
                (&mut table.offset, &channel.offset),
                (&mut table.step, &channel.step),
            ] {
                match given[..] {
                    [one] => rows.extend(std::iter::repeat_n(one, frame.shape[0])),
                    _ => rows.extend_from_slice(given),
                }
            }
        }
        table.check(frame, channels.len())?;
        Ok(table)
    }

    /// What is stored of each channel. Offsets and steps that are the same at every `x` are stored once.
    pub fn coded(&self, frame: &Frame) -> Vec<Coded> {
        let rows = frame.shape[0];
        let once = |v: &[f32]| v.iter().all(|x| *x == v[0]);
        self.weights
            .iter()
            .enumerate()
            .map(|(c, weights)| {
                let codes: Vec<i32> = self.codes[c * frame.len()..(c + 1) * frame.len()]
                    .iter()
                    .map(|v| i32::from(*v))
                    .collect();
                let (offset, step) = (
                    &self.offset[c * rows..(c + 1) * rows],
                    &self.step[c * rows..(c + 1) * rows],
                );
                let kept = if once(offset) && once(step) { 1 } else { rows };
                Coded {
                    bytes: coding::encode(frame.shape, weights, &codes),
                    offset: offset[..kept].to_vec(),
                    step: step[..kept].to_vec(),
                }
            })
            .collect()
    }

    /// The codes, `[channel][x][p_i][u][p_h]`.
    pub fn codes(&self) -> &[i16] {
        &self.codes
    }

    /// The offsets, `[channel][x]`.
    pub fn offset(&self) -> &[f32] {
        &self.offset
    }

    /// The steps, `[channel][x]`; not negative.
    pub fn step(&self) -> &[f32] {
        &self.step
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
        let rows = self.codes.chunks(frame.len() / frame.shape[0]);
        for ((offset, step), codes) in self.offset.iter().zip(&self.step).zip(rows) {
            let most = codes.iter().map(|c| c.unsigned_abs()).max().unwrap_or(0);
            let largest = f64::from(offset.abs()) + f64::from(most) * f64::from(*step);
            // false for NaN
            if !(*step >= 0.0 && largest <= 2.1 * LARGEST) {
                let found = format!("offset {offset}, step {step}, codes up to {most}");
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
        self.codes
            .iter()
            .enumerate()
            .map(|(k, code)| {
                f64::from(self.offset[k / row]) + f64::from(self.step[k / row]) * f64::from(*code)
            })
            .collect()
    }
}

/// Values of one or more channels of a sound frame, all finite.
fn check_values(frame: &Frame, values: &[f64]) -> Result<(), BsdfError> {
    frame.check()?;
    if values.is_empty() || !values.len().is_multiple_of(frame.len()) {
        let allowed = format!("a multiple of {} nodes", frame.len());
        return Err(domain("values", format!("{} values", values.len()), allowed));
    }
    match values.iter().find(|v| !v.is_finite()) {
        Some(bad) => Err(domain("values", bad.to_string(), "finite numbers")),
        None => Ok(()),
    }
}

// codes are kept in two bytes
const _: () = assert!(MOST == i16::MAX as i32);
