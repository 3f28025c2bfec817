//! Noise-aware smoothing of scattered readings.
//!
//! Around every reading a polynomial of the plane is fitted to growing rings of its Delaunay neighbours, each
//! weighted by its stated noise. The largest ring whose fit is still consistent with that noise (chi-square) gives
//! the smoothed value: flat regions are averaged over many readings, peaks stay as read. Readings without a stated
//! noise are left alone. Idea: formulas of local regression with adaptive bandwidth [FanGijbels1996, ch. 4].

use gonio_geom::delaunay::Adjacency;
use rayon::prelude::*;

use crate::mesh::Mesh;

/// Rings tried, and whether a quadratic (else a plane) is fitted.
const STEPS: [(usize, bool); 3] = [(1, false), (2, true), (3, true)];

/// Accepted excess of chi-square over its degrees of freedom, in its standard deviations. The rings overlap from
/// reading to reading, so a looser bound would let curvature through everywhere at once.
const EXCESS: f64 = 2.0;

/// `values` of the first `sigma.len()` vertices of `mesh` smoothed within their noise `sigma` (standard deviation,
/// same unit). Later vertices take no part. A `sigma` that is not positive and finite leaves its value as it is.
pub(crate) fn smooth(mesh: &Mesh, values: &[f64], sigma: &[f64]) -> Vec<f64> {
    let neighbours = mesh.adjacency();
    (0..sigma.len())
        .into_par_iter()
        .map_init(Workspace::default, |work, k| {
            work.smoothed(mesh, &neighbours, values, sigma, k)
        })
        .collect()
}

#[derive(Default)]
struct Workspace {
    members: Vec<u32>,
}

impl Workspace {
    fn smoothed(
        &mut self,
        mesh: &Mesh,
        neighbours: &Adjacency,
        values: &[f64],
        sigma: &[f64],
        k: usize,
    ) -> f64 {
        let noisy = |j: usize| j < sigma.len() && sigma[j] > 0.0 && sigma[j].is_finite();
        if !noisy(k) {
            return values[k];
        }
        self.members.clear();
        self.members.push(k as u32);
        let mut outer = 0;
        let mut best = values[k];
        for (_, quadratic) in STEPS {
            let end = self.members.len();
            for m in outer..end {
                for &j in neighbours.of(self.members[m] as usize) {
                    if noisy(j as usize) && !self.members.contains(&j) {
                        self.members.push(j);
                    }
                }
            }
            outer = end;
            let Some((value, chi2, dof)) = fit(mesh, values, sigma, k, &self.members, quadratic) else {
                continue;
            };
            let dof = dof as f64;
            if chi2 <= dof + EXCESS * (2.0 * dof).sqrt() {
                best = value;
            }
        }
        best
    }
}

/// Weighted least squares around vertex `k`: value at `k`, chi-square and degrees of freedom. `None` when the
/// members do not determine the polynomial.
fn fit(
    mesh: &Mesh,
    values: &[f64],
    sigma: &[f64],
    k: usize,
    members: &[u32],
    quadratic: bool,
) -> Option<(f64, f64, usize)> {
    let n = if quadratic { 6 } else { 3 };
    if members.len() < n + 2 {
        return None;
    }
    let origin = mesh.points()[k];
    let offset = |j: u32| {
        let p = mesh.points()[j as usize];
        [p[0] - origin[0], p[1] - origin[1]]
    };
    let scale = members
        .iter()
        .map(|&j| {
            let d = offset(j);
            d[0].abs().max(d[1].abs())
        })
        .fold(0.0, f64::max);
    if scale <= 0.0 {
        return None;
    }
    let row = |j: u32| {
        let d = offset(j);
        let (x, y) = (d[0] / scale, d[1] / scale);
        [1.0, x, y, x * x, x * y, y * y]
    };
    let mut normal = [[0.0; 6]; 6];
    let mut right = [0.0; 6];
    for &j in members {
        let r = row(j);
        let w = 1.0 / (sigma[j as usize] * sigma[j as usize]);
        for a in 0..n {
            for b in 0..=a {
                normal[a][b] += w * r[a] * r[b];
            }
            right[a] += w * r[a] * values[j as usize];
        }
    }
    let solution = cholesky_solve(normal, right, n)?;
    let chi2 = members
        .iter()
        .map(|&j| {
            let r = row(j);
            let model: f64 = (0..n).map(|a| r[a] * solution[a]).sum();
            let residual = (values[j as usize] - model) / sigma[j as usize];
            residual * residual
        })
        .sum();
    Some((solution[0], chi2, members.len() - n))
}

/// Solves `a x = b` for a symmetric positive matrix given by its lower triangle; `None` when it is (nearly) singular.
fn cholesky_solve(mut a: [[f64; 6]; 6], mut b: [f64; 6], n: usize) -> Option<[f64; 6]> {
    for i in 0..n {
        let diagonal = a[i][i];
        for j in 0..=i {
            let done: f64 = a[i].iter().zip(&a[j]).take(j).map(|(x, y)| x * y).sum();
            let sum = a[i][j] - done;
            if i == j {
                if sum <= 1e-10 * diagonal {
                    return None;
                }
                a[i][i] = sum.sqrt();
            } else {
                a[i][j] = sum / a[j][j];
            }
        }
    }
    for i in 0..n {
        for k in 0..i {
            b[i] -= a[i][k] * b[k];
        }
        b[i] /= a[i][i];
    }
    for i in (0..n).rev() {
        for k in i + 1..n {
            b[i] -= a[k][i] * b[k];
        }
        b[i] /= a[i][i];
    }
    Some(b)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A deterministic standard normal sequence (sum of twelve uniforms of an LCG).
    fn normals(n: usize) -> Vec<f64> {
        let mut state = 12345u64;
        let mut uniform = || {
            state = state
                .wrapping_mul(6364136223846793005)
                .wrapping_add(1442695040888963407);
            (state >> 11) as f64 / (1u64 << 53) as f64
        };
        (0..n)
            .map(|_| (0..12).map(|_| uniform()).sum::<f64>() - 6.0)
            .collect()
    }

    fn grid(n: usize) -> Mesh {
        let points = (0..n * n)
            .map(|k| {
                let (i, j) = (k % n, k / n);
                let shift = 1e-4 * ((k * 7919) % 97) as f64 / 97.0;
                [
                    -0.5 + i as f64 / n as f64 + shift,
                    -0.5 + j as f64 / n as f64 + 0.7 * shift,
                ]
            })
            .collect();
        Mesh::new(points).unwrap()
    }

    fn rms(values: impl Iterator<Item = f64>) -> f64 {
        let (sum, n) = values.fold((0.0, 0), |(s, n), v| (s + v * v, n + 1));
        (sum / n as f64).sqrt()
    }

    #[test]
    fn noise_inside_a_smooth_surface_is_more_than_halved() {
        let mesh = grid(40);
        let truth: Vec<f64> = mesh.points().iter().map(|p| 1.0 + 0.3 * p[0] - p[1]).collect();
        let noisy: Vec<f64> = truth
            .iter()
            .zip(normals(1600))
            .map(|(t, e)| t + 0.01 * e)
            .collect();
        let smoothed = smooth(&mesh, &noisy, &vec![0.01; 1600]);
        let inside = |k: &usize| mesh.points()[*k].iter().all(|x| x.abs() < 0.4);
        let left = rms((0..1600).filter(inside).map(|k| smoothed[k] - truth[k]));
        assert!(left < 0.005, "{left}");
    }

    #[test]
    fn a_peak_narrower_than_the_rings_stays() {
        let mesh = grid(40);
        let peak = |p: &[f64; 2]| 1.0 + 10.0 * (-(p[0] * p[0] + p[1] * p[1]) / 0.03f64.powi(2)).exp();
        let values: Vec<f64> = mesh.points().iter().map(peak).collect();
        let smoothed = smooth(&mesh, &values, &vec![0.01; 1600]);
        for (a, b) in smoothed.iter().zip(&values) {
            assert!((a - b).abs() < 0.03, "{a} {b}");
        }
    }

    #[test]
    fn readings_without_a_stated_noise_stay_as_read() {
        let mesh = grid(10);
        let values = normals(100);
        assert_eq!(smooth(&mesh, &values, &[0.0; 100]), values);
    }
}
