//! What is rendered.

mod look;
mod meet;
mod openings;
mod parts;

pub(crate) use meet::{MOST_PANES, Passage};
pub use parts::{Parts, SceneError, Surface, Upward};

use std::sync::Arc;

use parts::check;

use glam::{Vec3, Vec3A};
use obvhs::aabb::Aabb;
use obvhs::bvh2::Bvh2;
use obvhs::bvh2::builder::build_bvh2;
use obvhs::{Boundable, BvhBuildParams};

use crate::bvh::{Bvh, Triangles};
use crate::glint::Mirrors;
use crate::light::{Lights, Openings};
use crate::material::Material;
use crate::veil::Veil;

/// A scene, ready to be traced.
pub struct Scene {
    pub(crate) parts: Parts,
    pub(crate) lights: Lights,
    bvh: Bvh,
    curved: Option<Bvh2>,
    /// Largest coordinate: what distances are rounded against.
    pub(crate) extent: f32,
    /// Whether light comes from flat lights of even colour alone.
    pub(crate) flat_lights_only: bool,
    /// Whether no material lets light pass straight.
    opaque: bool,
    /// Where the sky is seen from inside.
    openings: Openings,
    /// What screens bring in, by surface.
    pub(crate) veils: Vec<Option<Arc<Veil>>>,
    /// Whether there are bodies or proxies.
    pub(crate) travels: bool,
    /// Plane mirrors that suns are seen in.
    pub(crate) mirrors: Mirrors,
}

/// Where a ray meets a surface.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Meeting {
    pub(crate) distance: f32,
    pub(crate) point: Vec3,
    /// Unit normal of the front.
    pub(crate) normal: Vec3,
    /// The same, smoothed over the mesh.
    pub(crate) smooth: Vec3,
    pub(crate) surface: u32,
}

/// What a ray meets.
pub(crate) enum Found {
    Nothing,
    /// A triangle at a distance.
    Flat(f32, u32),
    Curved(Meeting),
}

struct Bounds(Aabb);

impl Boundable for Bounds {
    fn aabb(&self) -> Aabb {
        self.0
    }
}

/// A point is moved off a surface by this share of the largest coordinate, so that rays from it do not meet it again.
pub(crate) const OFF: f32 = 4e-6;

impl Scene {
    /// A scene of these parts.
    ///
    /// # Errors
    /// [`SceneError`] for an index beyond its list, and a coordinate that is not finite.
    pub fn new(mut parts: Parts) -> Result<Self, SceneError> {
        check(&parts)?;
        let bvh = Bvh::new(&Triangles {
            vertices: &parts.vertices,
            indices: &parts.triangles,
        });
        let bounds: Vec<Bounds> = parts
            .shapes
            .iter()
            .map(|(s, _)| {
                let [low, high] = s.bounds();
                // The test against the boxes is not that of the triangles: keep clear of its rounding.
                let slack = 1e-5 * low.abs().max(high.abs()).max_element();
                Bounds(Aabb::new(Vec3A::from(low - slack), Vec3A::from(high + slack)))
            })
            .collect();
        let curved = (!bounds.is_empty()).then(|| {
            build_bvh2(
                &bounds,
                BvhBuildParams::medium_build(),
                &mut std::time::Duration::default(),
            )
        });
        let reach = bounds
            .iter()
            .map(|b| b.0.min.abs().max(b.0.max.abs()).max_element());
        let corners = parts.vertices.iter().flatten().map(|x| x.abs());
        let extent = reach.chain(corners).fold(0.0, f32::max);
        let lights = Lights::new(std::mem::take(&mut parts.lights));
        let opaque = !parts.materials.iter().any(|m| match m {
            Material::Nothing | Material::Model { ideal: true, .. } => true,
            Material::Function(f) => f.is_clear(),
            _ => false,
        });
        let proxies = parts.surfaces.iter().any(|s| s.proxy != 0.0);
        let travels = proxies || parts.surfaces.iter().any(|s| s.body.is_some());
        let flat_lights_only = lights.all_flat()
            && parts.light_patterns.iter().all(Option::is_none)
            && parts.sky.is_none()
            && parts.screens.is_empty()
            && parts.light_focus.is_empty()
            && !travels;
        let mut scene = Scene {
            flat_lights_only,
            parts,
            lights,
            bvh,
            curved,
            extent,
            opaque: opaque && !proxies,
            travels,
            openings: Openings::default(),
            veils: Vec::new(),
            mirrors: Mirrors::default(),
        };
        scene.openings = scene.find_openings();
        scene.hang_veils();
        scene.mirrors = Mirrors::of(&scene);
        Ok(scene)
    }

    /// Number of triangles and curved surfaces.
    pub fn primitives(&self) -> usize {
        self.parts.triangles.len() + self.parts.shapes.len()
    }
}
