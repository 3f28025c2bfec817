//! Sensors against closed forms; the same result on any number of threads and after any stop.

use std::f64::consts::PI;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};

use glam::Vec3;
use gonio_trace::camera::Camera;
use gonio_trace::light::{Flat, Light, Sky};
use gonio_trace::material::Material;
use gonio_trace::path::Limits;
use gonio_trace::render::{Effort, Picture, luminance};
use gonio_trace::scene::{Parts, Scene, Surface};
use gonio_trace::sensor::{Readings, Sensor};
use gonio_trace::studio;

fn effort(samples: u32, relative_error: Option<f64>) -> Effort {
    Effort {
        samples,
        relative_error,
        limits: Limits::default(),
        seed: 5,
        share: true,
    }
}

fn measure(scene: &Scene, sensor: Sensor, effort: &Effort) -> Readings {
    let mut readings = Readings::new(vec![sensor]);
    readings.measure(scene, effort, &AtomicBool::new(false), &|_| {});
    readings
}

/// A square of half side `half` at height `z` that faces down, with a light on it or of a material.
fn square(parts: &mut Parts, half: f32, z: f32, surface: Surface) -> [[Vec3; 3]; 2] {
    let k = parts.vertices.len() as u32;
    let corners = [
        [-half, -half, z],
        [-half, half, z],
        [half, half, z],
        [half, -half, z],
    ];
    parts.vertices.extend(corners);
    parts.triangles.extend([[k, k + 1, k + 2], [k, k + 2, k + 3]]);
    parts.triangle_surface.extend([parts.surfaces.len() as u32; 2]);
    parts.surfaces.push(surface);
    let c = corners.map(Vec3::from);
    [[c[0], c[1], c[2]], [c[0], c[2], c[3]]]
}

fn sky(radiance: f32) -> Sky {
    Sky::new(Arc::new(move |_: Vec3| Vec3::splat(radiance)))
}

#[test]
fn under_the_centre_of_a_square_light_irradiance_is_that_of_its_form_factor() {
    let mut parts = Parts {
        materials: vec![Material::Black],
        ..Parts::default()
    };
    let lamp = square(
        &mut parts,
        0.5,
        0.8,
        Surface {
            light: Some(0),
            ..Surface::default()
        },
    );
    parts.lights = vec![Light::Flat(Flat::new(&lamp, Vec3::new(1.0, 2.0, 3.0)).unwrap())];
    let scene = Scene::new(parts).unwrap();
    // Four corner rectangles of sides a: F = 4 (1 / 2 pi) * 2 (x / sqrt(1 + x2)) atan(x / sqrt(1 + x2)), x = a / h.
    let x = 0.5 / 0.8_f64;
    let s = x / (1.0 + x * x).sqrt();
    let wanted = 4.0 * s * s.atan();
    let up = Sensor::new(Vec3::ZERO, Vec3::Z).unwrap();
    for bounces in [1, 64] {
        let limits = Limits { bounces, roulette: 3 };
        let effort = Effort {
            limits,
            ..effort(16_384, None)
        };
        let found = measure(&scene, up, &effort).pixels[0];
        let [r, g, b] = found.mean();
        // Four standard errors: a false alarm in 16 000.
        let tolerance = 4.0 * found.error() / found.luminance() + 1e-5;
        assert!((r / wanted - 1.0).abs() < tolerance, "{r} {wanted} {tolerance}");
        assert!((g / r - 2.0).abs() < 1e-5 && (b / r - 3.0).abs() < 1e-5);
        assert!(tolerance < 5e-3);
    }
    let down = Sensor::new(Vec3::ZERO, -Vec3::Z).unwrap();
    assert_eq!(
        measure(&scene, down, &effort(64, None)).pixels[0].mean(),
        [0.0; 3]
    );
}

#[test]
fn under_a_uniform_sky_illuminance_is_pi_times_luminance_less_what_a_roof_hides() {
    let open = Scene::new(Parts {
        sky: Some(sky(2.0)),
        ..Parts::default()
    })
    .unwrap();
    let precise = effort(1 << 20, Some(1e-3));
    for normal in [Vec3::Z, Vec3::new(0.6, 0.0, 0.8), Vec3::X] {
        let sensor = Sensor::new(Vec3::new(1.0, 2.0, 3.0), normal).unwrap();
        let found = measure(&open, sensor, &precise).pixels[0];
        let wanted = PI * f64::from(luminance(Vec3::splat(2.0)));
        assert!(
            (found.luminance() - wanted).abs() < 4.0 * found.error() + 1e-6 * wanted,
            "{}",
            found.luminance()
        );
        assert!(found.error() <= 1e-3 * found.luminance());
    }
    // A black roof of form factor F takes its share; a portal around it changes the noise, not the value.
    let roof = |portals: bool| {
        let mut parts = Parts {
            materials: vec![Material::Black],
            sky: Some(sky(2.0)),
            ..Parts::default()
        };
        square(&mut parts, 0.5, 0.8, Surface::default());
        if portals {
            parts.portals = vec![[
                Vec3::new(-2.0, -2.0, 0.9),
                Vec3::new(4.0, 0.0, 0.0),
                Vec3::new(0.0, 4.0, 0.0),
            ]];
        }
        Scene::new(parts).unwrap()
    };
    let x = 0.5 / 0.8_f64;
    let s = x / (1.0 + x * x).sqrt();
    let wanted = 2.0 * (PI - 4.0 * s * s.atan());
    for portals in [false, true] {
        let sensor = Sensor::new(Vec3::ZERO, Vec3::Z).unwrap();
        let found = measure(&roof(portals), sensor, &precise).pixels[0];
        let tolerance = 4.0 * found.error() / found.luminance() + 1e-5;
        assert!(
            (found.mean()[0] / wanted - 1.0).abs() < tolerance,
            "{} {wanted}",
            found.mean()[0]
        );
    }
}

#[test]
fn a_wall_without_light_brings_reflected_light_from_the_second_bounce() {
    // Above a ground of reflectance rho under a uniform sky, a sensor that looks down: E = rho pi L, less nothing, as the
    // sensor casts no shadow.
    let mut parts = Parts {
        materials: vec![Material::Diffuse {
            reflectance: Vec3::splat(0.3),
        }],
        sky: Some(Sky::new(Arc::new(|d: Vec3| {
            Vec3::splat(if d.z > 0.0 { 1.0 } else { 0.0 })
        }))),
        ..Parts::default()
    };
    square(&mut parts, 1000.0, 0.0, Surface::default());
    let scene = Scene::new(parts).unwrap();
    let down = Sensor::new(Vec3::new(0.0, 0.0, 0.5), -Vec3::Z).unwrap();
    let at = |bounces| {
        let limits = Limits { bounces, roulette: 3 };
        measure(
            &scene,
            down,
            &Effort {
                limits,
                ..effort(16_384, None)
            },
        )
        .pixels[0]
    };
    assert_eq!(at(0).mean(), [0.0; 3]);
    // One more bounce than -ab: directly nothing.
    assert!(at(1).mean()[0] < 1e-5);
    for bounces in [2, 64] {
        let found = at(bounces);
        let tolerance = 4.0 * found.error() / found.luminance() + 1e-4;
        assert!((found.mean()[0] / (0.3 * PI) - 1.0).abs() < tolerance);
    }
}

fn ball() -> (Scene, Camera) {
    let scene = studio::scene(Material::Diffuse {
        reflectance: Vec3::new(0.7, 0.5, 0.2),
    })
    .unwrap();
    (scene, Camera::new(studio::view()).unwrap())
}

fn on_threads<T: Send>(threads: usize, work: impl FnOnce() -> T + Send) -> T {
    rayon::ThreadPoolBuilder::new()
        .num_threads(threads)
        .build()
        .unwrap()
        .install(work)
}

#[test]
fn one_seed_gives_one_picture_on_any_number_of_threads() {
    let (scene, camera) = ball();
    for effort in [effort(64, None), effort(512, Some(0.05))] {
        let pictures: Vec<Picture> = [1, 2, 7]
            .into_iter()
            .map(|threads| {
                on_threads(threads, || {
                    let mut picture = Picture::new(40, 33);
                    picture.render(&scene, &camera, &effort, &AtomicBool::new(false), &|_| {});
                    picture
                })
            })
            .collect();
        assert!(pictures[1] == pictures[0] && pictures[2] == pictures[0]);
        let mut other = Picture::new(40, 33);
        other.render(
            &scene,
            &camera,
            &Effort { seed: 6, ..effort },
            &AtomicBool::new(false),
            &|_| {},
        );
        assert!(other != pictures[0]);
    }
}

#[test]
fn a_picture_that_was_stopped_again_and_again_ends_as_one_that_was_not() {
    let (scene, camera) = ball();
    for effort in [effort(160, None), effort(640, Some(0.03))] {
        let mut whole = Picture::new(40, 33);
        whole.render(&scene, &camera, &effort, &AtomicBool::new(false), &|_| {});
        let counts: Vec<u32> = whole.pixels.iter().map(|p| p.count).collect();
        if effort.relative_error.is_some() {
            assert!(
                counts.iter().min() < counts.iter().max(),
                "pixels stop at different times"
            );
        }
        let mut pieces = Picture::new(40, 33);
        let mut stops = 0;
        loop {
            // Every call may finish a few tiles.
            let (stop, tiles) = (AtomicBool::new(false), AtomicUsize::new(0));
            pieces.render(&scene, &camera, &effort, &stop, &|_| {
                if tiles.fetch_add(1, Ordering::Relaxed) == 3 + stops {
                    stop.store(true, Ordering::Relaxed);
                }
            });
            if !stop.load(Ordering::Relaxed) {
                break;
            }
            stops += 1;
        }
        assert!(stops > 2);
        assert!(pieces == whole);
        // And more samples later are those of a picture that took them at once.
        if effort.relative_error.is_none() {
            let more = Effort {
                samples: 320,
                ..effort
            };
            pieces.render(&scene, &camera, &more, &AtomicBool::new(false), &|_| {});
            let mut at_once = Picture::new(40, 33);
            at_once.render(&scene, &camera, &more, &AtomicBool::new(false), &|_| {});
            assert!(pieces.pixels == at_once.pixels);
        }
    }
}

#[test]
fn one_seed_gives_one_reading_of_a_single_sensor_on_any_number_of_threads() {
    let (scene, _) = ball();
    let sensor = Sensor::new(Vec3::new(0.5, 0.5, 0.1), Vec3::Z).unwrap();
    for effort in [effort(9_008, None), effort(1 << 14, Some(1e-3))] {
        let readings: Vec<Readings> = [1, 2, 7]
            .into_iter()
            .map(|threads| on_threads(threads, || measure(&scene, sensor, &effort)))
            .collect();
        assert!(readings[0].pixels[0].count >= 9_008);
        assert!(readings[1] == readings[0] && readings[2] == readings[0]);
    }
}
