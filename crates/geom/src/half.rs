//! The half vector of incidence and exit.

use crate::Direction;

/// Slope `(x / z, y / z)` of the half vector of `wi` and `ws`, each taken to the front: the slope of the facet that mirrors one into
/// the other (of transmission: into its image in the sample plane).
///
/// Lobes of microfacet models keep their shape in this plane at every incidence: a lobe of Gaussian slopes is a Gaussian, and the
/// ridge of a brushed surface, which bends on the sphere, is straight. Not finite where both directions lie in the sample plane.
pub fn half_slope(wi: Direction, ws: Direction) -> [f64; 2] {
    let (a, b) = (wi.vec(), ws.vec());
    let z = a.z.abs() + b.z.abs();
    [(a.x + b.x) / z, (a.y + b.y) / z]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_mirror_and_the_through_direction_have_slope_zero() {
        for theta in [0.0, 40.0, 140.0] {
            let wi = Direction::from_degrees(theta, 25.0);
            for ws in [wi.mirror(), wi.through()] {
                let [x, y] = half_slope(wi, ws);
                assert!(x.hypot(y) < 1e-15);
            }
        }
    }

    #[test]
    fn a_tilted_facet_has_its_own_slope() {
        let wi = Direction::from_degrees(50.0, 0.0);
        let normal = crate::DVec3::new(0.1, -0.2, 1.0).normalize();
        let ws = Direction::from_unit(2.0 * wi.vec().dot(normal) * normal - wi.vec());
        let [x, y] = half_slope(wi, ws);
        assert!((x - 0.1).abs() < 1e-14 && (y + 0.2).abs() < 1e-14);
    }
}
