//! From a starting point to the minimum: weights from the prediction, and the beam profile where it matters.

use rayon::prelude::*;

use crate::chart::Chart;
use crate::data::{FitData, Weights};
use crate::metric::{Loss, Metric};
use crate::objective::{Objective, Scratch};
use crate::slab::Nodes;
use crate::solver::{Solution, SolverOptions, Stop, minimise};

/// Rounds of weights at most. A model that suits reaches the fixed point in three or four.
const WEIGHT_ROUNDS: usize = 60;
/// Evaluations of a round at most: a minimum that the next weights move is not worth more.
const ROUND_EVALUATIONS: usize = 12;
/// A round that does not move the minimum by less than this share of the one before is restless. After the first few of
/// them weights change to the geometric mean of old and new ones; after some more they stay as they are.
const CONVERGING: f64 = 0.6;
const DAMPED_AFTER: usize = 2;
const HELD_AFTER: usize = 8;
/// A round that moves the minimum by less than this many standard deviations is the last.
const SETTLED: f64 = 1e-3;
/// Rounds of beam profile rules at most.
const PLAN_ROUNDS: usize = 5;
/// Error of a quadrature rule that is allowed in every reading at once, in standard deviations of their mean: the errors
/// of neighbours have the same sign, and what one reading hides moves the minimum when all of them share it.
const RULE_BIAS: f64 = 0.1;
/// The same as a fraction of the DSF: rounding.
const RULE_RELATIVE: f64 = 1e-6;
/// Relative change of an interface's index ratio that asks for new rules.
const RATIO_MOVED: f64 = 1e-3;

/// Readings whose rules are tried at once.
const PLANNED: usize = 64;

/// What is minimised.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Goal {
    pub(crate) metric: Metric,
    pub(crate) loss: Loss,
    pub(crate) by_solid_angle: bool,
    pub(crate) weights: Weights,
}

impl Goal {
    pub(crate) fn objective<'a>(&self, chart: &'a Chart<'a>, data: &'a FitData) -> Objective<'a> {
        Objective {
            chart,
            data,
            metric: self.metric,
            loss: self.loss,
            by_solid_angle: self.by_solid_angle,
        }
    }
}

/// The minimum from `start` with weights that belong to it. Leaves the weights in `data`. Of a model that suits so little
/// that minimum and weights chase each other, the minimum for the mean weights of the last rounds.
pub(crate) fn settle(
    chart: &Chart<'_>,
    data: &mut FitData,
    goal: Goal,
    start: &[f64],
    (low, high): (&[f64], &[f64]),
    options: &SolverOptions<'_>,
) -> Solution {
    if goal.metric != Metric::Chi2 || goal.weights == Weights::Stated {
        if goal.metric == Metric::Chi2 {
            data.weigh_as_stated();
        }
        return minimise(&goal.objective(chart, data), start, low, high, options);
    }
    let mut x = start.to_vec();
    let (mut evaluations, mut round, mut restless) = (0, 0, 0);
    let mut before = f64::INFINITY;
    loop {
        round += 1;
        let predicted = goal.objective(chart, data).predict(&x);
        data.reweigh(&predicted, restless >= DAMPED_AFTER);
        let last = restless >= HELD_AFTER || round == WEIGHT_ROUNDS;
        let within = SolverOptions {
            max_evaluations: if last {
                options.max_evaluations
            } else {
                ROUND_EVALUATIONS
            },
            ..options.clone()
        };
        let mut found = minimise(&goal.objective(chart, data), &x, low, high, &within);
        evaluations += found.evaluations;
        found.evaluations = evaluations;
        let step = nalgebra::DVector::from_iterator(x.len(), found.x.iter().zip(&x).map(|(a, b)| a - b));
        let moved = step.dot(&(&found.normal.matrix * &step)).max(0.0).sqrt();
        let settled = found.stop.converged() && moved < SETTLED * misfit(goal.loss, &found, data.len());
        if settled || last || matches!(found.stop, Stop::Cancelled | Stop::NotFinite) {
            return found;
        }
        restless += usize::from(moved > CONVERGING * before);
        before = moved;
        x = found.x;
    }
}

/// How many times larger the uncertainties of the parameters are than the stated noise makes them, about; at least one. In
/// residuals that scatter `s` times as much as stated the pull of soft-L1 stays and its curvature falls as `1 / s`.
fn misfit(loss: Loss, found: &Solution, readings: usize) -> f64 {
    let mean = found.normal.cost / readings.max(1) as f64;
    match loss {
        Loss::SoftL1 => mean.sqrt().max(1.0),
        Loss::Linear => (2.0 * mean).sqrt().max(1.0),
    }
}

/// [`settle`] with the beam profile folded into the model for every reading that it changes.
pub(crate) fn refine(
    chart: &Chart<'_>,
    data: &mut FitData,
    goal: Goal,
    start: &[f64],
    bounds: (&[f64], &[f64]),
    options: &SolverOptions<'_>,
) -> Solution {
    if data.profiles.iter().all(Option::is_none) {
        return settle(chart, data, goal, start, bounds, options);
    }
    data.index_ratios = chart.index_ratios(start);
    let mut levels = plan(chart, data, start);
    data.rebuild(Some(&mut levels));
    let mut found = settle(chart, data, goal, start, bounds, options);
    for _ in 1..PLAN_ROUNDS {
        if found.stop == Stop::Cancelled || found.stop == Stop::NotFinite {
            break;
        }
        let ratios = chart.index_ratios(&found.x);
        let moved = |(old, new): (&f64, &f64)| (old - new).abs() > RATIO_MOVED * old;
        // Finer rules than needed do no harm; only readings that need more matter.
        let mut finer = data.index_ratios.iter().zip(&ratios).any(moved);
        data.index_ratios = ratios;
        let next = plan(chart, data, &found.x);
        for (old, new) in levels.iter_mut().flatten().zip(next.iter().flatten()) {
            finer |= new > old;
            *old = (*old).max(*new);
        }
        if !finer {
            break;
        }
        data.rebuild(Some(&mut levels));
        let evaluations = found.evaluations;
        found = settle(chart, data, goal, &found.x, bounds, options);
        found.evaluations += evaluations;
    }
    found
}

/// Folds the beam profile into the predictions of the model at `x` where it changes them.
pub(crate) fn fold_in_beam(chart: &Chart<'_>, data: &mut FitData, x: &[f64]) {
    if data.profiles.iter().any(Option::is_some) {
        data.index_ratios = chart.index_ratios(x);
        let mut levels = plan(chart, data, x);
        data.rebuild(Some(&mut levels));
    }
}

/// The coarsest rule that serves each reading: the one that the next finer one hardly changes.
fn plan(chart: &Chart<'_>, data: &FitData, x: &[f64]) -> Vec<Vec<u8>> {
    let allowed = RULE_BIAS / (data.len().max(1) as f64).sqrt();
    data.slabs
        .par_iter()
        .map_init(Scratch::default, |scratch, slab| {
            let mut levels = vec![0_u8; slab.y.len()];
            let Some(profile) = &data.profiles[slab.channel] else {
                return levels;
            };
            let local = chart.local(x, slab.channel, slab.component);
            let mut value = Vec::with_capacity(slab.y.len());
            for start in (0..slab.y.len()).step_by(PLANNED) {
                let view = slab.pairs.view(start..(start + PLANNED).min(slab.y.len()));
                scratch.evaluate(chart, &local, (view, &[1.0]), false);
                value.extend_from_slice(&scratch.predicted[..view.len()]);
            }
            let mut with_rule = |index: &[u32], level: usize| -> Vec<f64> {
                let mut out = Vec::with_capacity(index.len());
                for some in index.chunks(PLANNED) {
                    let rows = some.iter().map(|j| *j as usize);
                    let ratio = data.index_ratios[slab.channel];
                    let nodes = Nodes::new(slab, rows, (profile, level), ratio);
                    let view = nodes.pairs.view(0..nodes.pairs.len());
                    scratch.evaluate(chart, &local, (view, &nodes.weights), false);
                    out.extend_from_slice(&scratch.predicted[..some.len()]);
                }
                out
            };
            let mut active: Vec<u32> = (0..slab.y.len() as u32).collect();
            for level in 0..profile.levels() {
                let finer = with_rule(&active, level);
                let (mut rest, mut rest_value) = (Vec::new(), Vec::new());
                for ((&j, &coarse), &fine) in active.iter().zip(&value).zip(&finer) {
                    let sigma = (slab.law.variance(fine) + slab.extra[j as usize]).sqrt();
                    if (fine - coarse).abs() > RULE_RELATIVE * fine.abs() + allowed * sigma {
                        levels[j as usize] = level as u8 + 1;
                        rest.push(j);
                        rest_value.push(fine);
                    }
                }
                (active, value) = (rest, rest_value);
                if active.is_empty() {
                    break;
                }
            }
            levels
        })
        .collect()
}
