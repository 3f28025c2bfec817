//! Random numbers and directions of unit tests.

use std::f64::consts::TAU;

use gonio_geom::{DVec3, Direction};
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64Mcg;

/// Numbers in `[0, 1)`, the same ones for the same seed.
pub(crate) struct Numbers(Pcg64Mcg);

impl Numbers {
    pub(crate) fn new(seed: u64) -> Self {
        Numbers(Pcg64Mcg::seed_from_u64(seed))
    }

    pub(crate) fn next(&mut self) -> f64 {
        self.0.random()
    }

    /// A direction on the front, even over the solid angle, up to 88.9 degrees.
    pub(crate) fn direction(&mut self) -> Direction {
        let (z, phi) = (0.02 + 0.97 * self.next(), TAU * self.next());
        let r = (1.0 - z * z).sqrt();
        Direction::from_unit(DVec3::new(r * phi.cos(), r * phi.sin(), z))
    }
}
