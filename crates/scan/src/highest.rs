//! The highest reading over a hemisphere and how far the lobe's top may lie above it.

use gonio_geom::{Angles, DVec3, Delaunay, Direction, Side, half_slope};

use crate::Slice;
use crate::quadratic::Fitted;

/// The highest reading over one hemisphere.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Highest {
    /// Where it was read.
    pub at: Angles,
    /// Its DSF, 1/sr.
    pub value: f64,
    /// Standard uncertainty as the height of the lobe, 1/sr: that of the reading and `u_sampling`.
    pub u: f64,
    /// Part of `u` from readings that stand beside the lobe's top, 1/sr.
    pub u_sampling: f64,
}

/// The highest usable reading on `side`; `None` where there is none above zero.
///
/// The top of the lobe lies between the readings. A quadratic of `ln dsf` through the reading, its neighbours in the Delaunay
/// triangulation and theirs, weighted with the squares of their DSF, says how far above; all of it, uncorrected, counts as standard uncertainty
/// (`1 - exp(-(d / 2w)^2)` for a Gaussian read on a line at steps `d`), and so does what the residuals say of it. The quadratic is laid in the
/// plane of the half vector's slope, in which the ridge of a brushed surface is straight, or in the tangent plane, whichever fits
/// better. Where it has no top among the neighbours, half of the fall to the median of these counts.
pub fn highest(slice: &Slice, side: Side) -> Option<Highest> {
    let members: Vec<usize> = (0..slice.len())
        .filter(|&j| slice.flags[j].usable() && slice.direction(j).side() == side)
        .collect();
    let best = (0..members.len()).max_by(|&a, &b| slice.dsf[members[a]].total_cmp(&slice.dsf[members[b]]))?;
    let (reading, value) = (members[best], slice.dsf[members[best]]);
    if value <= 0.0 {
        return None;
    }
    let centre = slice.direction(reading).vec();
    // Triangles far from the top take no part in its surroundings.
    let mut near: Vec<(f64, usize)> = members
        .iter()
        .map(|&j| (slice.direction(j).vec().distance_squared(centre), j))
        .collect();
    if near.len() > NEAR {
        near.select_nth_unstable_by(NEAR, |a, b| a.0.total_cmp(&b.0));
        near.truncate(NEAR);
    }
    let members: Vec<usize> = near.into_iter().map(|n| n.1).collect();
    let u_sampling = beside_the_top(slice, side, &members, reading).unwrap_or(value);
    Some(Highest {
        at: Angles {
            theta: slice.theta_s[reading],
            phi: slice.phi_s[reading],
        },
        value,
        u: slice.u_dsf[reading].hypot(u_sampling),
        u_sampling,
    })
}

/// Readings next to the highest that are triangulated.
const NEAR: usize = 400;

fn beside_the_top(slice: &Slice, side: Side, members: &[usize], reading: usize) -> Option<f64> {
    let points: Vec<DVec3> = members.iter().map(|&j| slice.direction(j).vec()).collect();
    let mesh = Delaunay::new(&points, side).ok()?;
    let adjacency = mesh.adjacency();
    let top = members.iter().position(|&j| j == reading)?;
    let mut around: Vec<usize> = vec![top];
    for _ in 0..2 {
        let before = around.clone();
        for k in before {
            for &n in adjacency.of(k) {
                if !around.contains(&(n as usize)) {
                    around.push(n as usize);
                }
            }
        }
    }
    let value = slice.dsf[reading];
    let (e1, e2) = points[top].any_orthonormal_pair();
    let tangent = |k: usize| [points[k].dot(e1), points[k].dot(e2)];
    let wi = slice.incidence.direction();
    let slope = |k: usize| half_slope(wi, Direction::from_unit(points[k]));
    let origin = slope(top);
    let tilt = |k: usize| {
        let [x, y] = slope(k);
        [x - origin[0], y - origin[1]]
    };
    let level = |k: usize| slice.dsf[members[k]] / value;
    let next: Vec<usize> = adjacency.of(top).iter().map(|&k| k as usize).collect();
    let planes: [&dyn Fn(usize) -> [f64; 2]; 2] = [&tilt, &tangent];
    let rises = planes
        .into_iter()
        .filter_map(|place| rise(place, &level, &around, &next));
    if let Some((_, rise)) = rises.min_by(|a, b| a.0.total_cmp(&b.0)) {
        return Some(value * rise);
    }
    let mut others: Vec<f64> = next.iter().map(|&k| slice.dsf[members[k]]).collect();
    others.sort_by(f64::total_cmp);
    let median = others.get(others.len() / 2)?;
    Some(0.5 * (value - median).max(0.0))
}

/// How far the top of the quadratic of `ln level` over the points `around` lies above the origin, as a share of the level there, with
/// the uncertainty of that added in quadrature; before it the mean square of the residuals. `place` is where a point lies in a plane about
/// the highest reading. `None` where there is no top as near as the farthest of the points `next` to it.
fn rise(
    place: &dyn Fn(usize) -> [f64; 2],
    level: &dyn Fn(usize) -> f64,
    around: &[usize],
    next: &[usize],
) -> Option<(f64, f64)> {
    let rows = around
        .iter()
        .map(|&k| (place(k), level(k)))
        .filter(|([x, y], d)| *d > 1e-3 && x.is_finite() && y.is_finite())
        .map(|(x, d)| (x, d.ln(), d * d));
    if rows.clone().count() < 6 {
        return None;
    }
    let distance = |[x, y]: [f64; 2]| x.hypot(y);
    let reach = next.iter().map(|&k| distance(place(k))).fold(0.0, f64::max);
    let fitted = Fitted::through(rows)?;
    let at = fitted.quadratic.top().filter(|t| distance(*t) <= reach)?;
    // From the quadratic's own value at the reading: the noise of the reading is not counted twice.
    let above = (fitted.quadratic.at(at) - fitted.quadratic.constant).exp() - 1.0;
    Some((fitted.residual, above.max(0.0).hypot(fitted.u_rise(at))))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::slice_of;
    use gonio_geom::Direction;

    /// Readings on a raster of `pitch` about 30°, displaced by `phase` pitches, of a Gaussian lobe of 1/e half width `w`.
    fn raster(pitch: f64, phase: [f64; 2], w: f64) -> Slice {
        let axis = Direction::from_degrees(30.0, 0.0).vec();
        let (a, b) = axis.any_orthonormal_pair();
        let mut slice = slice_of(crate::testing::path_scan(60.0, 60.0, |_| 0.0));
        let points: Vec<DVec3> = (-10..=10)
            .flat_map(|k| (-10..=10).map(move |l| (f64::from(k) + phase[0], f64::from(l) + phase[1])))
            .map(|(x, y)| (axis + pitch * (x * a + 1.3 * y * b)).normalize())
            .collect();
        slice.theta_s = points.iter().map(|p| Direction::from_unit(*p).theta()).collect();
        slice.phi_s = points.iter().map(|p| Direction::from_unit(*p).phi()).collect();
        slice.dsf = points
            .iter()
            .map(|p| (-p.distance_squared(axis) / (w * w)).exp())
            .collect();
        slice.u_dsf = vec![0.0; points.len()];
        slice.flags = vec![crate::Flags::default(); points.len()];
        slice
    }

    #[test]
    fn what_the_highest_reading_lacks_of_the_lobe_is_its_uncertainty() {
        for (pitch, phase) in [(0.3, [0.5, 0.5]), (0.8, [0.4, 0.1]), (0.6, [0.1, 0.45])] {
            let found = highest(&raster(pitch * 0.05, phase, 0.05), Side::Front).unwrap();
            let missed = 1.0 - found.value;
            assert!(missed > 1e-3, "{missed}");
            assert!(
                (found.u / missed - 1.0).abs() < 0.25,
                "{pitch} {phase:?}: u {} missed {missed}",
                found.u
            );
        }
    }

    #[test]
    fn a_ridge_that_bends_on_the_sphere_is_claimed_as_one_that_is_straight() {
        // Slopes of a brushed surface, brushed 20 degrees off the plane of incidence; lines across the ridge, few readings along it.
        let wi = Direction::from_degrees(45.0, 0.0);
        let (sin, cos) = 20.0_f64.to_radians().sin_cos();
        for phase in [[0.4, 0.5], [-0.3, 0.4], [0.2, -0.35]] {
            let mut slice = raster(0.1, [0.0, 0.0], 1.0);
            slice.incidence = wi.angles();
            let mut points = Vec::new();
            let mut dsf = Vec::new();
            for k in -8..=8 {
                for l in -4..=4 {
                    // In widths.
                    let (a, b) = (0.3 * (f64::from(k) + phase[0]), 0.3 * (f64::from(l) + phase[1]));
                    let (across, along) = (0.04 * a, 0.3 * b);
                    let h =
                        DVec3::new(across * cos - along * sin, across * sin + along * cos, 1.0).normalize();
                    let d = 2.0 * wi.vec().dot(h) * h - wi.vec();
                    if d.z > 0.05 {
                        points.push(d);
                        dsf.push((-a * a - b * b).exp());
                    }
                }
            }
            slice.theta_s = points.iter().map(|p| Direction::from_unit(*p).theta()).collect();
            slice.phi_s = points.iter().map(|p| Direction::from_unit(*p).phi()).collect();
            slice.u_dsf = vec![0.0; points.len()];
            slice.flags = vec![crate::Flags::default(); points.len()];
            slice.dsf = dsf;
            let found = highest(&slice, Side::Front).unwrap();
            let missed = 1.0 - found.value;
            assert!(missed > 0.01, "{phase:?}: {missed}");
            assert!(
                (found.u / (missed * found.value) - 1.0).abs() < 0.1,
                "{phase:?}: u {} missed {missed}",
                found.u
            );
        }
    }

    #[test]
    fn a_lobe_between_sparse_readings_is_claimed_with_a_large_uncertainty() {
        let found = highest(&raster(0.15, [0.5, 0.5], 0.05), Side::Front).unwrap();
        assert!(found.u > 0.3 * found.value, "{found:?}");
    }
}
