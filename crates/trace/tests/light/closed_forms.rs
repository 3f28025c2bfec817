//! Radiance against closed forms: furnaces, integrating spheres, sun and sky, glass. [`common::close`] states the false-alarm rate of a comparison; seeds are fixed.

use std::f64::consts::{FRAC_1_PI, PI, TAU};
use std::sync::Arc;

use crate::common::{ball, flat, grey, irradiance, lamp, of, polygon, radiance, sharp, square};
use glam::Vec3;
use gonio_bsdf::Bsdf;
use gonio_bsdf::radiance::{Glass, Parameters};
use gonio_trace::light::{Distant, Light, Sky};
use gonio_trace::material::Material;
use gonio_trace::path::Limits;
use gonio_trace::scene::{Parts, Scene};
use gonio_trace::shape::Shape;

/// The inside of the unit cube: six walls by their corners, counterclockwise from within.
fn walls() -> [[Vec3; 4]; 6] {
    let p = |k: usize| Vec3::new((k & 1) as f32, (k >> 1 & 1) as f32, (k >> 2) as f32);
    [
        [0, 1, 3, 2],
        [4, 6, 7, 5],
        [0, 4, 5, 1],
        [2, 3, 7, 6],
        [0, 2, 6, 4],
        [1, 5, 7, 3],
    ]
    .map(|w| w.map(p))
}

/// A sphere of radius 1 that is seen from inside.
fn hollow() -> Shape {
    Shape::Sphere {
        centre: Vec3::ZERO,
        radius: 1.0,
        inward: true,
    }
}

#[test]
fn in_a_closed_furnace_radiance_is_emission_over_one_less_reflectance() {
    // Every wall emits 1 and reflects rho: L = 1 / (1 - rho) everywhere, in any direction.
    let at = [Vec3::new(0.3, 0.2, 0.6), Vec3::new(0.9, 0.95, 0.02)];
    for (rho, roulette, samples) in [
        (0.5, 3, 32_768),
        (0.9, 3, 16_384),
        (0.9, 1000, 8192),
        (0.99, 3, 8192),
    ] {
        let mut parts = Parts {
            materials: vec![grey(rho)],
            ..Parts::default()
        };
        for (k, corners) in walls().iter().enumerate() {
            parts.surfaces.push(lamp(0, k as u32));
            let triangles = polygon(&mut parts, corners, k as u32);
            parts.lights.push(flat(&triangles, 1.0));
        }
        let scene = Scene::new(parts).unwrap();
        // Cut off after so many bounces that 1e-6 is missing.
        let limits = Limits {
            bounces: (-14.0 / rho.ln()) as u32,
            roulette,
        };
        let wanted = 1.0 / (1.0 - f64::from(rho));
        for (origin, direction) in at.into_iter().zip([Vec3::new(0.6, 0.0, 0.8), -Vec3::Y]) {
            sharp(radiance(&scene, origin, direction, samples, limits), wanted, 0.02);
        }
    }
}

#[test]
fn in_a_uniform_sky_white_things_cannot_be_seen() {
    let mut parts = Parts {
        shapes: vec![(
            Shape::Sphere {
                centre: Vec3::new(0.5, 0.5, 0.5),
                radius: 0.4,
                inward: false,
            },
            0,
        )],
        surfaces: vec![of(0)],
        materials: vec![grey(1.0)],
        sky: Some(Sky::new(Arc::new(|_: Vec3| Vec3::splat(2.0)))),
        ..Parts::default()
    };
    // A box that is open at the top and to the front: light is reflected many times between it and the ball.
    for corners in [0, 2, 4, 5].map(|k| walls()[k]) {
        polygon(&mut parts, &corners, 0);
    }
    let scene = Scene::new(parts).unwrap();
    let limits = Limits {
        bounces: 1000,
        roulette: 3,
    };
    for towards in [
        Vec3::new(0.5, 0.5, 0.7),
        Vec3::new(0.9, 0.6, 0.0),
        Vec3::new(0.2, 0.0, 0.1),
    ] {
        let eye = Vec3::new(0.6, 3.0, 2.0);
        sharp(
            radiance(&scene, eye, (towards - eye).normalize(), 16_384, limits),
            2.0,
            0.01,
        );
    }
}

#[test]
fn in_an_integrating_sphere_the_reflected_light_is_the_same_everywhere() {
    // A ball of radiance 1 somewhere inside, which stops no light: E0 straight from it, and on every wall element
    // alike rho / (1 - rho) of the mean of E0 (Goebel1967, eq. 4, without ports).
    let (centre, r) = (Vec3::new(0.1, 0.2, -0.3), 0.05);
    for (rho, roulette) in [(0.2, 3), (0.8, 3), (0.8, 200), (0.97, 3)] {
        let mut parts = Parts {
            shapes: vec![(hollow(), 0)],
            surfaces: vec![of(0)],
            materials: vec![grey(rho)],
            ..Parts::default()
        };
        ball(&mut parts, centre, r, 1.0, Material::Nothing);
        let scene = Scene::new(parts).unwrap();
        let limits = Limits {
            bounces: 400,
            roulette,
        };
        let (rho, intensity) = (f64::from(rho), PI * f64::from(r).powi(2));
        for wall in [Vec3::X, Vec3::new(0.0, 0.6, -0.8), Vec3::new(-0.48, 0.6, 0.64)] {
            let way = (centre - wall).as_dvec3();
            let straight = intensity * -way.dot(wall.as_dvec3()) / way.length().powi(3);
            let wanted = rho * FRAC_1_PI * (straight + intensity * rho / (1.0 - rho));
            sharp(radiance(&scene, Vec3::ZERO, wall, 16_384, limits), wanted, 0.02);
        }
    }
}

#[test]
fn ports_of_an_integrating_sphere_take_their_share() {
    // Two black plane ports that cut caps off: E = E0 / (1 - rho (1 - f)), f the share of the caps in the area
    // [Goebel1967, eq. 4], for a lamp in the middle.
    let angles = [0.4_f32, 0.25];
    let axes = [Vec3::Z, Vec3::new(0.8, 0.0, -0.6)];
    for rho in [0.6, 0.95] {
        let mut parts = Parts {
            shapes: vec![(hollow(), 0)],
            surfaces: vec![of(0), of(1)],
            materials: vec![grey(rho), Material::Black],
            ..Parts::default()
        };
        for (angle, axis) in angles.into_iter().zip(axes) {
            let port = Shape::Ring {
                centre: angle.cos() * axis,
                normal: -axis,
                radii: [0.0, angle.sin()],
            };
            parts.shapes.push((port, 1));
        }
        ball(&mut parts, Vec3::ZERO, 0.05, 1.0, Material::Nothing);
        let scene = Scene::new(parts).unwrap();
        let f: f64 = angles.iter().map(|a| 0.5 * (1.0 - f64::from(*a).cos())).sum();
        let rho = f64::from(rho);
        let wanted = rho * FRAC_1_PI * PI * 0.05_f64.powi(2) / (1.0 - rho * (1.0 - f));
        let limits = Limits {
            bounces: 400,
            roulette: 3,
        };
        for wall in [Vec3::X, Vec3::Y, Vec3::new(0.0, -0.6, -0.8)] {
            sharp(radiance(&scene, 0.2 * wall, wall, 32_768, limits), wanted, 0.01);
        }
        assert_eq!(radiance(&scene, 0.2 * Vec3::Z, Vec3::Z, 64, limits).0, 0.0);
    }
}

/// Radiance by direction.
type Radiance = fn(Vec3) -> f32;

#[test]
fn sun_and_sky_light_the_ground() {
    let angle = 0.533_f64.to_radians();
    let solid = TAU * (1.0 - (0.5 * angle).cos());
    let skies: [(Radiance, f64); 2] = [
        // In proportion to the height: 2 pi / 3. The CIE's overcast sky of zenith radiance 1 [MoonSpencer1942]: 7 pi / 9.
        (|d| d.z.max(0.0), 2.0 * PI / 3.0),
        (
            |d| if d.z > 0.0 { (1.0 + 2.0 * d.z) / 3.0 } else { 0.0 },
            7.0 * PI / 9.0,
        ),
    ];
    for (sky, diffuse) in skies {
        let mut parts = Parts {
            surfaces: vec![of(0)],
            materials: vec![grey(0.4)],
            sky: Some(Sky::new(Arc::new(move |d: Vec3| Vec3::splat(sky(d))))),
            ..Parts::default()
        };
        let sun = Distant::new(Vec3::new(0.0, 0.6, 0.8), angle, Vec3::splat(2e4)).unwrap();
        parts.lights = vec![Light::Distant(sun)];
        square(&mut parts, 50.0, 0.0, true, 0);
        let scene = Scene::new(parts).unwrap();
        let wanted = 2e4 * solid * 0.8 + diffuse;
        let down = radiance(&scene, Vec3::Z, -Vec3::Z, 65_536, Limits::default());
        sharp(down, 0.4 * FRAC_1_PI * wanted, 2e-3);
        sharp(irradiance(&scene, Vec3::Z, Vec3::Z, 65_536), wanted, 2e-3);
    }
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
            surfaces: vec![of(0), lamp(1, 0), of(2)],
            materials: vec![grey(0.5), Material::Black, Material::model(model.clone(), None)],
            ..Parts::default()
        };
        square(&mut parts, 5.0, 0.0, true, 0);
        // So small and far that all of its light meets the pane at the normal.
        let corners = square(&mut parts, 0.05, 4.0, false, 1);
        parts.lights = vec![flat(&corners, 3e3)];
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
