//! Pictures: samples added up pixel by pixel until the error is small enough.

use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};

use glam::Vec3;
use rayon::prelude::*;

use crate::camera::Camera;
use crate::path::Limits;
use crate::sampler::Sampler;
use crate::scene::Scene;

/// Luminance over radiance of red, green and blue, cd/m2 per W/(m2 sr), as RADIANCE weighs them (formulas.md 8.2).
pub const LUMINANCE: Vec3 = Vec3::new(47.448_246, 119.950_585, 11.601_169);

/// Luminance of a radiance in red, green and blue, cd/m2.
pub fn luminance(radiance: Vec3) -> f32 {
    radiance.dot(LUMINANCE)
}

/// Sums of the samples of one pixel or sensor.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Pixel {
    /// Sum of the radiances.
    pub sum: [f64; 3],
    /// Sum of the squares of the luminances of batches, each of [`BATCH`] samples.
    pub square: f64,
    /// Samples.
    pub count: u32,
}

/// Samples whose mean counts as one in the standard error: a batch of scrambled low-discrepancy points is far more even
/// than as many independent ones.
pub const BATCH: u32 = 16;

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

    /// Mean radiance, W/(m2 sr).
    pub fn mean(&self) -> [f64; 3] {
        self.sum.map(|s| {
            if self.count > 0 {
                s / f64::from(self.count)
            } else {
                0.0
            }
        })
    }

    /// Mean luminance, cd/m2.
    pub fn luminance(&self) -> f64 {
        weigh(self.mean())
    }

    /// Standard error of the luminance, cd/m2, from the scatter of the batches; infinite below two of them.
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

/// How many samples a picture takes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Effort {
    /// Samples a pixel, at most; rounded up to whole batches.
    pub samples: u32,
    /// A pixel is done when the standard error of its luminance is below this fraction of it (or of a hundredth of the
    /// picture's mean, where it is darker); `None`: all pixels take all samples.
    pub relative_error: Option<f64>,
    /// Limits of the paths.
    pub limits: Limits,
    /// The same seed gives the same picture, whatever the number of threads.
    pub seed: u64,
}

/// A picture: pixels row by row from the top left.
#[derive(Clone, Debug, PartialEq)]
pub struct Picture {
    /// Pixels across.
    pub width: usize,
    /// Pixels down.
    pub height: usize,
    /// Row by row from the top.
    pub pixels: Vec<Pixel>,
}

/// Batches of all pixels between two looks at the error.
const ROUND: u32 = 2;
/// Pixels that one thread takes at a time, on a side.
const TILE: usize = 16;

impl Picture {
    /// A picture without samples.
    pub fn new(width: usize, height: usize) -> Self {
        Picture {
            width,
            height,
            pixels: vec![Pixel::default(); width * height],
        }
    }

    /// Adds samples to the picture until the effort is reached, on all threads. `report` hears the share that is done after
    /// every tile; when `stop` is set, the samples so far stay whole and the picture can be resumed.
    pub fn render(
        &mut self,
        scene: &Scene,
        camera: &Camera,
        effort: &Effort,
        stop: &AtomicBool,
        report: &(dyn Fn(f64) + Sync),
    ) {
        let goal = effort.samples.div_ceil(BATCH) * BATCH;
        loop {
            let least = self.pixels.iter().map(|p| p.count).min().unwrap_or(goal);
            let floor = self.floor();
            let done = |p: &Pixel| {
                p.count >= goal
                    || effort
                        .relative_error
                        .is_some_and(|e| p.error() <= e * p.luminance().max(floor))
            };
            let open = self.pixels.iter().filter(|p| !done(p)).count();
            if open == 0 || stop.load(Ordering::Relaxed) {
                return;
            }
            let batches = if effort.relative_error.is_some() {
                ROUND.max(least / BATCH / 4)
            } else {
                goal / BATCH
            };
            self.round(scene, camera, effort, goal, batches, &|p| done(p), stop, report);
        }
    }

    /// A hundredth of the mean luminance.
    fn floor(&self) -> f64 {
        let sum: f64 = self.pixels.iter().map(Pixel::luminance).sum();
        0.01 * sum / self.pixels.len().max(1) as f64
    }

    #[allow(clippy::too_many_arguments)]
    fn round(
        &mut self,
        scene: &Scene,
        camera: &Camera,
        effort: &Effort,
        goal: u32,
        batches: u32,
        done: &(dyn Fn(&Pixel) -> bool + Sync),
        stop: &AtomicBool,
        report: &(dyn Fn(f64) + Sync),
    ) {
        let (width, height) = (self.width, self.height);
        let tiles: Vec<(usize, usize)> = (0..height.div_ceil(TILE))
            .flat_map(|j| (0..width.div_ceil(TILE)).map(move |i| (i * TILE, j * TILE)))
            .collect();
        let finished = AtomicUsize::new(0);
        let pixels = &self.pixels;
        let parts: Vec<Vec<(usize, Pixel)>> = tiles
            .par_iter()
            .map(|&(left, top)| {
                let mut out = Vec::new();
                for y in top..(top + TILE).min(height) {
                    for x in left..(left + TILE).min(width) {
                        let k = y * width + x;
                        let mut pixel = pixels[k];
                        if done(&pixel) || stop.load(Ordering::Relaxed) {
                            continue;
                        }
                        for _ in 0..batches {
                            if pixel.count >= goal {
                                break;
                            }
                            let first = pixel.count;
                            pixel.add(batch(scene, camera, effort, [x, y], [width, height], first));
                        }
                        out.push((k, pixel));
                    }
                }
                let n = finished.fetch_add(1, Ordering::Relaxed) + 1;
                report(n as f64 / tiles.len() as f64);
                out
            })
            .collect();
        for (k, pixel) in parts.into_iter().flatten() {
            self.pixels[k] = pixel;
        }
    }
}

/// The sum of a batch of samples of one pixel, in the instructions that the processor has.
fn batch(
    scene: &Scene,
    camera: &Camera,
    effort: &Effort,
    at: [usize; 2],
    size: [usize; 2],
    first: u32,
) -> [f64; 3] {
    #[cfg(target_arch = "x86_64")]
    {
        #[target_feature(enable = "avx2,fma,bmi2")]
        fn wide(
            scene: &Scene,
            camera: &Camera,
            effort: &Effort,
            at: [usize; 2],
            size: [usize; 2],
            first: u32,
        ) -> [f64; 3] {
            samples(scene, camera, effort, at, size, first)
        }
        if is_x86_feature_detected!("avx2")
            && is_x86_feature_detected!("fma")
            && is_x86_feature_detected!("bmi2")
        {
            // SAFETY: the processor has the instructions.
            return unsafe { wide(scene, camera, effort, at, size, first) };
        }
    }
    samples(scene, camera, effort, at, size, first)
}

#[inline(always)]
fn samples(
    scene: &Scene,
    camera: &Camera,
    effort: &Effort,
    [x, y]: [usize; 2],
    [width, height]: [usize; 2],
    first: u32,
) -> [f64; 3] {
    let mut sum = [0.0; 3];
    for index in first..first + BATCH {
        let mut sampler = Sampler::new(effort.seed, (y * width + x) as u32, index);
        let [u, v] = sampler.two();
        let at = [
            (x as f32 + u) / width as f32,
            1.0 - (y as f32 + v) / height as f32,
        ];
        if let Some((origin, direction)) = camera.ray(at) {
            let radiance = scene.radiance(origin, direction, &effort.limits, &mut sampler);
            for (s, x) in sum.iter_mut().zip(radiance.to_array()) {
                *s += f64::from(x);
            }
        }
    }
    sum
}
