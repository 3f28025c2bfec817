//! What is rendered.

use std::sync::Arc;

use glam::{Vec3, Vec3A};
use obvhs::aabb::Aabb;
use obvhs::bvh2::Bvh2;
use obvhs::bvh2::builder::build_bvh2;
use obvhs::ray::{Ray as LibraryRay, RayHit};
use obvhs::{Boundable, BvhBuildParams};

use crate::bvh::{Bvh, Ray, Triangles};
use crate::light::{Light, Lights, Sky};
use crate::material::{Local, Material};
use crate::pattern::{Paint, Pattern};
use crate::shape::Shape;

/// How a surface looks and what it emits.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Surface {
    /// Index of its material.
    pub material: u32,
    /// Index of the light that it is.
    pub light: Option<u32>,
    /// Index of the pattern on its material.
    pub paint: Option<u32>,
    /// Whether the eye sees the material only while the light lights everything else: RADIANCE's `illum`. What lies behind
    /// it at infinity then lights nothing through its front: the light stands for it.
    pub concealed: bool,
    /// What the eye sees of its front beyond that, W/(m2 sr), without that it lights anything.
    pub glow: Vec3,
}

/// The parts of a scene.
#[derive(Default)]
pub struct Parts {
    /// Coordinates of vertices.
    pub vertices: Vec<[f32; 3]>,
    /// Triangles by vertex; their front is where they turn counterclockwise.
    pub triangles: Vec<[u32; 3]>,
    /// The surface each triangle belongs to.
    pub triangle_surface: Vec<u32>,
    /// Curved surfaces, with the index of their [`Surface`].
    pub shapes: Vec<(Shape, u32)>,
    /// All surfaces.
    pub surfaces: Vec<Surface>,
    /// All materials.
    pub materials: Vec<Material>,
    /// Patterns on materials.
    pub paints: Vec<Paint>,
    /// All lights.
    pub lights: Vec<Light>,
    /// Patterns by light, where it has one; may be shorter than the lights. Those at infinity have none.
    pub light_patterns: Vec<Option<Arc<dyn Pattern>>>,
    /// What lies at infinity.
    pub sky: Option<Sky>,
    /// Openings through which light comes in: parallelograms by a corner and two edges.
    pub portals: Vec<[Vec3; 3]>,
}

/// A scene that refers to something that is not there.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{field}[{index}]: found {found}, allowed {allowed}")]
pub struct SceneError {
    /// The list.
    pub field: &'static str,
    /// Its entry.
    pub index: usize,
    /// What it holds.
    pub found: String,
    /// What it may hold.
    pub allowed: String,
}

/// A scene, ready to be traced.
pub struct Scene {
    pub(crate) parts: Parts,
    pub(crate) lights: Lights,
    bvh: Bvh,
    curved: Option<Bvh2>,
    /// Largest coordinate: what distances are rounded against.
    extent: f32,
    /// Whether no material lets light pass straight.
    opaque: bool,
}

/// Where a ray meets a surface.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Meeting {
    pub(crate) distance: f32,
    pub(crate) point: Vec3,
    /// Unit normal of the front.
    pub(crate) normal: Vec3,
    pub(crate) surface: u32,
}

struct Bounds(Aabb);

impl Boundable for Bounds {
    fn aabb(&self) -> Aabb {
        self.0
    }
}

/// A point is moved off a surface by this share of the largest coordinate, so that rays from it do not meet it again.
const OFF: f32 = 4e-6;

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
        let opaque = !parts
            .materials
            .iter()
            .any(|m| matches!(m, Material::Nothing | Material::Model { ideal: true, .. }));
        Ok(Scene {
            parts,
            lights,
            bvh,
            curved,
            extent,
            opaque,
        })
    }

    /// Number of triangles and curved surfaces.
    pub fn primitives(&self) -> usize {
        self.parts.triangles.len() + self.parts.shapes.len()
    }

    /// The first surface that a ray of unit direction meets.
    #[inline(always)]
    pub(crate) fn meet(&self, origin: Vec3, direction: Vec3, far: f32) -> Option<Meeting> {
        let ray = Ray {
            t_max: far,
            ..Ray::new(origin.to_array(), direction.to_array())
        };
        let flat = self.bvh.closest(&ray);
        let limit = flat.map_or(far, |h| h.t);
        if let Some((distance, k)) = self.meet_curved(origin, direction, limit) {
            let (shape, surface) = &self.parts.shapes[k];
            let point = origin + distance * direction;
            return Some(Meeting {
                distance,
                point,
                normal: shape.normal(point),
                surface: *surface,
            });
        }
        flat.map(|h| {
            let corners = self.parts.triangles[h.triangle as usize]
                .map(|k| Vec3::from(self.parts.vertices[k as usize]));
            let [a, b, c] = corners;
            Meeting {
                distance: h.t,
                // By the corners rather than along the ray: on the triangle to the last place.
                point: a + h.u * (b - a) + h.v * (c - a),
                normal: (b - a).cross(c - a).normalize_or(-direction),
                surface: self.parts.triangle_surface[h.triangle as usize],
            }
        })
    }

    #[inline]
    fn meet_curved(&self, origin: Vec3, direction: Vec3, far: f32) -> Option<(f32, usize)> {
        let tree = self.curved.as_ref()?;
        let mut best: Option<(f32, usize)> = None;
        let ray = LibraryRay::new(Vec3A::from(origin), Vec3A::from(direction), 0.0, far);
        tree.ray_traverse(ray, &mut RayHit::none(), |_, place| {
            let k = tree.primitive_indices[place] as usize;
            let limit = best.map_or(far, |b| b.0);
            match self.parts.shapes[k].0.hit(origin, direction, 0.0, limit) {
                Some(t) => {
                    best = Some((t, k));
                    t
                }
                None => f32::INFINITY,
            }
        });
        best
    }

    /// Whether nothing that stops light lies on the way; light that comes straight through takes its colour.
    #[inline(always)]
    pub(crate) fn passes(
        &self,
        origin: Vec3,
        direction: Vec3,
        distance: f32,
        from_sky: bool,
    ) -> Option<Vec3> {
        if self.opaque {
            let ray = Ray {
                t_max: distance,
                ..Ray::new(origin.to_array(), direction.to_array())
            };
            let stopped = self.bvh.occluded(&ray) || self.meet_curved(origin, direction, distance).is_some();
            return (!stopped).then_some(Vec3::ONE);
        }
        let mut left = Vec3::ONE;
        let (mut from, mut far) = (origin, distance);
        for _ in 0..MOST_PANES {
            let Some(met) = self.meet(from, direction, far) else {
                return Some(left);
            };
            if from_sky
                && self.parts.surfaces[met.surface as usize].concealed
                && met.normal.dot(direction) < 0.0
            {
                return None;
            }
            left *= self.straight(&met, -direction);
            if left == Vec3::ZERO {
                return None;
            }
            far -= met.distance;
            from = self.off(&met, direction);
        }
        None
    }

    /// The share of light that comes straight through a surface towards `to_eye`.
    fn straight(&self, met: &Meeting, to_eye: Vec3) -> Vec3 {
        let [_, through] = self.local(met, to_eye).ideal();
        through.filter(|w| w.straight).map_or(Vec3::ZERO, |w| w.share)
    }

    /// The material where a ray met it, seen from `to_eye`.
    #[inline(always)]
    pub(crate) fn local(&self, met: &Meeting, to_eye: Vec3) -> Local<'_> {
        let surface = &self.parts.surfaces[met.surface as usize];
        let local = Local::new(
            &self.parts.materials[surface.material as usize],
            met.normal,
            to_eye,
        );
        match surface.paint {
            None => local,
            Some(k) => {
                let paint = &self.parts.paints[k as usize];
                let factor = paint.pattern.multiplier(met.point, met.normal, -to_eye);
                local.painted(factor, paint.bare.as_deref())
            }
        }
    }

    /// What a light emits at a point of it against a ray.
    #[inline(always)]
    pub(crate) fn emission(&self, k: u32, point: Vec3, normal: Vec3, direction: Vec3) -> Vec3 {
        let radiance = self.lights.get(k).radiance();
        match self.parts.light_patterns.get(k as usize) {
            Some(Some(pattern)) => radiance * pattern.multiplier(point, normal, direction),
            _ => radiance,
        }
    }

    /// The point, moved off its surface to the side that `direction` goes to.
    #[inline(always)]
    pub(crate) fn off(&self, met: &Meeting, direction: Vec3) -> Vec3 {
        let side = 1.0_f32.copysign(met.normal.dot(direction));
        met.point + (OFF * self.extent * side) * met.normal
    }
}

/// Surfaces that light passes straight through on one way, at most.
pub(crate) const MOST_PANES: usize = 64;

fn check(parts: &Parts) -> Result<(), SceneError> {
    let error = |field, index, found: String, allowed: String| SceneError {
        field,
        index,
        found,
        allowed,
    };
    if parts.triangle_surface.len() != parts.triangles.len() {
        return Err(error(
            "triangle_surface",
            parts.triangle_surface.len(),
            "the end".into(),
            format!("one entry for each of {} triangles", parts.triangles.len()),
        ));
    }
    if let Some(k) = parts
        .vertices
        .iter()
        .position(|v| v.iter().any(|x| !x.is_finite()))
    {
        return Err(error(
            "vertices",
            k,
            format!("{:?}", parts.vertices[k]),
            "finite coordinates".into(),
        ));
    }
    let below = |field, values: &mut dyn Iterator<Item = u32>, limit: usize| match values
        .enumerate()
        .find(|(_, v)| *v as usize >= limit)
    {
        Some((k, v)) => Err(error(field, k, v.to_string(), format!("below {limit}"))),
        None => Ok(()),
    };
    below(
        "triangles",
        &mut parts.triangles.iter().flatten().copied(),
        parts.vertices.len(),
    )?;
    below(
        "triangle_surface",
        &mut parts.triangle_surface.iter().copied(),
        parts.surfaces.len(),
    )?;
    below(
        "shapes",
        &mut parts.shapes.iter().map(|s| s.1),
        parts.surfaces.len(),
    )?;
    below(
        "surfaces.material",
        &mut parts.surfaces.iter().map(|s| s.material),
        parts.materials.len(),
    )?;
    below(
        "surfaces.paint",
        &mut parts.surfaces.iter().filter_map(|s| s.paint),
        parts.paints.len(),
    )?;
    below(
        "surfaces.light",
        &mut parts.surfaces.iter().filter_map(|s| s.light),
        parts.lights.len(),
    )
}
