//! Samples added up place by place, of a picture or of sensors, until the error is small enough.

use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};

use glam::Vec3;
use rayon::prelude::*;

use crate::camera::Camera;
use crate::lanes::LANES;
use crate::path::{Limits, Path};
use crate::sampler::Sampler;
use crate::scene::Scene;

/// Luminance over radiance of red, green and blue, cd/m2 per W/(m2 sr), as RADIANCE weighs them (formulas.md 8.2); just as
/// well illuminance over irradiance, lx per W/m2.
pub const LUMINANCE: Vec3 = Vec3::new(47.448_246, 119.950_585, 11.601_169);

/// Luminance of a radiance in red, green and blue, cd/m2.
pub fn luminance(radiance: Vec3) -> f32 {
    radiance.dot(LUMINANCE)
}

/// Sums of the samples of one pixel or sensor.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Pixel {
    /// Sum of the radiances (of a sensor: irradiances).
    pub sum: [f64; 3],
    /// Sum of the squares of the luminances of batches, each of [`BATCH`] samples.
    pub square: f64,
    /// Samples.
    pub count: u32,
}

/// Samples whose mean counts as one in the standard error: a batch of scrambled low-discrepancy points is far more even
/// than as many independent ones.
pub const BATCH: u32 = 8;

impl Pixel {
    /// Adds a batch of samples with this sum.
    fn add(&mut self, sum: [f64; 3]) {
        for (s, x) in self.sum.iter_mut().zip(sum) {
            *s += x;
        }
        let mean = sum.map(|x| x / f64::from(BATCH));
        self.square += weigh(mean).powi(2);
        self.count += BATCH;
    }

    /// Mean radiance, W/(m2 sr); of a sensor irradiance, W/m2.
    pub fn mean(&self) -> [f64; 3] {
        self.sum.map(|s| {
            if self.count > 0 {
                s / f64::from(self.count)
            } else {
                0.0
            }
        })
    }

    /// Mean luminance, cd/m2; of a sensor illuminance, lx.
    pub fn luminance(&self) -> f64 {
        weigh(self.mean())
    }

    /// Standard error of the luminance, cd/m2, from the scatter of the batches; infinite below two of them. Batches of one
    /// scrambled sequence repel each other: the true error is smaller, not larger.
    pub fn error(&self) -> f64 {
        let batches = f64::from(self.count / BATCH);
        if batches < 2.0 {
            return f64::INFINITY;
        }
        let mean = self.luminance();
        let variance = (self.square / batches - mean * mean).max(0.0) / (batches - 1.0);
        variance.sqrt()
    }
}

fn weigh(rgb: [f64; 3]) -> f64 {
    let w = LUMINANCE.to_array();
    (0..3).map(|k| f64::from(w[k]) * rgb[k]).sum()
}

/// How many samples are taken.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Effort {
    /// Samples a pixel or sensor, at most; rounded up to whole batches.
    pub samples: u32,
    /// A pixel is done when the standard error of its luminance is below this fraction of it (or of a hundredth of the
    /// mean of all, where it is darker); `None`: all take all samples.
    pub relative_error: Option<f64>,
    /// Limits of the paths.
    pub limits: Limits,
    /// The same seed gives the same result, whatever the number of threads.
    pub seed: u64,
    /// Whether pixels of a picture share paths with their neighbours: a sample takes longer and is worth many.
    pub share: bool,
}

impl Effort {
    fn goal(&self) -> u32 {
        self.samples.clamp(1, u32::MAX - BATCH).div_ceil(BATCH) * BATCH
    }
}

/// Where the rounds of samples stand: between two rounds all errors are looked at. Kept with the pixels, it lets work that
/// was stopped in the midst of a round go on to the very result of work that was not.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Round {
    /// Samples that open pixels have at the end of this round.
    pub goal: u32,
    /// A hundredth of the mean luminance at its beginning: what errors of darker pixels are compared with.
    pub floor: f64,
}

/// How far the work is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Report {
    /// Share of the samples that will have to be taken, by what is known.
    pub done: f64,
    /// Mean of the standard errors over the mean luminance, at the beginning of the round; infinite before two batches.
    pub error: f64,
}

/// Samples of the first round: with fewer, light that comes rarely may be missed and the error seem small.
const FIRST: u32 = 8 * BATCH;

impl Round {
    /// The next round.
    fn after(self, pixels: &[Pixel], goal: u32) -> Self {
        let next = (self.goal + self.goal / 2).max(FIRST).div_ceil(BATCH) * BATCH;
        Round {
            goal: next.min(goal),
            floor: 0.01 * mean(pixels, Pixel::luminance),
        }
    }
}

fn mean(pixels: &[Pixel], of: impl Fn(&Pixel) -> f64) -> f64 {
    pixels.iter().map(of).sum::<f64>() / pixels.len().max(1) as f64
}

/// What is sampled.
pub(crate) trait Draw: Sync {
    /// The beginning of a path of a place.
    fn start(&self, place: usize, sampler: Sampler) -> Path;

    /// Where the paths lead through, and how far.
    fn scene(&self) -> (&Scene, &Limits);

    /// The camera whose aft clipping plane the paths meet, if it has one.
    fn clip(&self) -> Option<&Camera> {
        None
    }

    /// Adds the samples `first` to `first + BATCH` of places that share paths to their sums; `false` where each stands for
    /// itself.
    fn shared(&self, places: &[usize], seed: u64, first: u32, sums: &mut [[f64; 3]]) -> bool;
}

/// Adds samples to `pixels` until the effort is reached; `groups` of places are the work of one thread at a time.
pub(crate) fn accumulate<D: Draw>(
    pixels: &mut [Pixel],
    round: &mut Round,
    groups: &[Vec<usize>],
    draw: &D,
    effort: &Effort,
    stop: &AtomicBool,
    report: &(dyn Fn(Report) + Sync),
) {
    let goal = effort.goal();
    loop {
        // What a round decides about a pixel hangs on the pixel before the round and the floor, so a round that was
        // stopped is taken up where it was.
        let now = *round;
        let precise = |p: &Pixel| {
            effort
                .relative_error
                .is_some_and(|e| p.count >= FIRST && p.error() <= e * p.luminance().max(now.floor))
        };
        let open = |p: &Pixel| p.count < now.goal.min(goal) && !precise(p);
        if !pixels.iter().any(open) {
            let next = now.after(pixels, goal);
            let done = |p: &Pixel| {
                p.count >= goal
                    || effort
                        .relative_error
                        .is_some_and(|e| p.count >= FIRST && p.error() <= e * p.luminance().max(next.floor))
            };
            if pixels.iter().all(done) {
                return;
            }
            *round = next;
            continue;
        }
        if stop.load(Ordering::Relaxed) {
            return;
        }
        let error = mean(pixels, Pixel::error) / mean(pixels, Pixel::luminance);
        let (mut taken, mut needed) = (0.0, 0.0);
        for p in pixels.iter() {
            taken += f64::from(p.count);
            needed += expected(p, now.floor, goal, effort);
        }
        let added = AtomicU64::new(0);
        let before: &[Pixel] = pixels;
        let parts: Vec<Vec<(usize, Pixel)>> = groups
            .par_iter()
            .map(|group| {
                let limit = now.goal.min(goal);
                let mut members: Vec<(usize, Pixel)> = group
                    .iter()
                    .map(|place| (*place, before[*place]))
                    .filter(|(_, pixel)| open(pixel))
                    .collect();
                let new = match effort.share {
                    true => together(draw, effort.seed, limit, &mut members, stop),
                    false => alone(draw, effort.seed, limit, &mut members, stop),
                };
                // Half a round of a pixel would count as its state before the round, where errors decide.
                members.retain(|(_, p)| effort.relative_error.is_none() || p.count >= limit);
                let all = added.fetch_add(new, Ordering::Relaxed) + new;
                report(Report {
                    done: ((taken + all as f64) / needed).min(1.0),
                    error,
                });
                members
            })
            .collect();
        for (place, pixel) in parts.into_iter().flatten() {
            pixels[place] = pixel;
        }
    }
}

/// Adds samples to each of some places; how many.
fn alone<D: Draw>(draw: &D, seed: u64, limit: u32, members: &mut [(usize, Pixel)], stop: &AtomicBool) -> u64 {
    let mut new = 0;
    for (place, pixel) in members {
        while pixel.count < limit && !stop.load(Ordering::Relaxed) {
            let left = ((limit - pixel.count) / BATCH) as usize;
            let sums_of = |call: usize| {
                let many = (left - call * BATCHES).clamp(1, BATCHES);
                let first = pixel.count + (call * BATCHES) as u32 * BATCH;
                (many, batches(draw, seed, *place, first, many))
            };
            let calls = left.div_ceil(BATCHES).min(CALLS);
            // Sums are added in the order of the samples, whoever computed them.
            let found: Vec<_> = match calls {
                0..2 => vec![sums_of(0)],
                _ => (0..calls).into_par_iter().map(sums_of).collect(),
            };
            for (many, sums) in &found {
                for sum in &sums[..*many] {
                    pixel.add(*sum);
                    new += u64::from(BATCH);
                }
            }
        }
    }
    new
}

/// Adds samples to places that share paths; how many.
fn together<D: Draw>(
    draw: &D,
    seed: u64,
    limit: u32,
    members: &mut [(usize, Pixel)],
    stop: &AtomicBool,
) -> u64 {
    let mut new = 0;
    let mut places = Vec::with_capacity(members.len());
    let mut sums = Vec::with_capacity(members.len());
    while !stop.load(Ordering::Relaxed)
        && let Some(count) = members.iter().map(|(_, p)| p.count).min().filter(|n| *n < limit)
    {
        // Those that are behind catch up first: who draws together is known by the counts alone.
        let behind = |p: &Pixel| p.count == count;
        places.clear();
        places.extend(members.iter().filter(|(_, p)| behind(p)).map(|(place, _)| *place));
        sums.clear();
        sums.resize(places.len(), [0.0; 3]);
        if !shared(draw, &places, seed, count, &mut sums) {
            return new + alone(draw, seed, limit, members, stop);
        }
        let added = members.iter_mut().filter(|(_, p)| behind(p));
        for ((_, pixel), sum) in added.zip(&sums) {
            pixel.add(*sum);
            new += u64::from(BATCH);
        }
    }
    new
}

/// Samples that a pixel will have, as its error falls with their square root.
fn expected(p: &Pixel, floor: f64, goal: u32, effort: &Effort) -> f64 {
    let all = f64::from(goal.max(p.count));
    let Some(wanted) = effort.relative_error else {
        return all;
    };
    let (error, limit) = (p.error(), wanted * p.luminance().max(floor));
    if !error.is_finite() || limit <= 0.0 {
        return all;
    }
    let count = f64::from(p.count);
    (count * (error / limit).powi(2)).clamp(count, all)
}

/// Calls for batches of one place that all threads take together, between two looks whether to stop.
const CALLS: usize = 64;

/// Batches whose paths are followed side by side.
const BATCHES: usize = LANES / BATCH as usize;

/// The sums of some batches of samples of one place, in the instructions that the processor has.
fn batches<D: Draw>(draw: &D, seed: u64, place: usize, first: u32, count: usize) -> [[f64; 3]; BATCHES] {
    #[cfg(target_arch = "x86_64")]
    {
        #[target_feature(enable = "avx2,fma,bmi2")]
        fn wide<D: Draw>(draw: &D, seed: u64, place: usize, first: u32, count: usize) -> [[f64; 3]; BATCHES] {
            samples(draw, seed, place, first, count)
        }
        if is_x86_feature_detected!("avx2")
            && is_x86_feature_detected!("fma")
            && is_x86_feature_detected!("bmi2")
        {
            // SAFETY: the processor has the instructions.
            return unsafe { wide(draw, seed, place, first, count) };
        }
    }
    samples(draw, seed, place, first, count)
}

#[inline(always)]
fn samples<D: Draw>(draw: &D, seed: u64, place: usize, first: u32, count: usize) -> [[f64; 3]; BATCHES] {
    let mut paths = [Path::dark(Sampler::new(seed, place as u32, first)); LANES];
    let paths = &mut paths[..count * BATCH as usize];
    // No closure: it would not have the instructions.
    for (k, path) in paths.iter_mut().enumerate() {
        *path = draw.start(place, Sampler::new(seed, place as u32, first + k as u32));
    }
    let (scene, limits) = draw.scene();
    match draw.clip() {
        None => scene.follow(paths, limits),
        Some(camera) => scene.follow_clipped(camera, paths, limits),
    }
    let mut sums = [[0.0; 3]; BATCHES];
    for (sum, batch) in sums.iter_mut().zip(paths.chunks(BATCH as usize)) {
        for path in batch {
            for (s, x) in sum.iter_mut().zip(path.sum.to_array()) {
                *s += f64::from(x);
            }
        }
    }
    sums
}

/// A batch of samples of places that share paths, in the instructions that the processor has.
fn shared<D: Draw>(draw: &D, places: &[usize], seed: u64, first: u32, sums: &mut [[f64; 3]]) -> bool {
    #[cfg(target_arch = "x86_64")]
    {
        #[target_feature(enable = "avx2,fma,bmi2")]
        fn wide<D: Draw>(draw: &D, places: &[usize], seed: u64, first: u32, sums: &mut [[f64; 3]]) -> bool {
            draw.shared(places, seed, first, sums)
        }
        if is_x86_feature_detected!("avx2")
            && is_x86_feature_detected!("fma")
            && is_x86_feature_detected!("bmi2")
        {
            // SAFETY: the processor has the instructions.
            return unsafe { wide(draw, places, seed, first, sums) };
        }
    }
    draw.shared(places, seed, first, sums)
}
