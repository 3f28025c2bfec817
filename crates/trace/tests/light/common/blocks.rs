//! Pictures of small rooms in blocks of pixels, over seeds.

use std::sync::Arc;
use std::sync::atomic::AtomicBool;

use glam::Vec3;
use gonio_bsdf::{Bsdf, RadianceMaterial};
use gonio_trace::camera::{Camera, Projection, View};
use gonio_trace::material::Material;
use gonio_trace::path::Limits;
use gonio_trace::render::{Effort, Picture};
use gonio_trace::scene::Scene;

/// A Radiance material as a surface has it.
pub(crate) fn model(m: RadianceMaterial) -> Material {
    let model: Arc<dyn Bsdf> = Arc::from(m.bsdf().unwrap());
    Material::model(model, None)
}

/// From the near wall of a room 2 m wide and high along `y`.
pub(crate) fn into_the_room(horizontal: f32) -> Camera {
    let view = View {
        projection: Projection::Perspective,
        point: Vec3::new(1.0, 0.1, 1.1),
        direction: Vec3::new(0.0, 1.0, -0.2),
        up: Vec3::Z,
        horizontal,
        vertical: 60.0,
        shift: [0.0; 2],
        fore: 0.0,
        aft: 0.0,
    };
    Camera::new(view).unwrap()
}

/// A block of pixels over 64 seeds.
#[derive(Debug)]
pub(crate) struct Block {
    mean: f64,
    standard_error: f64,
}

/// 30 blocks of 16 pixels, 16 paths a pixel and seed.
pub(crate) fn over_seeds(scene: &Scene, camera: &Camera, share: bool, bounces: u32) -> Vec<Block> {
    const SEEDS: u64 = 64;
    let run = |seed| {
        let effort = Effort {
            samples: 16,
            relative_error: None,
            limits: Limits {
                bounces,
                ..Limits::default()
            },
            seed,
            share,
        };
        let mut picture = Picture::new(24, 20);
        picture.render(scene, camera, &effort, &AtomicBool::new(false), &|_| {});
        let mut sums = vec![0.0; 30];
        for (k, pixel) in picture.pixels.iter().enumerate() {
            sums[k / 24 / 4 * 6 + k % 24 / 4] += pixel.luminance() / 16.0;
        }
        sums
    };
    let runs: Vec<Vec<f64>> = (0..SEEDS).map(|seed| run(100 + seed)).collect();
    (0..runs[0].len())
        .map(|k| {
            let mean = runs.iter().map(|r| r[k]).sum::<f64>() / SEEDS as f64;
            let scatter: f64 = runs.iter().map(|r| (r[k] - mean).powi(2)).sum();
            let standard_error = (scatter / ((SEEDS - 1) * SEEDS) as f64).sqrt();
            Block { mean, standard_error }
        })
        .collect()
}

/// Fails where two means of a block differ by more than 4 standard errors: of 63 and more degrees of freedom that happens
/// in 2 of 10 000 comparisons.
pub(crate) fn assert_equal(a: &[Block], b: &[Block], about: &str) {
    for (k, (a, b)) in a.iter().zip(b).enumerate() {
        let error = a.standard_error.hypot(b.standard_error);
        assert!(
            (a.mean - b.mean).abs() <= 4.0 * error + 1e-4 * b.mean,
            "{about}, block {k}: {a:?} {b:?}"
        );
    }
}

/// Squared relative errors, summed.
pub(crate) fn noise(blocks: &[Block]) -> f64 {
    blocks.iter().map(|v| (v.standard_error / v.mean).powi(2)).sum()
}
