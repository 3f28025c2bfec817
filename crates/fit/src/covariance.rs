//! Covariance of the fitted variables.

use std::collections::BTreeMap;

use nalgebra::{DMatrix, DVector};
use rayon::prelude::*;

use crate::cells::CELLS;
use crate::metric::{Loss, Metric, accumulate};
use crate::normal::Normal;
use crate::objective::{Objective, Scratch, chunks, symmetric};

/// Expectation of the squared pull, `r^2 / (1 + r^2)`, and of the curvature, `(1 + r^2)^(-3/2)`, of the soft-L1 loss for a
/// standard normal residual (by quadrature).
const SOFT_L1_PULL: f64 = 0.344_320_457_581;
const SOFT_L1_CURVATURE: f64 = 0.564_890_847_246;
/// Standard deviations by which the cells' scatter must exceed that of independent residuals to count.
const CORRELATED: f64 = 3.0;

/// Covariance and what went into it.
#[derive(Clone, Debug)]
pub(crate) struct Covariance {
    /// Of the variables; zero rows for variables that the data do not determine.
    pub(crate) matrix: DMatrix<f64>,
    /// Derivative of the variables by a common relative change of all readings, times its standard uncertainty.
    pub(crate) common: DVector<f64>,
    /// Inverse of the Gauss–Newton matrix.
    pub(crate) bread: DMatrix<f64>,
    /// Variables that take part: not fixed, not on a bound, with influence.
    pub(crate) free: Vec<bool>,
    /// Ratio of the scatter of cell sums to that of independent residuals, at least one.
    pub(crate) design_effect: f64,
    /// Cells with readings.
    pub(crate) cells: usize,
    /// Mean squared residual in units of the stated uncertainty, robust against outliers; `None` for metrics that have
    /// no unit.
    pub(crate) dispersion: Option<f64>,
    /// Predicted DSF of every block.
    pub(crate) predicted: Vec<Vec<f64>>,
}

/// Sum of the pulls over each cell of each slab, and its share of the diagonal of the scatter.
type CellSums = BTreeMap<(usize, usize), (DVector<f64>, Vec<f64>)>;

/// Sums over one block.
struct Sums {
    key: (usize, usize),
    slab: usize,
    /// Squared pulls, and `1 / sigma^2`, with the derivatives.
    meat: Vec<f64>,
    stated: Vec<f64>,
    /// Pulls of each cell with the derivatives; diagonal of its share of `meat`; its readings.
    cells: Vec<(Vec<f64>, Vec<f64>, usize)>,
    /// `curvature y` with the derivatives.
    scale: Vec<f64>,
    /// Squared pulls in units of the uncertainty.
    squares: f64,
    predicted: Vec<f64>,
}

/// The covariance at the minimum `x`; `normal` are the normal equations there. `None` when no variable is determined.
///
/// `B^-1 M B^-1` \[White1980\] with the Gauss–Newton matrix `B` and the scatter `M` of the pulls: of single readings, or of
/// the sums over cells where residuals within a cell are correlated (the model is not quite right, pointing errors).
/// Where the residuals scatter less than stated, the stated uncertainties count. A relative change common to all
/// readings (beam power) adds a term of rank one.
pub(crate) fn covariance(
    objective: &Objective<'_>,
    x: &[f64],
    normal: &Normal,
    held: &[bool],
) -> Option<Covariance> {
    let n = x.len();
    let free: Vec<bool> = (0..n).map(|k| !held[k] && normal.matrix[(k, k)] > 0.0).collect();
    let bread = determined_inverse(normal, &free)?;
    let free: Vec<bool> = (0..n).map(|k| bread[(k, k)] > 0.0).collect();
    let locals = objective.locals(x);
    let all: Vec<Sums> = (0..objective.data.blocks.len())
        .into_par_iter()
        .map_init(Scratch::default, |scratch, b| {
            sums(objective, &locals, b, scratch)
        })
        .collect();
    let (mut meat, mut stated) = (DMatrix::zeros(n, n), DMatrix::zeros(n, n));
    let mut common = DVector::zeros(n);
    let mut squares = 0.0;
    // Cells of a slab, over its blocks.
    let mut cells = CellSums::new();
    for s in &all {
        let g = &locals[s.key.0][s.key.1].by_variable;
        let to = g.transpose();
        let m = g.nrows();
        meat += &to * symmetric(&s.meat, m) * g;
        stated += &to * symmetric(&s.stated, m) * g;
        common += &to * DVector::from_column_slice(&s.scale) * objective.data.slabs[s.slab].u_common;
        squares += s.squares;
        for (c, (sum, diagonal, count)) in s.cells.iter().enumerate() {
            if *count > 0 {
                let entry = cells
                    .entry((s.slab, c))
                    .or_insert_with(|| (DVector::zeros(n), vec![0.0; n]));
                entry.0 += &to * DVector::from_column_slice(sum);
                for (k, total) in entry.1.iter_mut().enumerate() {
                    *total += (0..m).map(|a| g[(a, k)].powi(2) * diagonal[a]).sum::<f64>();
                }
            }
        }
    }
    let independent = &bread * &meat * &bread;
    let clustered = cells
        .values()
        .fold(DMatrix::zeros(n, n), |sum: DMatrix<f64>, (s, _)| {
            sum + s * s.transpose()
        });
    let count = cells.len();
    let parameters = free.iter().filter(|f| **f).count();
    let of_cells =
        &bread * clustered * &bread * (count as f64 / count.saturating_sub(parameters).max(1) as f64);
    let (ratio, scatter) = cell_statistics(&of_cells, &independent, &cells, &free);
    let correlated = count > 2 * parameters && ratio > 1.0 + CORRELATED * scatter;
    let mut matrix = if correlated {
        at_least(of_cells, &independent)
    } else {
        independent
    };
    let readings = objective.data.len() as f64;
    let dispersion = (objective.metric == Metric::Chi2).then(|| {
        let expected = match objective.loss {
            Loss::SoftL1 => SOFT_L1_PULL,
            Loss::Linear => 1.0,
        };
        squares / (readings - parameters as f64).max(1.0) / expected
    });
    if objective.metric == Metric::Chi2 && objective.data.slabs.iter().all(|s| s.law_known) {
        let efficiency = match objective.loss {
            Loss::SoftL1 => SOFT_L1_PULL / SOFT_L1_CURVATURE.powi(2),
            Loss::Linear => 1.0,
        };
        let expected = Normal {
            matrix: stated,
            ..normal.clone()
        };
        if let Some(floor) = determined_inverse(&expected, &free) {
            matrix = at_least(matrix, &(floor * efficiency));
        }
    }
    let common = &bread * common;
    Some(Covariance {
        matrix: matrix + &common * common.transpose(),
        common,
        bread,
        free,
        design_effect: if correlated { ratio.max(1.0) } else { 1.0 },
        cells: count,
        dispersion,
        predicted: all.into_iter().map(|s| s.predicted).collect(),
    })
}

/// The inverse over `free`, or over as many of them as the data determine: while the matrix is singular, the variable
/// with the largest share in its null vector is dropped.
fn determined_inverse(normal: &Normal, free: &[bool]) -> Option<DMatrix<f64>> {
    let mut free = free.to_vec();
    while free.contains(&true) {
        if let Some(inverse) = normal.inverse(&free) {
            return Some(inverse);
        }
        let index: Vec<usize> = (0..free.len()).filter(|&k| free[k]).collect();
        let scaled = DMatrix::from_fn(index.len(), index.len(), |a, b| {
            let (i, j) = (index[a], index[b]);
            normal.matrix[(i, j)] / (normal.matrix[(i, i)] * normal.matrix[(j, j)]).sqrt().max(1e-300)
        });
        let eigen = scaled.symmetric_eigen();
        let least = eigen.eigenvalues.imin();
        let worst = eigen.eigenvectors.column(least).iamax();
        free[index[worst]] = false;
    }
    None
}

fn sums(
    objective: &Objective<'_>,
    locals: &[[crate::chart::Local; 2]],
    b: usize,
    scratch: &mut Scratch,
) -> Sums {
    let block = &objective.data.blocks[b];
    let slab = &objective.data.slabs[block.slab];
    let key = objective.key(block);
    let local = &locals[key.0][key.1];
    let p = local.columns;
    let mut out = Sums {
        key,
        slab: block.slab,
        meat: vec![0.0; p * (p + 1) / 2],
        stated: vec![0.0; p * (p + 1) / 2],
        cells: vec![(vec![0.0; p], vec![0.0; p], 0); CELLS],
        scale: vec![0.0; p],
        squares: 0.0,
        predicted: Vec::with_capacity(block.len()),
    };
    let mut nothing = vec![0.0; p];
    let (mut product, mut squared, mut weighted) = (Vec::new(), Vec::new(), Vec::new());
    for range in chunks(block, 0..block.len()) {
        let m = range.len();
        let rows = block.in_slab(&range);
        scratch.evaluate(objective.chart, local, block.view(slab, range.clone()), true);
        scratch.weigh(objective, block, range);
        out.predicted.extend_from_slice(&scratch.predicted[..m]);
        product.resize(m, 0.0);
        squared.clear();
        squared.extend(scratch.pull[..m].iter().map(|p| p * p));
        weighted.clear();
        weighted.extend(
            scratch.curvature[..m]
                .iter()
                .zip(&slab.y[rows.clone()])
                .map(|(c, y)| c * y),
        );
        let (columns, variance) = (&scratch.columns[..p * m], &slab.inverse_variance[rows.clone()]);
        let (gradient, zeros) = (&mut out.scale, &mut nothing);
        accumulate(
            columns,
            m,
            &squared,
            &weighted,
            &mut product,
            gradient,
            &mut out.meat,
        );
        accumulate(
            columns,
            m,
            variance,
            &squared,
            &mut product,
            zeros,
            &mut out.stated,
        );
        for j in 0..m {
            let cell = &mut out.cells[slab.cell[rows.start + j] as usize];
            cell.2 += 1;
            for a in 0..p {
                let d = columns[a * m + j];
                cell.0[a] += d * scratch.pull[j];
                cell.1[a] += d * d * squared[j];
            }
            if variance[j] > 0.0 {
                out.squares += squared[j] / variance[j];
            }
        }
    }
    out
}

/// Mean ratio of the variances from cells to those from independent readings, and the standard deviation of that
/// ratio if the readings are independent: `sqrt(2 / K)` for `K` cells of equal weight.
fn cell_statistics(
    of_cells: &DMatrix<f64>,
    independent: &DMatrix<f64>,
    cells: &CellSums,
    free: &[bool],
) -> (f64, f64) {
    let (mut ratio, mut scatter, mut n) = (0.0, 0.0_f64, 0.0);
    for k in (0..free.len()).filter(|&k| free[k] && independent[(k, k)] > 0.0) {
        ratio += of_cells[(k, k)] / independent[(k, k)];
        n += 1.0;
        let (sum, square) = cells
            .values()
            .fold((0.0, 0.0), |(s, q), (_, d)| (s + d[k], q + d[k] * d[k]));
        if sum > 0.0 {
            scatter = scatter.max((2.0 * square / (sum * sum)).sqrt());
        }
    }
    if n > 0.0 { (ratio / n, scatter) } else { (1.0, 0.0) }
}

/// `matrix` with every variance raised to that of `least` where it is smaller, correlations kept; `least` itself when
/// `matrix` has next to no scatter (noise-free readings).
fn at_least(mut matrix: DMatrix<f64>, least: &DMatrix<f64>) -> DMatrix<f64> {
    const NONE: f64 = 1e-6;
    let n = matrix.nrows();
    if (0..n).all(|k| matrix[(k, k)] <= NONE * least[(k, k)]) {
        return least.clone();
    }
    let factor: Vec<f64> = (0..n)
        .map(|k| match (matrix[(k, k)], least[(k, k)]) {
            (own, least) if own > 0.0 && least > own => (least / own).sqrt(),
            _ => 1.0,
        })
        .collect();
    for a in 0..n {
        for b in 0..n {
            matrix[(a, b)] *= factor[a] * factor[b];
        }
    }
    matrix
}
