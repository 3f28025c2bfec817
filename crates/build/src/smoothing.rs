//! Noise-aware smoothing of scattered readings.
//!
//! Around every reading a polynomial of the plane is fitted to growing rings of its Delaunay neighbours, each
//! weighted by its stated noise. The largest ring whose fit is still consistent with that noise (chi-square) gives
//! the smoothed value: flat regions are averaged over many readings, peaks stay as read. Readings without a stated
//! noise are left alone. Idea: formulas of local regression with adaptive bandwidth [FanGijbels1996, ch. 4].

use gonio_geom::delaunay::Adjacency;
use rayon::prelude::*;

use crate::mesh::Mesh;

/// Whether a quadratic (else a plane) is fitted to the readings up to each ring.
const STEPS: [bool; 3] = [false, true, true];

/// Accepted excess of chi-square over its degrees of freedom, in its standard deviations. The rings overlap from
/// reading to reading, so a looser bound would let curvature through everywhere at once.
const EXCESS: f64 = 2.0;

/// `values` of the first `sigma.len()` vertices of `mesh` smoothed within their noise `sigma` (standard deviation,
/// same unit), each with the noise that is left. Later vertices take no part. A `sigma` that is not positive and finite
/// leaves its value as it is, of noise 0.
pub(crate) fn smooth(mesh: &Mesh, values: &[f64], sigma: &[f64]) -> Vec<(f64, f64)> {
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
    /// The round in which a vertex became a member last.
    joined: Vec<u32>,
    round: u32,
}

impl Workspace {
    fn smoothed(
        &mut self,
        mesh: &Mesh,
        neighbours: &Adjacency,
        values: &[f64],
        sigma: &[f64],
        k: usize,
    ) -> (f64, f64) {
        let noisy = |j: usize| j < sigma.len() && sigma[j] > 0.0 && sigma[j].is_finite();
        if !noisy(k) {
            return (values[k], 0.0);
        }
        let origin = mesh.points()[k];
        let offset = |j: u32| {
            let p = mesh.points()[j as usize];
            [p[0] - origin[0], p[1] - origin[1]]
        };
        let scale = neighbours
            .of(k)
            .iter()
            .filter(|&&j| noisy(j as usize))
            .map(|&j| offset(j).map(f64::abs).into_iter().fold(0.0, f64::max))
            .fold(0.0, f64::max);
        if scale <= 0.0 {
            return (values[k], sigma[k]);
        }
        self.members.clear();
        self.members.push(k as u32);
        self.joined.resize(sigma.len(), 0);
        self.round += 1;
        self.joined[k] = self.round;
        let mut fit = Fit::default();
        fit.add([0.0, 0.0], 0.0, sigma[k]);
        let (mut outer, mut best) = (0, (values[k], sigma[k]));
        for quadratic in STEPS {
            let end = self.members.len();
            for m in outer..end {
                for &j in neighbours.of(self.members[m] as usize) {
                    if noisy(j as usize) && self.joined[j as usize] != self.round {
                        self.joined[j as usize] = self.round;
                        self.members.push(j);
                        let at = offset(j).map(|x| x / scale);
                        fit.add(at, values[j as usize] - values[k], sigma[j as usize]);
                    }
                }
            }
            outer = end;
            if let Some((value, variance)) = fit.consistent_value(quadratic) {
                best = (values[k] + value, variance.sqrt());
            }
        }
        best
    }
}

/// Weighted least squares of a polynomial around the origin, reading by reading.
#[derive(Clone, Copy, Debug, Default)]
struct Fit {
    /// Lower triangle of the normal matrix over 1, x, y, x^2, x y, y^2.
    normal: [[f64; 6]; 6],
    right: [f64; 6],
    sum_of_squares: f64,
    count: usize,
}

impl Fit {
    fn add(&mut self, [x, y]: [f64; 2], value: f64, sigma: f64) {
        let row = [1.0, x, y, x * x, x * y, y * y];
        let w = 1.0 / (sigma * sigma);
        for a in 0..6 {
            for b in 0..=a {
                self.normal[a][b] += w * row[a] * row[b];
            }
            self.right[a] += w * row[a] * value;
        }
        self.sum_of_squares += w * value * value;
        self.count += 1;
    }

    /// The polynomial's value at the origin and its variance; `None` when the readings do not determine it or scatter about it by
    /// more than their noise.
    fn consistent_value(&self, quadratic: bool) -> Option<(f64, f64)> {
        let n = if quadratic { 6 } else { 3 };
        if self.count < n + 2 {
            return None;
        }
        let (solution, variance) = cholesky_solve(self.normal, self.right, n)?;
        let explained: f64 = (0..n).map(|a| solution[a] * self.right[a]).sum();
        let (chi2, dof) = (self.sum_of_squares - explained, (self.count - n) as f64);
        (chi2 <= dof + EXCESS * (2.0 * dof).sqrt()).then_some((solution[0], variance))
    }
}

/// Solves `a x = b` for a symmetric positive matrix given by its lower triangle, and the first element of the inverse;
/// `None` when it is (nearly) singular.
fn cholesky_solve(mut a: [[f64; 6]; 6], mut b: [f64; 6], n: usize) -> Option<([f64; 6], f64)> {
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
    let mut first = [0.0; 6];
    for i in 0..n {
        first[i] = if i == 0 { 1.0 } else { 0.0 };
        for k in 0..i {
            b[i] -= a[i][k] * b[k];
            first[i] -= a[i][k] * first[k];
        }
        b[i] /= a[i][i];
        first[i] /= a[i][i];
    }
    for i in (0..n).rev() {
        for k in i + 1..n {
            b[i] -= a[k][i] * b[k];
        }
        b[i] /= a[i][i];
    }
    Some((b, first.iter().map(|x| x * x).sum()))
}

#[cfg(test)]
mod tests {
    use rand::SeedableRng;
    use rand_distr::{Distribution, StandardNormal};
    use rand_pcg::Pcg64;

    use super::*;

    fn normals(n: usize) -> Vec<f64> {
        StandardNormal
            .sample_iter(Pcg64::seed_from_u64(12345))
            .take(n)
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
        let left = rms((0..1600).filter(inside).map(|k| smoothed[k].0 - truth[k]));
        assert!(left < 0.005, "{left}");
        let stated = rms((0..1600).filter(inside).map(|k| smoothed[k].1));
        assert!((stated / left - 1.0).abs() < 0.15, "{stated} {left}");
    }

    #[test]
    fn a_peak_narrower_than_the_rings_stays() {
        let mesh = grid(40);
        let peak = |p: &[f64; 2]| 1.0 + 10.0 * (-(p[0] * p[0] + p[1] * p[1]) / 0.03f64.powi(2)).exp();
        let values: Vec<f64> = mesh.points().iter().map(peak).collect();
        let smoothed = smooth(&mesh, &values, &vec![0.01; 1600]);
        for ((a, _), b) in smoothed.iter().zip(&values) {
            assert!((a - b).abs() < 0.03, "{a} {b}");
        }
    }

    #[test]
    fn readings_without_a_stated_noise_stay_as_read() {
        let mesh = grid(10);
        let values = normals(100);
        let smoothed: Vec<f64> = smooth(&mesh, &values, &[0.0; 100])
            .into_iter()
            .map(|v| v.0)
            .collect();
        assert_eq!(smoothed, values);
    }
}
