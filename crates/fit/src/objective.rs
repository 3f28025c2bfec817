//! The cost of a model over all readings, and its normal equations.

use std::ops::Range;

use gonio_bsdf::analytic::PairsView;
use gonio_geom::Component;
use nalgebra::{DMatrix, DVector};
use rayon::prelude::*;

use crate::chart::{Chart, Local};
use crate::data::FitData;
use crate::metric::{Columns, Loss, Metric, Weighed, accumulate, weigh};
use crate::normal::Normal;
use crate::slab::Block;
use crate::solver::LeastSquares;

/// Pairs worked on at once: their columns stay in the first-level cache.
const CHUNK: usize = 512;
/// Chunks of one task.
const CHUNKS_A_TASK: usize = 16;
/// The floor of cube roots in standard deviations of the read-out noise.
const FLOOR: f64 = 3.0;

/// A model over readings in a metric.
pub(crate) struct Objective<'a> {
    pub(crate) chart: &'a Chart<'a>,
    pub(crate) data: &'a FitData,
    pub(crate) metric: Metric,
    pub(crate) loss: Loss,
    pub(crate) by_solid_angle: bool,
}

/// What one task adds up, in the parameters of the parts.
struct Gram {
    cost: f64,
    gradient: Vec<f64>,
    matrix: Vec<f64>,
}

/// Buffers of one thread.
#[derive(Default)]
pub(crate) struct Scratch {
    /// Predicted DSF of each reading of the chunk.
    pub(crate) predicted: Vec<f64>,
    /// Its derivatives, one row a parameter of a part.
    pub(crate) columns: Vec<f64>,
    term: Vec<f64>,
    nodes: Vec<f64>,
    pub(crate) curvature: Vec<f64>,
    pub(crate) pull: Vec<f64>,
    product: Vec<f64>,
}

fn resized(v: &mut Vec<f64>, n: usize) -> &mut [f64] {
    if v.len() < n {
        v.resize(n, 0.0);
    }
    &mut v[..n]
}

impl Scratch {
    /// Predictions, and derivatives when wanted, of readings with as many pairs each as there are weights.
    pub(crate) fn evaluate(
        &mut self,
        chart: &Chart<'_>,
        local: &Local,
        (view, weights): (PairsView<'_>, &[f64]),
        derivatives: bool,
    ) {
        let nodes = weights.len();
        let m = view.len() / nodes;
        resized(&mut self.predicted, m).fill(0.0);
        resized(&mut self.columns, if derivatives { local.columns * m } else { 0 });
        let mut row = 0;
        for (k, p) in &local.parts {
            let family = chart.model.parts[*k].family;
            let term = resized(&mut self.term, m * nodes);
            let own = if derivatives { p.len() } else { 0 };
            match (derivatives, nodes) {
                (false, _) => family.dsf(p, view, term),
                (true, 1) => {
                    family.dsf_and_gradient(p, view, term, &mut self.columns[row * m..(row + own) * m]);
                }
                (true, _) => {
                    let gradient = resized(&mut self.nodes, own * m * nodes);
                    family.dsf_and_gradient(p, view, term, gradient);
                    mean_over_nodes(gradient, weights, &mut self.columns[row * m..(row + own) * m]);
                }
            }
            row += own;
            if nodes == 1 {
                for (sum, v) in self.predicted[..m].iter_mut().zip(term.iter()) {
                    *sum += v;
                }
            } else {
                for (sum, v) in self.predicted[..m].iter_mut().zip(term.chunks_exact(nodes)) {
                    *sum += v.iter().zip(weights).map(|(v, w)| v * w).sum::<f64>();
                }
            }
        }
    }

    /// Curvature and pull of the readings that [`Scratch::evaluate`] looked at last; returns their cost.
    pub(crate) fn weigh(&mut self, objective: &Objective<'_>, block: &Block, range: Range<usize>) -> f64 {
        let m = range.len();
        let slab = &objective.data.slabs[block.slab];
        let rows = block.in_slab(&range);
        resized(&mut self.curvature, m);
        resized(&mut self.pull, m);
        weigh(
            objective.metric,
            objective.loss,
            objective.by_solid_angle,
            FLOOR * slab.law.constant.sqrt(),
            Columns {
                predicted: &self.predicted[..m],
                y: &slab.y[rows.clone()],
                omega: &slab.omega[rows.clone()],
                inverse_variance: &slab.inverse_variance[rows],
            },
            &mut Weighed {
                curvature: &mut self.curvature[..m],
                pull: &mut self.pull[..m],
            },
        )
    }
}

fn mean_over_nodes(values: &[f64], weights: &[f64], out: &mut [f64]) {
    for (mean, v) in out.iter_mut().zip(values.chunks_exact(weights.len())) {
        *mean = v.iter().zip(weights).map(|(v, w)| v * w).sum();
    }
}

/// Readings of `block` in pieces of about [`CHUNK`] pairs.
pub(crate) fn chunks(block: &Block, within: Range<usize>) -> impl Iterator<Item = Range<usize>> {
    let size = (CHUNK / block.pairs_each()).max(4);
    let end = within.end;
    within
        .step_by(size)
        .map(move |start| start..(start + size).min(end))
}

impl Objective<'_> {
    /// The model at `x` for every channel and component.
    pub(crate) fn locals(&self, x: &[f64]) -> Vec<[Local; 2]> {
        (0..self.data.channels.len())
            .map(|c| {
                [Component::Reflection, Component::Transmission].map(|side| self.chart.local(x, c, side))
            })
            .collect()
    }

    /// Position in [`Objective::locals`] of the model of `block`.
    pub(crate) fn key(&self, block: &Block) -> (usize, usize) {
        let slab = &self.data.slabs[block.slab];
        (
            slab.channel,
            usize::from(slab.component == Component::Transmission),
        )
    }

    /// Pieces of all blocks for one thread each.
    fn tasks(&self) -> Vec<(usize, Range<usize>)> {
        let mut tasks = Vec::new();
        for (b, block) in self.data.blocks.iter().enumerate() {
            let size = (CHUNK / block.pairs_each()).max(4) * CHUNKS_A_TASK;
            let mut start = 0;
            while start < block.len() {
                let end = (start + size).min(block.len());
                tasks.push((b, start..end));
                start = end;
            }
        }
        tasks
    }

    /// Predicted DSF of every block.
    pub(crate) fn predict(&self, x: &[f64]) -> Vec<Vec<f64>> {
        let locals = self.locals(x);
        self.data
            .blocks
            .par_iter()
            .map_init(Scratch::default, |scratch, block| {
                let (c, side) = self.key(block);
                let slab = &self.data.slabs[block.slab];
                let mut out = Vec::with_capacity(block.len());
                for range in chunks(block, 0..block.len()) {
                    let m = range.len();
                    scratch.evaluate(self.chart, &locals[c][side], block.view(slab, range), false);
                    out.extend_from_slice(&scratch.predicted[..m]);
                }
                out
            })
            .collect()
    }

    fn gram(&self, block: &Block, range: Range<usize>, local: &Local, scratch: &mut Scratch) -> Gram {
        let n = local.columns;
        let slab = &self.data.slabs[block.slab];
        let mut gram = Gram {
            cost: 0.0,
            gradient: vec![0.0; n],
            matrix: vec![0.0; n * (n + 1) / 2],
        };
        for piece in chunks(block, range) {
            let m = piece.len();
            scratch.evaluate(self.chart, local, block.view(slab, piece.clone()), true);
            gram.cost += scratch.weigh(self, block, piece);
            accumulate(
                &scratch.columns[..n * m],
                m,
                &scratch.curvature,
                &scratch.pull,
                resized(&mut scratch.product, m),
                &mut gram.gradient,
                &mut gram.matrix,
            );
        }
        gram
    }
}

impl LeastSquares for Objective<'_> {
    fn len(&self) -> usize {
        self.chart.len()
    }

    /// Sums run in a fixed order, so that the result does not depend on the number of threads.
    fn normal(&self, x: &[f64], out: &mut Normal) {
        let locals = self.locals(x);
        let tasks = self.tasks();
        let grams: Vec<Gram> = tasks
            .par_iter()
            .map_init(Scratch::default, |scratch, (b, range)| {
                let block = &self.data.blocks[*b];
                let (c, side) = self.key(block);
                self.gram(block, range.clone(), &locals[c][side], scratch)
            })
            .collect();
        let mut sums: Vec<[Option<Gram>; 2]> = locals.iter().map(|_| [None, None]).collect();
        for (gram, (b, _)) in grams.into_iter().zip(&tasks) {
            let (c, side) = self.key(&self.data.blocks[*b]);
            match &mut sums[c][side] {
                Some(sum) => {
                    sum.cost += gram.cost;
                    sum.gradient
                        .iter_mut()
                        .zip(&gram.gradient)
                        .for_each(|(s, g)| *s += g);
                    sum.matrix.iter_mut().zip(&gram.matrix).for_each(|(s, g)| *s += g);
                }
                empty => *empty = Some(gram),
            }
        }
        for (locals, sums) in locals.iter().zip(sums) {
            for (local, sum) in locals.iter().zip(sums) {
                let Some(sum) = sum else { continue };
                out.cost += sum.cost;
                let g = &local.by_variable;
                out.gradient += g.transpose() * DVector::from_column_slice(&sum.gradient);
                out.matrix += g.transpose() * symmetric(&sum.matrix, local.columns) * g;
            }
        }
    }
}

/// The full matrix of an upper triangle stored row after row.
pub(crate) fn symmetric(upper: &[f64], n: usize) -> DMatrix<f64> {
    let mut out = DMatrix::zeros(n, n);
    let mut at = 0;
    for a in 0..n {
        for b in a..n {
            out[(a, b)] = upper[at];
            out[(b, a)] = upper[at];
            at += 1;
        }
    }
    out
}
