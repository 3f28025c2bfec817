//! Where the mirror peak of a slice stands.

use gonio_geom::Direction;

use crate::Slice;
use crate::invert::invert;

/// A mirror peak found in one slice.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Peak {
    /// Index of the slice.
    pub slice: usize,
    /// Where it stands.
    pub direction: Direction,
    /// Standard uncertainty of its position on each axis, radians.
    pub u: f64,
}

/// Readings above this fraction of the peak locate it.
const ABOVE: [f64; 3] = [0.7, 0.5, 0.3];
/// Readings a peak needs above that fraction.
const READINGS: usize = 8;
/// Angle from the nominal mirror direction within which a peak may stand, radians (15 degrees).
const SEARCH: f64 = 0.261_799_387_799_149_4;
/// Ratio of peak to median below which a slice has no mirror peak.
const CONTRAST: f64 = 2.0;
/// Systematic part of a peak's position, as a fraction of its half width: shadowing and Fresnel skew broad lobes.
const SKEW: f64 = 0.03;

/// The mirror peak of `slice`: vertex of the paraboloid that `ln dsf` follows above a fraction of the maximum, in
/// the tangent plane there. `None` without a peak near the mirror direction, or with too few readings on it.
pub(super) fn locate(index: usize, slice: &Slice) -> Option<Peak> {
    let mirror = slice.incidence.direction().mirror();
    let side = slice.incidence.direction().side();
    let usable = |j: &usize| {
        let d = slice.direction(*j);
        slice.flags[*j].usable() && d.side() == side && slice.dsf[*j] > 0.0
    };
    let near: Vec<usize> = (0..slice.len())
        .filter(usable)
        .filter(|&j| slice.direction(j).angle_to(mirror) <= 1.5 * SEARCH)
        .collect();
    let top = near
        .iter()
        .copied()
        .max_by(|&a, &b| slice.dsf[a].total_cmp(&slice.dsf[b]))?;
    let mut all: Vec<f64> = (0..slice.len()).filter(usable).map(|j| slice.dsf[j]).collect();
    if slice.dsf[top] < CONTRAST * crate::robust::median(&mut all)? {
        return None;
    }
    let centre = slice.direction(top);
    let (e1, e2) = centre.vec().any_orthonormal_pair();
    for fraction in ABOVE {
        let chosen: Vec<usize> = near
            .iter()
            .copied()
            .filter(|&j| slice.dsf[j] >= fraction * slice.dsf[top])
            .collect();
        if chosen.len() < READINGS {
            continue;
        }
        let rows: Vec<([f64; 6], f64)> = chosen
            .iter()
            .map(|&j| {
                let d = slice.direction(j).vec();
                let (x, y) = (d.dot(e1), d.dot(e2));
                ([1.0, x, y, x * x, x * y, y * y], slice.dsf[j].ln())
            })
            .collect();
        let Some((x, y, u, width)) = vertex(&rows) else {
            continue;
        };
        let direction = Direction::new(centre.vec() + x * e1 + y * e2)?;
        if direction.angle_to(mirror) > SEARCH {
            return None;
        }
        return Some(Peak {
            slice: index,
            direction,
            u: u.hypot(SKEW * width),
        });
    }
    None
}

/// Maximum of the least-squares quadratic through `rows`: position, its standard error from the scatter about the
/// fit, and the half width `1 / sqrt(-curvature)`. `None` when the quadratic has no maximum.
fn vertex(rows: &[([f64; 6], f64)]) -> Option<(f64, f64, f64, f64)> {
    let mut normal = [[0.0; 6]; 6];
    let mut right = [0.0; 6];
    for (a, y) in rows {
        for i in 0..6 {
            right[i] += a[i] * y;
            for j in 0..6 {
                normal[i][j] += a[i] * a[j];
            }
        }
    }
    let inverse = invert(normal)?;
    let c: [f64; 6] = std::array::from_fn(|i| (0..6).map(|j| inverse[i][j] * right[j]).sum());
    let determinant = 4.0 * c[3] * c[5] - c[4] * c[4];
    if c[3] >= 0.0 || determinant <= 0.0 {
        return None;
    }
    let x = (c[4] * c[2] - 2.0 * c[5] * c[1]) / determinant;
    let y = (c[4] * c[1] - 2.0 * c[3] * c[2]) / determinant;
    let square: f64 = rows
        .iter()
        .map(|(a, v)| (v - (0..6).map(|k| a[k] * c[k]).sum::<f64>()).powi(2))
        .sum();
    let scatter = square / (rows.len().max(7) - 6) as f64;
    let curvature = determinant.sqrt(); // geometric mean of the two, of the sign-reversed quadratic's Hessian
    let slope_variance = scatter * 0.5 * (inverse[1][1] + inverse[2][2]);
    Some((x, y, slope_variance.sqrt() / curvature, 1.0 / curvature.sqrt()))
}
