//! Light of the beam that only mirrors, refraction and gaps send to a reading, found from both ends.
//!
//! From the beam, rays hit the apertures of readings by chance; from an aperture, rays back through the lit part of the sample meet
//! the beam by chance. Each way counts by the balance heuristic [Veach1997, eq. 9.8] on densities per unit of etendue, which
//! ideal surfaces keep.

use std::f64::consts::PI;

use gonio_geom::{DVec3, Direction};

use crate::way::Way;
use crate::{Focus, Instrument};

/// Rays from the beam for one from each reading.
pub(crate) const FORWARD: u32 = 64;
/// A spot is not smaller, metres.
pub(crate) const SMALLEST: f64 = 1e-6;

/// The beam on a sample, and the two ways to find light of it.
pub(crate) struct Beamlet<'a> {
    instrument: &'a Instrument,
    way: &'a Way,
    /// Radius of the spot across the beam, and of what is looked at from the readings, metres.
    spot: f64,
    seen: f64,
}

impl<'a> Beamlet<'a> {
    /// `margin`: how far beside the spot light is looked for, metres.
    pub(crate) fn new(instrument: &'a Instrument, way: &'a Way, margin: f64) -> Self {
        let spot = 0.5 * instrument.beam.spot_diameter.max(SMALLEST);
        Beamlet {
            instrument,
            way,
            spot,
            seen: spot + margin.max(1e-3 * spot),
        }
    }

    /// Share of the beam per unit of etendue in the ray towards `wi` over `x` of the sample's plane, 1/(m2 sr).
    pub(crate) fn density(&self, x: DVec3, wi: DVec3) -> f64 {
        let Instrument {
            beam,
            detector,
            holder,
            ..
        } = self.instrument;
        if self.way.across(x).length() > self.spot || !holder.holds(x) {
            return 0.0;
        }
        let (aim, factor) = match beam.focus {
            Focus::Sample => (-wi, 1.0),
            Focus::Detector => {
                let distance = detector.distance;
                let along = -x.dot(wi);
                let length = (along * along - x.length_squared() + distance * distance)
                    .max(0.0)
                    .sqrt()
                    - along;
                let aim = (x - length * wi) / distance;
                (aim, (length / distance).powi(2) / -aim.dot(wi).min(-1e-9))
            }
        };
        let chord = (aim - self.way.through()).length();
        beam.profile.density(chord) * factor / (PI * self.spot * self.spot)
    }

    /// A point of the sample's plane, even over what is looked at.
    pub(crate) fn point(&self, [x, y]: [f64; 2]) -> DVec3 {
        self.way.lit(self.seen * x, self.seen * y)
    }

    /// Density of looking from an aperture's point over `y` of the sample's plane, per unit of etendue, of one ray.
    fn looking(&self, y: DVec3, to: &To) -> f64 {
        // Nor where a ray along the plane never passes it.
        let inside = self.way.across(y).length() <= self.seen;
        if !inside {
            return 0.0;
        }
        let detector = &self.instrument.detector;
        let aperture = PI * (detector.distance * detector.aperture.tan()).powi(2);
        to.length.powi(2) / (self.area() * aperture * to.cosine * to.facing)
    }

    /// Area of the sample's plane that is looked at, m2.
    fn area(&self) -> f64 {
        PI * self.seen * self.seen / self.way.through().z.abs()
    }

    /// How much a ray from the beam counts that leaves over `y` for an aperture, where density is that of the beam.
    pub(crate) fn forward_share(&self, density: f64, y: DVec3, to: &To) -> f64 {
        let forward = f64::from(FORWARD) * density;
        forward / (forward + self.looking(y, to)).max(f64::MIN_POSITIVE)
    }

    /// Flux per unit solid angle of the aperture for a ray of it back over `y` that meets the beam where it has this density.
    pub(crate) fn backward(&self, density: f64, y: DVec3, to: &To) -> f64 {
        if density == 0.0 {
            return 0.0;
        }
        let looking = self.looking(y, to);
        let share = looking / (f64::from(FORWARD) * density + looking);
        let ratio = self.instrument.detector.distance / to.length;
        share * density * to.cosine * to.facing * ratio * ratio * self.area()
    }
}

/// The way from a point of the sample's plane to one of an aperture.
pub(crate) struct To {
    pub(crate) direction: DVec3,
    /// Metres.
    length: f64,
    /// Cosines at the sample's plane and at the aperture.
    cosine: f64,
    facing: f64,
}

impl To {
    /// From `y` to `at`, metres, of an aperture that faces `ws`.
    pub(crate) fn new(y: DVec3, at: DVec3, ws: Direction) -> Self {
        let way = at - y;
        let length = way.length();
        let direction = way / length;
        To {
            direction,
            length,
            cosine: direction.z.abs().max(1e-6),
            facing: direction.dot(ws.vec()).max(1e-6),
        }
    }
}
