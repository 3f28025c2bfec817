//! What a scene is made of.

use std::sync::Arc;

use glam::Vec3;

use crate::light::{Light, Sky};
use crate::material::Material;
use crate::pattern::{Mixture, Paint, Pattern, Texture};
use crate::shape::Shape;
use crate::travel::Body;

/// How a surface looks and what it emits.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Surface {
    /// Index of its material.
    pub material: u32,
    /// Index of the light that it is.
    pub light: Option<u32>,
    /// Index of the pattern on its material.
    pub paint: Option<u32>,
    /// Index of what turns its normal.
    pub texture: Option<u32>,
    /// Index of the mixture that it shows in place of its material.
    pub mixture: Option<u32>,
    /// Whether the eye sees the material only while the light lights everything else: RADIANCE's `illum`. What lies behind
    /// it at infinity then lights nothing through its front: the light stands for it.
    pub concealed: bool,
    /// What the eye sees of its front beyond that, W/(m2 sr), without that it lights anything.
    pub glow: Vec3,
    /// Index of the body that it bounds.
    pub body: Option<u32>,
    /// How far behind the surface (before it, when negative) light goes on that it transmits, past the geometry that it
    /// stands for: the thickness of RADIANCE's `BSDF`. Rays from the eye and to lights then pass the surface and see that
    /// geometry; 0 for a surface that is one.
    pub proxy: f32,
    /// Index of what turns its material from place to place.
    pub up: Option<u32>,
}

/// Which way is up for a material that has axes.
pub trait Upward: Send + Sync {
    /// What the y axis of the material is closest to at a point, in the world; of any length. `normal` is the unit normal of
    /// the front, `direction` that of the ray that arrives.
    fn up(&self, point: Vec3, normal: Vec3, direction: Vec3) -> Vec3;
}

impl Surface {
    /// Whether it shows its material everywhere as it is.
    #[inline(always)]
    pub(crate) fn is_plain(&self) -> bool {
        self.paint.is_none() && self.texture.is_none() && self.mixture.is_none()
    }
}

/// The parts of a scene.
#[derive(Default)]
pub struct Parts {
    /// Coordinates of vertices.
    pub vertices: Vec<[f32; 3]>,
    /// Normals of smooth surfaces by vertex: a triangle is smooth where all three are there and not zero. May be shorter
    /// than the vertices.
    pub normals: Vec<[f32; 3]>,
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
    /// What turns normals.
    pub textures: Vec<Arc<dyn Texture>>,
    /// Mixtures of materials, patterns and textures.
    pub mixtures: Vec<Mixture>,
    /// All lights. Paths draw them and meet them: each, but those at infinity, belongs to a surface that stands in its place.
    pub lights: Vec<Light>,
    /// Patterns by light, where it has one; may be shorter than the lights. Those at infinity have none.
    pub light_patterns: Vec<Option<Arc<dyn Pattern>>>,
    /// By light, how far behind it its light seems to come from: it falls off as from there, as that of RADIANCE's spotlights
    /// does; may be shorter than the lights.
    pub light_focus: Vec<f32>,
    /// Boundaries of bodies.
    pub bodies: Vec<Body>,
    /// What turns materials from place to place.
    pub ups: Vec<Arc<dyn Upward>>,
    /// What lies at infinity.
    pub sky: Option<Sky>,
    /// Openings through which the sky is seen, such as panes of clear glass: parallelograms by a corner and two edges.
    pub portals: Vec<[Vec3; 3]>,
    /// Openings that scatter what comes in, such as blinds.
    pub screens: Vec<[Vec3; 3]>,
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

pub(crate) fn check(parts: &Parts) -> Result<(), SceneError> {
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
    if let Some(k) = parts.normals.iter().position(|n| !Vec3::from(*n).is_finite()) {
        let found = format!("{:?}", parts.normals[k]);
        return Err(error("normals", k, found, "finite components".into()));
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
        "surfaces.texture",
        &mut parts.surfaces.iter().filter_map(|s| s.texture),
        parts.textures.len(),
    )?;
    below(
        "surfaces.mixture",
        &mut parts.surfaces.iter().filter_map(|s| s.mixture),
        parts.mixtures.len(),
    )?;
    for (k, mixture) in parts.mixtures.iter().enumerate() {
        for layer in &mixture.layers {
            let within = |index: Option<u32>, limit: usize| index.is_none_or(|i| (i as usize) < limit);
            let good = within(layer.mixture, k)
                && (layer.mixture.is_some() || (layer.material as usize) < parts.materials.len())
                && within(layer.paint, parts.paints.len())
                && within(layer.texture, parts.textures.len())
                && within(layer.up, parts.ups.len());
            if !good {
                let allowed = "indices within their lists, and of mixtures those before it";
                return Err(error("mixtures", k, format!("{layer:?}"), allowed.into()));
            }
        }
    }
    below(
        "surfaces.body",
        &mut parts.surfaces.iter().filter_map(|s| s.body),
        parts.bodies.len(),
    )?;
    below(
        "surfaces.up",
        &mut parts.surfaces.iter().filter_map(|s| s.up),
        parts.ups.len(),
    )?;
    below(
        "surfaces.light",
        &mut parts.surfaces.iter().filter_map(|s| s.light),
        parts.lights.len(),
    )
}
