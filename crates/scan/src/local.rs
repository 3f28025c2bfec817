//! Slope and curvature of a reading's neighbourhood.

use gonio_geom::{DVec3, Delaunay, Side};
use rayon::prelude::*;

use crate::quadratic::Quadratic;
use crate::{DirectionIndex, Resolution, Slice};

/// Standard uncertainty of every DSF from the width of the beam, 1/sr: `second_moment / 4 abs(laplace D)`, the whole of the
/// bias that a profile of this second moment (rad^2) and full width `fwhm` (radians) causes, to second order. It is part of
/// `u_dsf` wherever a reference scan was processed; what folds the beam into a model takes it out again.
///
/// The laplacian is that of a quadratic through the reading, its neighbours in the Delaunay triangulation and those within
/// 1.5 `fwhm`, of `ln D` where these are of one order of magnitude: exact for a Gaussian lobe however few readings it
/// holds. Where readings lie on a line (an in-plane scan) it is twice the curvature along the path. Zero for a width that is
/// not finite, and where neither is known (the path turns, jumps or ends).
pub fn resolution_uncertainty(slice: &Slice, second_moment: f64, fwhm: f64) -> Vec<f64> {
    let bias = resolution_bias(slice, second_moment, fwhm);
    bias.into_iter().map(f64::abs).collect()
}

/// The same with its sign: above 0 where the beam raises a reading.
pub(crate) fn resolution_bias(slice: &Slice, second_moment: f64, fwhm: f64) -> Vec<f64> {
    if !fwhm.is_finite() {
        return vec![0.0; slice.len()];
    }
    let mut bias: Vec<f64> = path_curvature(slice, 1.5 * fwhm)
        .into_iter()
        .map(|c| 2.0 * c)
        .collect();
    for side in Side::BOTH {
        for (j, found, most) in laplacians(slice, side, 1.5 * fwhm) {
            // A beam takes no more from a reading than the readings around differ by: a quadratic that runs away says less.
            bias[j] = found.signum() * found.abs().min(4.0 * most / second_moment);
        }
    }
    bias.iter_mut().for_each(|l| *l *= 0.25 * second_moment);
    bias
}

/// `u_dsf` of every reading without the part that the width of the beam adds, [`resolution_uncertainty`], 1/sr: for what
/// folds the beam into a model, and for what asks how far a peak stands out of the noise.
pub fn u_beside_resolution(slice: &Slice, resolution: &Resolution) -> Vec<f64> {
    let of_beam = resolution_uncertainty(slice, resolution.second_moment, resolution.fwhm);
    let rest = |(u, r): (&f64, f64)| (u * u - r * r).max(0.0).sqrt();
    slice.u_dsf.iter().zip(of_beam).map(rest).collect()
}

/// Neighbours within reach that take part at most.
const NEAR: usize = 20;
/// Readings that a quadratic is laid through at least: it has six coefficients.
const LEAST: usize = 9;
/// Ratio of the lowest to the highest reading down to which their logarithm is taken.
const ONE_ORDER: f64 = 0.1;

/// Laplacian of the DSF over the sphere at readings of one side, 1/(sr rad^2), where their neighbours determine it, and by how
/// much these differ.
fn laplacians(slice: &Slice, side: Side, reach: f64) -> Vec<(usize, f64, f64)> {
    let members: Vec<usize> = (0..slice.len())
        .filter(|&j| slice.flags[j].usable() && slice.direction(j).side() == side)
        .collect();
    let points: Vec<DVec3> = members.iter().map(|&j| slice.direction(j).vec()).collect();
    let Ok(mesh) = Delaunay::new(&points, side) else {
        return Vec::new();
    };
    if mesh.triangles().is_empty() {
        return Vec::new();
    }
    let adjacency = mesh.adjacency();
    let index = DirectionIndex::new(points.clone());
    let value = |k: usize| slice.dsf[members[k]];
    let one = |k: usize| {
        let mut around: Vec<usize> = adjacency.of(k).iter().map(|&n| n as usize).collect();
        if around.is_empty() {
            return None;
        }
        for (n, _) in index.nearest_k(points[k], NEAR, reach) {
            if n != k && !around.contains(&n) {
                around.push(n);
            }
        }
        around.push(k);
        if around.len() < LEAST {
            for &n in adjacency.of(k) {
                for &next in adjacency.of(n as usize) {
                    if !around.contains(&(next as usize)) {
                        around.push(next as usize);
                    }
                }
            }
        }
        laplacian(&points, value, k, &around).map(|(l, most)| (members[k], l, most))
    };
    (0..members.len()).into_par_iter().filter_map(one).collect()
}

/// Laplacian at point `k` from the points `around`, itself among them, near ones counting more; and how far their values lie
/// apart.
fn laplacian(
    points: &[DVec3],
    value: impl Fn(usize) -> f64,
    k: usize,
    around: &[usize],
) -> Option<(f64, f64)> {
    let p = points[k];
    let (e1, e2) = p.any_orthonormal_pair();
    let place = |n: usize| {
        let d = points[n] - p;
        [d.dot(e1), d.dot(e2)]
    };
    let mut squares: Vec<f64> = around.iter().map(|&n| points[n].distance_squared(p)).collect();
    squares.sort_by(f64::total_cmp);
    let middle = squares[squares.len() / 2];
    let highest = around.iter().map(|&n| value(n)).fold(f64::MIN, f64::max);
    let lowest = around.iter().map(|&n| value(n)).fold(f64::MAX, f64::min);
    let logarithmic = lowest > ONE_ORDER * highest;
    let rows = around.iter().map(|&n| {
        let v = if logarithmic { value(n).ln() } else { value(n) };
        (place(n), v, 1.0 / (points[n].distance_squared(p) + middle))
    });
    let q = Quadratic::through(rows)?;
    let [xx, _, yy] = q.curvature;
    let plain = xx + yy;
    let [gx, gy] = q.slope;
    let found = if logarithmic {
        value(k) * (plain + gx * gx + gy * gy)
    } else {
        plain
    };
    found.is_finite().then_some((found, highest - lowest))
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
    use crate::testing::{path_scan, record, slice_of, spiral_scan};
    use gonio_geom::Direction;

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
    fn what_a_beam_does_to_a_lobe_is_claimed_whatever_the_path_sees_of_it() {
        // Lines across a ridge and along it, and few readings on the lobe: the width of exp(-x^2/a^2 - y^2/b^2) decides.
        let (a, b, axis) = (0.15, 0.04, DVec3::Z);
        let lobe = |d: Direction| {
            let v = d.vec() - axis;
            0.2 + (-(v.x / a).powi(2) - (v.y / b).powi(2)).exp()
        };
        let expected = -2.0 * (1.0 / (a * a) + 1.0 / (b * b));
        for (dx, dy) in [(0.01, 0.002), (0.02, 0.01), (0.002, 0.02), (0.05, 0.02)] {
            let mut scan = record(10.0, 0.0);
            for k in -20..=20 {
                for l in -20..=20 {
                    let v = axis + f64::from(k) * dx * DVec3::X + f64::from(l) * dy * DVec3::Y;
                    let d = Direction::new(v).unwrap();
                    scan.push(d, lobe(d));
                }
            }
            let slice = slice_of(scan);
            let top = (0..slice.len())
                .max_by(|&i, &j| slice.dsf[i].total_cmp(&slice.dsf[j]))
                .unwrap();
            let u = resolution_uncertainty(&slice, 1e-5, 0.005)[top];
            let ratio = u / (0.25 * 1e-5 * expected.abs());
            assert!((0.6..1.5).contains(&ratio), "steps {dx}, {dy}: {ratio}");
        }
    }

    #[test]
    fn a_beam_takes_no_more_than_the_readings_around_differ_by() {
        // A line of readings and three beside it: a quadratic across the line has next to nothing to hold it.
        let mut scan = record(10.0, 0.0);
        for k in -10..=10 {
            let x = 0.01 * f64::from(k);
            let value = 1.0 + 0.3 * (37.0 * f64::from(k)).sin();
            scan.push(
                Direction::new(DVec3::new(x, 1e-7 * f64::from(k % 3), 1.0)).unwrap(),
                value,
            );
        }
        for x in [-0.05, 0.0, 0.05] {
            scan.push(Direction::new(DVec3::new(x, 0.3, 1.0)).unwrap(), 1.0);
        }
        let slice = slice_of(scan);
        let u = resolution_uncertainty(&slice, 1e-4, 0.01);
        assert!(u.iter().all(|u| *u <= 0.6 + 1e-12), "{u:?}");
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
