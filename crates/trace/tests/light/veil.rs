//! Screens that bring in the sky: with what is known beforehand the means are those without.

use std::sync::Arc;

use glam::Vec3;
use gonio_bsdf::klems::{Klems, KlemsBasis, KlemsMatrix};
use gonio_bsdf::{Channel, FourComponents};
use gonio_geom::{Component, Side};
use gonio_trace::light::{Distant, Light, Sky};
use gonio_trace::material::Material;
use gonio_trace::path::Limits;
use gonio_trace::render::Effort;
use gonio_trace::scene::{Parts, Scene, Surface};
use gonio_trace::sensor::{Readings, Sensor};

fn quad(parts: &mut Parts, corners: [[f32; 3]; 4], surface: u32) {
    let k = parts.vertices.len() as u32;
    parts.vertices.extend(corners);
    parts.triangles.extend([[k, k + 1, k + 2], [k, k + 2, k + 3]]);
    parts.triangle_surface.extend([surface; 2]);
}

/// A room of 4 by 4 by 3 with a screen in the wall y = 0, a wall before it that hides some of the sky, and a mirror-like
/// lobe about the straight direction.
fn room(veiled: bool) -> Scene {
    let basis = KlemsBasis::full();
    let n = basis.len();
    let through = |k: usize| {
        0.05 + if k / n == k % n {
            0.3 / basis.lambda()[k / n]
        } else {
            0.0
        }
    };
    let values = (0..n * n).map(|k| through(k) as f32).collect();
    let matrix = KlemsMatrix::new(basis.clone(), basis.clone(), values).unwrap();
    let mut four = FourComponents::default();
    four.set(Side::Front, Component::Transmission, Some(matrix));
    let model: Arc<dyn gonio_bsdf::Bsdf> = Arc::new(Klems::new(Channel::Photopic, four));
    let mut parts = Parts {
        materials: vec![
            Material::Diffuse {
                reflectance: Vec3::splat(0.5),
            },
            Material::model(model, Some(Vec3::Z)),
        ],
        surfaces: vec![
            Surface::default(),
            Surface {
                material: 1,
                ..Surface::default()
            },
        ],
        sky: Some(Sky::new(Arc::new(|d: Vec3| {
            let bright =
                Vec3::new(1.0, 2.0, 3.0) * (1.0 + 8.0 * d.dot(Vec3::new(0.6, -0.64, 0.48)).max(0.0).powi(20));
            if d.z > 0.0 { bright } else { Vec3::splat(0.3) }
        }))),
        lights: vec![Light::Distant(
            Distant::new(Vec3::new(0.3, -0.8, 0.5), 0.02, Vec3::splat(2e4)).unwrap(),
        )],
        ..Parts::default()
    };
    let [x, y, z] = [4.0, 4.0, 3.0];
    quad(
        &mut parts,
        [[0.0, 0.0, 0.0], [x, 0.0, 0.0], [x, y, 0.0], [0.0, y, 0.0]],
        0,
    );
    quad(
        &mut parts,
        [[0.0, 0.0, z], [0.0, y, z], [x, y, z], [x, 0.0, z]],
        0,
    );
    quad(
        &mut parts,
        [[0.0, 0.0, 0.0], [0.0, y, 0.0], [0.0, y, z], [0.0, 0.0, z]],
        0,
    );
    quad(
        &mut parts,
        [[x, 0.0, 0.0], [x, 0.0, z], [x, y, z], [x, y, 0.0]],
        0,
    );
    quad(
        &mut parts,
        [[0.0, y, 0.0], [x, y, 0.0], [x, y, z], [0.0, y, z]],
        0,
    );
    // Hides some of the sky.
    quad(
        &mut parts,
        [
            [-1.0, -1.0, -1.0],
            [1.5, -1.0, -1.0],
            [1.5, -1.0, 4.0],
            [-1.0, -1.0, 4.0],
        ],
        0,
    );
    let screen = [[0.0, 0.0, 0.0], [x, 0.0, 0.0], [x, 0.0, z], [0.0, 0.0, z]];
    if veiled {
        quad(&mut parts, screen, 1);
    } else {
        // The same in halves: no parallelogram of two triangles.
        quad(
            &mut parts,
            [[0.0, 0.0, 0.0], [2.0, 0.0, 0.0], [2.0, 0.0, z], [0.0, 0.0, z]],
            1,
        );
        quad(
            &mut parts,
            [[2.0, 0.0, 0.0], [x, 0.0, 0.0], [x, 0.0, z], [2.0, 0.0, z]],
            1,
        );
    }
    let at = screen.map(Vec3::from);
    parts.screens.push([at[0], at[1] - at[0], at[3] - at[0]]);
    Scene::new(parts).unwrap()
}

fn read(veiled: bool, samples: u32, seed: u64) -> Readings {
    let points = [
        [2.0, 2.0, 0.001],
        [1.0, 0.5, 0.8],
        [3.5, 3.5, 1.5],
        [2.0, 0.2, 1.5],
    ];
    let towards = [Vec3::Z, Vec3::Z, -Vec3::Y, -Vec3::Y];
    let sensors = points
        .iter()
        .zip(towards)
        .map(|(p, n)| Sensor::new(Vec3::from(*p), n).unwrap());
    let mut readings = Readings::new(sensors.collect());
    let effort = Effort {
        samples,
        relative_error: None,
        limits: Limits::default(),
        seed,
        share: false,
    };
    readings.measure(&room(veiled), &effort, &Default::default(), &|_| {});
    readings
}

#[test]
fn what_is_known_of_a_screen_beforehand_changes_no_mean_and_much_noise() {
    let (with, without) = (read(true, 65_536, 1), read(false, 262_144, 2));
    for (a, b) in with.pixels.iter().zip(&without.pixels) {
        let (x, y) = (a.luminance(), b.luminance());
        let error = a.error().hypot(b.error());
        // Four sensors: one false alarm in 4000 seeds.
        assert!((x - y).abs() < 4.0 * error, "{x} {y} {error}");
        for (p, q) in a.mean().iter().zip(b.mean()) {
            assert!((p / q - 1.0).abs() < 0.05, "{p} {q}");
        }
        // A quarter of the samples.
        assert!(a.error() < 1.6 * b.error(), "{} {}", a.error(), b.error());
    }
}
