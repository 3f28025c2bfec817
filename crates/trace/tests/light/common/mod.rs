//! What the tests against closed forms share: means with their errors, and parts of scenes.
#![allow(dead_code)]

pub(crate) mod blocks;

use glam::Vec3;
use gonio_trace::light::{Ball, Flat, Light};
use gonio_trace::material::Material;
use gonio_trace::path::Limits;
use gonio_trace::sampler::Sampler;
use gonio_trace::scene::{Parts, Scene, Surface};
use gonio_trace::sensor::Sensor;
use gonio_trace::shape::Shape;

/// Independent scramblings of a mean.
const RUNS: u32 = 64;

/// Mean and standard error of `samples` draws, from the scatter of independent scramblings.
pub(crate) fn mean(samples: u32, draw: impl Fn(&mut Sampler) -> f32) -> (f64, f64) {
    let (mut sum, mut square) = (0.0, 0.0);
    for run in 0..RUNS {
        let batch: f64 = (0..samples / RUNS)
            .map(|index| f64::from(draw(&mut Sampler::new(11, run, index))))
            .sum();
        let mean = batch / f64::from(samples / RUNS);
        sum += mean / f64::from(RUNS);
        square += mean * mean / f64::from(RUNS);
    }
    (sum, ((square - sum * sum).max(0.0) / f64::from(RUNS - 1)).sqrt())
}

/// Radiance at a point from a direction.
pub(crate) fn radiance(
    scene: &Scene,
    origin: Vec3,
    direction: Vec3,
    samples: u32,
    limits: Limits,
) -> (f64, f64) {
    mean(samples, |s| scene.radiance(origin, direction, &limits, s).y)
}

/// Irradiance of a sensor.
pub(crate) fn irradiance(scene: &Scene, point: Vec3, normal: Vec3, samples: u32) -> (f64, f64) {
    let sensor = Sensor::new(point, normal).unwrap();
    mean(samples, |s| scene.irradiance(&sensor, &Limits::default(), s).y)
}

/// Four standard errors and the rounding of single precision. Student's t of 63 degrees of freedom is beyond 4 in 2 of
/// 10 000 comparisons.
#[track_caller]
pub(crate) fn close(found: (f64, f64), wanted: f64) {
    let off = (found.0 - wanted).abs();
    assert!(off < 4.0 * found.1 + 2e-4 * wanted, "{found:?}, wanted {wanted}");
}

/// As [`close`], and the mean is known to this fraction at least.
#[track_caller]
pub(crate) fn sharp(found: (f64, f64), wanted: f64, fraction: f64) {
    close(found, wanted);
    assert!(found.1 < fraction * wanted, "{found:?}, wanted {wanted}");
}

/// A Lambertian reflector.
pub(crate) fn grey(reflectance: f32) -> Material {
    Material::Diffuse {
        reflectance: Vec3::splat(reflectance),
    }
}

/// A surface of a material.
pub(crate) fn of(material: u32) -> Surface {
    Surface {
        material,
        ..Surface::default()
    }
}

/// A surface that is a light.
pub(crate) fn lamp(material: u32, light: u32) -> Surface {
    Surface {
        light: Some(light),
        ..of(material)
    }
}

/// A light of these triangles.
pub(crate) fn flat(triangles: &[[Vec3; 3]], radiance: f32) -> Light {
    Light::Flat(Flat::new(triangles, Vec3::splat(radiance)).unwrap())
}

/// A convex polygon as a fan; its front is where it turns counterclockwise.
pub(crate) fn polygon(parts: &mut Parts, corners: &[Vec3], surface: u32) -> Vec<[Vec3; 3]> {
    let k = parts.vertices.len() as u32;
    parts.vertices.extend(corners.iter().map(|c| c.to_array()));
    let fan: Vec<[u32; 3]> = (2..corners.len() as u32).map(|i| [0, i - 1, i]).collect();
    parts.triangles.extend(fan.iter().map(|t| t.map(|i| i + k)));
    parts.triangle_surface.extend(fan.iter().map(|_| surface));
    fan.iter().map(|t| t.map(|i| corners[i as usize])).collect()
}

/// A square of half side `half` at height `z`, facing up or down.
pub(crate) fn square(parts: &mut Parts, half: f32, z: f32, up: bool, surface: u32) -> Vec<[Vec3; 3]> {
    let mut corners =
        [[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]].map(|[x, y]| Vec3::new(half * x, half * y, z));
    if !up {
        corners.reverse();
    }
    polygon(parts, &corners, surface)
}

/// Adds a luminous ball; `Material::Nothing` stops no light.
pub(crate) fn ball(parts: &mut Parts, centre: Vec3, radius: f32, radiance: f32, material: Material) {
    let shape = Shape::Sphere {
        centre,
        radius,
        inward: false,
    };
    parts.shapes.push((shape, parts.surfaces.len() as u32));
    parts.surfaces.push(lamp(parts.materials.len() as u32, 0));
    parts.materials.push(material);
    parts.lights = vec![Light::Ball(
        Ball::new(centre, radius, Vec3::splat(radiance)).unwrap(),
    )];
}
