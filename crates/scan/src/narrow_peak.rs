//! Peaks as narrow as the beam that stand between the readings.

use gonio_geom::{DVec3, Side};

use crate::Slice;
use crate::invert::invert;

/// A peak above whose half maximum more readings stand is resolved.
const FEW: usize = 6;
/// Readings below this fraction of the highest one tell nothing about a peak as narrow as the beam.
const LOWEST: f64 = 1e-3;
/// A peak stands out of what lies around it by this factor.
const CONTRAST: f64 = 5.0;
/// Readings that a fit of position and height needs.
const LEAST: usize = 3;

/// Adds to the uncertainty of the integrals what a peak as narrow as the beam holds beside what its readings count.
///
/// Where the highest readings of a side are few and stand out, a Gaussian of the beam's `second_moment` (rad^2) is laid
/// through them, or a wider one that fits, which gives its place and its flux; the difference to the flux that these readings count in the
/// integral is a standard uncertainty of the quadrature. With readings a third of the beam's width apart it is nothing.
pub(crate) fn add_uncertainty(slice: &mut Slice, second_moment: f64) {
    if !(second_moment.is_finite() && second_moment > 0.0) {
        return;
    }
    for k in 0..slice.integrals.len() {
        let Some(missed) = missed(slice, slice.integrals[k].side, second_moment) else {
            continue;
        };
        let integral = &mut slice.integrals[k];
        integral.u = integral.u.hypot(missed);
        integral.u_quadrature = integral.u_quadrature.hypot(missed);
    }
}

/// The difference between the flux of the narrow peak on `side` and what its readings count; `None` without one.
fn missed(slice: &Slice, side: Side, second_moment: f64) -> Option<f64> {
    let usable = |j: &usize| slice.flags[*j].usable() && slice.direction(*j).side() == side;
    let top = (0..slice.len())
        .filter(usable)
        .max_by(|&a, &b| slice.dsf[a].total_cmp(&slice.dsf[b]))?;
    let highest = slice.dsf[top];
    if highest <= 10.0 * slice.u_independent(top) {
        return None;
    }
    let centre = slice.direction(top).vec();
    let (e1, e2) = centre.any_orthonormal_pair();
    // Twice the width, so that the surroundings of a peak that is displaced by one take part.
    let reach = 4.0 * second_moment.sqrt() + 2.0 * slice.omega[top].sqrt();
    let mut near: Vec<(f64, DVec3, usize)> = (0..slice.len())
        .filter(usable)
        .map(|j| (slice.dsf[j], slice.direction(j).vec(), j))
        .filter(|r| r.1.distance_squared(centre) <= reach * reach)
        .collect();
    if near.iter().filter(|r| r.0 >= 0.5 * highest).count() > FEW {
        return None;
    }
    near.sort_by(|a, b| a.0.total_cmp(&b.0));
    let around = near[near.len() / 4].0.max(0.0);
    if highest < CONTRAST * around {
        return None;
    }
    let floor = (LOWEST * highest).max(2.0 * around);
    let on_peak: Vec<_> = near.iter().filter(|r| r.0 > floor).collect();
    if on_peak.len() < LEAST {
        return None;
    }
    let rows = on_peak.iter().map(|&&(f, v, _)| {
        let (x, y) = (v.dot(e1), v.dot(e2));
        ([1.0, x, y, x * x + y * y], f)
    });
    let flux = flux(rows, second_moment, reach)?;
    let counted: f64 = on_peak.iter().map(|r| (r.0 - around) * slice.omega[r.2]).sum();
    let missed = (flux - counted).abs();
    // More than all of the light is no peak of this shape.
    (missed < 1.0).then_some(missed)
}

/// Flux of the Gaussian `exp(a + b . x - x^2 / m)` through readings `([1, x, y, x^2 + y^2], f)`: of width `m` where they are
/// few, of their own width (`m` at least) where they determine it. `None` for readings on one line and for a peak farther
/// than `reach` from them. Readings count by their height, for those on the flanks bear what the beam is no Gaussian in.
fn flux(rows: impl Iterator<Item = ([f64; 4], f64)> + Clone, m: f64, reach: f64) -> Option<f64> {
    let fixed = rows
        .clone()
        .map(|(r, f)| ([r[0], r[1], r[2]], f.ln() + r[3] / m, f * f));
    let free = rows.map(|(r, f)| (r, f.ln(), f * f));
    let [mut a, mut b1, mut b2] = least_squares(fixed)?;
    let mut width = m;
    if let Some([a4, x4, y4, c]) = least_squares(free)
        && c < 0.0
        && -1.0 / c > m
    {
        (a, b1, b2, width) = (a4, x4, y4, -1.0 / c);
    }
    let displaced = 0.5 * width * b1.hypot(b2);
    (displaced <= reach).then(|| std::f64::consts::PI * width * (a + displaced * displaced / width).exp())
}

/// Coefficients by the weighted normal equations; `None` where the rows do not determine them.
fn least_squares<const N: usize>(rows: impl Iterator<Item = ([f64; N], f64, f64)>) -> Option<[f64; N]> {
    let (mut normal, mut right) = ([[0.0; N]; N], [0.0; N]);
    for (row, value, weight) in rows {
        for i in 0..N {
            right[i] += weight * row[i] * value;
            for j in 0..N {
                normal[i][j] += weight * row[i] * row[j];
            }
        }
    }
    let inverse = invert(normal)?;
    Some(std::array::from_fn(|i| {
        (0..N).map(|j| inverse[i][j] * right[j]).sum()
    }))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::measurement::HemisphericalIntegral;
    use crate::testing::slice_of;
    use gonio_geom::Direction;

    /// Readings on a raster about 30°, of a Gaussian peak of flux 0.3 and second moment `m` on a Lambertian of 0.1.
    fn raster(pitch: f64, phase: [f64; 2], m: f64) -> Slice {
        let axis = Direction::from_degrees(30.0, 0.0).vec();
        let (a, b) = axis.any_orthonormal_pair();
        let mut slice = slice_of(crate::testing::path_scan(60.0, 60.0, |_| 0.0));
        let mut points = Vec::new();
        for k in -10..=10 {
            for l in -10..=10 {
                let (x, y) = (f64::from(k) + phase[0], f64::from(l) + phase[1]);
                points.push((axis + pitch * (x * a + y * b)).normalize());
            }
        }
        let value = |p: &DVec3| {
            let d2 = p.distance_squared(axis);
            0.1 * p.z / std::f64::consts::PI + 0.3 * (-d2 / m).exp() / (std::f64::consts::PI * m)
        };
        slice.theta_s = points.iter().map(|p| Direction::from_unit(*p).theta()).collect();
        slice.phi_s = points.iter().map(|p| Direction::from_unit(*p).phi()).collect();
        slice.dsf = points.iter().map(value).collect();
        slice.u_dsf = slice.dsf.iter().map(|d| 0.01 * d).collect();
        slice.omega = vec![pitch * pitch; points.len()];
        slice.flags = vec![crate::Flags::default(); points.len()];
        slice.integrals = vec![HemisphericalIntegral {
            side: Side::Front,
            value: 0.0,
            extrapolated: 0.0,
            u: 0.0,
            u_quadrature: 0.0,
        }];
        slice
    }

    #[test]
    fn a_peak_between_readings_adds_what_they_miss_of_it() {
        let m: f64 = 4e-6;
        for (pitch, phase) in [
            (2.0, [0.5, 0.5]),
            (2.0, [0.0, 0.1]),
            (2.8, [0.5, 0.4]),
            (1.6, [0.2, 0.3]),
        ] {
            let mut slice = raster(pitch * m.sqrt(), phase, m);
            let counted: f64 = slice
                .dsf
                .iter()
                .zip(&slice.omega)
                .map(|(d, o)| (d - 0.1 * 0.866 / std::f64::consts::PI) * o)
                .sum();
            add_uncertainty(&mut slice, m);
            let error = (counted - 0.3).abs();
            let u = slice.integrals[0].u;
            assert!(
                (u - error).abs() < 0.25 * error + 0.003,
                "{pitch} {phase:?}: u {u}, error {error}"
            );
        }
    }

    #[test]
    fn a_peak_that_the_readings_resolve_adds_nothing_and_a_broad_lobe_neither() {
        let m: f64 = 4e-6;
        for (pitch, lobe) in [(0.5, m), (1.0, 25.0 * m)] {
            let mut slice = raster(pitch * m.sqrt(), [0.3, 0.2], lobe);
            add_uncertainty(&mut slice, m);
            assert_eq!(slice.integrals[0].u, 0.0);
        }
    }
}
