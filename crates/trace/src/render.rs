//! Pictures.

use std::sync::atomic::AtomicBool;

use glam::Vec3;

pub use crate::accumulate::{BATCH, Effort, LUMINANCE, Pixel, Report, Round, luminance};
use crate::accumulate::{Draw, accumulate};
use crate::camera::Camera;
use crate::path::Limits;
use crate::sampler::Sampler;
use crate::scene::Scene;

/// A picture: pixels row by row from the top left.
#[derive(Clone, Debug, PartialEq)]
pub struct Picture {
    /// Pixels across.
    pub width: usize,
    /// Pixels down.
    pub height: usize,
    /// Row by row from the top.
    pub pixels: Vec<Pixel>,
    /// Where its samples stand.
    pub round: Round,
}

/// Pixels that one thread takes at a time, on a side.
const TILE: usize = 16;

impl Picture {
    /// A picture without samples.
    pub fn new(width: usize, height: usize) -> Self {
        Picture {
            width,
            height,
            pixels: vec![Pixel::default(); width * height],
            round: Round::default(),
        }
    }

    /// Adds samples to the picture until the effort is reached, on all threads. `report` hears after every tile how far the
    /// work is; when `stop` is set, the samples so far stay whole, and the same call later ends with the same picture as
    /// without the stop. With more samples than before or a smaller error it adds to those that are there.
    pub fn render(
        &mut self,
        scene: &Scene,
        camera: &Camera,
        effort: &Effort,
        stop: &AtomicBool,
        report: &(dyn Fn(Report) + Sync),
    ) {
        let (width, height) = (self.width, self.height);
        let tiles: Vec<Vec<usize>> = (0..height.div_ceil(TILE))
            .flat_map(|j| (0..width.div_ceil(TILE)).map(move |i| (i * TILE, j * TILE)))
            .map(|(left, top)| {
                (top..(top + TILE).min(height))
                    .flat_map(|y| (left..(left + TILE).min(width)).map(move |x| y * width + x))
                    .collect()
            })
            .collect();
        let view = Sight {
            scene,
            camera,
            limits: effort.limits,
            size: [width, height],
        };
        accumulate(
            &mut self.pixels,
            &mut self.round,
            &tiles,
            &view,
            effort,
            stop,
            report,
        );
    }
}

/// Radiance through the pixels.
struct Sight<'a> {
    scene: &'a Scene,
    camera: &'a Camera,
    limits: Limits,
    size: [usize; 2],
}

impl Draw for Sight<'_> {
    #[inline(always)]
    fn draw(&self, place: usize, sampler: &mut Sampler) -> Vec3 {
        let [width, height] = self.size;
        let (x, y) = (place % width, place / width);
        let [u, v] = sampler.two();
        let at = [
            (x as f32 + u) / width as f32,
            1.0 - (y as f32 + v) / height as f32,
        ];
        match self.camera.ray(at) {
            Some((origin, direction)) => self.scene.radiance(origin, direction, &self.limits, sampler),
            None => Vec3::ZERO,
        }
    }
}
