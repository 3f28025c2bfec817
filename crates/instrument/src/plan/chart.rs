//! Planes in which lobes are laid out.

use gonio_geom::{Component, DVec3, Direction, Side, half_slope};

/// A map between a plane and the directions of one hemisphere.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Chart {
    /// The slope of the half vector of incidence and exit: lobes about the mirror direction keep their shape in it at every
    /// incidence, so that a step across the plane of incidence shrinks as `cos theta_i` on the sphere, and the ridge of a
    /// brushed surface is straight. Transmission: exit mirrored in the sample plane.
    Slope { wi: DVec3, side: Side },
    /// Angle and azimuth about a direction.
    Tangent { centre: DVec3, side: Side },
}

/// `d` as seen from the other side of the sample where `side` is the back.
fn to_front(d: DVec3, side: Side) -> DVec3 {
    DVec3::new(d.x, d.y, d.z * side.sign())
}

impl Chart {
    /// The slope plane for light from `wi` scattered by `component`.
    pub(super) fn slope(wi: Direction, component: Component) -> Chart {
        Chart::Slope {
            wi: to_front(wi.vec(), wi.side()),
            side: component.scattered_side(wi.side()),
        }
    }

    /// The plane about `centre`.
    pub(super) fn tangent(centre: Direction) -> Chart {
        Chart::Tangent {
            centre: centre.vec(),
            side: centre.side(),
        }
    }

    fn side(&self) -> Side {
        match self {
            Chart::Slope { side, .. } | Chart::Tangent { side, .. } => *side,
        }
    }

    /// The direction at a point of the plane; `None` where it lies beyond the horizon.
    pub(super) fn direction(&self, [x, y]: [f64; 2]) -> Option<Direction> {
        let d = match *self {
            Chart::Slope { wi, side } => {
                let h = DVec3::new(x, y, 1.0).normalize();
                let facing = wi.dot(h);
                if facing <= 0.0 {
                    return None;
                }
                to_front(2.0 * facing * h - wi, side)
            }
            Chart::Tangent { centre, .. } => {
                let (a, b) = centre.any_orthonormal_pair();
                let r = x.hypot(y);
                if r >= std::f64::consts::PI {
                    return None;
                }
                let sinc = if r > 0.0 { r.sin() / r } else { 1.0 };
                r.cos() * centre + sinc * (x * a + y * b)
            }
        };
        let d = Direction::new(d)?;
        (d.side() == self.side() && d.cos_theta() != 0.0).then_some(d)
    }

    /// The point of the plane for a direction of its hemisphere.
    pub(super) fn point(&self, d: Direction) -> [f64; 2] {
        match *self {
            Chart::Slope { wi, .. } => half_slope(Direction::from_unit(wi), d),
            Chart::Tangent { centre, .. } => {
                let (a, b) = centre.any_orthonormal_pair();
                let (x, y) = (d.vec().dot(a), d.vec().dot(b));
                let sin = x.hypot(y);
                let r = sin.atan2(d.vec().dot(centre));
                let scale = if sin > 0.0 { r / sin } else { 1.0 };
                [scale * x, scale * y]
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn points_of_both_planes_come_back() {
        let wi = Direction::from_degrees(60.0, 20.0);
        for component in [Component::Reflection, Component::Transmission] {
            let side = component.scattered_side(wi.side());
            let centre = Direction::from_degrees(if side == Side::Front { 50.0 } else { 130.0 }, 190.0);
            for chart in [Chart::slope(wi, component), Chart::tangent(centre)] {
                for point in [[0.0, 0.0], [0.1, -0.1], [0.05, 0.1]] {
                    let d = chart.direction(point).unwrap();
                    let back = chart.point(d);
                    assert!(
                        (back[0] - point[0]).hypot(back[1] - point[1]) < 1e-12,
                        "{chart:?} {point:?}"
                    );
                    assert_eq!(d.side(), side);
                }
            }
        }
    }

    #[test]
    fn a_step_across_the_plane_of_incidence_shrinks_as_the_cosine() {
        for theta in [0.0_f64, 40.0, 75.0] {
            let wi = Direction::from_degrees(theta, 0.0);
            let chart = Chart::slope(wi, Component::Reflection);
            let step = 1e-4;
            let angle = |p| chart.direction(p).unwrap().angle_to(wi.mirror());
            assert!((angle([step, 0.0]) / (2.0 * step) - 1.0).abs() < 1e-3);
            assert!((angle([0.0, step]) / (2.0 * step * theta.to_radians().cos()) - 1.0).abs() < 1e-3);
        }
    }
}
