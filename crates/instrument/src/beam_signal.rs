//! The bare beam as the detector sees it.

use gonio_geom::{DVec3, Direction};

use crate::radial::Radial;
use crate::{Beam, Detector};

/// Radius of the spot seen from the detector sphere, radians, below which it widens nothing.
const POINT: f64 = 1e-9;

/// The beam on the detector sphere, averaged over the aperture.
///
/// Beam, aperture and spot are round, so the signal is a function of the distance from the beam's centre.
pub(crate) struct BeamSignal {
    power: f64,
    centre: DVec3,
    /// Signal of a beam of unit power.
    profile: Radial,
}

impl BeamSignal {
    /// The beam that arrives in direction `to`, seen from the sample.
    pub(crate) fn new(beam: &Beam, detector: &Detector, to: Direction) -> Self {
        let (profile, spot) = (&beam.profile, beam.spot_on_sphere(detector.distance));
        let width = profile.width();
        let seen = Radial::smeared(|c| profile.density(c), profile.reach(), width, detector.aperture);
        let profile = if spot < POINT {
            seen
        } else {
            let feature = width.min(detector.aperture);
            Radial::smeared(|c| seen.at(c), seen.reach(), feature, spot)
        };
        BeamSignal {
            power: beam.power,
            centre: to.vec(),
            profile,
        }
    }

    /// The signal at receiver direction `ws`; its integral over the sphere is the beam power.
    pub(crate) fn at(&self, ws: Direction) -> f64 {
        self.power * self.profile.at((ws.vec() - self.centre).length())
    }

    /// The mean of [`BeamSignal::at`] over the way `travel` (a chord of the unit sphere) about `ws`.
    pub(crate) fn moving(&self, ws: Direction, travel: DVec3) -> f64 {
        if travel == DVec3::ZERO {
            return self.at(ws);
        }
        if (ws.vec() - self.centre).length() > self.profile.reach() + 0.5 * travel.length() {
            return 0.0;
        }
        let steps = [-0.375, -0.125, 0.125, 0.375].map(|t| Direction::new(ws.vec() + t * travel));
        0.25 * steps.into_iter().flatten().map(|d| self.at(d)).sum::<f64>()
    }
}
