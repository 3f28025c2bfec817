//! The detector.

use std::f64::consts::PI;

use gonio_bsdf::Channel;

use crate::InstrumentError;
use crate::error::in_range;

/// The detector and its electronics. Levels are in the unit of the signal.
#[derive(Clone, Debug, PartialEq)]
pub struct Detector {
    /// Distance from the sample's centre, metres, `[0.05, 100]`.
    pub distance: f64,
    /// Half angle of the round aperture seen from the sample, radians, `[1e-5, 0.1]`.
    pub aperture: f64,
    /// Standard deviation of the read-out noise.
    pub noise_readout: f64,
    /// Standard deviation of the noise proportional to the signal, as a fraction, `[0, 0.5]`.
    pub noise_relative: f64,
    /// Shot noise: variance over signal, in the unit of the signal, `>= 0`.
    pub noise_shot: f64,
    /// Mean dark level.
    pub dark_level: f64,
    /// Amplitude of the slow swing of the dark level about its mean.
    pub dark_swing: f64,
    /// Period of that swing, seconds, `>= 60`.
    pub dark_period: f64,
    /// Highest reading; stronger signals read this.
    pub saturation: f64,
    /// Readings a second, `[0.1, 1e5]`.
    pub rate: f64,
    /// Angular speed along the path, rad/s, `[1e-4, 100]`. Where the path asks for readings further apart than it covers between
    /// two of them, they are taken later. `None`: fast enough for any path.
    pub speed: Option<f64>,
    /// Share of the way from one reading to the next over which a reading averages, `[0, 1]`: the detector does not stop.
    pub integration: f64,
    /// Half angle around the retro direction in which the detector shades the beam, radians, `[0, 0.5]`.
    pub shadow: f64,
    /// Standard deviation of the difference between true and recorded direction, in each of two axes, radians.
    pub pointing: f64,
    /// Binary digits of a reading within its full scale, `[0, 32]`; 0 leaves readings as they are.
    pub bits: u32,
    /// Gain ranges in increasing order of full scale; a reading is taken in the first that holds it. Empty: one range of
    /// `noise_readout` up to `saturation`.
    pub ranges: Vec<GainRange>,
    /// What is recorded at once. Empty: one output a channel of the model, each with the whole beam.
    pub outputs: Vec<Output>,
}

/// A gain range of the amplifier. Levels are in the unit of the signal: readings are divided by their gain.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct GainRange {
    /// Highest reading, `> 0`.
    pub full_scale: f64,
    /// Standard deviation of the read-out noise.
    pub noise_readout: f64,
    /// Relative error of the gain, `[-0.2, 0.2]`.
    pub gain_error: f64,
}

/// One of several detectors that stand side by side, or a filter in front of one.
#[derive(Clone, Debug, PartialEq)]
pub struct Output {
    /// Channel under which it is recorded.
    pub channel: Channel,
    /// Its share of the beam's power as a factor, `> 0`: lamp times responsivity.
    pub power: f64,
    /// Weight of each channel of the model in what it sees of the sample; their sum is 1.
    pub weights: Vec<f64>,
}

impl Default for Detector {
    /// 1.020 m, aperture of .1 degrees, noise .05 and .8 %, dark 2 swinging by 0.5 in two hours, 100 readings a second,
    /// shadow of 3 degrees, pointing to .001 degrees.
    fn default() -> Self {
        Detector {
            distance: 1.020,
            aperture: 0.1_f64.to_radians(),
            noise_readout: 0.05,
            noise_relative: 0.008,
            dark_level: 2.0,
            dark_swing: 0.5,
            dark_period: 7200.0,
            saturation: 1e9,
            rate: 100.0,
            shadow: 3.0_f64.to_radians(),
            pointing: 0.001_f64.to_radians(),
            noise_shot: 0.0,
            speed: None,
            integration: 0.0,
            bits: 0,
            ranges: Vec::new(),
            outputs: Vec::new(),
        }
    }
}

impl Detector {
    /// Solid angle of the aperture seen from the sample's centre, sr.
    pub fn solid_angle(&self) -> f64 {
        2.0 * PI * (1.0 - self.aperture.cos())
    }

    /// Dark level `time` seconds into the campaign when the swing began at `phase`.
    pub fn dark(&self, time: f64, phase: f64) -> f64 {
        self.dark_level + self.dark_swing * (2.0 * PI * time / self.dark_period + phase).sin()
    }

    pub(crate) fn check(&self) -> Result<(), InstrumentError> {
        in_range("distance", self.distance, 0.05, 100.0, " m")?;
        in_range("aperture", self.aperture, 1e-5, 0.1, " rad")?;
        in_range("noise_readout", self.noise_readout, 0.0, 1e12, "")?;
        in_range("noise_relative", self.noise_relative, 0.0, 0.5, "")?;
        in_range("dark_level", self.dark_level, -1e12, 1e12, "")?;
        in_range("dark_swing", self.dark_swing, 0.0, 1e12, "")?;
        in_range("dark_period", self.dark_period, 60.0, 1e9, " s")?;
        in_range("saturation", self.saturation, f64::MIN_POSITIVE, f64::MAX, "")?;
        in_range("rate", self.rate, 0.1, 1e5, " 1/s")?;
        in_range("shadow", self.shadow, 0.0, 0.5, " rad")?;
        in_range("pointing", self.pointing, 0.0, 0.1, " rad")?;
        in_range("noise_shot", self.noise_shot, 0.0, 1e12, "")?;
        in_range("speed", self.speed.unwrap_or(1.0), 1e-4, 100.0, " rad/s")?;
        in_range("integration", self.integration, 0.0, 1.0, "")?;
        in_range("bits", f64::from(self.bits), 0.0, 32.0, "")?;
        for r in &self.ranges {
            in_range("full_scale", r.full_scale, f64::MIN_POSITIVE, f64::MAX, "")?;
            in_range("noise_readout", r.noise_readout, 0.0, 1e12, "")?;
            in_range("gain_error", r.gain_error, -0.2, 0.2, "")?;
        }
        if let Some(w) = self
            .ranges
            .windows(2)
            .find(|w| w[0].full_scale >= w[1].full_scale)
        {
            return Err(InstrumentError::Domain {
                field: "full_scale",
                found: format!("{} before {}", w[0].full_scale, w[1].full_scale),
                allowed: "gain ranges in increasing order".into(),
            });
        }
        for o in &self.outputs {
            in_range("power of a channel", o.power, f64::MIN_POSITIVE, 1e12, "")?;
        }
        Ok(())
    }

    /// The outputs for a model of `channels`.
    ///
    /// # Errors
    /// [`InstrumentError::Domain`] for an output whose weights are not one finite number a channel of the model.
    pub(crate) fn outputs_for(&self, channels: &[Channel]) -> Result<Vec<Output>, InstrumentError> {
        if self.outputs.is_empty() {
            let one = |k: usize| {
                let mut weights = vec![0.0; channels.len()];
                weights[k] = 1.0;
                weights
            };
            return Ok(channels
                .iter()
                .enumerate()
                .map(|(k, &channel)| Output {
                    channel,
                    power: 1.0,
                    weights: one(k),
                })
                .collect());
        }
        for o in &self.outputs {
            if o.weights.len() != channels.len() || o.weights.iter().any(|w| !w.is_finite()) {
                return Err(InstrumentError::Domain {
                    field: "weights of a channel",
                    found: format!("{:?} for {}", o.weights, o.channel),
                    allowed: format!("{} finite numbers, one a channel of the model", channels.len()),
                });
            }
        }
        Ok(self.outputs.clone())
    }

    /// Gain range of a noise-free `level`, dark included: the first that holds it with a margin of 5 %, else the last.
    pub(crate) fn range(&self, level: f64) -> GainRange {
        let whole = GainRange {
            full_scale: self.saturation,
            noise_readout: self.noise_readout,
            gain_error: 0.0,
        };
        let held = |r: &&GainRange| level <= 0.95 * r.full_scale;
        *self
            .ranges
            .iter()
            .find(held)
            .or(self.ranges.last())
            .unwrap_or(&whole)
    }

    /// Standard deviation of a reading of the noise-free `signal` in the range of `noise_readout`.
    pub fn noise(&self, noise_readout: f64, signal: f64) -> f64 {
        let own = self.noise_relative * signal;
        (noise_readout * noise_readout + self.noise_shot * signal.max(0.0) + own * own).sqrt()
    }

    /// Highest reading there is.
    pub fn highest(&self) -> f64 {
        self.ranges.last().map_or(self.saturation, |r| r.full_scale)
    }
}
