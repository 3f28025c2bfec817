//! How many nodes a table needs along each axis.

use gonio_bsdf::compact::{Frame, Symmetry};

use super::base::Base;
use super::samples::{draw, spans};
use super::solve::{logs, nearest};
use super::source::{Pair, Source};

/// Points at which interpolation along one axis is compared with the model.
const PROBES: usize = 5000;
/// What remains of the error of linear interpolation when the nodes are fitted instead of taken from the model: measured,
/// 0.3 to 0.6 on the materials of docs/models/compact.md.
const FITTED: f64 = 0.55;

const X: &[usize] = &[4, 6, 8, 10, 12, 14, 16, 18, 20, 24, 28, 32, 40];
const U: &[usize] = &[6, 8, 10, 12, 14, 16, 20, 24, 28, 32, 40, 48, 64, 80, 96, 112, 128];
const QUARTER: &[usize] = &[2, 3, 4, 5, 6, 7, 9, 11, 13];
const HALF: &[usize] = &[3, 4, 5, 7, 9, 11, 13, 17, 21, 25, 33, 41];
const ROUND: &[usize] = &[4, 6, 8, 12, 16, 20, 24, 32, 40, 48, 64];

/// What is asked of a table.
#[derive(Clone, Copy, Debug)]
pub(super) struct Wanted {
    /// Relative L1 error, mean over incidences.
    pub(super) target: f64,
    /// Most nodes.
    pub(super) nodes: usize,
}

/// Signed errors of interpolation along each axis, for a choice of nodes each.
struct Errors {
    /// `[axis][choice][probe]`.
    of: [Vec<(usize, Vec<f32>)>; 4],
    weight: Vec<f32>,
}

/// The smallest frame whose estimated error meets the target; the best one within the nodes where none does. The
/// estimate adds the errors of interpolation along the axes, each measured alone, with its sign.
pub(super) fn plan(
    source: &Source<'_>,
    base: &Base,
    symmetry: Symmetry,
    phi_x: f64,
    wanted: Wanted,
) -> Frame {
    let mut best: Option<(Frame, f64)> = None;
    for scale in [0.5, 1.0, 2.0] {
        let frame = Frame {
            symmetry,
            width: base.width.map(|w| (w * scale).clamp(1e-3, 1.0)),
            phi_x,
            shape: [2, 2, 2, 4],
        };
        let errors = Errors::measured(source, base, frame);
        let (shape, error) = errors.choose(wanted);
        let nodes = |f: &Frame| f.len();
        let frame = Frame { shape, ..frame };
        let better = best.is_none_or(|(known, known_error)| {
            let (met, known_met) = (error <= wanted.target, known_error <= wanted.target);
            match (met, known_met) {
                (true, true) => nodes(&frame) < nodes(&known),
                (false, false) => error < known_error,
                _ => met,
            }
        });
        if better {
            best = Some((frame, error));
        }
    }
    match best {
        Some((frame, _)) => frame,
        None => unreachable!("three scales were tried"),
    }
}

impl Errors {
    fn measured(source: &Source<'_>, base: &Base, mut frame: Frame) -> Self {
        let symmetry = frame.symmetry;
        let phi_i: &[usize] = match symmetry {
            Symmetry::Isotropic | Symmetry::IsotropicChiral => &[1],
            Symmetry::Quadrilateral => QUARTER,
            Symmetry::Bilateral | Symmetry::HalfTurn => HALF,
            Symmetry::Anisotropic => ROUND,
        };
        let phi_h = if symmetry == Symmetry::Isotropic {
            HALF
        } else {
            ROUND
        };
        // one node of the incidence's azimuth, or the least there may be
        frame.shape = [2, phi_i[0], 2, phi_h[0]];
        let samples = draw(source, base, &frame, 0, PROBES);
        let density = frame.density();
        let span = spans(&frame);
        let n = samples.pairs.len();
        let channels = source.channels();
        let weight: Vec<f32> = (0..n)
            .map(|j| samples.columns.iter().map(|c| c.weight[j]).sum())
            .collect();
        let coordinates: Vec<[f64; 4]> = samples
            .places
            .iter()
            .map(|p| {
                [0, 1, 2, 3].map(|a| {
                    if density[a] > 0.0 {
                        f64::from(p[a]) / density[a]
                    } else {
                        0.0
                    }
                })
            })
            .collect();
        let truth = logs(source, base, &samples.pairs);
        let choices = [X, phi_i, U, phi_h];
        let of = [0, 1, 2, 3].map(|axis| {
            choices[axis]
                .iter()
                .map(|&nodes| {
                    if nodes == 1 {
                        return (nodes, vec![0.0; n]);
                    }
                    let intervals = if frame.is_round(axis) { nodes } else { nodes - 1 };
                    let step = span[axis] / intervals as f64;
                    let mut ends: [Vec<Pair>; 2] = [Vec::with_capacity(n), Vec::with_capacity(n)];
                    let mut shares = Vec::with_capacity(n);
                    for at in &coordinates {
                        let place = at[axis] / step;
                        let low = place.floor().min(intervals as f64 - 1.0);
                        shares.push(place - low);
                        for (k, end) in ends.iter_mut().enumerate() {
                            let mut moved = *at;
                            moved[axis] = (low + k as f64) * step;
                            end.push(nearest(&frame, moved));
                        }
                    }
                    let [low, high] = ends.map(|pairs| logs(source, base, &pairs));
                    let errors = (0..n)
                        .map(|j| {
                            let mean = (0..channels)
                                .map(|c| {
                                    let k = c * n + j;
                                    low[k] + shares[j] * (high[k] - low[k]) - truth[k]
                                })
                                .sum::<f64>();
                            (mean / channels as f64) as f32
                        })
                        .collect();
                    (nodes, errors)
                })
                .collect()
        });
        Errors { of, weight }
    }

    /// Nodes along the axes and the estimated error.
    fn choose(&self, wanted: Wanted) -> ([usize; 4], f64) {
        let total: f32 = self.weight.iter().sum::<f32>().max(f32::MIN_POSITIVE);
        let mut best: Option<([usize; 4], f64)> = None;
        let mut outer = vec![0.0f32; self.weight.len()];
        for (n0, e0) in &self.of[0] {
            for (n1, e1) in &self.of[1] {
                for ((outer, a), b) in outer.iter_mut().zip(e0).zip(e1) {
                    *outer = a + b;
                }
                for (n2, e2) in &self.of[2] {
                    for (n3, e3) in &self.of[3] {
                        let shape = [*n0, *n1, *n2, *n3];
                        let nodes: usize = shape.iter().product();
                        if nodes > wanted.nodes {
                            continue;
                        }
                        if let Some((known, error)) = best
                            && error <= wanted.target
                            && nodes >= known.iter().product()
                        {
                            continue;
                        }
                        let sum: f32 = (0..outer.len())
                            .map(|j| {
                                self.weight[j]
                                    * ((outer[j] + e2[j] + e3[j]).clamp(-3.0, 3.0).exp() - 1.0).abs()
                            })
                            .sum();
                        let error = FITTED * f64::from(sum / total);
                        let better = best.is_none_or(|(_, known)| error < known || error <= wanted.target);
                        if better {
                            best = Some((shape, error));
                        }
                    }
                }
            }
        }
        best.unwrap_or(([2, self.of[1][0].0, 2, 4], f64::INFINITY))
    }
}
