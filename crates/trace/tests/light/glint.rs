//! Suns in plane mirrors: closed forms, and pictures against those in which they are found by chance; seeds
//! are fixed.

use crate::common::blocks::{assert_equal, into_the_room, model, noise, over_seeds};
use crate::common::{grey, irradiance, of, sharp};
use glam::Vec3;
use gonio_bsdf::RadianceMaterial;
use gonio_bsdf::radiance::{Glass, Mirror, Parameters, Plastic};
use gonio_trace::camera::Camera;
use gonio_trace::light::{Distant, Light};
use gonio_trace::material::Material;
use gonio_trace::scene::{Parts, Scene};
use std::f64::consts::PI;

fn mirror(share: f64) -> Material {
    let mirror = Mirror::from_arguments(&[], &[share; 3]).unwrap();
    model(RadianceMaterial::Mirror(mirror))
}

fn sun(direction: [f32; 3], degrees: f64, radiance: f32) -> Light {
    let direction = Vec3::from(direction);
    Light::Distant(Distant::new(direction, degrees.to_radians(), Vec3::splat(radiance)).unwrap())
}

/// A parallelogram of `n` by `n` pieces; its front is that of `a x b`.
fn quad(parts: &mut Parts, corner: [f32; 3], a: [f32; 3], b: [f32; 3], n: u32, surface: u32) {
    let (c, a, b) = (
        Vec3::from(corner),
        Vec3::from(a) / n as f32,
        Vec3::from(b) / n as f32,
    );
    let first = parts.vertices.len() as u32;
    for i in 0..=n {
        for j in 0..=n {
            parts.vertices.push((c + i as f32 * a + j as f32 * b).to_array());
        }
    }
    for i in 0..n {
        for j in 0..n {
            let [p, q] = [first + i * (n + 1) + j, first + (i + 1) * (n + 1) + j];
            parts.triangles.extend([[p, q, q + 1], [p, q + 1, p + 1]]);
            parts.triangle_surface.extend([surface; 2]);
        }
    }
}

#[test]
fn a_mirrored_sun_lights_by_the_reflectance_and_the_cosine_and_a_pane_takes_its_share() {
    for (degrees, glazed) in [(0.533, false), (0.533, true), (12.0, false)] {
        let glass = Glass::from_arguments(&[], &[0.9; 3]).unwrap();
        let mut parts = Parts {
            materials: vec![mirror(0.8), model(RadianceMaterial::Glass(glass))],
            surfaces: vec![of(0), of(1)],
            lights: vec![sun([-0.8, 0.0, 0.6], degrees, 1e4)],
            ..Parts::default()
        };
        // Faces -x; the sensor faces +x and has the sun behind it.
        quad(
            &mut parts,
            [2.0, -3.0, -3.0],
            [0.0, 0.0, 6.0],
            [0.0, 6.0, 0.0],
            1,
            0,
        );
        if glazed {
            quad(
                &mut parts,
                [1.0, -3.0, -3.0],
                [0.0, 0.0, 6.0],
                [0.0, 6.0, 0.0],
                1,
                1,
            );
        }
        let scene = Scene::new(parts).unwrap();
        let sine = (0.5 * degrees.to_radians()).sin();
        let mut wanted = 0.8 * PI * sine.powi(2) * 1e4 * 0.8;
        if glazed {
            // The light passes twice, at one angle. Of a sun this small the pane is the same all over.
            let glass = Glass::from_arguments(&[], &[0.9; 3]).unwrap();
            let wi = gonio_geom::Direction::from_spherical((0.8_f64).acos(), 0.0);
            let mut share = [0.0; 3];
            let pane = RadianceMaterial::Glass(glass).bsdf().unwrap();
            pane.delta(wi, gonio_geom::Component::Transmission, &mut share);
            wanted *= share[1].powi(2);
        }
        // Light between pane and mirror comes back by chance.
        let found = irradiance(&scene, Vec3::ZERO, Vec3::X, 16_384);
        if glazed {
            assert!(
                (wanted * 0.9995..1.2 * wanted).contains(&found.0),
                "{found:?}, {wanted}"
            );
        } else {
            sharp(found, wanted, 2e-3);
        }
    }
}

/// A room without roof: the sun falls on a mirror in a wall, which throws it on the floor and the opposite wall.
fn room(pieces: u32) -> (Scene, Camera) {
    let plastic = Plastic::from_arguments(&[], &[0.3, 0.4, 0.5, 0.1, 0.2]).unwrap();
    let mut parts = Parts {
        materials: vec![grey(0.6), mirror(0.9), model(RadianceMaterial::Plastic(plastic))],
        surfaces: vec![of(0), of(1), of(2)],
        lights: vec![
            sun([-0.5, 0.1, 1.0], 20.0, 30.0),
            sun([-0.6, -0.1, 0.7], 14.0, 20.0),
        ],
        ..Parts::default()
    };
    quad(&mut parts, [0., 0., 0.], [2., 0., 0.], [0., 3., 0.], 1, 2);
    quad(&mut parts, [0., 0., 0.], [0., 3., 0.], [0., 0., 2.], 1, 0);
    quad(&mut parts, [2., 0., 0.], [0., 0., 2.], [0., 3., 0.], 1, 0);
    quad(&mut parts, [0., 3., 0.], [2., 0., 0.], [0., 0., 2.], 1, 2);
    quad(
        &mut parts,
        [1.98, 0.5, 0.8],
        [0., 0., 1.],
        [0., 2., 0.],
        pieces,
        1,
    );
    (Scene::new(parts).unwrap(), into_the_room(80.0))
}

#[test]
fn suns_drawn_through_mirrors_bring_what_chance_brings_with_less_noise() {
    // A mirror of many pieces is not asked for suns.
    let ((drawn, camera), (chance, _)) = (room(1), room(7));
    for (bounces, share) in [(1, true), (2, true), (64, true), (64, false)] {
        let a = over_seeds(&drawn, &camera, share, bounces);
        let b = over_seeds(&chance, &camera, share, bounces);
        assert_equal(&a, &b, &format!("{bounces} bounces"));
        if bounces > 1 {
            assert!(noise(&a) < 0.5 * noise(&b), "{} {}", noise(&a), noise(&b));
        }
    }
}
