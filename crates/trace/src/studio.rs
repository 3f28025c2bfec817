//! A material to look at: a ball on a plane, under a lamp and a soft sky.

use std::sync::Arc;

use glam::Vec3;

use crate::camera::{Projection, View};
use crate::light::{Flat, Light, Sky};
use crate::material::Material;
use crate::scene::{Parts, Scene, SceneError, Surface};
use crate::shape::Shape;

/// Reflectances of the two kinds of square of the plane.
const GREYS: [f32; 2] = [0.45, 0.25];
/// Squares from the middle to the rim, and their size: the ball has the radius 1.
const SQUARES: i32 = 24;
const SIZE: f32 = 0.75;

/// The scene: a ball of radius 1 of the material (its `up` along `z`) on a chequered plane; a square lamp to the left above
/// the eye; a sky of a tenth to a third of a W/(m2 sr), brightest at the zenith.
///
/// # Errors
/// None for materials that [`Scene::new`] takes.
pub fn scene(material: Material) -> Result<Scene, SceneError> {
    let mut parts = Parts {
        materials: vec![
            material,
            Material::Diffuse {
                reflectance: Vec3::splat(GREYS[0]),
            },
            Material::Diffuse {
                reflectance: Vec3::splat(GREYS[1]),
            },
            Material::Black,
        ],
        surfaces: (0..4)
            .map(|k| Surface {
                material: k,
                light: (k == 3).then_some(0),
                ..Surface::default()
            })
            .collect(),
        shapes: vec![(
            Shape::Sphere {
                centre: Vec3::Z,
                radius: 1.0,
                inward: false,
            },
            0,
        )],
        ..Parts::default()
    };
    for i in -SQUARES..SQUARES {
        for j in -SQUARES..SQUARES {
            let corner = SIZE * Vec3::new(i as f32, j as f32, 0.0);
            let kind = 1 + (i + j).rem_euclid(2) as u32;
            quad(&mut parts, [corner, SIZE * Vec3::X, SIZE * Vec3::Y], kind);
        }
    }
    // Two metres square, four from the ball, towards it.
    let centre = Vec3::new(-3.0, -2.6, 4.6);
    let back = (centre - Vec3::Z).normalize();
    let across = back.cross(Vec3::Z).normalize();
    let along = back.cross(across);
    let lamp = [centre - across - along, 2.0 * along, 2.0 * across];
    let faces = quad(&mut parts, lamp, 3);
    parts.lights = Flat::new(&faces, Vec3::splat(9.0))
        .map(Light::Flat)
        .into_iter()
        .collect();
    parts.sky = Some(Sky::new(Arc::new(|d: Vec3| {
        Vec3::splat(0.1 + 0.25 * d.z.max(0.0))
    })));
    Scene::new(parts)
}

/// The view of the ball.
pub fn view() -> View {
    let point = Vec3::new(0.0, -6.5, 3.1);
    View {
        projection: Projection::Perspective,
        point,
        direction: Vec3::new(0.0, 0.0, 0.92) - point,
        up: Vec3::Z,
        horizontal: 24.0,
        vertical: 24.0,
        shift: [0.0; 2],
        fore: 0.0,
        aft: 0.0,
    }
}

/// Adds a parallelogram by a corner and two edges, its front where they turn counterclockwise; its triangles.
fn quad(parts: &mut Parts, [corner, a, b]: [Vec3; 3], surface: u32) -> [[Vec3; 3]; 2] {
    let k = parts.vertices.len() as u32;
    let corners = [corner, corner + a, corner + a + b, corner + b];
    parts.vertices.extend(corners.map(|c| c.to_array()));
    parts.triangles.extend([[k, k + 1, k + 2], [k, k + 2, k + 3]]);
    parts.triangle_surface.extend([surface; 2]);
    [
        [corners[0], corners[1], corners[2]],
        [corners[0], corners[2], corners[3]],
    ]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_lamp_shines_on_the_ball() {
        let studio = scene(Material::Black).unwrap();
        let above = crate::sensor::Sensor::new(Vec3::new(0.0, 0.0, 2.001), Vec3::Z).unwrap();
        let limits = crate::path::Limits {
            bounces: 1,
            roulette: 3,
        };
        let mean = (0..256)
            .map(|k| {
                let mut sampler = crate::sampler::Sampler::new(1, 0, k);
                studio.irradiance(&above, &limits, &mut sampler).x / 256.0
            })
            .sum::<f32>();
        // The sky alone gives pi (0.1 + 0.25 * 2 / 3) = 0.84.
        assert!(mean > 1.2, "{mean}");
    }
}
