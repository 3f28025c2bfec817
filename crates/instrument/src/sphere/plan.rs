//! What a data sheet says of an integrating sphere.

use std::f64::consts::FRAC_PI_2;
use std::fmt;

use crate::InstrumentError;
use crate::error::in_range;

/// Which light is measured.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Arrangement {
    /// The beam comes through the entrance and meets the sample on the other side: reflectance.
    Reflection,
    /// The sample covers the port that the beam comes through: transmittance.
    Transmission,
}

/// A port by what it is for; numbers are those of figure 6.6 of the source chapter [DIN5036].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PortName {
    /// 1: the sample is here, at the pole -z.
    Sample,
    /// 3: the beam comes in here. In transmission the sample covers it.
    Entrance,
    /// 5: where mirrored (or unbent) light arrives: open (the gloss trap) or closed with a plug.
    Trap,
    /// 2: here it is measured.
    Detector,
    /// The standard is here while the sample is measured, and the sample while the standard is.
    Comparison,
    /// An auxiliary lamp shines on the wall from here.
    Auxiliary,
}

impl fmt::Display for PortName {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            PortName::Sample => "sample",
            PortName::Entrance => "entrance",
            PortName::Trap => "trap",
            PortName::Detector => "detector",
            PortName::Comparison => "comparison",
            PortName::Auxiliary => "auxiliary",
        })
    }
}

/// A round port somewhere in the wall.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Place {
    /// Polar angle of its middle from +z (away from the sample) as the centre of the sphere sees it, radians.
    pub theta: f64,
    /// Azimuth; the beam comes from azimuth 0, radians.
    pub phi: f64,
    /// Radius of its rim, m.
    pub radius: f64,
}

/// The gloss trap.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Trap {
    /// Radius of its rim, m.
    pub radius: f64,
    /// Reflectance of the open trap.
    pub residual: f64,
}

/// The detector behind its port.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Detector {
    /// Where.
    pub place: Place,
    /// Its reflectance.
    pub reflectance: f64,
    /// Half angle of what it sees, by the cosine within; pi/2 sees all, radians.
    pub view: f64,
}

/// A round screen between two ports, across the line from middle to middle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Baffle {
    /// The ports that shall not see each other.
    pub between: [PortName; 2],
    /// How far on the way from the first to the second, 0 to 1.
    pub at: f64,
    /// Its radius, m.
    pub radius: f64,
    /// Its reflectance.
    pub reflectance: f64,
}

/// An integrating sphere.
#[derive(Clone, Debug, PartialEq)]
pub struct Plan {
    /// Which light is measured.
    pub arrangement: Arrangement,
    /// Inner radius, m.
    pub radius: f64,
    /// Reflectance of the wall, Lambertian.
    pub wall: f64,
    /// Reflectance of the reference standard, Lambertian.
    pub standard: f64,
    /// Reflectance of what closes a port, a flat Lambertian disk.
    pub plug: f64,
    /// Incidence on the sample, radians.
    pub theta_i: f64,
    /// Azimuth of the incidence on the sample: the sample is turned, radians.
    pub phi_i: f64,
    /// Radius of the beam's cross-section on the sample, m.
    pub beam_radius: f64,
    /// Half angle of the beam's rays about its axis at each point, radians.
    pub divergence: f64,
    /// Radius of the sample's port, m.
    pub sample_radius: f64,
    /// Radius of the entrance, m; of no meaning in transmission.
    pub entrance_radius: f64,
    /// The gloss trap, if there is one.
    pub trap: Option<Trap>,
    /// The detector.
    pub detector: Detector,
    /// The port of the comparison method.
    pub comparison: Option<Place>,
    /// The port of the auxiliary lamp.
    pub auxiliary: Option<Place>,
    /// Screens.
    pub baffles: Vec<Baffle>,
}

/// Largest radius of a port over that of the sphere.
pub(super) const LARGEST_PORT: f64 = 0.5;

impl Plan {
    /// Numbers out of their ranges; how ports and beam lie to each other is looked at later.
    pub(super) fn check(&self) -> Result<(), InstrumentError> {
        in_range("sphere.radius", self.radius, 0.01, 10.0, " m")?;
        in_range("sphere.wall", self.wall, 0.05, 0.999, "")?;
        in_range("standard", self.standard, 0.01, 1.0, "")?;
        in_range("trap.plug", self.plug, 0.0, 1.0, "")?;
        let steepest = f64::to_radians(85.0);
        in_range("theta_i", self.theta_i, 0.0, steepest, " rad")?;
        in_range("phi_i", self.phi_i, -1e3, 1e3, " rad")?;
        in_range("beam.divergence", self.divergence, 0.0, 0.2, " rad")?;
        let widest = LARGEST_PORT * self.radius;
        in_range("beam.diameter", 2.0 * self.beam_radius, 1e-6, 2.0 * widest, " m")?;
        let port = |field, radius: f64| in_range(field, 2.0 * radius, 1e-4, 2.0 * widest, " m");
        port("sample.diameter", self.sample_radius)?;
        if self.arrangement == Arrangement::Reflection {
            port("entrance.diameter", self.entrance_radius)?;
        }
        if let Some(trap) = &self.trap {
            port("trap.diameter", trap.radius)?;
            in_range("trap.residual", trap.residual, 0.0, 1.0, "")?;
        }
        port("detector.diameter", self.detector.place.radius)?;
        in_range("detector.reflectance", self.detector.reflectance, 0.0, 1.0, "")?;
        in_range("detector.view", self.detector.view, 0.01, FRAC_PI_2, " rad")?;
        if let Some(place) = &self.comparison {
            port("comparison.diameter", place.radius)?;
        }
        if let Some(place) = &self.auxiliary {
            port("auxiliary.diameter", place.radius)?;
        }
        for baffle in &self.baffles {
            in_range("baffle.at", baffle.at, 0.02, 0.98, "")?;
            port("baffle.diameter", baffle.radius)?;
            in_range("baffle.reflectance", baffle.reflectance, 0.0, 1.0, "")?;
        }
        Ok(())
    }
}
