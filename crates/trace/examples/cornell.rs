//! The Cornell box of the benchmarks: `cornell SIZE SAMPLES BOUNCES SEED` prints the mean radiance of the picture.
#![allow(clippy::print_stdout, clippy::unwrap_used, missing_docs)]

use glam::Vec3;
use gonio_trace::camera::{Camera, Projection, View};
use gonio_trace::light::{Flat, Light};
use gonio_trace::material::Material;
use gonio_trace::path::Limits;
use gonio_trace::render::{Effort, Picture};
use gonio_trace::scene::{Parts, Scene, Surface};

fn quad(parts: &mut Parts, q: [[f32; 3]; 4], surface: u32) {
    let k = parts.vertices.len() as u32;
    parts.vertices.extend(q);
    parts.triangles.extend([[k, k + 1, k + 2], [k, k + 2, k + 3]]);
    parts.triangle_surface.extend([surface; 2]);
}

fn block(parts: &mut Parts, size: [f32; 3], turn: f32, at: [f32; 3], surface: u32) {
    let (s, c) = turn.to_radians().sin_cos();
    let p = |k: usize| {
        let v = [
            size[0] * (k & 1) as f32,
            size[1] * (k >> 1 & 1) as f32,
            size[2] * (k >> 2) as f32,
        ];
        [
            c * v[0] - s * v[1] + at[0],
            s * v[0] + c * v[1] + at[1],
            v[2] + at[2],
        ]
    };
    for f in [
        [0, 2, 3, 1],
        [4, 5, 7, 6],
        [0, 1, 5, 4],
        [2, 6, 7, 3],
        [0, 4, 6, 2],
        [1, 3, 7, 5],
    ] {
        quad(parts, f.map(p), surface);
    }
}

fn main() {
    let mut arguments = std::env::args().skip(1).map(|a| a.parse::<u32>().unwrap());
    let size = arguments.next().unwrap_or(256) as usize;
    let samples = arguments.next().unwrap_or(64);
    let bounces = arguments.next().unwrap_or(7);
    let seed = arguments.next().unwrap_or(1);
    let mut parts = Parts::default();
    for rho in [[0.75, 0.75, 0.75], [0.63, 0.06, 0.05], [0.15, 0.48, 0.09]] {
        parts.materials.push(Material::Diffuse {
            reflectance: rho.into(),
        });
    }
    parts.materials.push(Material::Black);
    for material in 0..3 {
        parts.surfaces.push(Surface {
            material,
            light: None,
            ..Surface::default()
        });
    }
    parts.surfaces.push(Surface {
        material: 3,
        light: Some(0),
        ..Surface::default()
    });
    quad(
        &mut parts,
        [[0., 0., 0.], [1., 0., 0.], [1., 1., 0.], [0., 1., 0.]],
        0,
    );
    quad(
        &mut parts,
        [[0., 0., 1.], [0., 1., 1.], [1., 1., 1.], [1., 0., 1.]],
        0,
    );
    quad(
        &mut parts,
        [[0., 1., 0.], [1., 1., 0.], [1., 1., 1.], [0., 1., 1.]],
        0,
    );
    quad(
        &mut parts,
        [[0., 0., 0.], [0., 1., 0.], [0., 1., 1.], [0., 0., 1.]],
        1,
    );
    quad(
        &mut parts,
        [[1., 0., 0.], [1., 0., 1.], [1., 1., 1.], [1., 1., 0.]],
        2,
    );
    let lamp = [
        [0.35, 0.35, 0.998],
        [0.35, 0.65, 0.998],
        [0.65, 0.65, 0.998],
        [0.65, 0.35, 0.998],
    ];
    quad(&mut parts, lamp, 3);
    let l = lamp.map(Vec3::from);
    parts.lights.push(Light::Flat(
        Flat::new(&[[l[0], l[1], l[2]], [l[0], l[2], l[3]]], Vec3::splat(15.0)).unwrap(),
    ));
    block(&mut parts, [0.3, 0.3, 0.6], 18.0, [0.15, 0.5, 0.001], 0);
    block(&mut parts, [0.3, 0.3, 0.3], -17.0, [0.58, 0.2, 0.001], 0);
    let scene = Scene::new(parts).unwrap();
    let camera = Camera::new(View {
        projection: Projection::Perspective,
        point: Vec3::new(0.5, -1.35, 0.5),
        direction: Vec3::Y,
        up: Vec3::Z,
        horizontal: 39.0,
        vertical: 39.0,
        shift: [0.0; 2],
        fore: 0.0,
        aft: 0.0,
    })
    .unwrap();
    let effort = Effort {
        samples,
        relative_error: None,
        limits: Limits { bounces, roulette: 5 },
        seed: seed.into(),
        share: false,
    };
    let mut picture = Picture::new(size, size);
    picture.render(&scene, &camera, &effort, &Default::default(), &|_| {});
    let mut mean = [0.0; 3];
    for p in &picture.pixels {
        for (m, x) in mean.iter_mut().zip(p.mean()) {
            *m += x / picture.pixels.len() as f64;
        }
    }
    println!("{mean:?}");
}
