//! Pictures.

use std::sync::atomic::AtomicBool;

pub use crate::accumulate::{BATCH, Effort, LUMINANCE, Pixel, Report, Round, luminance};
use glam::Vec3;

use crate::accumulate::{Draw, accumulate};
use crate::camera::Camera;
use crate::path::{Limits, Path};
use crate::sampler::Sampler;
use crate::scene::Scene;
use crate::shared::{MEMBERS, Table};

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
const TILE: usize = 8;

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

impl Sight<'_> {
    #[inline(always)]
    fn ray(&self, place: usize, [u, v]: [f32; 2]) -> Option<(Vec3, Vec3)> {
        let [width, height] = self.size;
        let (x, y) = (place % width, place / width);
        self.camera.ray([
            (x as f32 + u) / width as f32,
            1.0 - (y as f32 + v) / height as f32,
        ])
    }
}

impl Draw for Sight<'_> {
    #[inline(always)]
    fn start(&self, place: usize, mut sampler: Sampler) -> Path {
        match self.ray(place, sampler.two()) {
            Some((origin, direction)) => Path::new(origin, direction, sampler),
            None => Path::dark(sampler),
        }
    }

    fn scene(&self) -> (&Scene, &Limits) {
        (self.scene, &self.limits)
    }

    fn clip(&self) -> Option<&Camera> {
        self.camera.clips().then_some(self.camera)
    }

    #[inline(always)]
    fn shared(&self, places: &[usize], seed: u64, first: u32, sums: &mut [[f64; 3]]) -> bool {
        if self.scene.travels || self.camera.clips() {
            // Paths that remember where they were are no one else's.
            return false;
        }
        for (places, sums) in places.chunks(MEMBERS).zip(sums.chunks_mut(MEMBERS)) {
            for index in first..first + BATCH {
                let mut table = Table::new(self.scene, &self.limits, seed, places, index);
                for (k, place) in places.iter().enumerate() {
                    let mut sampler = Sampler::new(seed, *place as u32, index);
                    if let Some((origin, direction)) = self.ray(*place, sampler.two()) {
                        table.look(k, origin, direction, sampler);
                    }
                }
                for (sum, value) in sums.iter_mut().zip(table.finish()) {
                    for (s, x) in sum.iter_mut().zip(value.to_array()) {
                        *s += f64::from(x);
                    }
                }
            }
        }
        true
    }
}
