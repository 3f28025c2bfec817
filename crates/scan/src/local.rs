//! Slope and curvature of a reading's neighbourhood along the detector's path.

use gonio_geom::{DVec3, Delaunay, Side};

use crate::Slice;

/// Standard uncertainty of every DSF from the width of the beam, 1/sr: `second_moment / 2 abs(D'')` along the path, the
/// whole of the bias that a profile of this second moment (rad^2) and full width `fwhm` (radians) causes. It is part of
/// `u_dsf` wherever a reference scan was processed; what folds the beam into a model takes it out again. Zero for a width
/// that is not finite, and where [`Slice::dsf`] gives no curvature (path turns, jumps or ends).
pub fn resolution_uncertainty(slice: &Slice, second_moment: f64, fwhm: f64) -> Vec<f64> {
    if !fwhm.is_finite() {
        return vec![0.0; slice.len()];
    }
    let mut u = path_curvature(slice, 1.5 * fwhm);
    u.iter_mut().for_each(|c| *c = (0.5 * second_moment * *c).abs());
    u
}

/// Second derivative of the DSF along the path at every reading, 1/(sr rad^2), from a parabola through the
/// neighbours within `reach` radians on either side (at least one). Zero where the path turns, jumps or ends.
pub(crate) fn path_curvature(slice: &Slice, reach: f64) -> Vec<f64> {
    let n = slice.len();
    let mut out = vec![0.0; n];
    let step: Vec<f32> = (1..n)
        .map(|j| slice.direction(j - 1).angle_to(slice.direction(j)) as f32)
        .collect();
    for j in 1..n.saturating_sub(1) {
        let h = f64::from(step[j]);
        if h <= 0.0 {
            continue;
        }
        let wanted = ((reach / h).round() as usize).clamp(1, 12);
        let regular = |k: usize| (f64::from(step[k]) - h).abs() <= 0.1 * h;
        // Up to `wanted` regular steps to both sides.
        let mut m = 0;
        while m < wanted && j > m && j + m < n - 1 && regular(j - m - 1) && regular(j + m) {
            m += 1;
        }
        let straight = || {
            let across = slice.direction(j - m).angle_to(slice.direction(j + m));
            across > 0.95 * 2.0 * m as f64 * h
        };
        if m == 0 || !slice.flags[j - m..=j + m].iter().all(|f| f.usable()) || !straight() {
            continue;
        }
        out[j] = parabola(&slice.dsf[j - m..=j + m]) / (h * h);
    }
    out
}

/// Second derivative of the least-squares parabola through `2 m + 1` values at unit steps.
fn parabola(v: &[f64]) -> f64 {
    let m = (v.len() / 2) as f64;
    let n = v.len() as f64;
    let mean_square = m * (m + 1.0) / 3.0;
    let (mut numerator, mut denominator) = (0.0, 0.0);
    for (k, y) in v.iter().enumerate() {
        let q = (k as f64 - m).powi(2) - mean_square;
        numerator += q * y;
        denominator += q * q;
    }
    if n < 3.0 {
        0.0
    } else {
        2.0 * numerator / denominator
    }
}

/// Magnitude of the DSF's gradient over the sphere at every reading, 1/(sr rad), see [`gradients`]. Zero where
/// a reading has no triangle.
pub(crate) fn gradient(slice: &Slice) -> Vec<f64> {
    let mut out = vec![0.0; slice.len()];
    for side in Side::BOTH {
        let members: Vec<usize> = (0..slice.len())
            .filter(|&j| slice.flags[j].usable() && slice.direction(j).side() == side)
            .collect();
        let points: Vec<DVec3> = members.iter().map(|&j| slice.direction(j).vec()).collect();
        let values: Vec<f64> = members.iter().map(|&j| slice.dsf[j]).collect();
        let Ok(mesh) = Delaunay::new(&points, side) else {
            continue;
        };
        for (slope, &j) in gradients(&mesh, &points, &values).iter().zip(&members) {
            out[j] = slope.length();
        }
    }
    out
}

/// Gradient of `values` over the sphere at every point: the mean of the gradients of the flat triangles around it,
/// weighted with their areas. Zero at a point without a triangle.
pub(crate) fn gradients(mesh: &Delaunay, points: &[DVec3], values: &[f64]) -> Vec<DVec3> {
    let mut sum = vec![DVec3::ZERO; points.len()];
    let mut area = vec![0.0; points.len()];
    for t in mesh.triangles() {
        let [a, b, c] = t.map(|k| points[k as usize]);
        let [fa, fb, fc] = t.map(|k| values[k as usize]);
        let normal = (b - a).cross(c - a);
        let double = normal.length();
        if double <= 0.0 {
            continue;
        }
        // Gradient of the linear function on the flat triangle, times twice its area.
        let g = normal.cross(c - b) * fa + normal.cross(a - c) * fb + normal.cross(b - a) * fc;
        for k in t {
            sum[*k as usize] += g / double;
            area[*k as usize] += double;
        }
    }
    for (g, a) in sum.iter_mut().zip(&area) {
        if *a > 0.0 {
            *g /= *a;
        }
    }
    for &(copy, vertex) in mesh.copies() {
        sum[copy as usize] = sum[vertex as usize];
    }
    sum
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::{path_scan, slice_of, spiral_scan};

    #[test]
    fn the_curvature_of_a_parabola_is_its_second_derivative() {
        assert!((parabola(&[4.0, 1.0, 0.0, 1.0, 4.0]) - 2.0).abs() < 1e-12);
        let slice = slice_of(path_scan(30.0, 0.5, |d| d.cos_theta()));
        let found = path_curvature(&slice, 0.03);
        let j = 60;
        let expected = -slice.theta_s[j].cos();
        assert!(
            (found[j] / expected - 1.0).abs() < 1e-3,
            "{} {expected}",
            found[j]
        );
    }

    #[test]
    fn the_gradient_of_the_cosine_is_the_sine() {
        let slice = slice_of(spiral_scan(0.0, 0.0, 20_000, Side::Front, |d| d.cos_theta()));
        let found = gradient(&slice);
        for j in (500..15_000).step_by(100) {
            let expected = slice.theta_s[j].sin();
            assert!(
                (found[j] / expected - 1.0).abs() < 0.02,
                "{} {expected}",
                found[j]
            );
        }
    }
}
