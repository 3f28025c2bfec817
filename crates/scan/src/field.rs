//! A slice as a function of direction, for comparing slices with one another.

use gonio_geom::{DVec3, Delaunay, Direction, Side};

use crate::Slice;
use crate::local::gradients;

/// An interpolated value with the independent parts of its standard uncertainty.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Value {
    pub(crate) f: f64,
    /// From the noise of the readings around.
    pub(crate) noise: f64,
    /// From the interpolation between them.
    pub(crate) interpolation: f64,
}

impl Value {
    pub(crate) fn u(&self) -> f64 {
        self.noise.hypot(self.interpolation)
    }
}

/// The BSDF between the usable readings of a slice, not across holes.
pub(crate) struct Field<'a> {
    slice: &'a Slice,
    halves: Vec<Half>,
}

struct Half {
    side: Side,
    members: Vec<u32>,
    points: Vec<DVec3>,
    /// BSDF at each point and its gradient over the sphere.
    values: Vec<f64>,
    slopes: Vec<DVec3>,
    mesh: Delaunay,
    /// Longest edge that is interpolated over, as a chord squared.
    longest: f64,
}

/// Distance of readings, times this, that still counts as measured ground between them.
const GAP: f64 = 2.5;
/// Error of the second-order estimate as a fraction of the first-order one's: on the safe side where neighbours
/// resolve a lobe (see the test).
const THIRD_ORDER: f64 = 0.25;
/// A reading within this angle of a direction is a reading of that direction, radians.
const AT: f64 = 1e-4;

/// Mean angular distance of `n` readings spread evenly over a hemisphere, radians.
pub(crate) fn even_spacing(n: usize) -> f64 {
    (std::f64::consts::TAU / n.max(1) as f64).sqrt()
}

impl<'a> Field<'a> {
    pub(crate) fn new(slice: &'a Slice) -> Self {
        let halves = Side::BOTH
            .into_iter()
            .filter_map(|side| {
                let members: Vec<u32> = (0..slice.len())
                    .filter(|&j| {
                        let d = slice.direction(j);
                        slice.flags[j].usable() && d.side() == side && d.cos_theta().abs() > 1e-3
                    })
                    .map(|j| j as u32)
                    .collect();
                let points: Vec<DVec3> = members
                    .iter()
                    .map(|&j| slice.direction(j as usize).vec())
                    .collect();
                let values: Vec<f64> = members.iter().map(|&j| slice.bsdf(j as usize)).collect();
                let mesh = Delaunay::new(&points, side).ok()?;
                let slopes = gradients(&mesh, &points, &values);
                let longest = (GAP * even_spacing(points.len())).clamp(0.1, 1.0);
                Some(Half {
                    side,
                    members,
                    points,
                    values,
                    slopes,
                    mesh,
                    longest: longest * longest,
                })
            })
            .collect();
        Field { slice, halves }
    }

    /// The BSDF at `d`; `None` where the readings around it are missing or too far apart.
    ///
    /// With values `f_k`, gradients `g_k`, barycentric weights `w_k` and ways `d_k` from the corners of the triangle
    /// around `d`, `f = sum w_k (f_k + g_k . d_k / 2)` is exact for a quadratic function. The corners' own first-order
    /// predictions `f_k + g_k . d_k` are off by half the second derivative along `d_k`: a quarter of their rms
    /// distance from `f`, less what noise explains, is taken as the standard uncertainty of the interpolation (`f`
    /// itself is off by third-order terms only). At a reading it is zero.
    pub(crate) fn at(&self, d: Direction) -> Option<Value> {
        let half = self.halves.iter().find(|h| h.side == d.side())?;
        let found = half.mesh.locate(d.vec(), 0)?;
        let corner = found.vertices.map(|v| v as usize);
        let [a, b, c] = corner.map(|v| half.points[v]);
        let longest = a
            .distance_squared(b)
            .max(b.distance_squared(c))
            .max(c.distance_squared(a));
        if longest > half.longest {
            return None;
        }
        let rise = corner.map(|v| half.slopes[v].dot(d.vec() - half.points[v]));
        let sigma = corner.map(|v| {
            let j = half.members[v] as usize;
            self.slice.u_independent(j) / self.slice.theta_s[j].cos().abs()
        });
        let (mut f, mut noise2) = (0.0, 0.0);
        for (k, w) in found.weights.into_iter().enumerate() {
            f += w * (half.values[corner[k]] + 0.5 * rise[k]);
            noise2 += (w * sigma[k]).powi(2);
        }
        let mut spread = 0.0;
        for (k, w) in found.weights.into_iter().enumerate() {
            let off = half.values[corner[k]] + rise[k] - f;
            // Value and gradient of a corner each bring about the variance of one reading.
            spread += w * (off * off - 2.0 * sigma[k] * sigma[k]);
        }
        Some(Value {
            f,
            noise: noise2.sqrt(),
            interpolation: THIRD_ORDER * spread.max(0.0).sqrt(),
        })
    }

    /// Whether a reading was taken in the direction `d` itself.
    pub(crate) fn read_at(&self, d: Direction) -> bool {
        let half = self.halves.iter().find(|h| h.side == d.side());
        half.and_then(|h| Some((h, h.mesh.locate(d.vec(), 0)?)))
            .is_some_and(|(h, found)| {
                found
                    .vertices
                    .iter()
                    .any(|&v| h.points[v as usize].distance(d.vec()) < AT)
            })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::{slice_of, spiral_scan};

    fn lobe(d: Direction) -> f64 {
        let gamma = d.angle_to(Direction::from_degrees(20.0, 40.0));
        (-(gamma / 0.12).powi(2)).exp() * d.cos_theta()
    }

    #[test]
    fn the_stated_interpolation_uncertainty_covers_the_error_on_the_flanks_of_a_lobe() {
        let slice = slice_of(spiral_scan(0.0, 0.0, 5000, Side::Front, lobe));
        let field = Field::new(&slice);
        let (mut inside, mut n, mut square, mut claimed) = (0, 0, 0.0, 0.0);
        for i in 0..4000 {
            let d =
                Direction::from_degrees(20.0 + 20.0 * (f64::from(i) * 0.618).fract(), f64::from(i) * 0.09);
            let truth = lobe(d) / d.cos_theta();
            let Some(v) = field.at(d).filter(|_| truth > 1e-3) else {
                continue;
            };
            n += 1;
            inside += i32::from((v.f - truth).abs() <= 2.0 * v.u());
            square += (v.f - truth).powi(2);
            claimed += v.u().powi(2);
        }
        assert!(n > 500, "{n}");
        assert!(f64::from(inside) > 0.95 * f64::from(n), "{inside} of {n}");
        // Not a bound that everything would meet: the claim stays within a factor of four of the rms error.
        assert!(claimed < 16.0 * square, "{claimed} {square}");
    }

    #[test]
    fn a_reading_is_returned_as_it_is() {
        let slice = slice_of(spiral_scan(0.0, 0.0, 500, Side::Front, lobe));
        let field = Field::new(&slice);
        for j in (10..400).step_by(13) {
            let v = field.at(slice.direction(j)).unwrap();
            assert!((v.f - slice.bsdf(j)).abs() < 1e-9 * slice.bsdf(j).abs().max(1e-6));
            assert!(v.interpolation < 1e-6 && field.read_at(slice.direction(j)));
        }
        assert!(!field.read_at(Direction::from_degrees(45.1, 0.3)));
    }
}
