//! Beam and detector.

use std::f64::consts::PI;

use crate::InstrumentError;
use crate::error::in_range;

/// Angular profile of the beam on the detector sphere, without a sample.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum BeamProfile {
    /// `exp(-c^2 / w^2)`, `c` the chord from the beam's centre and `w` the 1/e half width, radians.
    Gaussian {
        /// 1/e half width, radians, `[1e-4, 0.1]`.
        half_width: f64,
    },
    /// Even within a cap.
    TopHat {
        /// Radius of the cap, radians, `[1e-4, 0.1]`.
        radius: f64,
    },
}

impl BeamProfile {
    /// The half width or the radius.
    pub fn width(self) -> f64 {
        match self {
            BeamProfile::Gaussian { half_width } => half_width,
            BeamProfile::TopHat { radius } => radius,
        }
    }

    /// Chord beyond which no more than 2e-7 of the beam lies.
    pub fn reach(self) -> f64 {
        match self {
            BeamProfile::Gaussian { half_width } => 4.0 * half_width,
            BeamProfile::TopHat { radius } => radius,
        }
    }

    /// Flux per unit solid angle at chord `c` from the centre, as a share of the beam: 1/sr, integral 1 over the
    /// sphere.
    pub fn density(self, c: f64) -> f64 {
        match self {
            BeamProfile::Gaussian { half_width: w } => {
                (-(c * c) / (w * w)).exp() / (PI * w * w * -(-4.0 / (w * w)).exp_m1())
            }
            BeamProfile::TopHat { radius } => {
                // A cap of chord c has the solid angle pi c^2 exactly.
                let chord = 2.0 * (0.5 * radius).sin();
                if c <= chord {
                    1.0 / (PI * chord * chord)
                } else {
                    0.0
                }
            }
        }
    }

    /// Chord that holds the share `u` of the beam, `u` in `[0, 1)`.
    pub(crate) fn chord_of_share(self, u: f64) -> f64 {
        match self {
            BeamProfile::Gaussian { half_width: w } => {
                let whole = -(-4.0 / (w * w)).exp_m1();
                w * (-(1.0 - u * whole).ln()).max(0.0).sqrt()
            }
            BeamProfile::TopHat { radius } => 2.0 * (0.5 * radius).sin() * u.sqrt(),
        }
    }
}

/// The beam: focused on the detector sphere, passing the sample as an evenly lit spot.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Beam {
    /// `P_i = integral E domega` of the beam without sample, in units of the signal times sr, `> 0`.
    pub power: f64,
    /// Its profile on the detector sphere.
    pub profile: BeamProfile,
    /// Diameter of the spot on the sample at normal incidence, metres, `[0, 0.1]`.
    pub spot_diameter: f64,
}

impl Default for Beam {
    /// Power 1000, Gaussian of .1 degrees (full width at half maximum .17 degrees), spot of 10 mm.
    fn default() -> Self {
        Beam {
            power: 1000.0,
            profile: BeamProfile::Gaussian {
                half_width: 0.1_f64.to_radians(),
            },
            spot_diameter: 0.01,
        }
    }
}

impl Beam {
    pub(crate) fn check(&self) -> Result<(), InstrumentError> {
        in_range("power", self.power, f64::MIN_POSITIVE, 1e12, "")?;
        in_range("beam width", self.profile.width(), 1e-4, 0.1, " rad")?;
        in_range("spot_diameter", self.spot_diameter, 0.0, 0.1, " m")
    }
}

/// The detector and its electronics. Levels are in the unit of the signal.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Detector {
    /// Distance from the sample's centre, metres, `[0.05, 100]`.
    pub distance: f64,
    /// Half angle of the round aperture seen from the sample, radians, `[1e-5, 0.1]`.
    pub aperture: f64,
    /// Standard deviation of the read-out noise.
    pub noise_readout: f64,
    /// Standard deviation of the noise proportional to the signal, as a fraction, `[0, 0.5]`.
    pub noise_relative: f64,
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
    /// Half angle around the retro direction in which the detector shades the beam, radians, `[0, 0.5]`.
    pub shadow: f64,
    /// Standard deviation of the difference between true and recorded direction, in each of two axes, radians.
    pub pointing: f64,
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
        in_range("pointing", self.pointing, 0.0, 0.1, " rad")
    }
}
