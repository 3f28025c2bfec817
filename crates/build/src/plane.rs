//! The plane in which slices are triangulated and tabulated: the stereographic projection of one hemisphere.
//!
//! `p = (x, y) / (1 + z)` maps the upper hemisphere onto the unit disk. Circles stay circles, so a planar Delaunay
//! triangulation of the images is the spherical one; angles stay angles, so nothing is stretched in one direction;
//! and cells of equal side get finer towards the horizon, where lobes get narrower.

use gonio_geom::DVec3;

/// A point of the plane.
pub(crate) type Point = [f64; 2];

/// The image of a unit vector with `z > -1`.
pub(crate) fn to_plane(v: DVec3) -> Point {
    let k = 1.0 / (1.0 + v.z);
    [v.x * k, v.y * k]
}

/// The unit vector of a point: the inverse of [`to_plane`].
pub(crate) fn from_plane(p: Point) -> DVec3 {
    let r2 = p[0] * p[0] + p[1] * p[1];
    let k = 2.0 / (1.0 + r2);
    DVec3::new(p[0] * k, p[1] * k, k - 1.0)
}

/// `p` pulled back to the disk of `radius` when it lies outside.
pub(crate) fn into_disk(p: Point, radius: f64) -> Point {
    let r2 = p[0] * p[0] + p[1] * p[1];
    if r2 <= radius * radius {
        return p;
    }
    let k = radius / r2.sqrt();
    [p[0] * k, p[1] * k]
}

/// Solid angle a small area of the plane stands for, per unit area, at `p`.
pub(crate) fn solid_angle_density(p: Point) -> f64 {
    let k = 2.0 / (1.0 + p[0] * p[0] + p[1] * p[1]);
    k * k
}

#[cfg(test)]
mod tests {
    use super::*;
    use gonio_geom::Direction;

    #[test]
    fn the_projection_and_its_inverse_cancel() {
        for (theta, phi) in [(0.0, 0.0), (30.0, 40.0), (89.9, 200.0), (90.0, 359.0)] {
            let v = Direction::from_degrees(theta, phi).vec();
            assert!((from_plane(to_plane(v)) - v).length() < 1e-14);
        }
    }

    #[test]
    fn the_solid_angle_of_the_disk_is_two_pi() {
        let n = 2000;
        let sum: f64 = (0..n)
            .map(|k| {
                let r = (k as f64 + 0.5) / n as f64;
                solid_angle_density([r, 0.0]) * std::f64::consts::TAU * r / n as f64
            })
            .sum();
        assert!((sum - std::f64::consts::TAU).abs() < 1e-6);
    }
}
