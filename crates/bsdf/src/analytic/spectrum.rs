//! Albedo of a lobe in each channel.

use crate::{BsdfError, Channel};

use super::in_range;

/// One albedo in `[0, 1]` for each named channel.
#[derive(Clone, Debug, PartialEq)]
pub struct Spectrum {
    channels: Vec<Channel>,
    values: Vec<f64>,
}

impl Spectrum {
    /// An albedo for each channel. At least one channel, none twice, every value in `[0, 1]`; `field` is the name of
    /// the parameter in the error.
    pub fn new(field: &'static str, values: &[(Channel, f64)]) -> Result<Self, BsdfError> {
        if values.is_empty() {
            return Err(BsdfError::Domain {
                field,
                found: "no channel".into(),
                allowed: "one value for each of at least one channel".into(),
            });
        }
        let mut channels = Vec::with_capacity(values.len());
        for &(channel, value) in values {
            in_range(field, value, 0.0, 1.0)?;
            if channels.contains(&channel) {
                return Err(BsdfError::Domain {
                    field,
                    found: format!("channel {channel} twice"),
                    allowed: "each channel once".into(),
                });
            }
            channels.push(channel);
        }
        Ok(Spectrum {
            channels,
            values: values.iter().map(|&(_, v)| v).collect(),
        })
    }

    /// A single photopic albedo in `[0, 1]`.
    pub fn photopic(field: &'static str, value: f64) -> Result<Self, BsdfError> {
        Spectrum::new(field, &[(Channel::Photopic, value)])
    }

    /// The channels in order.
    pub fn channels(&self) -> &[Channel] {
        &self.channels
    }

    /// The albedos in the order of [`Spectrum::channels`].
    pub fn values(&self) -> &[f64] {
        &self.values
    }
}
