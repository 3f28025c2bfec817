//! Rays from each patch of the two hemispheres through a device, and the patches that they leave to.

use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};

use glam::Vec3;
use gonio_bsdf::FourComponents;
use gonio_geom::{Component, DVec3, Direction, Side};
use gonio_trace::accumulate::LUMINANCE;
use gonio_trace::passage::{Entering, Leaving};
use gonio_trace::path::Limits;
use gonio_trace::sampler::Sampler;
use rayon::prelude::*;

use super::Device;
use crate::nodes::shifted;

/// Directions of a hemisphere in patches.
pub(super) trait Patches: Sync {
    /// Whether light is sent from the patches it leaves to, so that each pair of them is seen from both ends.
    const RECIPROCAL: bool;

    /// Patches that light is sent from.
    fn starts(&self) -> usize;

    /// Patches that light leaves to.
    fn exits(&self) -> usize;

    /// Projected solid angle of a patch that light leaves to, sr.
    fn lambda(&self, exit: usize) -> f64;

    /// The patch that light from `wi` leaves to in the direction `ws`.
    fn exit(&self, wi: Vec3, ws: Direction) -> usize;

    /// A direction of a patch that light is sent from, on `side`, for numbers in `[0, 1)`.
    fn point(&self, start: usize, side: Side, numbers: [f64; 3]) -> Direction;
}

/// How many rays are followed, and which.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Effort {
    /// Rays from each patch, rounded up by [`Effort::rounded`].
    pub rays: u32,
    /// Sides that rays are sent from; light that arrives there and, by reciprocity, light that comes through to there is
    /// known then.
    pub sides: [bool; 2],
    /// How far a ray is followed.
    pub limits: Limits,
    /// The same seed gives the same values, whatever the number of threads.
    pub seed: u64,
}

impl Default for Effort {
    fn default() -> Self {
        Effort {
            rays: 4096,
            sides: [true; 2],
            limits: Limits::default(),
            seed: 1,
        }
    }
}

impl Effort {
    /// What a number of rays is rounded up to: sixteen times 4, 5, 6 or 7 times a power of two, or less than that.
    pub fn rounded(rays: u32) -> u32 {
        REPLICATES.saturating_mul(batch(rays))
    }
}

/// Rays of each replicate: points of a low-discrepancy sequence are most even in numbers with few factors but two.
fn batch(rays: u32) -> u32 {
    let wanted = rays.div_ceil(REPLICATES).max(1);
    let step = 1 << wanted.ilog2().saturating_sub(2);
    wanted.div_ceil(step) * step
}

/// How much is done, in `[0, 1]`.
pub type Progress<'a> = &'a (dyn Fn(f64) + Sync);

/// Independent scramblings of the points, whose scatter is the standard error.
const REPLICATES: u32 = 16;

/// A mean, and the square of its standard error.
pub(super) type Mean = ([f64; 3], f64);

/// What rays that begin in one patch find out.
pub(super) struct Row {
    pub(super) side: Side,
    pub(super) start: usize,
    /// About light that comes from there, `[leaves on the front, on the back][patch]`.
    pub(super) onward: [Vec<Mean>; 2],
    /// About light that leaves there, `[comes from the front, from the back][patch]`.
    pub(super) back: [Vec<Mean>; 2],
}

/// Sums of rays by the patch they leave to, those that leave by the window and those beside it.
#[derive(Clone, Copy, Default)]
struct Sum {
    by: Vec3,
    beside: Vec3,
}

/// Weights of red, green and blue in a luminance of white 1.
fn weights() -> Vec3 {
    LUMINANCE / LUMINANCE.element_sum()
}

/// What rays from each patch and side find out, as `each` keeps it.
///
/// `None` when `stop` was set before the end.
pub(super) fn rows<P: Patches, T: Send>(
    device: &Device,
    patches: &P,
    effort: &Effort,
    stop: &AtomicBool,
    report: Progress<'_>,
    each: impl Fn(Row) -> T + Sync,
) -> Option<Vec<T>> {
    let sides = Side::BOTH.into_iter().zip(effort.sides);
    let work: Vec<(Side, usize)> = sides
        .filter_map(|(side, wanted)| wanted.then_some(side))
        .flat_map(|side| (0..patches.starts()).map(move |start| (side, start)))
        .collect();
    let done = AtomicUsize::new(0);
    work.par_iter()
        .map(|(side, start)| {
            if stop.load(Ordering::Relaxed) {
                return None;
            }
            let kept = each(row(device, patches, effort, *side, *start));
            let done = done.fetch_add(1, Ordering::Relaxed) + 1;
            report(done as f64 / work.len() as f64);
            Some(kept)
        })
        .collect()
}

fn row<P: Patches>(device: &Device, patches: &P, effort: &Effort, side: Side, start: usize) -> Row {
    let batch = batch(effort.rays);
    let n = patches.exits();
    let zero = || [vec![([0.0; 3], 0.0); n], vec![([0.0; 3], 0.0); n]];
    let (mut onward, mut back) = (zero(), zero());
    let mut sums = [vec![Sum::default(); n], vec![Sum::default(); n]];
    let place = (start as u32) << 1 | u32::from(side == Side::Back);
    let mut rays = Vec::with_capacity(batch as usize);
    let mut out = Vec::new();
    for replicate in 0..REPLICATES {
        sums.iter_mut().for_each(|s| s.fill(Sum::default()));
        rays.clear();
        let seed = seed(effort.seed, replicate);
        // The first numbers are the shift of a lattice in place and direction together.
        let mut sampler = Sampler::new(seed, place, u32::MAX);
        let (a, b, c) = (sampler.two(), sampler.two(), sampler.two());
        let shift = [a[0], a[1], b[0], b[1], c[0]];
        rays.extend((0..batch).map(|k| {
            entering(
                device,
                patches,
                side,
                start,
                shifted(k, &shift),
                Sampler::new(seed, place, k),
            )
        }));
        out.clear();
        device.scene.pass(&device.cell, &rays, &effort.limits, &mut out);
        for leaving in &out {
            let v = leaving.direction;
            let to = Direction::from_unit(DVec3::new(v.x.into(), v.y.into(), v.z.into()));
            let sum =
                &mut sums[usize::from(v.z < 0.0)][patches.exit(-rays[leaving.ray as usize].direction, to)];
            match by_window(device, leaving) {
                true => sum.by += leaving.weight,
                false => sum.beside += leaving.weight,
            }
        }
        for (end, sums) in sums.iter().enumerate() {
            // Whether the pair is seen from its other end too.
            let both = P::RECIPROCAL && effort.sides[end];
            for (patch, sum) in sums.iter().enumerate() {
                let per = 1.0 / (f64::from(batch) * patches.lambda(patch));
                let f = |sum: Vec3| sum.to_array().map(|x| f64::from(x) * per);
                let all = sum.by + sum.beside;
                let (on, way_back) = if !both {
                    (all, all)
                } else if (end == usize::from(side == Side::Back)) && patch == start {
                    // Both ends are one.
                    (all, Vec3::ZERO)
                } else {
                    // The scatter of a mean over a patch falls with its size.
                    let (there, here) = (patches.lambda(patch), patches.lambda(start));
                    let share = (there / (there + here)) as f32;
                    (share * sum.by + sum.beside, share * sum.by)
                };
                add(&mut onward[end][patch], f(on));
                add(&mut back[end][patch], f(way_back));
            }
        }
    }
    for (mean, square) in onward.iter_mut().chain(&mut back).flatten() {
        let n = f64::from(REPLICATES);
        *square = (*square / n - grey(*mean).powi(2)).max(0.0) / (n - 1.0);
    }
    Row {
        side,
        start,
        onward,
        back,
    }
}

/// Adds the mean of a replicate.
fn add((mean, square): &mut Mean, f: [f64; 3]) {
    for (mean, x) in mean.iter_mut().zip(f) {
        *mean += x / f64::from(REPLICATES);
    }
    *square += grey(f).powi(2);
}

/// Seeds of replicates: those of two seeds have none in common.
pub(super) fn seed(seed: u64, replicate: u32) -> u64 {
    // Steps of the golden ratio, mixed by a multiplication; the sampler mixes the rest.
    let mixed = (seed ^ seed >> 32).wrapping_mul(0x9e37_79b9_7f4a_7c15);
    mixed.wrapping_add(u64::from(replicate).wrapping_mul(0xd1b5_4a32_d192_ed03))
}

pub(super) fn grey(rgb: [f64; 3]) -> f64 {
    let w = weights().to_array();
    (0..3).map(|k| f64::from(w[k]) * rgb[k]).sum()
}

/// Whether a ray leaves by the window of its side; any does of a part that repeats.
fn by_window(device: &Device, leaving: &Leaving) -> bool {
    if device.cell.periodic {
        return true;
    }
    let v = leaving.direction;
    let z = match v.z > 0.0 {
        true => device.cell.high.z,
        false => device.cell.low.z,
    };
    let at = leaving.origin + (z - leaving.origin.z) / v.z * v;
    let [[x0, y0], [x1, y1]] = device.window;
    (x0..=x1).contains(&at.x) && (y0..=y1).contains(&at.y)
}

/// A ray from a direction.
fn entering<P: Patches>(
    device: &Device,
    patches: &P,
    side: Side,
    start: usize,
    [u, v, s, t, w]: [f64; 5],
    sampler: Sampler,
) -> Entering {
    let [[x0, y0], [x1, y1]] = device.window;
    let z = match side {
        Side::Front => device.cell.high.z,
        Side::Back => device.cell.low.z,
    };
    let from = patches.point(start, side, [s, t, w]);
    Entering {
        origin: Vec3::new(x0 + u as f32 * (x1 - x0), y0 + v as f32 * (y1 - y0), z),
        direction: -from.vec().as_vec3(),
        sampler,
    }
}

/// The place of a side and component among the four.
pub(super) fn key(side: Side, component: Component) -> usize {
    FourComponents::<()>::KEYS
        .iter()
        .position(|k| *k == (side, component))
        .unwrap_or(0)
}
