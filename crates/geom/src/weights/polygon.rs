//! Convex spherical polygons with sides of at most a quarter circle: area, first moment, clipping.

use glam::DVec3;

/// The four quarters of the upper hemisphere, counter-clockwise seen from outside.
pub(crate) const QUARTERS: [[DVec3; 3]; 4] = [
    [DVec3::X, DVec3::Y, DVec3::Z],
    [DVec3::Y, DVec3::NEG_X, DVec3::Z],
    [DVec3::NEG_X, DVec3::NEG_Y, DVec3::Z],
    [DVec3::NEG_Y, DVec3::X, DVec3::Z],
];

/// Solid angle and `∫ω dω` of a polygon, counter-clockwise seen from outside.
///
/// The solid angle is the sum over a fan of triangles, each `tan(Ω/2) = triple product / (1 + Σ dot products)`
/// [VanOosterom1983, eq. 8], the arcs added as a product of complex numbers; the moment is Lambert's polygon formula,
/// `½ Σ Θ_k (v_k × v_k+1) / |v_k × v_k+1|` [Arvo1995, eq. 1].
pub(crate) fn area_and_moment(v: &[DVec3]) -> (f64, DVec3) {
    if v.len() < 3 {
        return (0.0, DVec3::ZERO);
    }
    let a = v[0];
    let (mut re, mut im) = (1.0, 0.0);
    for w in v[1..].windows(2) {
        let (b, c) = (w[0], w[1]);
        let num = a.dot((b - a).cross(c - a));
        let den = 1.0 + a.dot(b) + b.dot(c) + c.dot(a);
        (re, im) = (re * den - im * num, re * num + im * den);
    }
    let omega = 2.0 * im.atan2(re);
    let mut moment = DVec3::ZERO;
    let mut from = v[v.len() - 1];
    for &to in v {
        let cross = from.cross(to);
        moment += cross * arc_over_sine(cross.length_squared(), from.dot(to));
        from = to;
    }
    (omega, 0.5 * moment)
}

/// `Θ / sin Θ` from `sin² Θ` and `cos Θ`; `Θ` in `[0, pi)`.
fn arc_over_sine(s2: f64, c: f64) -> f64 {
    if s2 < 1e-3 && c > 0.0 {
        // arcsin series: the next term is below 4e-17
        1.0 + s2
            * (1.0 / 6.0
                + s2 * (3.0 / 40.0 + s2 * (5.0 / 112.0 + s2 * (35.0 / 1152.0 + s2 * (63.0 / 2816.0)))))
    } else {
        let s = s2.sqrt();
        s.atan2(c) / s
    }
}

/// Keeps the part of `polygon` with `v · normal >= 0`. `work` is scratch space.
pub(crate) fn clip(polygon: &mut Vec<DVec3>, normal: DVec3, work: &mut Vec<DVec3>) {
    let Some(&last) = polygon.last() else {
        return;
    };
    if polygon.iter().all(|v| v.dot(normal) >= 0.0) {
        return;
    }
    work.clear();
    let mut from = last;
    let mut d_from = from.dot(normal);
    for &to in polygon.iter() {
        let d_to = to.dot(normal);
        if (d_from < 0.0) != (d_to < 0.0) {
            let crossing = (from * d_to - to * d_from) * if d_to < d_from { -1.0 } else { 1.0 };
            work.extend(crossing.try_normalize());
        }
        if d_to >= 0.0 {
            work.push(to);
        }
        (from, d_from) = (to, d_to);
    }
    std::mem::swap(polygon, work);
}

#[cfg(test)]
mod tests {
    use std::f64::consts::{FRAC_PI_2, FRAC_PI_4};

    use super::*;

    #[test]
    fn an_octant_has_an_eighth_of_the_sphere_and_equal_moments() {
        for q in &QUARTERS {
            let (omega, m) = area_and_moment(q);
            assert!((omega - FRAC_PI_2).abs() < 1e-15);
            assert!((m.abs() - DVec3::splat(FRAC_PI_4)).length() < 1e-15);
            assert!(m.dot(q[0] + q[1] + q[2]) > 0.0);
        }
    }

    #[test]
    fn clipped_parts_add_up() {
        let normal = DVec3::new(0.3, -0.7, 0.2);
        let mut work = Vec::new();
        for q in &QUARTERS {
            let (mut a, mut b) = (q.to_vec(), q.to_vec());
            clip(&mut a, normal, &mut work);
            clip(&mut b, -normal, &mut work);
            let ((oa, ma), (ob, mb)) = (area_and_moment(&a), area_and_moment(&b));
            let (o, m) = area_and_moment(q);
            assert!((oa + ob - o).abs() < 1e-14 && (ma + mb - m).length() < 1e-14);
        }
    }

    #[test]
    fn the_series_of_small_arcs_meets_the_closed_form() {
        for theta in [1e-9, 1e-3, 0.0316, 0.0317, 1.0, 3.0f64] {
            let (s, c) = theta.sin_cos();
            assert!((arc_over_sine(s * s, c) - theta / s).abs() < 1e-15 * theta / s * 4.0);
        }
    }
}
