//! Averages over pairs of patches of the two hemispheres.
//!
//! A ray through the window that leaves through it, or through the window on the other side, counts for its way back as well
//! (Helmholtz reciprocity [Veach1997, sec. 5.2]). One that leaves a part beside its window does not: the light that would come in there is
//! not asked for.

use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};

use glam::Vec3;
use gonio_bsdf::FourComponents;
use gonio_bsdf::klems::{KlemsBasis, Role};
use gonio_geom::{Component, DVec3, Direction, Side};
use gonio_trace::accumulate::LUMINANCE;
use gonio_trace::passage::{Entering, Leaving};
use gonio_trace::path::Limits;
use gonio_trace::sampler::Sampler;
use rayon::prelude::*;

use super::Device;
use crate::nodes::shifted;

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

/// A matrix over pairs of patches, `[exit][incident]` row by row.
#[derive(Clone, Debug, PartialEq)]
pub struct PatchTable {
    /// Mean BSDF of each pair, red, green and blue, 1/sr.
    pub values: Vec<[f64; 3]>,
    /// Standard error of its luminance (of equal red, green and blue: of each), 1/sr.
    pub errors: Vec<f64>,
}

impl PatchTable {
    /// Luminance of pair `k`, 1/sr: that of its red, green and blue over that of white.
    pub fn luminance(&self, k: usize) -> f64 {
        grey(self.values[k])
    }
}

/// How much is done, in `[0, 1]`.
pub type Progress<'a> = &'a (dyn Fn(f64) + Sync);

/// Independent scramblings of the points, whose scatter is the standard error.
const REPLICATES: u32 = 16;

/// A mean, and the square of its standard error.
type Mean = ([f64; 3], f64);

/// What rays that begin in one patch find out.
struct Row {
    side: Side,
    start: usize,
    /// About light that comes from there, `[leaves on the front, on the back][patch]`.
    onward: [Vec<Mean>; 2],
    /// About light that leaves there, `[comes from the front, from the back][patch]`.
    back: [Vec<Mean>; 2],
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

/// BSDF of a device, averaged over pairs of patches: rays are followed through points and directions that are even in area
/// and projected solid angle. Two estimates of one pair, one from each of its ends, are one value by reciprocity; each counts as
/// its scatter lets it.
///
/// Of a part that does not repeat, values are of the light that falls on the window, wherever it leaves; from sides that no rays
/// are sent from, of the light that leaves through the window, wherever it comes from.
///
/// `None` when `stop` was set before the end.
pub fn patch_tables(
    device: &Device,
    basis: &KlemsBasis,
    effort: &Effort,
    stop: &AtomicBool,
    report: Progress<'_>,
) -> Option<FourComponents<PatchTable>> {
    let sides: Vec<Side> = Side::BOTH
        .into_iter()
        .zip(effort.sides)
        .filter_map(|(side, wanted)| wanted.then_some(side))
        .collect();
    let work: Vec<(Side, usize)> = sides
        .iter()
        .flat_map(|side| (0..basis.len()).map(move |patch| (*side, patch)))
        .collect();
    let done = AtomicUsize::new(0);
    let rows: Option<Vec<Row>> = work
        .par_iter()
        .map(|(side, patch)| {
            if stop.load(Ordering::Relaxed) {
                return None;
            }
            let row = row(device, basis, effort, *side, *patch);
            let done = done.fetch_add(1, Ordering::Relaxed) + 1;
            report(done as f64 / work.len() as f64);
            Some(row)
        })
        .collect();
    rows.map(|rows| tables(basis, &rows))
}

fn row(device: &Device, basis: &KlemsBasis, effort: &Effort, side: Side, start: usize) -> Row {
    let batch = batch(effort.rays);
    let n = basis.len();
    let lambda = basis.lambda();
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
        let (a, b) = (sampler.two(), sampler.two());
        let shift = [a[0], a[1], b[0], b[1]];
        rays.extend((0..batch).map(|k| {
            entering(
                device,
                basis,
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
            let sum = &mut sums[usize::from(v.z < 0.0)][basis.patch(to, Role::Exit)];
            match by_window(device, leaving) {
                true => sum.by += leaving.weight,
                false => sum.beside += leaving.weight,
            }
        }
        for (end, sums) in sums.iter().enumerate() {
            // Whether the pair is seen from its other end too.
            let both = effort.sides[end];
            for (patch, sum) in sums.iter().enumerate() {
                let per = 1.0 / (f64::from(batch) * lambda[patch]);
                let f = |sum: Vec3| sum.to_array().map(|x| f64::from(x) * per);
                let all = sum.by + sum.beside;
                let (on, way_back) = if !both {
                    (all, all)
                } else if (end == usize::from(side == Side::Back)) && patch == start {
                    // Both ends are one.
                    (all, Vec3::ZERO)
                } else {
                    // The scatter of a mean over a patch falls with its size.
                    let share = (lambda[patch] / (lambda[patch] + lambda[start])) as f32;
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

fn grey(rgb: [f64; 3]) -> f64 {
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
fn entering(
    device: &Device,
    basis: &KlemsBasis,
    side: Side,
    start: usize,
    [u, v, s, t]: [f64; 4],
    sampler: Sampler,
) -> Entering {
    let [[x0, y0], [x1, y1]] = device.window;
    let z = match side {
        Side::Front => device.cell.high.z,
        Side::Back => device.cell.low.z,
    };
    let from = basis.point(start, Role::Exit, side, s, t);
    Entering {
        origin: Vec3::new(x0 + u as f32 * (x1 - x0), y0 + v as f32 * (y1 - y0), z),
        direction: -from.vec().as_vec3(),
        sampler,
    }
}

/// Matrices from rows: what each says of its direction as that of the light, and as that of the exit.
fn tables(basis: &KlemsBasis, rows: &[Row]) -> FourComponents<PatchTable> {
    let n = basis.len();
    // The index of each patch as incident.
    let turned: Vec<usize> = (0..n)
        .map(|k| basis.patch(basis.point(k, Role::Exit, Side::Front, 0.5, 0.5), Role::Incident))
        .collect();
    let key = |side: Side, component: Component| {
        FourComponents::<()>::KEYS
            .iter()
            .position(|k| *k == (side, component))
            .unwrap_or(0)
    };
    let mut sums: [Vec<Mean>; 4] = Default::default();
    let mut put = |key: usize, exit: usize, incident: usize, part: &Mean| {
        if sums[key].is_empty() {
            sums[key] = vec![([0.0; 3], 0.0); n * n];
        }
        let sum = &mut sums[key][exit * n + turned[incident]];
        for (s, x) in sum.0.iter_mut().zip(part.0) {
            *s += x;
        }
        sum.1 += part.1;
    };
    for row in rows {
        for (k, end) in Side::BOTH.into_iter().enumerate() {
            let component = match end == row.side {
                true => Component::Reflection,
                false => Component::Transmission,
            };
            for (patch, (onward, back)) in row.onward[k].iter().zip(&row.back[k]).enumerate() {
                put(key(row.side, component), patch, row.start, onward);
                put(key(end, component), row.start, patch, back);
            }
        }
    }
    let mut four = FourComponents::default();
    for ((side, component), sums) in FourComponents::<()>::KEYS.into_iter().zip(sums) {
        if !sums.is_empty() {
            let table = PatchTable {
                values: sums.iter().map(|(f, _)| *f).collect(),
                errors: sums.iter().map(|(_, square)| square.sqrt()).collect(),
            };
            four.set(side, component, Some(table));
        }
    }
    four
}
