//! Which scatterings are joined with readings.
//!
//! Rays are cheap, joining a scattering with thousands of readings is not: of the scatterings of many rays few are joined, drawn evenly
//! along a curve through the places and directions of all of them. What they miss differs little from what stands for it.

use glam::Vec3;
use gonio_trace::passage::{Cell, Scattering};
use gonio_trace::sampler::Sampler;

use super::part::{Part, PartSignal, Source};
use super::rows;

/// Rays for one whose scattering is joined.
const RAYS: u32 = 64;

impl PartSignal<'_> {
    /// As many scatterings as there are rays in `range`, for those of [`RAYS`] times as many of a set.
    pub(super) fn sources(&self, set: usize, range: std::ops::Range<u32>) -> Vec<Source> {
        let wanted = range.len();
        let (lit, rays) = self.rays(set, range.start * RAYS..range.end * RAYS);
        let Part {
            device, effort, seed, ..
        } = self.part;
        let mut found = Vec::new();
        device.scene.pass_heard(
            &device.cell,
            &rays,
            &effort.limits,
            &mut Vec::new(),
            &mut |scattering: Scattering| found.push(scattering),
        );
        let offset = Sampler::new(rows::seed(*seed, set as u32), u32::MAX - 2, range.start).one();
        let chosen = chosen(found, &device.cell, wanted, offset);
        let placed = chosen.into_iter().map(|scattering| {
            let lit = lit[scattering.ray as usize];
            Source {
                from: self.place(scattering.point(), lit.x),
                scattering: scattering.weighing(scattering.weight() / RAYS as f32),
                lit,
            }
        });
        placed.collect()
    }
}

/// `wanted` of the scatterings with weights that stand for all: systematic draws [CarpenterCliffordFearnhead1999] along a curve
/// that passes all surfaces that face alike, place by place and from where light came. Half of the draws go by light, half are the
/// same for surfaces that face each way: what little light those have that others shade may be all that a reading sees.
fn chosen(found: Vec<Scattering>, cell: &Cell, wanted: usize, offset: f32) -> Vec<Scattering> {
    let light = |s: &Scattering| f64::from(s.weight().element_sum());
    let mut facing = [0.0; FACINGS];
    let mut order: Vec<(usize, u64, u32)> = Vec::with_capacity(found.len());
    for (k, s) in found.iter().enumerate() {
        let (way, place) = along_curve(s, cell);
        facing[way] += light(s);
        order.push((way, place, k as u32));
    }
    let total: f64 = facing.iter().sum();
    if found.len() <= wanted || total <= 0.0 {
        return found;
    }
    order.sort_unstable();
    let ways = facing.iter().filter(|x| **x > 0.0).count() as f64;
    let mut next = f64::from(offset);
    let mut sum = 0.0;
    let mut out = Vec::with_capacity(wanted + 1);
    for (way, _, k) in order {
        let scattering = found[k as usize];
        let own = light(&scattering);
        if own <= 0.0 {
            continue;
        }
        // Draws of this one, on average.
        let draws = 0.5 * wanted as f64 * own * (1.0 / total + 1.0 / (ways * facing[way]));
        sum += draws;
        while next < sum {
            out.push(scattering.weighing(scattering.weight() / draws as f32));
            next += 1.0;
        }
    }
    out
}

/// Ways to face: thirds of each axis, so that what faces along another axis is not divided by its noise.
const FACINGS: usize = 27;

/// How the surface faces, and the place on the curve: bits of the point and of the direction light came from in turns, from coarse to
/// fine.
fn along_curve(s: &Scattering, cell: &Cell) -> (usize, u64) {
    let third = |x: f32| usize::from(x > -0.38) + usize::from(x > 0.38);
    let way = s.normal().to_array().iter().fold(0, |n, x| 3 * n + third(*x));
    let size = (cell.high - cell.low).max(Vec3::splat(f32::MIN_POSITIVE));
    let [a, b] = [(s.point() - cell.low) / size, 0.5 * s.to_source() + 0.5]
        .map(|v| v.to_array().map(|x| (1024.0 * x).clamp(0.0, 1023.0) as u64));
    let numbers = [a[0], a[1], a[2], b[0], b[1], b[2]];
    let bits = (0..10).rev().flat_map(|bit| numbers.map(|x| x >> bit & 1));
    (way, bits.fold(0, |code, bit| code << 1 | bit))
}
