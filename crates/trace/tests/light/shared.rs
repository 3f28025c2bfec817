//! Pictures whose pixels share paths against those whose pixels do not; seeds are fixed.

use std::sync::Arc;

use crate::common::blocks::{assert_equal, into_the_room, model, noise, over_seeds};
use crate::common::{grey, of};
use glam::Vec3;
use gonio_bsdf::radiance::{Glass, Parameters, Plastic};
use gonio_trace::camera::Camera;
use gonio_trace::light::{Flat, Light, Sky};
use gonio_trace::material::Material;
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
    (Scene::new(parts).unwrap(), into_the_room(70.0))
}

#[test]
fn shared_paths_bring_what_those_of_each_pixel_bring_with_less_noise() {
    let (scene, camera) = room();
    for bounces in [2, 64] {
        let shared = over_seeds(&scene, &camera, true, bounces);
        let alone = over_seeds(&scene, &camera, false, bounces);
        assert_equal(&shared, &alone, &format!("{bounces} bounces"));
        assert!(noise(&shared) < 0.5 * noise(&alone));
    }
}
