//! Means over independent sets of rays, whose scatter is the error.

use glam::Vec3;

/// Independent sets of rays.
pub(super) const REPLICATES: usize = 16;

/// Sums over the rays of each set, `[set][reading]`, red, green and blue, and the rays of each set a reading.
pub(super) struct Sums {
    pub(super) sum: Vec<Vec<Vec3>>,
    pub(super) rays: Vec<u32>,
}

impl Sums {
    pub(super) fn new(readings: usize) -> Self {
        Sums {
            sum: vec![vec![Vec3::ZERO; readings]; REPLICATES],
            rays: vec![0; readings],
        }
    }

    /// Mean of a reading over all sets.
    pub(super) fn mean(&self, j: usize) -> Vec3 {
        let sum: Vec3 = self.sum.iter().map(|s| s[j]).sum();
        sum / (self.rays[j].max(1) as f32 * REPLICATES as f32)
    }

    /// Square of the standard error of a mean, with these weights of the channels.
    pub(super) fn square(&self, j: usize, weights: Vec3) -> f64 {
        let mean = weights.dot(self.mean(j));
        let per = 1.0 / self.rays[j].max(1) as f32;
        let squares = self.sum.iter().map(|s| (weights.dot(s[j]) * per - mean).powi(2));
        f64::from(squares.sum::<f32>()) / (REPLICATES * (REPLICATES - 1)) as f64
    }
}
