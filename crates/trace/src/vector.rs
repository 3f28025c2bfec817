//! Directions in the frame of a surface.

use glam::{DVec3, Vec3};
use gonio_geom::Direction;

/// Right-handed axes of a surface in world coordinates: `z` is its front normal.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Frame {
    /// Where azimuth 0 points.
    pub x: Vec3,
    /// Where azimuth 90 degrees points.
    pub y: Vec3,
    /// The normal of the front.
    pub z: Vec3,
}

impl Frame {
    /// Axes about a unit normal, at no particular azimuth.
    pub fn about(z: Vec3) -> Self {
        let (x, y) = z.any_orthonormal_pair();
        Frame { x, y, z }
    }

    /// Axes about a unit normal with `y` in the plane of `z` and `up`, as RADIANCE orients a BSDF; at no particular azimuth
    /// where `up` is parallel to it.
    pub fn upright(z: Vec3, up: Vec3) -> Self {
        match up.cross(z).try_normalize() {
            Some(x) => Frame { x, y: z.cross(x), z },
            None => Frame::about(z),
        }
    }

    /// A world direction in the frame.
    #[inline]
    pub fn local(&self, v: Vec3) -> Vec3 {
        Vec3::new(v.dot(self.x), v.dot(self.y), v.dot(self.z))
    }

    /// A local direction in the world.
    #[inline]
    pub fn world(&self, v: Vec3) -> Vec3 {
        v.x * self.x + v.y * self.y + v.z * self.z
    }

    /// A world unit vector as a direction of the frame, in double precision.
    #[inline]
    pub fn direction(&self, v: Vec3) -> Direction {
        let l = self.local(v);
        Direction::from_unit(DVec3::new(l.x.into(), l.y.into(), l.z.into()).normalize())
    }

    /// A direction of the frame in the world.
    #[inline]
    pub fn vector(&self, d: Direction) -> Vec3 {
        self.world(d.vec().as_vec3())
    }
}

/// A direction about `z` with density `cos / pi`.
#[inline]
pub(crate) fn cosine_weighted([u, v]: [f32; 2]) -> Vec3 {
    let (r, (s, c)) = (u.sqrt(), (std::f32::consts::TAU * v).sin_cos());
    Vec3::new(r * c, r * s, (1.0 - u).max(0.0).sqrt())
}

/// A direction about `z` within a cone, evenly over the solid angle `2 pi (1 - cos)`.
#[inline]
pub(crate) fn in_cone(one_minus_cos: f32, [u, v]: [f32; 2]) -> Vec3 {
    let drop = u * one_minus_cos;
    let sin = (drop * (2.0 - drop)).max(0.0).sqrt();
    let (s, c) = (std::f32::consts::TAU * v).sin_cos();
    Vec3::new(sin * c, sin * s, 1.0 - drop)
}
