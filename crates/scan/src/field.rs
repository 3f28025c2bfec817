//! A slice as a function of direction, for comparing slices with one another.

use gonio_geom::{DVec3, Delaunay, Direction, Side};

use crate::Slice;

/// A value with the independent part of its standard uncertainty.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Value {
    pub(crate) f: f64,
    pub(crate) u: f64,
}

/// Linear interpolation of the BSDF between the usable readings of a slice, not across holes.
pub(crate) struct Field<'a> {
    slice: &'a Slice,
    halves: Vec<Half>,
}

struct Half {
    side: Side,
    members: Vec<u32>,
    points: Vec<DVec3>,
    mesh: Delaunay,
    /// Longest edge that is interpolated over, as a chord squared.
    longest: f64,
}

/// Distance of readings, times this, that still counts as measured ground between them.
const GAP: f64 = 2.5;

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
                let mesh = Delaunay::new(&points, side).ok()?;
                let longest = (GAP * even_spacing(points.len())).clamp(0.1, 1.0);
                Some(Half {
                    side,
                    members,
                    points,
                    mesh,
                    longest: longest * longest,
                })
            })
            .collect();
        Field { slice, halves }
    }

    /// The BSDF at `d`; `None` where the readings around it are missing or too far apart.
    pub(crate) fn at(&self, d: Direction) -> Option<Value> {
        let half = self.halves.iter().find(|h| h.side == d.side())?;
        let found = half.mesh.locate(d.vec(), 0)?;
        let [a, b, c] = found.vertices.map(|v| half.points[v as usize]);
        let longest = a
            .distance_squared(b)
            .max(b.distance_squared(c))
            .max(c.distance_squared(a));
        if longest > half.longest {
            return None;
        }
        let (mut f, mut u2) = (0.0, 0.0);
        for (v, w) in found.vertices.iter().zip(found.weights) {
            let j = half.members[*v as usize] as usize;
            f += w * self.slice.bsdf(j);
            u2 += (w * self.slice.u_independent(j) / self.slice.theta_s[j].cos()).powi(2);
        }
        Some(Value { f, u: u2.sqrt() })
    }
}
