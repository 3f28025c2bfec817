//! A part on the holder, and the rays of the beam that fall on it.

use std::sync::Mutex;

use glam::Vec3;
use gonio_geom::DVec3;
use gonio_trace::passage::{Entering, Scattering};
use gonio_trace::sampler::Sampler;

use super::Device;
use super::beamlet::SMALLEST;
use super::readings::{MonteCarlo, ReadingEffort};
use crate::nodes::{on_disk, shifted};
use crate::way::Way;
use crate::{Instrument, Output};

/// A part on the holder.
pub(super) struct Part<'a> {
    pub(super) device: &'a Device,
    pub(super) effort: &'a ReadingEffort,
    pub(super) seed: u64,
    pub(super) known: Mutex<Vec<MonteCarlo>>,
}

/// A part lit from one direction.
pub(super) struct PartSignal<'a> {
    pub(super) part: &'a Part<'a>,
    pub(super) instrument: &'a Instrument,
    pub(super) outputs: &'a [Output],
    pub(super) way: Way,
    pub(super) surface: DVec3,
}

/// A ray of the beam on the part: where it meets the sample's plane, and what goes with it.
#[derive(Clone, Copy)]
pub(super) struct Lit {
    /// Metres, in the sample's frame.
    pub(super) x: DVec3,
    /// Towards the source.
    pub(super) wi: DVec3,
    pub(super) aperture: [f64; 2],
    pub(super) time: f64,
}

/// Where light comes from to the readings.
pub(super) struct Source {
    pub(super) scattering: Scattering,
    pub(super) lit: Lit,
    /// Metres, in the sample's frame.
    pub(super) from: DVec3,
}

impl PartSignal<'_> {
    /// Rays `range` of set `set`: those of the beam that fall on the sample, and what they are on the part. Rays beside it are left out.
    pub(super) fn rays(&self, set: usize, range: std::ops::Range<u32>) -> (Vec<Lit>, Vec<Entering>) {
        let Instrument {
            beam,
            detector,
            holder,
            ..
        } = self.instrument;
        let seed = super::rows::seed(self.part.seed, set as u32);
        let mut numbers = Sampler::new(seed, u32::MAX, u32::MAX);
        let shift: [f32; 8] = std::array::from_fn(|_| numbers.one());
        let mut lit = Vec::new();
        let mut rays = Vec::new();
        for k in range {
            let u: [f64; 7] = shifted(k, &shift);
            let [sx, sy] = on_disk([u[0], u[1]]).map(|s| 0.5 * beam.spot_diameter.max(SMALLEST) * s);
            let x = self.way.lit(sx, sy);
            if !holder.holds(x) {
                continue;
            }
            let (bs, bc) = (std::f64::consts::TAU * u[3]).sin_cos();
            let chord = beam.profile.chord_of_share(u[2]);
            let Some(wi) = self.way.source(beam, detector.distance, x, chord, [bc, bs]) else {
                continue;
            };
            lit.push(Lit {
                x,
                wi: wi.vec(),
                aperture: on_disk([u[4], u[5]]),
                time: u[6] - 0.5,
            });
            rays.push(Entering {
                origin: self.before(x, wi.vec()),
                direction: -wi.vec().as_vec3(),
                sampler: Sampler::new(seed, 1, k),
            });
        }
        (lit, rays)
    }

    /// Where a ray through `x` of the sample's plane that comes from `from` meets the box of the part, in its frame.
    pub(super) fn before(&self, x: DVec3, from: DVec3) -> Vec3 {
        let Device { cell, window, .. } = self.part.device;
        let z = match from.z > 0.0 {
            true => cell.high.z,
            false => cell.low.z,
        };
        let [low, high] = *window;
        let middle = DVec3::new(
            0.5 * f64::from(low[0] + high[0]),
            0.5 * f64::from(low[1] + high[1]),
            0.0,
        );
        let at = (x - self.surface) / self.part.effort.unit + middle;
        let at = at + (f64::from(z) - at.z) / from.z * from;
        let wrapped = |x: f64, low: f32, high: f32| match cell.periodic {
            true => f64::from(low) + (x - f64::from(low)).rem_euclid(f64::from(high - low)),
            false => x,
        };
        let (x, y) = (wrapped(at.x, low[0], high[0]), wrapped(at.y, low[1], high[1]));
        Vec3::new(x as f32, y as f32, z)
    }

    /// A point of the part's frame in that of the sample, metres; of a part that repeats, `fell`, where the light fell on it.
    pub(super) fn place(&self, at: Vec3, fell: DVec3) -> DVec3 {
        let Device { cell, window, .. } = self.part.device;
        if cell.periodic {
            return fell;
        }
        let [low, high] = *window;
        let middle = 0.5 * (Vec3::new(low[0], low[1], 0.0) + Vec3::new(high[0], high[1], 0.0));
        self.surface + self.part.effort.unit * (at - middle).as_dvec3()
    }

    /// Where a ray passes the sample's plane, metres.
    pub(super) fn passes(&self, at: DVec3, direction: DVec3) -> DVec3 {
        at + (self.surface.z - at.z) / direction.z * direction
    }
}
