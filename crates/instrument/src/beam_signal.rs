//! The bare beam as the detector sees it.

use gonio_geom::{DVec3, Direction};

use crate::nodes::{node, on_disk};
use crate::{Beam, Detector};

/// Nodes of the average of the beam over the aperture (and over the spot, where that widens it).
const NODES: usize = 256;
/// The same with the spot, two dimensions more.
const NODES_WITH_SPOT: usize = 1024;

/// The beam on the detector sphere, averaged over the aperture.
pub(crate) struct BeamSignal {
    beam: Beam,
    centre: DVec3,
    aperture: f64,
    /// Chord from the centre beyond which there is no signal.
    reach: f64,
    /// Points of the aperture in units of its radius, and of the spot as a displacement on the sphere.
    nodes: Vec<([f64; 2], [f64; 2])>,
}

impl BeamSignal {
    /// The beam that arrives in direction `to`, seen from the sample.
    pub(crate) fn new(beam: &Beam, detector: &Detector, to: Direction) -> Self {
        let spot = beam.spot_on_sphere(detector.distance);
        let nodes = if spot == 0.0 {
            (0..NODES).map(|k| (on_disk(node::<2>(k)), [0.0; 2])).collect()
        } else {
            let both = |k| {
                let [a, b, c, d] = node::<4>(k);
                (on_disk([a, b]), on_disk([c, d]).map(|x| spot * x))
            };
            (0..NODES_WITH_SPOT).map(both).collect()
        };
        BeamSignal {
            beam: beam.clone(),
            centre: to.vec(),
            aperture: detector.aperture.tan(),
            reach: beam.profile.reach() + detector.aperture.tan() + spot,
            nodes,
        }
    }

    /// The signal at receiver direction `ws`; its integral over the sphere is the beam power.
    pub(crate) fn at(&self, ws: Direction) -> f64 {
        if (ws.vec() - self.centre).length() > self.reach {
            return 0.0;
        }
        let (a, b) = ws.vec().any_orthonormal_pair();
        let sum: f64 = self
            .nodes
            .iter()
            .map(|&([u, v], [x, y])| {
                let (u, v) = (self.aperture * u + x, self.aperture * v + y);
                let point = (ws.vec() + u * a + v * b).normalize();
                self.beam.profile.density((point - self.centre).length())
            })
            .sum();
        self.beam.power * sum / self.nodes.len() as f64
    }

    /// The mean of [`BeamSignal::at`] over the way `travel` (a chord of the unit sphere) about `ws`.
    pub(crate) fn moving(&self, ws: Direction, travel: DVec3) -> f64 {
        if travel == DVec3::ZERO {
            return self.at(ws);
        }
        if (ws.vec() - self.centre).length() > self.reach + 0.5 * travel.length() {
            return 0.0;
        }
        let steps = [-0.375, -0.125, 0.125, 0.375].map(|t| Direction::new(ws.vec() + t * travel));
        0.25 * steps.into_iter().flatten().map(|d| self.at(d)).sum::<f64>()
    }
}
