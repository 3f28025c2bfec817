//! Bounded Levenberg–Marquardt on accumulated normal equations.

use std::sync::atomic::{AtomicBool, Ordering};

use crate::normal::Normal;

/// A sum of squares (or of robust losses of residuals) as the solver sees it.
pub trait LeastSquares {
    /// Number of variables.
    fn len(&self) -> usize;

    /// Whether there is no variable.
    fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// Cost, gradient and Gauss–Newton matrix at `x` into `out`, which comes cleared and of the right size.
    fn normal(&self, x: &[f64], out: &mut Normal);
}

/// When to stop, and what may move.
#[derive(Clone, Debug)]
pub struct SolverOptions<'a> {
    /// Most evaluations of the normal equations.
    pub max_evaluations: usize,
    /// Stop when every variable moves by less than this times its size.
    pub step_tolerance: f64,
    /// Stop when the residuals are orthogonal to every derivative within this cosine.
    pub gradient_tolerance: f64,
    /// Stop when the predicted decrease of the cost is below this fraction of it.
    pub cost_tolerance: f64,
    /// Variables that stay where they are, as long as the variables; empty: none.
    pub fixed: &'a [bool],
    /// Set by another thread to stop at the next evaluation.
    pub cancel: Option<&'a AtomicBool>,
}

impl Default for SolverOptions<'_> {
    fn default() -> Self {
        SolverOptions {
            max_evaluations: 200,
            step_tolerance: 1e-9,
            gradient_tolerance: 1e-12,
            cost_tolerance: 1e-15,
            fixed: &[],
            cancel: None,
        }
    }
}

/// Why the solver stopped.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Stop {
    /// The residuals are orthogonal to every derivative.
    Gradient,
    /// No variable moves any more.
    Step,
    /// The cost cannot be told to decrease any more.
    Cost,
    /// The allowed number of evaluations is used up.
    Evaluations,
    /// The cost or its derivatives are not finite at the start.
    NotFinite,
    /// The cancel flag was set.
    Cancelled,
}

impl Stop {
    /// Whether a minimum was found.
    pub fn converged(self) -> bool {
        matches!(self, Stop::Gradient | Stop::Step | Stop::Cost)
    }
}

/// Where the solver ended.
#[derive(Clone, Debug)]
pub struct Solution {
    /// The variables.
    pub x: Vec<f64>,
    /// Normal equations at `x`.
    pub normal: Normal,
    /// Evaluations of the normal equations.
    pub evaluations: usize,
    /// Why it ended.
    pub stop: Stop,
}

/// Damping at the start, in units of the matrix' diagonal.
const DAMPING: f64 = 1e-3;
/// Largest damping before a step is given up.
const MAX_DAMPING: f64 = 1e16;

/// Minimises `problem` from `start` with every variable between `low` and `high`.
///
/// Levenberg–Marquardt with Marquardt's scaling \[Marquardt1963\] and the gain-ratio control of the damping of
/// \[MadsenNielsenTingleff2004, alg. 3.16\]. Each step minimises the damped quadratic model within the box by an
/// active-set method \[StarkParker1995\]. Only the matrix of the
/// normal equations is kept, never the Jacobian: memory does not grow with the number of residuals.
///
/// `start` is moved into the box first. Slices of unequal length panic.
pub fn minimise(
    problem: &dyn LeastSquares,
    start: &[f64],
    low: &[f64],
    high: &[f64],
    options: &SolverOptions<'_>,
) -> Solution {
    let n = problem.len();
    assert!(
        start.len() == n && low.len() == n && high.len() == n,
        "one start and two bounds a variable"
    );
    let held = |k: usize| options.fixed.get(k).copied().unwrap_or(false);
    let cancelled = || options.cancel.is_some_and(|c| c.load(Ordering::Relaxed));
    let mut x: Vec<f64> = (0..n).map(|k| start[k].max(low[k]).min(high[k])).collect();
    let mut normal = Normal::new(n);
    problem.normal(&x, &mut normal);
    let mut evaluations = 1;
    let finish = |x, normal, evaluations, stop| Solution {
        x,
        normal,
        evaluations,
        stop,
    };
    if !normal.is_finite() {
        return finish(x, normal, evaluations, Stop::NotFinite);
    }
    let (mut damping, mut growth) = (DAMPING, 2.0);
    let mut scale = vec![0.0_f64; n];
    let mut trial = Normal::new(n);
    loop {
        for (k, s) in scale.iter_mut().enumerate() {
            *s = s.max(normal.matrix[(k, k)]);
        }
        // A variable on its bound that wants to leave the box, and one without influence, stay.
        let stays: Vec<bool> = (0..n)
            .map(|k| {
                let g = normal.gradient[k];
                held(k)
                    || normal.matrix[(k, k)] <= 0.0
                    || (x[k] <= low[k] && g >= 0.0)
                    || (x[k] >= high[k] && g <= 0.0)
            })
            .collect();
        let cosine = (0..n)
            .filter(|&k| !stays[k])
            .map(|k| normal.gradient[k].abs() / (2.0 * normal.cost * normal.matrix[(k, k)]).sqrt())
            .fold(0.0, f64::max);
        if normal.cost == 0.0 || cosine <= options.gradient_tolerance {
            return finish(x, normal, evaluations, Stop::Gradient);
        }
        loop {
            if cancelled() {
                return finish(x, normal, evaluations, Stop::Cancelled);
            }
            if damping > MAX_DAMPING {
                return finish(x, normal, evaluations, Stop::Cost);
            }
            let room: Vec<(f64, f64)> = (0..n).map(|k| (low[k] - x[k], high[k] - x[k])).collect();
            let Some(step) = normal.boxed_step(damping, &scale, &stays, &room) else {
                damping *= growth;
                growth *= 2.0;
                continue;
            };
            let predicted = normal.predicted_decrease(&step);
            let tiny = (0..n)
                .all(|k| step[k].abs() <= options.step_tolerance * (x[k].abs() + options.step_tolerance));
            if tiny && damping < 1.0 {
                return finish(x, normal, evaluations, Stop::Step);
            }
            if predicted <= options.cost_tolerance * normal.cost && damping < 1.0 {
                return finish(x, normal, evaluations, Stop::Cost);
            }
            if evaluations >= options.max_evaluations {
                return finish(x, normal, evaluations, Stop::Evaluations);
            }
            let next: Vec<f64> = (0..n)
                .map(|k| (x[k] + step[k]).max(low[k]).min(high[k]))
                .collect();
            trial.clear();
            problem.normal(&next, &mut trial);
            evaluations += 1;
            let gain = (normal.cost - trial.cost) / predicted;
            if trial.is_finite() && gain > 0.0 {
                damping *= (1.0 - (2.0 * gain - 1.0).powi(3)).max(1.0 / 9.0);
                damping = damping.max(1e-14);
                growth = 2.0;
                x = next;
                std::mem::swap(&mut normal, &mut trial);
                break;
            }
            // Past the rounding of the cost a decrease can no longer be seen.
            if predicted.abs() <= 1e-13 * normal.cost {
                return finish(x, normal, evaluations, Stop::Cost);
            }
            damping *= growth;
            growth *= 2.0;
        }
    }
}
