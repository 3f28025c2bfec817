//! Suns seen in plane mirrors: drawn as lights of their own, as RADIANCE's virtual light sources are [Ward1994].
//!
//! A point that scatters draws a direction towards a sun, mirrors it in the plane of each mirror, and asks whether the way is
//! free. A path that meets the sun by way of such a mirror counts by the balance heuristic. A disk of half a degree would else be
//! found once in 50 000 paths.

use glam::Vec3;
use gonio_geom::{Component, Direction};

use crate::material::{Local, Material, rgb};
use crate::path::{Origin, balance};
use crate::reflect::SHORT;
use crate::scene::{Meeting, Scene};

/// Triangles of mirrors, at most: each is asked at every point. With more, suns are found by chance.
const MOST: usize = 64;
/// What a mirror reflects at least, head on.
const BRIGHT: f32 = 0.3;

/// Triangles that mirror, and the surfaces that they belong to.
#[derive(Default)]
pub(crate) struct Mirrors {
    triangles: Vec<Mirror>,
    surfaces: Vec<bool>,
}

struct Mirror {
    corner: Vec3,
    edges: [Vec3; 2],
    /// Unit normal of the front.
    normal: Vec3,
    surface: u32,
}

impl Mirror {
    /// How far a ray goes to it; a point on its other side is seen as well.
    #[inline]
    fn meets(&self, origin: Vec3, direction: Vec3) -> Option<f32> {
        let [ab, ac] = self.edges;
        let across = direction.cross(ac);
        let scale = 1.0 / ab.dot(across);
        let way = origin - self.corner;
        let u = scale * way.dot(across);
        let other = way.cross(ab);
        let v = scale * direction.dot(other);
        let far = scale * ac.dot(other);
        (u >= 0.0 && v >= 0.0 && u + v <= 1.0 && far > 0.0 && far.is_finite()).then_some(far)
    }
}

impl Mirrors {
    /// Those of a scene with suns, unless bodies bend what they mirror.
    pub(crate) fn of(scene: &Scene) -> Self {
        let [far, _] = scene.lights.kinds();
        if !far || scene.travels {
            return Mirrors::default();
        }
        let parts = &scene.parts;
        let mut surfaces: Vec<bool> = parts
            .surfaces
            .iter()
            .map(|s| {
                s.is_plain()
                    && s.light.is_none()
                    && !s.concealed
                    && s.up.is_none()
                    && reflects(&parts.materials[s.material as usize])
            })
            .collect();
        for (_, surface) in &parts.shapes {
            surfaces[*surface as usize] = false;
        }
        let bent = |triangle: &[u32; 3]| {
            let normal = |k: &u32| parts.normals.get(*k as usize).is_some_and(|n| *n != [0.0; 3]);
            triangle.iter().any(normal)
        };
        for (triangle, surface) in parts.triangles.iter().zip(&parts.triangle_surface) {
            if bent(triangle) {
                surfaces[*surface as usize] = false;
            }
        }
        let all = (0..parts.triangles.len() as u32)
            .filter(|k| surfaces[parts.triangle_surface[*k as usize] as usize])
            .map(|k| {
                let ([a, b, c], surface) = scene.triangle(k);
                Mirror {
                    corner: a,
                    edges: [b - a, c - a],
                    normal: (b - a).cross(c - a).normalize_or_zero(),
                    surface,
                }
            });
        let triangles: Vec<Mirror> = all.take(MOST + 1).collect();
        if triangles.is_empty() || triangles.len() > MOST {
            return Mirrors::default();
        }
        Mirrors { triangles, surfaces }
    }

    pub(crate) fn is_empty(&self) -> bool {
        self.triangles.is_empty()
    }
}

/// Whether a material mirrors most of what it does not absorb, on one side at least.
fn reflects(material: &Material) -> bool {
    let Material::Model {
        model, ideal: true, ..
    } = material
    else {
        return false;
    };
    [1.0, -1.0].into_iter().any(|z| {
        let share = Direction::new(gonio_geom::DVec3::new(0.0, 0.0, z)).map(|d| {
            rgb(model.as_ref(), |s| {
                model.delta(d, Component::Reflection, s);
            })
        });
        share.is_some_and(|s| s.max_element() >= BRIGHT)
    })
}

impl Scene {
    /// How a ray came about that a surface has mirrored.
    #[inline(always)]
    pub(crate) fn mirrored(&self, came: Origin, surface: u32) -> Origin {
        match came {
            Origin::Drawn { pdf, draws, from }
                if self.mirrors.surfaces.get(surface as usize) == Some(&true) =>
            {
                Origin::Mirrored { from, pdf, draws }
            }
            _ => Origin::Alone,
        }
    }

    /// Light that a point scatters of one of the suns by way of plane mirrors; one of `draws` samples, which add up.
    #[inline(always)]
    pub(crate) fn lit_by_mirrors(
        &self,
        met: &Meeting,
        local: &Local<'_>,
        which: f32,
        place: [f32; 2],
        draws: f32,
    ) -> Vec3 {
        match self.mirrors.is_empty() {
            true => Vec3::ZERO,
            false => self.sum_of_mirrors(met, local, which, place, draws),
        }
    }

    #[inline(never)]
    fn sum_of_mirrors(
        &self,
        met: &Meeting,
        local: &Local<'_>,
        which: f32,
        place: [f32; 2],
        draws: f32,
    ) -> Vec3 {
        let mut sum = Vec3::ZERO;
        let Some((k, chance)) = self.lights.choose_far(which) else {
            return sum;
        };
        let Some(sun) = self.towards(k, met.point, chance * draws, place) else {
            return sum;
        };
        for mirror in &self.mirrors.triangles {
            let up = sun.direction.dot(mirror.normal);
            if up * (met.point - mirror.corner).dot(mirror.normal) <= 0.0 {
                continue;
            }
            let direction = sun.direction - 2.0 * up * mirror.normal;
            let Some(far) = mirror.meets(met.point, direction) else {
                continue;
            };
            let (f, pdf) = local.eval(direction);
            if f == Vec3::ZERO {
                continue;
            }
            let pdf = self.with_screens(met.point, direction, pdf);
            let Some(first) = self.passes(self.off(met, direction), direction, far * SHORT, false) else {
                continue;
            };
            let seen = Meeting {
                distance: far,
                point: met.point + far * direction,
                normal: mirror.normal,
                smooth: mirror.normal,
                surface: mirror.surface,
            };
            let [Some(way), _] = self.local(&seen, -direction).ideal() else {
                continue;
            };
            let Some(second) = self.passes(
                self.off(&seen, sun.direction),
                sun.direction,
                f32::INFINITY,
                false,
            ) else {
                continue;
            };
            let weight = balance(sun.pdf, pdf) / sun.pdf;
            sum += f * first.left * way.share * second.left * sun.radiance * weight;
        }
        sum
    }
}
