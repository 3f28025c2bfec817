//! Irradiance of lamps and form factors against closed forms. [`common::close`] states the false-alarm rate of a
//! comparison; seeds are fixed.

use std::f64::consts::{FRAC_1_PI, PI, TAU};

use crate::common::{ball, flat, irradiance, lamp, mean, polygon, sharp};
use glam::{DVec3, Vec3};
use gonio_trace::material::Material;
use gonio_trace::path::Limits;
use gonio_trace::scene::{Parts, Scene};
use gonio_trace::sensor::Sensor;

#[test]
fn a_small_ball_obeys_the_inverse_square_and_the_cosine_and_a_large_one_its_solid_angle() {
    // Down to a thousandth of the distance, where the rim must not lie in the ball's own shadow.
    for (radius, tolerance) in [(0.003_f32, 5e-5), (0.05, 5e-4), (1.2, 1e-3)] {
        let centre = Vec3::new(0.5, -1.0, 3.0);
        let mut parts = Parts::default();
        ball(&mut parts, centre, radius, 7.0, Material::Black);
        let scene = Scene::new(parts).unwrap();
        for (point, normal) in [
            (Vec3::new(0.5, -1.0, 0.0), Vec3::Z),
            (Vec3::ZERO, Vec3::Z),
            (Vec3::new(-2.0, 1.0, 0.5), Vec3::new(0.6, 0.0, 0.8)),
        ] {
            // As long as all of it is above the horizon, the cosine is that of its centre: E = pi L sin2 cos.
            let way = (centre - point).as_dvec3();
            let cos = way.normalize().dot(normal.as_dvec3());
            let wanted = PI * 7.0 * f64::from(radius).powi(2) / way.length_squared() * cos;
            sharp(irradiance(&scene, point, normal, 16_384), wanted, tolerance);
        }
    }
}

/// A disc at a height that faces down, as 1024 corners of equal area: what is left of its shape is below 1e-5.
fn disc(a: f64, h: f64) -> Vec<Vec3> {
    let step = TAU / 1024.0;
    let radius = a * (step / step.sin()).sqrt();
    (0..1024)
        .map(|k| {
            let (s, c) = (-step * f64::from(k)).sin_cos();
            DVec3::new(radius * c, radius * s, h).as_vec3()
        })
        .collect()
}

#[test]
fn a_disc_lights_points_beside_its_axis_by_its_closed_form() {
    let (a, h) = (0.7_f64, 1.1_f64);
    let corners = disc(a, h);
    let mut parts = Parts {
        surfaces: vec![lamp(0, 0)],
        materials: vec![Material::Black],
        ..Parts::default()
    };
    let faces = polygon(&mut parts, &corners, 0);
    parts.lights = vec![flat(&faces, 2.0)];
    let scene = Scene::new(parts).unwrap();
    for p in [0.0, 0.4, 0.7, 3.0] {
        // [Howell2021, B-13]
        let root = ((h * h + p * p + a * a).powi(2) - 4.0 * a * a * p * p).sqrt();
        let wanted = PI * 2.0 * 0.5 * (1.0 - (h * h + p * p - a * a) / root);
        let point = Vec3::new(0.0, p as f32, 0.0);
        sharp(irradiance(&scene, point, Vec3::Z, 16_384), wanted, 2e-3);
    }
}

/// Irradiance from a polygon of radiance 1 that lies above the horizon: the sum over its edges of the angle each is seen
/// under and the cosine of its plane [Lambert1760].
fn lambert(corners: &[Vec3], point: Vec3, normal: Vec3) -> f64 {
    let ways: Vec<DVec3> = corners
        .iter()
        .map(|c| (*c - point).as_dvec3().normalize())
        .collect();
    let sum: f64 = (0..ways.len())
        .map(|k| {
            let (a, b) = (ways[k], ways[(k + 1) % ways.len()]);
            let across = a.cross(b);
            across.length().atan2(a.dot(b)) * across.normalize().dot(normal.as_dvec3())
        })
        .sum();
    0.5 * sum.abs()
}

#[test]
fn a_polygon_lights_a_point_as_lambert_says() {
    // Askew, five corners, no parallelogram.
    let (o, a, b) = (
        Vec3::new(0.2, -0.4, 1.5),
        Vec3::new(0.0, 0.8, 0.6),
        Vec3::new(-1.0, 0.0, 0.0),
    );
    let corners =
        [[0.0, 0.0], [1.0, -0.2], [1.6, 0.5], [0.9, 1.4], [-0.1, 0.8]].map(|[x, y]| o + x * a + y * b);
    let mut parts = Parts {
        surfaces: vec![lamp(0, 0)],
        materials: vec![Material::Black],
        ..Parts::default()
    };
    let mut turned = corners;
    if a.cross(b).dot(o) > 0.0 {
        turned.reverse();
    }
    let faces = polygon(&mut parts, &turned, 0);
    parts.lights = vec![flat(&faces, 1.0)];
    let scene = Scene::new(parts).unwrap();
    for (point, normal) in [
        (Vec3::ZERO, Vec3::Z),
        (Vec3::new(0.3, 0.5, 0.2), Vec3::new(-0.6, 0.0, 0.8)),
        (Vec3::new(-0.5, -0.5, 1.0), Vec3::Z),
    ] {
        sharp(
            irradiance(&scene, point, normal, 32_768),
            lambert(&corners, point, normal),
            3e-3,
        );
    }
}

/// The share of the light of one surface that reaches another, by reciprocity from irradiance on points spread over the
/// other: `place` turns two uniform numbers into a point of it.
fn form_factor(scene: &Scene, normal: Vec3, place: impl Fn([f32; 2]) -> Vec3) -> (f64, f64) {
    let found = mean(65_536, |s| {
        let sensor = Sensor::new(place(s.two()), normal).unwrap();
        scene.irradiance(&sensor, &Limits::default(), s).y
    });
    (found.0 * FRAC_1_PI, found.1 * FRAC_1_PI)
}

fn luminous(corners: &[Vec3]) -> Scene {
    let mut parts = Parts {
        surfaces: vec![lamp(0, 0)],
        materials: vec![Material::Black],
        ..Parts::default()
    };
    let faces = polygon(&mut parts, corners, 0);
    parts.lights = vec![flat(&faces, 1.0)];
    Scene::new(parts).unwrap()
}

#[test]
fn form_factors_of_rectangles_are_those_of_the_handbook() {
    let (a, b, c) = (1.5_f32, 0.8_f32, 0.6_f32);
    let up = |z: f32| [[0.0, 0.0], [0.0, b], [a, b], [a, 0.0]].map(|[x, y]| Vec3::new(x, y, z));
    // Parallel, opposed [Howell2021, C-11].
    let (x, y) = (f64::from(a / c), f64::from(b / c));
    let (x1, y1) = (1.0 + x * x, 1.0 + y * y);
    let parallel = 2.0 / (PI * x * y)
        * ((x1 * y1 / (x1 + y * y)).sqrt().ln()
            + x * y1.sqrt() * (x / y1.sqrt()).atan()
            + y * x1.sqrt() * (y / x1.sqrt()).atan()
            - x * x.atan()
            - y * y.atan());
    let found = form_factor(&luminous(&up(c)), Vec3::Z, |[u, v]| Vec3::new(u * a, v * b, 0.0));
    sharp(found, parallel, 4e-3);
    // At right angles with a common edge of length a [Howell2021, C-14]: from the floor (a x b) to a wall (a x c).
    let (h, w) = (f64::from(c / a), f64::from(b / a));
    let (h2, w2) = (h * h, w * w);
    let both = h2 + w2;
    let logs = (1.0 + w2) * (1.0 + h2) / (1.0 + both);
    let first = (w2 * (1.0 + both) / ((1.0 + w2) * both)).powf(w2);
    let second = (h2 * (1.0 + both) / ((1.0 + h2) * both)).powf(h2);
    let square = 1.0 / (PI * w)
        * (w * (1.0 / w).atan() + h * (1.0 / h).atan() - both.sqrt() * (1.0 / both.sqrt()).atan()
            + 0.25 * (logs * first * second).ln());
    let wall = [[0.0, 0.0], [0.0, c], [a, c], [a, 0.0]].map(|[x, z]| Vec3::new(x, b, z));
    let turned = [wall[3], wall[2], wall[1], wall[0]];
    let facing = if (wall[1] - wall[0]).cross(wall[2] - wall[0]).y < 0.0 {
        wall
    } else {
        turned
    };
    let found = form_factor(&luminous(&facing), Vec3::Z, |[u, v]| Vec3::new(u * a, v * b, 0.0));
    sharp(found, square, 5e-3);
}

#[test]
fn the_form_factor_of_coaxial_discs_is_that_of_the_handbook() {
    let (r1, r2, h) = (0.9_f64, 0.6_f64, 0.7_f64);
    let corners = disc(r2, h);
    // [Howell2021, C-41]
    let (x, y) = (r1 / h, r2 / h);
    let s = 1.0 + (1.0 + y * y) / (x * x);
    let wanted = 0.5 * (s - (s * s - 4.0 * (y / x).powi(2)).sqrt());
    let found = form_factor(&luminous(&corners), Vec3::Z, |[u, v]| {
        let (sin, cos) = (std::f32::consts::TAU * v).sin_cos();
        r1 as f32 * u.sqrt() * Vec3::new(cos, sin, 0.0)
    });
    sharp(found, wanted, 4e-3);
}
