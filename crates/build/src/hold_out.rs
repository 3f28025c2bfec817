//! The error of a slice between its readings.
//!
//! A reading and everything around it within its distance to the next line of readings is taken away, and its value
//! predicted from what is left around the hole. A hole is twice as wide as a gap between readings; the error of linear
//! interpolation goes with the square of the gap, and its mean over a gap is two thirds of that in the middle.

use std::collections::HashSet;
use std::f64::consts::PI;

use gonio_geom::delaunay::Adjacency;
use rayon::prelude::*;

use crate::mesh::Mesh;
use crate::plane::Point;
use crate::slice_surface::SliceSurface;

/// Readings of a slice that are predicted from those around them.
const PREDICTED: usize = 200;

/// Mean error between readings over the error in the middle of a hole.
const SHARE: f64 = 1.0 / 6.0;

/// Radius of the hole over the distance to the farthest neighbour: it keeps readings at that distance.
const HOLE: f64 = 0.95;

/// Radius of the surroundings over that of the hole.
const AROUND: f64 = 2.5;

/// Most readings of the surroundings.
const MOST_AROUND: usize = 600;

/// Error of a slice between readings, relative L1 of the DSF.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct SliceError {
    /// Noise left after smoothing.
    pub(crate) noise: f64,
    /// Interpolation between readings.
    pub(crate) gap: f64,
    /// How far the mean of repeats is from what they repeat.
    pub(crate) repeats: f64,
}

impl SliceError {
    /// In units of `unit` times the light it is relative to.
    pub(crate) fn times(&self, unit: f64) -> Self {
        SliceError {
            noise: unit * self.noise,
            gap: unit * self.gap,
            repeats: unit * self.repeats,
        }
    }

    /// All together.
    pub(crate) fn total(&self) -> f64 {
        self.noise.hypot(self.gap).hypot(self.repeats)
    }

    /// Of a slice whose `bsdf` at reading `j` and solid angle times cosine `weight` are known.
    pub(crate) fn new(surface: &SliceSurface, bsdf: &[f64], weight: &[f64]) -> Self {
        let flux: Vec<f64> = bsdf.iter().zip(weight).map(|(f, w)| f.max(0.0) * w).collect();
        let total: f64 = flux.iter().sum();
        if total <= 0.0 {
            return SliceError::default();
        }
        let relative = |j: usize, error: f64| {
            let ratio = surface.ratio_of(j).0.abs();
            if ratio > 0.0 { error / ratio } else { 0.0 }
        };
        let noise: f64 = (0..flux.len())
            .map(|j| flux[j] * relative(j, surface.ratio_of(j).1))
            .sum();
        // Picked in proportion to flux, so that plain means are means over the light.
        let step = total / PREDICTED as f64;
        let (mut picked, mut sum) = (Vec::with_capacity(PREDICTED), 0.5 * step);
        for (j, f) in flux.iter().enumerate() {
            sum += f;
            if sum >= step {
                picked.push(j);
                sum %= step;
            }
        }
        let neighbours = surface.mesh().adjacency();
        let errors: Vec<f64> = picked
            .par_iter()
            .filter_map(|&j| {
                let apart = (predicted(surface, &neighbours, flux.len(), j)? - surface.ratio_of(j).0).abs();
                // Noise of the prediction and of the value predicted is not an error of interpolation.
                let noise = 1.2 * surface.ratio_of(j).1;
                Some(relative(j, (apart * apart - noise * noise).max(0.0).sqrt()))
            })
            .collect();
        let gap = errors.iter().sum::<f64>() / errors.len().max(1) as f64;
        SliceError {
            noise: (2.0 / PI).sqrt() * noise / total,
            gap: SHARE * gap,
            repeats: 0.0,
        }
    }
}

/// The value at reading `j` from the readings around a hole about it; `None` at the edge of what was measured.
fn predicted(surface: &SliceSurface, neighbours: &Adjacency, readings: usize, j: usize) -> Option<f64> {
    let points = surface.mesh().points();
    let centre = points[j];
    let distance = |k: u32| {
        let p = points[k as usize];
        (p[0] - centre[0]).hypot(p[1] - centre[1])
    };
    let first = neighbours.of(j);
    if first.iter().any(|&k| k as usize >= readings) {
        return None;
    }
    let hole = HOLE * first.iter().map(|&k| distance(k)).fold(0.0, f64::max);
    let (mut seen, mut members) = (HashSet::from([j as u32]), vec![j as u32]);
    let mut next = 0;
    while next < members.len() && members.len() < MOST_AROUND {
        for &k in neighbours.of(members[next] as usize) {
            if (k as usize) < readings && distance(k) <= AROUND * hole && seen.insert(k) {
                members.push(k);
            }
        }
        next += 1;
    }
    members.retain(|&k| distance(k) > hole);
    let around: Vec<Point> = members.iter().map(|&k| points[k as usize]).collect();
    let mesh = Mesh::new(around)?;
    let at = mesh.locate(centre)?;
    Some(
        (0..3)
            .map(|m| at.weights[m] * surface.ratio_of(members[at.vertices[m] as usize] as usize).0)
            .sum(),
    )
}
