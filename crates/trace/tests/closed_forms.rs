//! Radiance against closed forms: furnace, integrating sphere, disk, sun, sky, glass.
#![allow(clippy::unwrap_used, missing_docs)]

use std::f32::consts::PI;
use std::sync::Arc;

use glam::Vec3;
use gonio_bsdf::Bsdf;
use gonio_bsdf::radiance::{Glass, Parameters};
use gonio_trace::light::{Ball, Distant, Flat, Light, Sky};
use gonio_trace::material::Material;
use gonio_trace::path::Limits;
use gonio_trace::sampler::Sampler;
use gonio_trace::scene::{Parts, Scene, Surface};
use gonio_trace::shape::Shape;

/// Mean and standard error of the radiance at a point from a direction.
fn radiance(scene: &Scene, origin: Vec3, direction: Vec3, samples: u32, limits: Limits) -> (f64, f64) {
    let (mut sum, mut square) = (0.0, 0.0);
    for pixel in 0..64 {
        let mut batch = 0.0;
        for index in 0..samples / 64 {
            let mut sampler = Sampler::new(11, pixel, index);
            batch += f64::from(scene.radiance(origin, direction, &limits, &mut sampler).y);
        }
        let mean = batch / f64::from(samples / 64);
        sum += mean / 64.0;
        square += mean * mean / 64.0;
    }
    (sum, ((square - sum * sum).max(0.0) / 63.0).sqrt())
}

fn grey(reflectance: f32) -> Material {
    Material::Diffuse {
        reflectance: Vec3::splat(reflectance),
    }
}

/// A square of half side `half` at height `z`, facing up or down.
fn square(parts: &mut Parts, half: f32, z: f32, up: bool, surface: u32) -> [[Vec3; 3]; 2] {
    let k = parts.vertices.len() as u32;
    let corners = [
        [-half, -half, z],
        [half, -half, z],
        [half, half, z],
        [-half, half, z],
    ];
    parts.vertices.extend(corners);
    let faces = if up {
        [[0, 1, 2], [0, 2, 3]]
    } else {
        [[0, 2, 1], [0, 3, 2]]
    };
    parts.triangles.extend(faces.map(|f: [u32; 3]| f.map(|i| i + k)));
    parts.triangle_surface.extend([surface; 2]);
    faces.map(|f| f.map(|i| Vec3::from(corners[i as usize])))
}

/// Four standard errors and the rounding of single precision; false alarm 6e-5 a comparison.
#[track_caller]
fn close(found: (f64, f64), wanted: f64) {
    let off = (found.0 - wanted).abs();
    assert!(off < 4.0 * found.1 + 2e-4 * wanted, "{found:?}, wanted {wanted}");
}

#[test]
fn in_a_closed_furnace_radiance_is_emission_over_one_less_reflectance() {
    // Every surface of a closed sphere emits 1 and reflects rho: L = 1 / (1 - rho). The emission is a light that paths meet.
    for (rho, roulette) in [(0.2, 3), (0.8, 3), (0.8, 200)] {
        let scene = Scene::new(Parts {
            shapes: vec![(
                Shape::Sphere {
                    centre: Vec3::ZERO,
                    radius: 1.0,
                    inward: true,
                },
                0,
            )],
            surfaces: vec![Surface {
                material: 0,
                light: None,
                ..Surface::default()
            }],
            materials: vec![grey(rho)],
            lights: vec![Light::Ball(
                Ball::new(Vec3::new(0.1, 0.2, 0.0), 0.05, Vec3::ONE).unwrap(),
            )],
            ..Parts::default()
        })
        .unwrap();
        // A ball of radiance 1 that is no surface itself: flux pi * 4 pi r^2 into the sphere; on the wall the mean
        // radiosity over pi is flux / area * rho / (1 - rho) / pi.
        let wanted = 0.05_f64.powi(2) * f64::from(rho) / (1.0 - f64::from(rho));
        let limits = Limits {
            bounces: 400,
            roulette,
        };
        // Averaged over the wall: directions from the centre.
        let mut all = (0.0, 0.0);
        let n = 32;
        for k in 0..n {
            let z = 1.0 - 2.0 * (k as f32 + 0.5) / n as f32;
            let phi = 2.4 * k as f32;
            let r = (1.0 - z * z).sqrt();
            let one = radiance(
                &scene,
                Vec3::ZERO,
                Vec3::new(r * phi.cos(), r * phi.sin(), z),
                8192,
                limits,
            );
            all.0 += one.0 / f64::from(n);
            all.1 += (one.1 / f64::from(n)).powi(2);
        }
        // The 32 directions of a spiral see the direct part unevenly: within 1 %.
        assert!((all.0 / wanted - 1.0).abs() < 0.01, "{} {wanted}", all.0);
    }
}

#[test]
fn a_square_light_and_a_luminous_sphere_give_their_irradiance() {
    // On the axis of a square of half side a at height h: E = L * 4 (2 / pi ...) by its form factor.
    let (half, height) = (0.5_f32, 1.0_f32);
    let mut parts = Parts {
        surfaces: vec![
            Surface {
                material: 0,
                light: None,
                ..Surface::default()
            },
            Surface {
                material: 1,
                light: Some(0),
                ..Surface::default()
            },
        ],
        materials: vec![grey(0.5), Material::Black],
        ..Parts::default()
    };
    square(&mut parts, 5.0, 0.0, true, 0);
    let lamp = square(&mut parts, half, height, false, 1);
    parts.lights = vec![Light::Flat(Flat::new(&lamp, Vec3::splat(3.0)).unwrap())];
    let scene = Scene::new(parts).unwrap();
    let x = f64::from(half / height);
    let corner = x / (1.0 + x * x).sqrt() * (x / (1.0 + x * x).sqrt()).atan() * 2.0 / std::f64::consts::TAU;
    let wanted = 3.0 * 0.5 * 4.0 * corner;
    let eye = Vec3::new(2.0, 0.0, 0.5);
    let found = radiance(&scene, eye, (-eye).normalize(), 65_536, Limits::default());
    close(found, wanted);
    // A sphere of radius r at distance d: E = pi L (r / d)^2 from straight above.
    let ball = Scene::new(Parts {
        vertices: vec![[-5.0, -5.0, 0.0], [5.0, -5.0, 0.0], [0.0, 5.0, 0.0]],
        triangles: vec![[0, 1, 2]],
        triangle_surface: vec![0],
        shapes: vec![(
            Shape::Sphere {
                centre: Vec3::new(0.0, 0.0, 2.0),
                radius: 0.3,
                inward: false,
            },
            1,
        )],
        surfaces: vec![
            Surface {
                material: 0,
                light: None,
                ..Surface::default()
            },
            Surface {
                material: 1,
                light: Some(0),
                ..Surface::default()
            },
        ],
        materials: vec![grey(0.5), Material::Black],
        lights: vec![Light::Ball(
            Ball::new(Vec3::new(0.0, 0.0, 2.0), 0.3, Vec3::ONE).unwrap(),
        )],
        ..Parts::default()
    })
    .unwrap();
    let eye = Vec3::new(1.0, 0.0, 0.5);
    close(
        radiance(&ball, eye, (-eye).normalize(), 65_536, Limits::default()),
        0.5 * (0.3 / 2.0_f64).powi(2),
    );
}

#[test]
fn sun_and_sky_light_the_ground() {
    let mut parts = Parts {
        surfaces: vec![Surface {
            material: 0,
            light: None,
            ..Surface::default()
        }],
        materials: vec![grey(0.4)],
        sky: Some(Sky::new(Arc::new(|d: Vec3| {
            // A cosine-shaped sky: E = integral L cos = 2 pi / 3.
            Vec3::splat(d.z.max(0.0))
        }))),
        ..Parts::default()
    };
    let angle = 0.533_f64.to_radians();
    let sun = Vec3::new(0.0, 0.6, 0.8);
    parts.lights = vec![Light::Distant(
        Distant::new(sun, angle, Vec3::splat(2e4)).unwrap(),
    )];
    square(&mut parts, 50.0, 0.0, true, 0);
    let scene = Scene::new(parts).unwrap();
    let solid = std::f64::consts::TAU * (1.0 - (0.5 * angle).cos());
    let wanted = 0.4 / f64::from(PI) * (2e4 * solid * 0.8 + 2.0 * f64::from(PI) / 3.0);
    let found = radiance(
        &scene,
        Vec3::new(0.0, 0.0, 1.0),
        -Vec3::Z,
        65_536,
        Limits::default(),
    );
    close(found, wanted);
}

#[test]
fn light_through_a_pane_of_glass_is_that_without_it_times_its_transmittance() {
    let glass = Glass::from_arguments(&[], &[0.96, 0.96, 0.96]).unwrap();
    let model: Arc<dyn Bsdf> = Arc::from(gonio_bsdf::RadianceMaterial::Glass(glass).bsdf().unwrap());
    let mut shares = [0.0; 3];
    model.delta(
        gonio_geom::Direction::NORMAL,
        gonio_geom::Component::Transmission,
        &mut shares,
    );
    assert!((shares[1] - 0.881).abs() < 2e-3, "{shares:?}");
    let room = |pane: bool| {
        let mut parts = Parts {
            surfaces: (0..3)
                .map(|k| Surface {
                    material: k,
                    light: (k == 1).then_some(0),
                    ..Surface::default()
                })
                .collect(),
            materials: vec![grey(0.5), Material::Black, Material::model(model.clone(), None)],
            ..Parts::default()
        };
        square(&mut parts, 5.0, 0.0, true, 0);
        // So small and far that all of its light meets the pane at the normal.
        let lamp = square(&mut parts, 0.05, 4.0, false, 1);
        parts.lights = vec![Light::Flat(Flat::new(&lamp, Vec3::splat(3e3)).unwrap())];
        if pane {
            square(&mut parts, 2.0, 2.0, true, 2);
        }
        Scene::new(parts).unwrap()
    };
    let limits = Limits {
        bounces: 1,
        ..Limits::default()
    };
    let eye = Vec3::new(0.2, 0.0, 1.0);
    let ray = (Vec3::new(0.0, 0.0, 0.0) - eye).normalize();
    let with = radiance(&room(true), eye, ray, 16_384, limits);
    let without = radiance(&room(false), eye, ray, 16_384, limits);
    let ratio = with.0 / without.0;
    assert!(
        (ratio / shares[1] - 1.0).abs() < 4.0 * (with.1 / with.0) + 2e-3,
        "{ratio} {}",
        shares[1]
    );
}
