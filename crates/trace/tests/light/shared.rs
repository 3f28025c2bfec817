//! Pictures whose pixels share paths against those whose pixels do not. Of 63 and more degrees of freedom, 4 standard errors
//! are exceeded in 2 of 10 000 comparisons; seeds are fixed.

use std::sync::Arc;
use std::sync::atomic::AtomicBool;

use crate::common::{grey, of};
use glam::Vec3;
use gonio_bsdf::Bsdf;
use gonio_bsdf::radiance::{Glass, Parameters, Plastic};
use gonio_trace::camera::{Camera, Projection, View};
use gonio_trace::light::{Flat, Light, Sky};
use gonio_trace::material::Material;
use gonio_trace::path::Limits;
use gonio_trace::render::{Effort, Picture};
use gonio_trace::scene::{Parts, Scene, Surface};
use gonio_trace::shape::Shape;

fn quad(parts: &mut Parts, corner: [f32; 3], a: [f32; 3], b: [f32; 3], surface: u32) -> [[Vec3; 3]; 2] {
    let (c, a, b) = (Vec3::from(corner), Vec3::from(a), Vec3::from(b));
    let corners = [c, c + a, c + a + b, c + b];
    let k = parts.vertices.len() as u32;
    parts.vertices.extend(corners.map(|p| p.to_array()));
    parts.triangles.extend([[k, k + 1, k + 2], [k, k + 2, k + 3]]);
    parts.triangle_surface.extend([surface; 2]);
    [
        [corners[0], corners[1], corners[2]],
        [corners[0], corners[2], corners[3]],
    ]
}

fn model(m: gonio_bsdf::RadianceMaterial) -> Material {
    let model: Arc<dyn Bsdf> = Arc::from(m.bsdf().unwrap());
    Material::model(model, None)
}

/// A room with a window of glass, a lamp, a glossy floor and a glossy ball; open to the eye.
fn room() -> (Scene, Camera) {
    let glass = Glass::from_arguments(&[], &[0.8, 0.8, 0.8, 2.0]).unwrap();
    let plastic = Plastic::from_arguments(&[], &[0.3, 0.4, 0.5, 0.2, 0.15]).unwrap();
    let mut parts = Parts {
        materials: vec![
            grey(0.7),
            model(gonio_bsdf::RadianceMaterial::Glass(glass)),
            model(gonio_bsdf::RadianceMaterial::Plastic(plastic)),
            Material::Black,
        ],
        surfaces: vec![of(0), of(1), of(2)],
        ..Parts::default()
    };
    quad(&mut parts, [0., 0., 0.], [2., 0., 0.], [0., 3., 0.], 2);
    quad(&mut parts, [0., 0., 2.], [0., 3., 0.], [2., 0., 0.], 0);
    quad(&mut parts, [0., 0., 0.], [0., 3., 0.], [0., 0., 2.], 0);
    quad(&mut parts, [2., 0., 0.], [0., 0., 2.], [0., 3., 0.], 0);
    quad(&mut parts, [0., 3., 0.], [2., 0., 0.], [0., 0., 0.8], 0);
    quad(&mut parts, [0., 3., 0.8], [2., 0., 0.], [0., 0., 1.2], 1);
    quad(&mut parts, [0., 0., 0.], [0., 0., 2.], [2., 0., 0.], 0);
    let lamp = quad(&mut parts, [0.8, 1.0, 1.9], [0., 0.4, 0.], [0.4, 0., 0.], 3);
    parts
        .lights
        .push(Light::Flat(Flat::new(&lamp, Vec3::splat(2.0)).unwrap()));
    parts.surfaces.push(Surface {
        light: Some(0),
        ..of(3)
    });
    let ball = Shape::Sphere {
        centre: Vec3::new(1.4, 1.8, 0.4),
        radius: 0.4,
        inward: false,
    };
    parts.shapes.push((ball, 0));
    parts.sky = Some(Sky::new(Arc::new(|d: Vec3| Vec3::splat((1.5 + d.z).max(0.2)))));
    parts.portals = vec![[Vec3::new(0., 3., 0.8), Vec3::X * 2.0, Vec3::Z * 1.2]];
    let view = View {
        projection: Projection::Perspective,
        point: Vec3::new(1.0, 0.1, 1.1),
        direction: Vec3::new(0.0, 1.0, -0.2),
        up: Vec3::Z,
        horizontal: 70.0,
        vertical: 60.0,
        shift: [0.0; 2],
        fore: 0.0,
        aft: 0.0,
    };
    (Scene::new(parts).unwrap(), Camera::new(view).unwrap())
}

fn effort(samples: u32, seed: u64, share: bool, bounces: u32) -> Effort {
    Effort {
        samples,
        relative_error: None,
        limits: Limits {
            bounces,
            ..Limits::default()
        },
        seed,
        share,
    }
}

/// Sums over blocks of pixels of one picture.
fn blocks(scene: &Scene, camera: &Camera, effort: &Effort) -> Vec<f64> {
    let mut picture = Picture::new(24, 20);
    picture.render(scene, camera, effort, &AtomicBool::new(false), &|_| {});
    let mut sums = vec![0.0; 30];
    for (k, pixel) in picture.pixels.iter().enumerate() {
        sums[k / 24 / 4 * 6 + k % 24 / 4] += pixel.luminance() / 16.0;
    }
    sums
}

/// Mean and standard error of each block over seeds.
fn over_seeds(scene: &Scene, camera: &Camera, share: bool, bounces: u32) -> Vec<(f64, f64)> {
    const SEEDS: u64 = 64;
    let runs: Vec<Vec<f64>> = (0..SEEDS)
        .map(|seed| blocks(scene, camera, &effort(16, 100 + seed, share, bounces)))
        .collect();
    (0..runs[0].len())
        .map(|k| {
            let mean = runs.iter().map(|r| r[k]).sum::<f64>() / SEEDS as f64;
            let scatter: f64 = runs.iter().map(|r| (r[k] - mean).powi(2)).sum();
            (mean, (scatter / ((SEEDS - 1) * SEEDS) as f64).sqrt())
        })
        .collect()
}

#[test]
fn shared_paths_bring_what_those_of_each_pixel_bring_with_less_noise() {
    let (scene, camera) = room();
    for bounces in [2, 64] {
        let shared = over_seeds(&scene, &camera, true, bounces);
        let alone = over_seeds(&scene, &camera, false, bounces);
        for (k, (a, b)) in shared.iter().zip(&alone).enumerate() {
            let error = a.1.hypot(b.1);
            assert!(
                (a.0 - b.0).abs() < 4.0 * error + 1e-4 * b.0,
                "{bounces} bounces, block {k}: {a:?} {b:?}"
            );
        }
        let noise = |all: &[(f64, f64)]| all.iter().map(|v| (v.1 / v.0).powi(2)).sum::<f64>();
        assert!(noise(&shared) < 0.5 * noise(&alone));
    }
}
