//! Normal equations of a least-squares problem.

use nalgebra::{DMatrix, DVector};

/// The cost and its quadratic model: `cost + gradient.d + d.matrix.d / 2`.
#[derive(Clone, Debug, PartialEq)]
pub struct Normal {
    /// Half the sum of squares (or the sum of the losses).
    pub cost: f64,
    /// `J^T r`.
    pub gradient: DVector<f64>,
    /// `J^T J`, symmetric.
    pub matrix: DMatrix<f64>,
}

/// Most changes of the active set a variable; it settles in far fewer.
const ACTIVE_SET_CHANGES: usize = 4;

impl Normal {
    /// Zero equations of `n` variables.
    pub fn new(n: usize) -> Self {
        Normal {
            cost: 0.0,
            gradient: DVector::zeros(n),
            matrix: DMatrix::zeros(n, n),
        }
    }

    /// Sets everything to zero.
    pub fn clear(&mut self) {
        self.cost = 0.0;
        self.gradient.fill(0.0);
        self.matrix.fill(0.0);
    }

    /// Adds one residual with its derivatives.
    pub fn add_residual(&mut self, residual: f64, derivatives: &[f64]) {
        self.cost += 0.5 * residual * residual;
        for (a, &da) in derivatives.iter().enumerate() {
            self.gradient[a] += da * residual;
            for (b, &db) in derivatives.iter().enumerate() {
                self.matrix[(a, b)] += da * db;
            }
        }
    }

    /// Whether everything is finite.
    pub fn is_finite(&self) -> bool {
        self.cost.is_finite()
            && self.gradient.iter().all(|v| v.is_finite())
            && self.matrix.iter().all(|v| v.is_finite())
    }

    /// Decrease of the quadratic model by `step`.
    pub(crate) fn predicted_decrease(&self, step: &DVector<f64>) -> f64 {
        -(self.gradient.dot(step) + 0.5 * step.dot(&(&self.matrix * step)))
    }

    /// The step that minimises the damped model within `room` (how far each variable may go down and up, which holds 0);
    /// variables in `stays` do not move. `None` when the matrix is not positive definite.
    ///
    /// An active-set method after \[StarkParker1995\]: it goes towards the minimum over the free variables as far as the box
    /// allows, holds the variable that it hits there, and frees one that would rather leave its bound. The model never rises
    /// on the way. Setting all variables that leave the box to their bounds at once would not do: steps along a direction
    /// that the data hardly determine cancel each other, and cut short they no longer do.
    pub(crate) fn boxed_step(
        &self,
        damping: f64,
        scale: &[f64],
        stays: &[bool],
        room: &[(f64, f64)],
    ) -> Option<DVector<f64>> {
        let n = stays.len();
        let mut matrix = self.matrix.clone();
        for (k, s) in scale.iter().enumerate() {
            matrix[(k, k)] += damping * s;
        }
        let mut step = DVector::zeros(n);
        let mut free: Vec<bool> = stays.iter().map(|s| !s).collect();
        for _ in 0..ACTIVE_SET_CHANGES * (n + 1) {
            let index: Vec<usize> = (0..n).filter(|&k| free[k]).collect();
            let slope = &self.gradient + &matrix * &step;
            let part = DMatrix::from_fn(index.len(), index.len(), |a, b| matrix[(index[a], index[b])]);
            let right = DVector::from_fn(index.len(), |a, _| -slope[index[a]]);
            let more = solve_scaled(&part, &right)?;
            if more.iter().any(|v| !v.is_finite()) {
                return None;
            }
            // The share of the way up to the first bound.
            let mut way = 1.0;
            let mut hit = None;
            for (a, &k) in index.iter().enumerate() {
                let bound = if more[a] < 0.0 { room[k].0 } else { room[k].1 };
                let share = ((bound - step[k]) / more[a]).max(0.0);
                if share < way {
                    (way, hit) = (share, Some((k, bound)));
                }
            }
            for (a, &k) in index.iter().enumerate() {
                step[k] = (step[k] + way * more[a]).clamp(room[k].0, room[k].1);
            }
            if let Some((k, bound)) = hit {
                step[k] = bound;
                free[k] = false;
                continue;
            }
            let slope = &self.gradient + &matrix * &step;
            let pull = |k: usize| slope[k] / matrix[(k, k)].sqrt();
            let leaves = (0..n)
                .filter(|&k| !free[k] && !stays[k])
                .filter(|&k| {
                    (step[k] <= room[k].0 && slope[k] < 0.0) || (step[k] >= room[k].1 && slope[k] > 0.0)
                })
                .filter(|&k| room[k].0 < room[k].1)
                .max_by(|&a, &b| pull(a).abs().total_cmp(&pull(b).abs()));
            match leaves {
                Some(k) => free[k] = true,
                None => break,
            }
        }
        Some(step)
    }

    /// Inverse of the matrix over the variables `free`, zero elsewhere. `None` when it is singular to rounding.
    pub fn inverse(&self, free: &[bool]) -> Option<DMatrix<f64>> {
        let index: Vec<usize> = (0..free.len()).filter(|&k| free[k]).collect();
        let m = index.len();
        let root: Vec<f64> = index.iter().map(|&i| self.matrix[(i, i)].sqrt()).collect();
        if root.iter().any(|r| !(r.is_finite() && *r > 0.0)) {
            return None;
        }
        let scaled = DMatrix::from_fn(m, m, |a, b| {
            self.matrix[(index[a], index[b])] / (root[a] * root[b])
        });
        let least = scaled.clone().symmetric_eigenvalues().min();
        if least.is_nan() || least < 1e-13 {
            return None;
        }
        let inverse = scaled.cholesky()?.inverse();
        let mut out = DMatrix::zeros(free.len(), free.len());
        for a in 0..m {
            for b in 0..m {
                out[(index[a], index[b])] = inverse[(a, b)] / (root[a] * root[b]);
            }
        }
        Some(out)
    }
}

/// `matrix^-1 right` by Cholesky after scaling the diagonal to one.
fn solve_scaled(matrix: &DMatrix<f64>, right: &DVector<f64>) -> Option<DVector<f64>> {
    let root: Vec<f64> = (0..right.len()).map(|k| matrix[(k, k)].sqrt()).collect();
    let scaled = DMatrix::from_fn(root.len(), root.len(), |a, b| {
        matrix[(a, b)] / (root[a] * root[b])
    });
    let b = DVector::from_fn(root.len(), |k, _| right[k] / root[k]);
    let y = scaled.cholesky()?.solve(&b);
    Some(DVector::from_fn(root.len(), |k, _| y[k] / root[k]))
}
