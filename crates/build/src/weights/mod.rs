//! How much each measured incidence counts at a query: natural neighbours, and a guarded local quadratic.
//!
//! Both work in the plane `theta (cos phi, sin phi)` of directions of incidence, scaled to the unit disk, and both
//! reproduce functions that are linear in it; the quadratic reproduces parabolas too.

mod natural;
mod quadratic;

use std::f64::consts::FRAC_2_PI;

use gonio_geom::DVec3;

use crate::plane::Point;

pub(crate) use natural::Natural;
pub(crate) use quadratic::{cubic, monomials, quadratic};

/// Most points that count at a query.
pub(crate) const MOST: usize = 16;

/// The image of a direction of the upper hemisphere in the plane of incidences.
#[inline]
pub(crate) fn to_incidence_plane(v: DVec3) -> Point {
    let r = v.x.hypot(v.y);
    let theta = r.atan2(v.z);
    let k = if r > 1e-12 {
        FRAC_2_PI * theta / r
    } else {
        FRAC_2_PI
    };
    [v.x * k, v.y * k]
}

/// Points and their weights, at most [`MOST`].
#[derive(Clone, Copy, Debug)]
pub(crate) struct Weights {
    list: [(usize, f64); MOST],
    count: usize,
}

impl Weights {
    pub(crate) const NONE: Weights = Weights {
        list: [(0, 0.0); MOST],
        count: 0,
    };

    pub(crate) fn as_slice(&self) -> &[(usize, f64)] {
        &self.list[..self.count]
    }

    /// Adds to the weight of a point; past [`MOST`] points the least one gives way.
    fn add(&mut self, point: usize, weight: f64) {
        let known = self.list[..self.count].iter_mut().find(|w| w.0 == point);
        if let Some(known) = known {
            known.1 += weight;
        } else if self.count < MOST {
            self.list[self.count] = (point, weight);
            self.count += 1;
        } else if let Some(least) = self
            .list
            .iter_mut()
            .min_by(|a, b| a.1.abs().total_cmp(&b.1.abs()))
            && least.1.abs() < weight.abs()
        {
            *least = (point, weight);
        }
    }

    /// The weights times a linear function of the plane, so that they add up to 1 and their mean point is `p`; `None`
    /// when the points lie on a line or the correction is not small.
    fn linear_about(mut self, points: &[Point], p: Point) -> Option<Self> {
        let sum: f64 = self.as_slice().iter().map(|w| w.1).sum();
        if !sum.is_finite() || sum.abs() < 1e-300 {
            return None;
        }
        let list = &mut self.list[..self.count];
        let (mut x, mut y, mut xx, mut xy, mut yy) = (0.0, 0.0, 0.0, 0.0, 0.0);
        for (k, w) in list.iter_mut() {
            *w /= sum;
            let d = [points[*k][0] - p[0], points[*k][1] - p[1]];
            x += *w * d[0];
            y += *w * d[1];
            xx += *w * d[0] * d[0];
            xy += *w * d[0] * d[1];
            yy += *w * d[1] * d[1];
        }
        // Factor a + b dx + c dy with a + b x + c y = 1, a x + b xx + c xy = 0, a y + b xy + c yy = 0.
        let det = (xx * yy - xy * xy) - x * (x * yy - y * xy) + y * (x * xy - y * xx);
        if det.abs() <= 1e-9 * xx * yy {
            return None;
        }
        let a = (xx * yy - xy * xy) / det;
        let b = (y * xy - x * yy) / det;
        let c = (x * xy - y * xx) / det;
        for (k, w) in list.iter_mut() {
            *w *= a + b * (points[*k][0] - p[0]) + c * (points[*k][1] - p[1]);
            if !(-0.1..=1.1).contains(w) {
                return None;
            }
        }
        Some(self)
    }
}

#[cfg(test)]
pub(crate) mod tests {
    use super::*;
    use gonio_geom::Direction;

    /// A polar grid of incidences with the normal.
    pub(crate) fn grid() -> Vec<Point> {
        let mut points = vec![[0.0, 0.0]];
        for theta in [15.0, 30.0, 45.0, 60.0, 75.0] {
            for k in 0..16 {
                let d = Direction::from_degrees(theta, 22.5 * f64::from(k));
                points.push(to_incidence_plane(d.vec()));
            }
        }
        points
    }

    /// Queries all over the grid, on its lines too.
    pub(crate) fn queries() -> impl Iterator<Item = Point> {
        let angles = [0.0, 5.0, 11.25, 22.5, 45.0, 90.0, 123.4, 180.0, 250.0];
        [1.0, 7.5, 15.01, 22.5, 37.5, 44.9, 60.5, 70.0]
            .into_iter()
            .flat_map(move |t| angles.map(|p| to_incidence_plane(Direction::from_degrees(t, p).vec())))
    }

    #[test]
    fn the_distance_from_the_origin_is_the_polar_angle() {
        let p = to_incidence_plane(Direction::from_degrees(63.0, 200.0).vec());
        assert!((p[0].hypot(p[1]) - 0.7).abs() < 1e-12);
        assert_eq!(to_incidence_plane(DVec3::Z), [0.0, 0.0]);
    }
}
