//! What rays meet in a scene, and what of the light passes.

use glam::{Vec3, Vec3A};
use obvhs::bvh2::Bvh2;
use obvhs::ray::{Ray as LibraryRay, RayHit};

use super::{Found, Meeting, Scene};
use crate::bvh::Ray;
use crate::lanes::{Rays, on_triangle};
use crate::travel::transmittance;

impl Scene {
    /// The first surface that a ray of unit direction meets.
    #[inline(always)]
    pub(crate) fn meet(&self, origin: Vec3, direction: Vec3, far: f32) -> Option<Meeting> {
        match self.find(origin, direction, far) {
            Found::Nothing => None,
            Found::Curved(met) => Some(met),
            Found::Flat(distance, triangle) => {
                let (corners, surface) = self.triangle(triangle);
                let (point, normal) = on_triangle(corners, origin + distance * direction);
                Some(Meeting {
                    distance,
                    point,
                    normal,
                    smooth: self.smoothed(triangle, point).unwrap_or(normal),
                    surface,
                })
            }
        }
    }

    /// The first surface that a ray of unit direction meets, without where.
    #[inline(always)]
    pub(crate) fn find(&self, origin: Vec3, direction: Vec3, far: f32) -> Found {
        let ray = Ray {
            t_max: far,
            ..Ray::new(origin.to_array(), direction.to_array())
        };
        let flat = self.bvh.closest(&ray).map(|h| (h.t, h.triangle));
        self.nearer(flat, origin, direction, far)
    }

    /// The triangle that a ray meets, or the curved surface before it.
    #[inline(always)]
    fn nearer(&self, flat: Option<(f32, u32)>, origin: Vec3, direction: Vec3, far: f32) -> Found {
        let limit = flat.map_or(far, |h| h.0);
        if let Some((distance, k)) = self.meet_curved(origin, direction, limit) {
            let (shape, surface) = &self.parts.shapes[k];
            let point = origin + distance * direction;
            let normal = shape.normal(point);
            return Found::Curved(Meeting {
                distance,
                point,
                normal,
                smooth: normal,
                surface: *surface,
            });
        }
        flat.map_or(Found::Nothing, |(t, k)| Found::Flat(t, k))
    }

    /// The first surfaces that `count` rays meet.
    #[inline(always)]
    pub(crate) fn find_all(&self, rays: &mut Rays, count: usize, mut each: impl FnMut(usize, Found)) {
        if !self.bvh.takes_many() {
            for k in 0..count {
                each(
                    k,
                    self.find(rays.origin.get(k), rays.direction.get(k), rays.far[k]),
                );
            }
            return;
        }
        rays.turn(count, 1.0 / self.extent);
        let flat = self.bvh.closest_of_many(rays, count);
        for k in 0..count {
            let (origin, direction) = (rays.origin.get(k), rays.direction.get(k));
            each(k, self.nearer(flat.get(k), origin, direction, rays.far[k]));
        }
    }

    /// What of the light comes through on `count` ways, from their ends.
    #[inline(always)]
    pub(crate) fn pass_all(&self, rays: &mut Rays, count: usize, mut each: impl FnMut(usize, Vec3)) {
        let many = self.opaque && self.bvh.takes_many();
        let stopped = if many {
            rays.turn(count, 1.0 / self.extent);
            self.bvh.occluded_of_many(rays, count)
        } else {
            0
        };
        for k in 0..count {
            let (origin, direction, far) = (rays.origin.get(k), rays.direction.get(k), rays.far[k]);
            if !many {
                if let Some(passage) = self.passes(origin, direction, far, false) {
                    each(k, passage.left);
                }
            } else if stopped >> k & 1 == 0 && self.meet_curved(origin, direction, far).is_none() {
                each(k, Vec3::ONE);
            }
        }
    }

    /// Of `count` ways, those on which no surface lies, bit by bit.
    #[inline(always)]
    pub(crate) fn free_of_many(&self, rays: &mut Rays, count: usize) -> u64 {
        let mut free = 0_u64;
        if self.bvh.takes_many() {
            rays.turn(count, 1.0 / self.extent);
            free = !self.bvh.occluded_of_many(rays, count);
            if self.curved.is_none() {
                return free;
            }
        }
        for k in 0..count {
            let (origin, direction, far) = (rays.origin.get(k), rays.direction.get(k), rays.far[k]);
            let stopped = if self.bvh.takes_many() {
                free >> k & 1 == 0
            } else {
                self.bvh.occluded(&rays.get(k))
            };
            let open = !stopped && self.meet_curved(origin, direction, far).is_none();
            free = free & !(1 << k) | u64::from(open) << k;
        }
        free
    }

    /// The corners of a triangle and its surface.
    #[inline(always)]
    pub(crate) fn triangle(&self, k: u32) -> ([Vec3; 3], u32) {
        let corners = self.parts.triangles[k as usize].map(|v| Vec3::from(self.parts.vertices[v as usize]));
        (corners, self.parts.triangle_surface[k as usize])
    }

    #[inline(always)]
    fn meet_curved(&self, origin: Vec3, direction: Vec3, far: f32) -> Option<(f32, usize)> {
        let tree = self.curved.as_ref()?;
        self.meet_in(tree, origin, direction, far)
    }

    fn meet_in(&self, tree: &Bvh2, origin: Vec3, direction: Vec3, far: f32) -> Option<(f32, usize)> {
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
    ) -> Option<Passage> {
        if self.opaque {
            let ray = Ray {
                t_max: distance,
                ..Ray::new(origin.to_array(), direction.to_array())
            };
            let stopped = self.bvh.occluded(&ray) || self.meet_curved(origin, direction, distance).is_some();
            return (!stopped).then_some(Passage::FREE);
        }
        let Passage { mut left, mut alone } = Passage::FREE;
        let (mut from, mut far) = (origin, distance);
        for _ in 0..MOST_PANES {
            let Some(met) = self.meet(from, direction, far) else {
                return Some(Passage { left, alone });
            };
            let surface = &self.parts.surfaces[met.surface as usize];
            if from_sky && surface.concealed && met.normal.dot(direction) < 0.0 {
                return None;
            }
            if surface.proxy != 0.0 && (!from_sky || self.passes_proxy(&met, direction, true)) {
                alone |= !self.passes_proxy(&met, direction, true);
            } else {
                left *= self.straight(&met, -direction);
            }
            if let Some(k) = surface.body
                && met.normal.dot(direction) > 0.0
            {
                left *= transmittance(self.parts.bodies[k as usize].inside, met.distance);
            }
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
        let through = self.local(met, to_eye).transmitted();
        through.filter(|w| w.straight).map_or(Vec3::ZERO, |w| w.share)
    }
}

/// Light that comes straight from a light.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Passage {
    /// The share that is left.
    pub(crate) left: Vec3,
    /// Whether no scattered ray can take the same way.
    pub(crate) alone: bool,
}

impl Passage {
    const FREE: Self = Passage {
        left: Vec3::ONE,
        alone: false,
    };
}

/// Surfaces that light passes straight through on one way, at most.
pub(crate) const MOST_PANES: u32 = 64;
