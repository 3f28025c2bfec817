//! Points of several paths, coordinate by coordinate: what is computed of all of them at once.
//!
//! The loops run over whole blocks of lanes without a branch, so that the compiler makes them of vector instructions; lanes
//! that no path uses hold anything, and nobody looks at them.

use glam::Vec3;

use crate::bvh::Ray;
use crate::scene::{Meeting, Scene};
use crate::vector::Frame;

/// Most paths at once.
pub(crate) const LANES: usize = 64;
/// Lanes are computed in blocks of so many.
const BLOCK: usize = 8;
/// Rays are followed in blocks of so many, at most.
const WIDEST: usize = 16;

/// Lanes to compute for `count` paths.
#[inline(always)]
pub(crate) fn blocks(count: usize) -> usize {
    count.next_multiple_of(BLOCK).min(LANES)
}

/// A vector of each path.
#[derive(Clone, Copy)]
#[repr(C, align(64))]
pub(crate) struct Vectors {
    x: [f32; LANES],
    y: [f32; LANES],
    z: [f32; LANES],
}

impl Default for Vectors {
    fn default() -> Self {
        Vectors {
            x: [0.0; LANES],
            y: [0.0; LANES],
            z: [0.0; LANES],
        }
    }
}

impl Vectors {
    #[inline(always)]
    pub(crate) fn get(&self, k: usize) -> Vec3 {
        Vec3::new(self.x[k], self.y[k], self.z[k])
    }

    pub(crate) fn rows(&self) -> [&[f32; LANES]; 3] {
        [&self.x, &self.y, &self.z]
    }

    #[inline(always)]
    pub(crate) fn set(&mut self, k: usize, v: Vec3) {
        self.x[k] = v.x;
        self.y[k] = v.y;
        self.z[k] = v.z;
    }
}

/// Rays of unit direction.
pub(crate) struct Rays {
    pub(crate) origin: Vectors,
    pub(crate) direction: Vectors,
    /// At right angles to the direction and each other, and of one length; [`Rays::turn`] finds both.
    pub(crate) across: Vectors,
    pub(crate) aside: Vectors,
    /// Nothing beyond is met.
    pub(crate) far: [f32; LANES],
}

impl Default for Rays {
    fn default() -> Self {
        Rays {
            origin: Vectors::default(),
            direction: Vectors::default(),
            across: Vectors::default(),
            aside: Vectors::default(),
            far: [0.0; LANES],
        }
    }
}

impl Rays {
    #[inline(always)]
    pub(crate) fn set(&mut self, k: usize, origin: Vec3, direction: Vec3, far: f32) {
        self.origin.set(k, origin);
        self.direction.set(k, direction);
        self.far[k] = far;
    }

    pub(crate) fn get(&self, k: usize) -> Ray {
        Ray {
            t_max: self.far[k],
            ..Ray::new(self.origin.get(k).to_array(), self.direction.get(k).to_array())
        }
    }

    /// The frames of the first `count` rays, with axes of a length across them; the lanes of their last block beyond them meet nothing,
    /// whatever their frames are.
    #[inline(always)]
    pub(crate) fn turn(&mut self, count: usize, length: f32) {
        for k in 0..blocks(count) {
            let frame = Frame::about(self.direction.get(k));
            self.across.set(k, length * frame.x);
            self.aside.set(k, length * frame.y);
        }
        self.far[count..count.next_multiple_of(WIDEST).min(LANES)].fill(-1.0);
    }
}

/// What the paths meet.
pub(crate) struct Hits {
    corners: [Vectors; 3],
    point: Vectors,
    normal: Vectors,
    distance: [f32; LANES],
    surface: [u32; LANES],
    triangle: [u32; LANES],
    kind: [Kind; LANES],
}

#[derive(Clone, Copy, PartialEq, Eq)]
#[repr(u32)]
enum Kind {
    Nothing,
    Flat,
    Curved,
}

impl Default for Hits {
    fn default() -> Self {
        Hits {
            corners: [Vectors::default(); 3],
            point: Vectors::default(),
            normal: Vectors::default(),
            distance: [0.0; LANES],
            surface: [0; LANES],
            triangle: [0; LANES],
            kind: [Kind::Nothing; LANES],
        }
    }
}

impl Hits {
    /// Lane `k` meets nothing.
    #[inline(always)]
    pub(crate) fn nothing(&mut self, k: usize) {
        self.kind[k] = Kind::Nothing;
    }

    /// Lane `k` meets a curved surface.
    #[inline(always)]
    pub(crate) fn curved(&mut self, k: usize, met: &Meeting) {
        self.kind[k] = Kind::Curved;
        self.point.set(k, met.point);
        self.normal.set(k, met.normal);
        self.distance[k] = met.distance;
        self.surface[k] = met.surface;
    }

    /// Lane `k` meets a triangle; [`Hits::compute`] finds where.
    #[inline(always)]
    pub(crate) fn flat(&mut self, k: usize, triangle: u32, corners: [Vec3; 3], distance: f32, surface: u32) {
        self.triangle[k] = triangle;
        self.kind[k] = Kind::Flat;
        for (all, corner) in self.corners.iter_mut().zip(corners) {
            all.set(k, corner);
        }
        self.distance[k] = distance;
        self.surface[k] = surface;
    }

    /// The points and normals of the triangles that the first `count` lanes meet.
    #[inline(always)]
    pub(crate) fn compute(&mut self, rays: &Rays, count: usize) {
        for k in 0..blocks(count) {
            let corners = [
                self.corners[0].get(k),
                self.corners[1].get(k),
                self.corners[2].get(k),
            ];
            let at = rays.origin.get(k) + self.distance[k] * rays.direction.get(k);
            let (point, normal) = on_triangle(corners, at);
            let flat = self.kind[k] == Kind::Flat;
            self.point.set(k, if flat { point } else { self.point.get(k) });
            self.normal.set(k, if flat { normal } else { self.normal.get(k) });
        }
    }

    /// The point and normal of lane `k`, if it meets anything.
    #[inline(always)]
    pub(crate) fn place(&self, k: usize) -> (Vec3, Vec3) {
        (self.point.get(k), self.normal.get(k))
    }

    /// What lane `k` meets in a scene.
    #[inline(always)]
    pub(crate) fn meeting(&self, k: usize, scene: &Scene) -> Option<Meeting> {
        let (point, normal) = self.place(k);
        let smooth = match self.kind[k] {
            Kind::Nothing => return None,
            Kind::Flat => scene.smoothed(self.triangle[k], point).unwrap_or(normal),
            Kind::Curved => normal,
        };
        Some(Meeting {
            distance: self.distance[k],
            point,
            normal,
            smooth,
            surface: self.surface[k],
        })
    }
}

/// The point of the plane of a triangle that is nearest to `at`, and its unit normal: along a ray, a point lies off it by
/// what the distance is rounded.
#[inline(always)]
pub(crate) fn on_triangle([a, b, c]: [Vec3; 3], at: Vec3) -> (Vec3, Vec3) {
    let across = (b - a).cross(c - a);
    let scale = 1.0 / across.length();
    // Of one so small that its area is lost in rounding, any.
    let normal = if scale.is_finite() {
        across * scale
    } else {
        Vec3::Z
    };
    let off = if scale.is_finite() {
        normal.dot(at - a)
    } else {
        0.0
    };
    (at - off * normal, normal)
}
