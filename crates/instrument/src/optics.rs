//! The beam.

use std::f64::consts::PI;

use crate::error::in_range;
use crate::{InstrumentError, ProfileTable};

/// Angular profile of the beam on the detector sphere, without a sample.
#[derive(Clone, Debug, PartialEq)]
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
    /// As measured.
    Table(ProfileTable),
}

impl BeamProfile {
    /// The half width or the radius; of a table the half width at half the maximum.
    pub fn width(&self) -> f64 {
        match self {
            BeamProfile::Gaussian { half_width } => *half_width,
            BeamProfile::TopHat { radius } => *radius,
            BeamProfile::Table(table) => table.width(),
        }
    }

    /// Chord beyond which no more than 2e-7 of the beam lies.
    pub fn reach(&self) -> f64 {
        match self {
            BeamProfile::Gaussian { half_width } => 4.0 * half_width,
            BeamProfile::TopHat { radius } => *radius,
            BeamProfile::Table(table) => table.reach(),
        }
    }

    /// Flux per unit solid angle at chord `c` from the centre, as a share of the beam: 1/sr, integral 1 over the
    /// sphere.
    pub fn density(&self, c: f64) -> f64 {
        match *self {
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
            BeamProfile::Table(ref table) => table.density(c),
        }
    }

    /// Chord that holds the share `u` of the beam, `u` in `[0, 1)`.
    pub(crate) fn chord_of_share(&self, u: f64) -> f64 {
        match *self {
            BeamProfile::Gaussian { half_width: w } => {
                let whole = -(-4.0 / (w * w)).exp_m1();
                w * (-(1.0 - u * whole).ln()).max(0.0).sqrt()
            }
            BeamProfile::TopHat { radius } => 2.0 * (0.5 * radius).sin() * u.sqrt(),
            BeamProfile::Table(ref table) => table.chord_of_share(u),
        }
    }
}

/// Where the condenser lens puts the image of the source.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Focus {
    /// On the detector sphere: the profile is the image there, whichever point of the spot it is reached over.
    #[default]
    Detector,
    /// On the sample: every point of the spot sends the same directions, and the profile is their spread. On the detector
    /// sphere the beam is wider by the spot.
    Sample,
}

/// The beam, which passes the sample as an evenly lit spot.
#[derive(Clone, Debug, PartialEq)]
pub struct Beam {
    /// `P_i = integral E domega` of the beam without sample, in units of the signal times sr, `> 0`.
    pub power: f64,
    /// Its profile on the detector sphere (focus there), or the spread of its directions (focus on the sample).
    pub profile: BeamProfile,
    /// Where it is focused.
    pub focus: Focus,
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
            focus: Focus::Detector,
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

    /// Radius of the spot seen from the detector sphere, radians, where that widens the beam there; else 0.
    pub(crate) fn spot_on_sphere(&self, distance: f64) -> f64 {
        match self.focus {
            Focus::Detector => 0.0,
            Focus::Sample => 0.5 * self.spot_diameter / distance,
        }
    }
}
