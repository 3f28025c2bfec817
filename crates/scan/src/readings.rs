//! Readings as an instrument wrote them: one record per incidence, channel and purpose.

use std::collections::BTreeMap;
use std::fmt;
use std::str::FromStr;

use gonio_bsdf::{Channel, Quantity};
use gonio_geom::{Angles, Direction};

use crate::ScanError;

/// What a record was taken for.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum ScanKind {
    /// The sample in the beam.
    Sample,
    /// The beam alone, no sample: the reference scan of P_i (also the instrument signature).
    Beam,
    /// Dark or blank: no light from the sample.
    Dark,
    /// A calibrated standard in place of the sample.
    Standard,
}

impl ScanKind {
    /// Name used in files and Python.
    pub fn name(self) -> &'static str {
        match self {
            ScanKind::Sample => "sample",
            ScanKind::Beam => "beam",
            ScanKind::Dark => "dark",
            ScanKind::Standard => "standard",
        }
    }
}

impl fmt::Display for ScanKind {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}

impl FromStr for ScanKind {
    type Err = ScanError;
    fn from_str(s: &str) -> Result<Self, Self::Err> {
        match s.to_ascii_lowercase().as_str() {
            "sample" => Ok(ScanKind::Sample),
            "beam" => Ok(ScanKind::Beam),
            "dark" => Ok(ScanKind::Dark),
            "standard" => Ok(ScanKind::Standard),
            _ => Err(ScanError::Domain {
                field: "kind",
                found: format!("{s:?}"),
                allowed: "sample, beam, dark, standard".into(),
            }),
        }
    }
}

/// What is known of a record beside its readings. Every field may be unknown.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ScanMeta {
    /// Name of the sample.
    pub sample_name: Option<String>,
    /// Name of the instrument.
    pub instrument: Option<String>,
    /// Detector distance in metres.
    pub distance: Option<f64>,
    /// Solid angle of the detector aperture seen from the sample, sr.
    pub receiver_solid_angle: Option<f64>,
    /// Diameter of the illuminated spot at normal incidence, metres.
    pub beam_diameter: Option<f64>,
    /// Standard deviation of the read-out noise, in the unit of the values.
    pub noise_readout: Option<f64>,
    /// Standard deviation of the noise proportional to the signal, as a fraction.
    pub noise_relative: Option<f64>,
    /// Share of the way from one reading to the next over which a reading averages, `[0, 1]`: the detector does not stop.
    pub integration: Option<f64>,
    /// Reading at which the detector saturates, in the unit of the values.
    pub saturation: Option<f64>,
    /// Start of the record, ISO 8601.
    pub started: Option<String>,
    /// File the record came from.
    pub source: Option<String>,
    /// Header fields that gonio does not interpret, verbatim.
    pub other: BTreeMap<String, String>,
}

/// One record: the readings of one incidence and one channel, as columns of equal length.
#[derive(Clone, Debug, PartialEq)]
pub struct Scan {
    /// What it was taken for.
    pub kind: ScanKind,
    /// What the values are.
    pub quantity: Quantity,
    /// Spectral channel.
    pub channel: Channel,
    /// Direction of incidence.
    pub incidence: Angles,
    /// Receiver polar angles `theta_s`, canonical, radians.
    pub theta_s: Vec<f64>,
    /// Receiver azimuths `phi_s`, canonical, radians.
    pub phi_s: Vec<f64>,
    /// Values of `quantity`; NaN means no data.
    pub value: Vec<f64>,
    /// Time of each reading in seconds since `meta.started`, when recorded.
    pub time: Option<Vec<f64>>,
    /// Everything else.
    pub meta: ScanMeta,
}

impl Scan {
    /// Number of readings.
    pub fn len(&self) -> usize {
        self.value.len()
    }

    /// Whether there is no reading.
    pub fn is_empty(&self) -> bool {
        self.value.is_empty()
    }

    /// Receiver direction of reading `j`.
    pub fn direction(&self, j: usize) -> Direction {
        Direction::from_spherical(self.theta_s[j], self.phi_s[j])
    }
}
