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

    /// The step that minimises the damped model within `room` (how far each variable may go down and up); variables
    /// in `stays` do not move. `None` when the matrix is not positive definite.
    pub(crate) fn boxed_step(
        &self,
        damping: f64,
        scale: &[f64],
        stays: &[bool],
        room: &[(f64, f64)],
    ) -> Option<DVector<f64>> {
        let n = stays.len();
        let mut step = DVector::zeros(n);
        let mut free: Vec<usize> = (0..n).filter(|&k| !stays[k]).collect();
        let mut bound: Vec<usize> = Vec::new();
        while !free.is_empty() {
            let m = free.len();
            let matrix = DMatrix::from_fn(m, m, |a, b| {
                let (i, j) = (free[a], free[b]);
                self.matrix[(i, j)] + if i == j { damping * scale[i] } else { 0.0 }
            });
            let right = DVector::from_fn(m, |a, _| {
                let i = free[a];
                -self.gradient[i] - bound.iter().map(|&j| self.matrix[(i, j)] * step[j]).sum::<f64>()
            });
            let solved = solve_scaled(&matrix, &right)?;
            let outside = |a: usize| solved[a] < room[free[a]].0 || solved[a] > room[free[a]].1;
            if !(0..m).any(outside) {
                for (a, &i) in free.iter().enumerate() {
                    step[i] = solved[a];
                }
                break;
            }
            let mut rest = Vec::with_capacity(m);
            for (a, &i) in free.iter().enumerate() {
                if outside(a) {
                    step[i] = solved[a].clamp(room[i].0, room[i].1);
                    bound.push(i);
                } else {
                    rest.push(i);
                }
            }
            free = rest;
        }
        step.iter().all(|v| v.is_finite()).then_some(step)
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
