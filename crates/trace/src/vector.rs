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
#[inline(always)]
pub(crate) fn cosine_weighted([u, v]: [f32; 2]) -> Vec3 {
    let (r, [c, s]) = (u.sqrt(), on_circle(v));
    Vec3::new(r * c, r * s, (1.0 - u).max(0.0).sqrt())
}

/// A direction about `z` within a cone, evenly over the solid angle `2 pi (1 - cos)`.
#[inline(always)]
pub(crate) fn in_cone(one_minus_cos: f32, [u, v]: [f32; 2]) -> Vec3 {
    let drop = u * one_minus_cos;
    let sin = (drop * (2.0 - drop)).max(0.0).sqrt();
    let [c, s] = on_circle(v);
    Vec3::new(sin * c, sin * s, 1.0 - drop)
}

/// Cosine and sine of a whole turn times `v` in `[0, 1]`, within 1e-7: Taylor's polynomials over an eighth of a turn to
/// either side of each axis. Without a branch, for loops over many.
#[inline(always)]
fn on_circle(v: f32) -> [f32; 2] {
    let quarter = (4.0 * v + 0.5).floor();
    let x = (v - 0.25 * quarter) * std::f32::consts::TAU;
    let y = x * x;
    let sin = x * (1.0 + y * (-1.0 / 6.0 + y * (1.0 / 120.0 + y * (-1.0 / 5040.0))));
    let cos = 1.0 + y * (-0.5 + y * (1.0 / 24.0 + y * (-1.0 / 720.0 + y * (1.0 / 40320.0))));
    let odd = (quarter == 1.0) | (quarter == 3.0);
    let (a, b) = if odd { (sin, cos) } else { (cos, sin) };
    [
        if (quarter == 1.0) | (quarter == 2.0) {
            -a
        } else {
            a
        },
        if (quarter == 2.0) | (quarter == 3.0) {
            -b
        } else {
            b
        },
    ]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_circle_is_round_to_single_precision() {
        for k in 0..=100_000 {
            let v = k as f32 / 100_000.0;
            let (s, c) = (std::f64::consts::TAU * f64::from(v)).sin_cos();
            let [x, y] = on_circle(v);
            assert!(
                (f64::from(x) - c).abs() < 4e-7 && (f64::from(y) - s).abs() < 4e-7,
                "{v}: {x} {c} {y} {s}"
            );
        }
    }
}
