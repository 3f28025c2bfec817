//! Processed readings: DSF with its uncertainty.

use gonio_bsdf::Channel;
use gonio_geom::{Angles, Direction, Side};

use crate::{Flags, Processing, Resolution};

/// A hemispherical integral of the DSF of one slice, with what was measured and what had to be extrapolated apart.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct HemisphericalIntegral {
    /// Hemisphere of the receiver.
    pub side: Side,
    /// `integral dsf domega` over the whole hemisphere: DHR or DHT.
    pub value: f64,
    /// The part of `value` in directions that were not measured (holes, grazing gap).
    pub extrapolated: f64,
    /// Combined standard uncertainty of `value`.
    pub u: f64,
    /// Standard uncertainty from the quadrature alone.
    pub u_quadrature: f64,
}

/// One processed incidence and channel. Columns have equal length, one entry a reading.
#[derive(Clone, Debug, PartialEq)]
pub struct Slice {
    /// Direction of incidence.
    pub incidence: Angles,
    /// Spectral channel.
    pub channel: Channel,
    /// Receiver polar angles, canonical, radians.
    pub theta_s: Vec<f64>,
    /// Receiver azimuths, canonical, radians.
    pub phi_s: Vec<f64>,
    /// DSF in 1/sr. Negative values are kept.
    pub dsf: Vec<f64>,
    /// Combined standard uncertainty of `dsf`, 1/sr (independent and common parts).
    pub u_dsf: Vec<f64>,
    /// Solid-angle weight of each reading, sr; zero where the reading is unusable.
    pub omega: Vec<f64>,
    /// Flags of each reading.
    pub flags: Vec<Flags>,
    /// The part of the relative uncertainty common to every reading (beam power, standard), standard, as a fraction.
    pub u_common: f64,
    /// Hemispherical integrals, one a hemisphere that was measured.
    pub integrals: Vec<HemisphericalIntegral>,
}

impl Slice {
    /// Number of readings.
    pub fn len(&self) -> usize {
        self.dsf.len()
    }

    /// Whether there is no reading.
    pub fn is_empty(&self) -> bool {
        self.dsf.is_empty()
    }

    /// Receiver direction of reading `j`.
    pub fn direction(&self, j: usize) -> Direction {
        Direction::from_spherical(self.theta_s[j], self.phi_s[j])
    }

    /// The part of `u_dsf` of reading `j` that other readings do not share, 1/sr.
    pub fn u_independent(&self, j: usize) -> f64 {
        let common = self.u_common * self.dsf[j];
        (self.u_dsf[j].powi(2) - common.powi(2)).max(0.0).sqrt()
    }

    /// BSDF of reading `j`: `dsf / |cos theta_s|`; NaN on the horizon.
    pub fn bsdf(&self, j: usize) -> f64 {
        let c = self.theta_s[j].cos().abs();
        if c > 0.0 { self.dsf[j] / c } else { f64::NAN }
    }

    /// The integral over the hemisphere `side`, when it was measured.
    pub fn integral(&self, side: Side) -> Option<&HemisphericalIntegral> {
        self.integrals.iter().find(|h| h.side == side)
    }
}

/// A sample's processed slices with what holds for all of them.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Measurement {
    /// Slices in the order of the input.
    pub slices: Vec<Slice>,
    /// Name of the sample.
    pub sample_name: Option<String>,
    /// Full width at half maximum of the instrument signature, radians: the resolution limit.
    pub signature_fwhm: Option<f64>,
    /// The signature of each channel with a beam scan.
    pub resolutions: Vec<Resolution>,
    /// Physics warnings found on the way (also logged).
    pub warnings: Vec<String>,
    /// What the processing found out about the instrument and the corrections.
    pub processing: Processing,
}
