//! Few samples have the mean of many, and errors fall with the number of samples as fast as those of independent ones, or
//! faster. Seeds are fixed; each test states its false-alarm rate.

use crate::common::{flat, grey, lamp, of, polygon, square};
use glam::Vec3;
use gonio_trace::material::Material;
use gonio_trace::path::Limits;
use gonio_trace::sampler::Sampler;
use gonio_trace::scene::{Parts, Scene};
use gonio_trace::sensor::Sensor;

/// A lamp in the ceiling of a box without front, its walls of a reflectance.
fn room(reflectance: f32) -> Scene {
    let mut parts = Parts {
        surfaces: vec![of(0), lamp(1, 0)],
        materials: vec![grey(reflectance), Material::Black],
        ..Parts::default()
    };
    for (corner, a, b) in [
        (Vec3::new(-1.0, -1.0, 0.0), 2.0 * Vec3::X, 2.0 * Vec3::Y),
        (Vec3::new(-1.0, -1.0, 2.0), 2.0 * Vec3::Y, 2.0 * Vec3::X),
        (Vec3::new(-1.0, 1.0, 0.0), 2.0 * Vec3::X, 2.0 * Vec3::Z),
        (Vec3::new(-1.0, -1.0, 0.0), 2.0 * Vec3::Y, 2.0 * Vec3::Z),
        (Vec3::new(1.0, -1.0, 0.0), 2.0 * Vec3::Z, 2.0 * Vec3::Y),
        // A shelf that hides part of the lamp.
        (Vec3::new(-0.2, -0.3, 1.2), 0.5 * Vec3::X, 0.5 * Vec3::Y),
    ] {
        polygon(&mut parts, &[corner, corner + a, corner + a + b, corner + b], 0);
    }
    let faces = square(&mut parts, 0.4, 1.95, false, 1);
    parts.lights = vec![flat(&faces, 5.0)];
    Scene::new(parts).unwrap()
}

/// What a sample estimates: a sensor in half shadow, and a view across the edge of the shelf.
fn draw(scene: &Scene, view: bool, sampler: &mut Sampler) -> f64 {
    let limits = Limits {
        bounces: 16,
        roulette: 3,
    };
    if view {
        let [u, v] = sampler.two();
        let eye = Vec3::new(0.1, -2.5, 1.6);
        let at = Vec3::new(0.2 * u, -0.3, 1.1 + 0.2 * v);
        return f64::from(scene.radiance(eye, (at - eye).normalize(), &limits, sampler).y);
    }
    let sensor = Sensor::new(Vec3::new(0.3, 0.2, 0.4), Vec3::new(0.0, -0.28, 0.96)).unwrap();
    f64::from(scene.irradiance(&sensor, &limits, sampler).y)
}

/// Mean of the first `samples` of a seed.
fn estimate(scene: &Scene, view: bool, seed: u64, samples: u32) -> f64 {
    let sum: f64 = (0..samples)
        .map(|index| draw(scene, view, &mut Sampler::new(seed, 3, index)))
        .sum();
    sum / f64::from(samples)
}

/// Mean and its standard error of estimates by seed.
fn mean(estimates: &[f64]) -> (f64, f64) {
    let n = estimates.len() as f64;
    let mean = estimates.iter().sum::<f64>() / n;
    let square: f64 = estimates.iter().map(|x| (x - mean).powi(2)).sum();
    (mean, (square / (n * (n - 1.0))).sqrt())
}

fn converged(scene: &Scene, view: bool) -> (f64, f64) {
    let many: Vec<f64> = (0..64)
        .map(|seed| estimate(scene, view, 1_000_000 + seed, 8192))
        .collect();
    mean(&many)
}

#[test]
fn one_two_four_and_sixteen_samples_have_the_mean_of_many() {
    let scene = room(0.6);
    for view in [false, true] {
        let truth = converged(&scene, view);
        for samples in [1, 2, 4, 16] {
            let few: Vec<f64> = (0..4096)
                .map(|seed| estimate(&scene, view, seed, samples))
                .collect();
            let few = mean(&few);
            // Four standard errors: a false alarm in 16 000 comparisons, of eight.
            let error = few.1.hypot(truth.1);
            assert!(
                (few.0 - truth.0).abs() < 4.0 * error,
                "{samples} samples: {few:?}, {truth:?}"
            );
            assert!(error < 0.03 * truth.0);
        }
    }
}

/// Slope of the logarithm of the error over that of the samples, from 4 to 4096, and its standard error.
fn slope(scene: &Scene, view: bool) -> (f64, f64) {
    const SEEDS: u64 = 64;
    let truth = converged(scene, view).0;
    let points: Vec<[f64; 2]> = (2..=12)
        .map(|k| {
            let samples = 1 << k;
            let square: f64 = (0..SEEDS)
                .map(|seed| (estimate(scene, view, seed + (k << 20), samples) - truth).powi(2))
                .sum();
            [f64::from(samples).ln(), 0.5 * (square / SEEDS as f64).ln()]
        })
        .collect();
    let n = points.len() as f64;
    let [x, y] = [0, 1].map(|i| points.iter().map(|p| p[i]).sum::<f64>() / n);
    let width: f64 = points.iter().map(|p| (p[0] - x).powi(2)).sum();
    let slope = points.iter().map(|p| (p[0] - x) * (p[1] - y)).sum::<f64>() / width;
    // The logarithm of the root of a mean of 64 squares of normal errors scatters by 1 / sqrt(2 * 64).
    (slope, (0.5 / SEEDS as f64 / width).sqrt())
}

#[test]
fn errors_fall_as_those_of_independent_samples_or_faster() {
    // Reflected light: as independent samples, -1/2 at least; three standard errors of the slope, a false alarm in 700.
    // Light straight from the lamp: two even dimensions with an edge through them, -3/4.
    for (reflectance, view, wanted) in [(0.6, false, -0.5), (0.6, true, -0.5), (0.0, false, -0.7)] {
        let scene = room(reflectance);
        let (found, error) = slope(&scene, view);
        assert!(
            found < wanted + 3.0 * error,
            "{found} +- {error}, reflectance {reflectance}"
        );
    }
}
