//! What readings have of the rays: from where a surface scatters light, and what comes to them unscattered.

use std::sync::atomic::{AtomicBool, Ordering};

use glam::Vec3;
use gonio_geom::{DVec3, Direction};
use gonio_trace::passage::{Entering, Leaving};
use gonio_trace::sampler::Sampler;
use rayon::prelude::*;

use super::apertures::Apertures;
use super::beamlet::{Beamlet, FORWARD, To};
use super::part::{Part, PartSignal, Source};
use super::sums::{REPLICATES, Sums};
use crate::nodes::{on_disk, shifted};

/// Readings that are computed together.
const BLOCK: usize = 64;

/// What goes from the beam to the readings without being scattered.
pub(super) struct Ways<'a> {
    pub(super) beamlet: Beamlet<'a>,
    pub(super) ws: &'a [Direction],
    pub(super) travel: &'a [DVec3],
}

impl PartSignal<'_> {
    /// What a reading has of a source: flux per unit solid angle of the aperture, seen from the middle.
    fn joined(&self, source: &Source, ws: Direction, (a, b): (DVec3, DVec3), travel: DVec3) -> Vec3 {
        let detector = &self.instrument.detector;
        let radius = detector.aperture.tan();
        let [u, v] = source.lit.aperture;
        let at = ws.vec() + radius * (u * a + v * b) + source.lit.time * travel;
        let way = detector.distance * at - source.from;
        let inverse = way.length_recip();
        let direction = way * inverse;
        let facing = direction.dot(ws.vec()) * (detector.distance * inverse).powi(2);
        let Part { device, .. } = self.part;
        let f = device
            .scene
            .scattered_to(&device.cell, &source.scattering, direction.as_vec3());
        f * facing as f32
    }

    /// Adds rays up to `goal` a set to the readings that are open.
    pub(super) fn join(
        &self,
        sums: &mut Sums,
        open: &[usize],
        goal: u32,
        ws: &[Direction],
        travel: &[DVec3],
    ) {
        let Some(first) = open.first().map(|j| sums.rays[*j]) else {
            return;
        };
        let sources: Vec<Vec<Source>> = (0..REPLICATES)
            .into_par_iter()
            .map(|set| self.sources(set, first..goal))
            .collect();
        let found: Vec<Vec<[Vec3; REPLICATES]>> = open
            .par_chunks(BLOCK)
            .map(|block| {
                let of = |j: &usize| {
                    let axes = ws[*j].vec().any_orthonormal_pair();
                    std::array::from_fn(|set| {
                        let each = sources[set].iter();
                        each.map(|s| self.joined(s, ws[*j], axes, travel[*j])).sum()
                    })
                };
                block.iter().map(of).collect()
            })
            .collect();
        for (j, sets) in open.iter().zip(found.iter().flatten()) {
            for (all, x) in sums.sum.iter_mut().zip(sets) {
                all[*j] += *x;
            }
            sums.rays[*j] = goal;
        }
    }

    /// Adds rays of the beam up to `goal` of each set to the open readings whose aperture they hit, and rays from these; whether any
    /// comes to the readings unscattered or from an ideal surface.
    pub(super) fn meet(
        &self,
        sums: &mut Sums,
        apertures: &Apertures,
        open: &[usize],
        goal: u32,
        ways: &Ways<'_>,
    ) -> bool {
        let Some(first) = open.first().map(|j| sums.rays[*j]) else {
            return false;
        };
        let mut is_open = vec![false; sums.rays.len()];
        open.iter().for_each(|j| is_open[*j] = true);
        let any = AtomicBool::new(false);
        sums.sum.par_iter_mut().enumerate().for_each(|(set, sum)| {
            let mut from = first;
            while from < goal {
                let to = goal.min(from + 4096);
                if self.hit(set, from..to, apertures, &is_open, ways, sum) {
                    any.store(true, Ordering::Relaxed);
                }
                from = to;
            }
        });
        let any = any.into_inner() || first > 0;
        if any {
            let found: Vec<Vec<[Vec3; REPLICATES]>> = open
                .par_chunks(BLOCK)
                .map(|block| {
                    let each = block.iter();
                    each.map(|j| std::array::from_fn(|set| self.look(set, first..goal, *j, ways)))
                        .collect()
                })
                .collect();
            for (j, sets) in open.iter().zip(found.iter().flatten()) {
                sums.sum.iter_mut().zip(sets).for_each(|(all, x)| all[*j] += *x);
            }
        }
        open.iter().for_each(|j| sums.rays[*j] = goal);
        any
    }

    /// Rays `range` of a set from the beam; whether any left from an ideal surface or straight.
    fn hit(
        &self,
        set: usize,
        range: std::ops::Range<u32>,
        apertures: &Apertures,
        is_open: &[bool],
        ways: &Ways<'_>,
        sum: &mut [Vec3],
    ) -> bool {
        let Part { device, effort, .. } = self.part;
        let (lit, rays) = self.rays(set, range);
        let mut left: Vec<Leaving> = Vec::new();
        device
            .scene
            .pass_heard(&device.cell, &rays, &effort.limits, &mut left, &mut |_| ());
        let mut any = false;
        for ray in left.iter().filter(|ray| ray.ideal) {
            any = true;
            let lit = &lit[ray.ray as usize];
            let direction = ray.direction.as_dvec3();
            let from = self.place(ray.origin, lit.x);
            let y = self.passes(from, direction);
            apertures.hit(from, direction, lit.time, |j, at| {
                if !is_open[j] {
                    return;
                }
                let share = match ray.scattered {
                    true => 1.0,
                    false => {
                        let density = ways.beamlet.density(lit.x, lit.wi);
                        ways.beamlet
                            .forward_share(density, y, &To::new(y, at, ways.ws[j]))
                    }
                };
                sum[j] += ray.weight * share as f32 * apertures.per_solid_angle();
            });
        }
        any
    }

    /// Rays of a set from the aperture of reading `j`, one for [`FORWARD`] of those `range` from the beam.
    fn look(&self, set: usize, range: std::ops::Range<u32>, j: usize, ways: &Ways<'_>) -> Vec3 {
        let Part {
            device, effort, seed, ..
        } = self.part;
        let detector = &self.instrument.detector;
        let seed = super::rows::seed(*seed, set as u32);
        let mut numbers = Sampler::new(seed, u32::MAX - 1, j as u32);
        let shift: [f32; 5] = std::array::from_fn(|_| numbers.one());
        let ws = ways.ws[j];
        let (a, b) = ws.vec().any_orthonormal_pair();
        let radius = detector.aperture.tan();
        let mut to = Vec::new();
        let mut rays = Vec::new();
        for k in range.start / FORWARD..range.end / FORWARD {
            let u: [f64; 5] = shifted(k, &shift);
            let y = ways.beamlet.point(on_disk([u[0], u[1]]));
            let [s, t] = on_disk([u[2], u[3]]);
            let at = ws.vec() + radius * (s * a + t * b) + (u[4] - 0.5) * ways.travel[j];
            let way = To::new(y, detector.distance * at, ws);
            rays.push(Entering {
                origin: self.before(y, way.direction),
                direction: -way.direction.as_vec3(),
                sampler: Sampler::new(seed ^ 0x5bd1_e995, j as u32, k),
            });
            to.push((y, way));
        }
        let mut left: Vec<Leaving> = Vec::new();
        device
            .scene
            .pass_ideal(&device.cell, &rays, &effort.limits, &mut left);
        left.iter()
            .map(|ray| {
                let (y, way) = &to[ray.ray as usize];
                let wi = ray.direction.as_dvec3();
                let x = self.passes(self.place(ray.origin, *y), wi);
                let density = match wi.dot(self.way.through()) < 0.0 {
                    true => ways.beamlet.density(x, wi),
                    false => 0.0,
                };
                // Rays are counted as those of the beam.
                let found = ways.beamlet.backward(density, *y, way) * f64::from(FORWARD);
                ray.weight * found as f32
            })
            .sum()
    }
}
