//! The values of a table that come closest to the model between the nodes as well.

use gonio_bsdf::compact::Frame;
use rayon::prelude::*;

use super::base::Base;
use super::samples::{Column, Samples, log_ratio};
use super::source::{Pair, Source};

/// Steps of the conjugate gradients.
const STEPS: usize = 30;
/// Weight of a node's first value, in those of a sample of mean light.
const HOLD: f64 = 0.02;
/// Weight of a sample without light.
const DARK: f64 = 1e-3;

/// The nodes of a frame.
#[derive(Clone, Copy, Debug)]
pub(super) struct Grid {
    nodes: [usize; 4],
    round: [bool; 4],
    stride: [usize; 4],
}

/// Up to sixteen nodes and their shares.
type Corners = ([u32; 16], [f32; 16], usize);

impl Grid {
    pub(super) fn new(frame: &Frame) -> Self {
        Grid {
            nodes: frame.shape,
            round: [0, 1, 2, 3].map(|k| frame.is_round(k)),
            stride: [0, 1, 2, 3].map(|k| frame.shape[k + 1..].iter().product()),
        }
    }

    fn corners(&self, place: &[f32; 4]) -> Corners {
        let (mut at, mut share, mut used) = ([0u32; 16], [0.0f32; 16], 1);
        share[0] = 1.0;
        for (k, &n) in self.nodes.iter().enumerate() {
            if n == 1 {
                continue;
            }
            let (low, high, t) = if self.round[k] {
                let low = place[k] as usize;
                (low % n, (low + 1) % n, place[k] - low as f32)
            } else {
                let low = (place[k] as usize).min(n - 2);
                (low, low + 1, (place[k] - low as f32).min(1.0))
            };
            for j in 0..used {
                at[used + j] = at[j] + (high * self.stride[k]) as u32;
                share[used + j] = share[j] * t;
                at[j] += (low * self.stride[k]) as u32;
                share[j] *= 1.0 - t;
            }
            used *= 2;
        }
        (at, share, used)
    }

    /// Interpolated value.
    pub(super) fn at(&self, values: &[f64], place: &[f32; 4]) -> f64 {
        let (at, share, used) = self.corners(place);
        (0..used)
            .map(|j| f64::from(share[j]) * values[at[j] as usize])
            .sum()
    }
}

/// The pairs at the nodes; where a node is no pair, the nearest one of smaller half vector.
pub(super) fn nodes(frame: &Frame) -> Vec<Pair> {
    let [_, n1, n2, n3] = frame.shape;
    let density = frame.density();
    (0..frame.len())
        .into_par_iter()
        .map(|k| {
            let node = [k / (n1 * n2 * n3), k / (n2 * n3) % n1, k / n3 % n2, k % n3];
            nearest(
                frame,
                [0, 1, 2, 3].map(|a| {
                    if density[a] > 0.0 {
                        node[a] as f64 / density[a]
                    } else {
                        0.0
                    }
                }),
            )
        })
        .collect()
}

/// Logarithms of pairs, `[channel][pair]`.
pub(super) fn logs(source: &Source<'_>, base: &Base, pairs: &[Pair]) -> Vec<f64> {
    let n = source.channels();
    let (f, b) = (source.many(pairs), base.many(source, pairs));
    (0..n * pairs.len())
        .map(|k| {
            let j = (k % pairs.len()) * n + k / pairs.len();
            log_ratio(f[j], b[j])
        })
        .collect()
}

/// The pair at coordinates, drawn towards the mirror direction until there is one.
pub(super) fn nearest(frame: &Frame, at: [f64; 4]) -> Pair {
    let [x, p_i, mut u, p_h] = at;
    let x = x.min(0.985);
    for _ in 0..200 {
        if let Some((wi, ws, _)) = frame.pair([x, p_i, u, p_h]) {
            return (wi, ws);
        }
        u *= 0.95;
    }
    // the mirror direction itself
    match frame.pair([x, p_i, 0.0, p_h]) {
        Some((wi, ws, _)) => (wi, ws),
        None => (gonio_geom::Direction::NORMAL, gonio_geom::Direction::NORMAL),
    }
}

/// Least squares of one channel's samples, weighted by their light, from `values` on.
///
/// Conjugate gradients of the normal equations with a diagonal preconditioner \[GolubVanLoan2013, section 11.5\]; each
/// node is held to its first value a little, so that those without light stay what they were.
pub(super) fn refine(grid: &Grid, samples: &Samples, column: &Column, values: &mut [f64]) {
    let n = values.len();
    let weight = |j: usize| f64::from(column.weight[j]) + DARK;
    let (mut diagonal, mut residual) = (vec![HOLD; n], vec![0.0; n]);
    for (j, place) in samples.places.iter().enumerate() {
        let (at, share, used) = grid.corners(place);
        let found: f64 = (0..used)
            .map(|k| f64::from(share[k]) * values[at[k] as usize])
            .sum();
        let pull = weight(j) * (f64::from(column.log[j]) - found);
        for k in 0..used {
            let share = f64::from(share[k]);
            diagonal[at[k] as usize] += weight(j) * share * share;
            residual[at[k] as usize] += share * pull;
        }
    }
    let product = |p: &[f64]| {
        let mut out: Vec<f64> = p.iter().map(|v| HOLD * v).collect();
        for (j, place) in samples.places.iter().enumerate() {
            let (at, share, used) = grid.corners(place);
            let found: f64 = (0..used).map(|k| f64::from(share[k]) * p[at[k] as usize]).sum();
            let pull = weight(j) * found;
            for k in 0..used {
                out[at[k] as usize] += f64::from(share[k]) * pull;
            }
        }
        out
    };
    let dot = |a: &[f64], b: &[f64]| -> f64 { a.iter().zip(b).map(|(a, b)| a * b).sum() };
    let scaled = |r: &[f64]| -> Vec<f64> { r.iter().zip(&diagonal).map(|(r, d)| r / d).collect() };
    let mut z = scaled(&residual);
    let mut p = z.clone();
    let mut rz = dot(&residual, &z);
    let first = rz;
    for _ in 0..STEPS {
        if rz <= 1e-10 * first || rz <= 0.0 {
            break;
        }
        let ap = product(&p);
        let step = rz / dot(&p, &ap);
        values.iter_mut().zip(&p).for_each(|(v, p)| *v += step * p);
        residual.iter_mut().zip(&ap).for_each(|(r, a)| *r -= step * a);
        z = scaled(&residual);
        let next = dot(&residual, &z);
        let share = next / rz;
        p.iter_mut().zip(&z).for_each(|(p, z)| *p = z + share * *p);
        rz = next;
    }
}

/// Light at each node of one channel, that of the mean node being 1.
pub(super) fn light(grid: &Grid, samples: &Samples, column: &Column, nodes: usize) -> Vec<f64> {
    let mut light = vec![0.0; nodes];
    for (place, weight) in samples.places.iter().zip(&column.weight) {
        let (at, share, used) = grid.corners(place);
        for k in 0..used {
            light[at[k] as usize] += f64::from(share[k] * weight);
        }
    }
    let mean = light.iter().sum::<f64>() / nodes as f64;
    if mean > 0.0 {
        light.iter_mut().for_each(|l| *l /= mean);
    }
    light
}

/// Relative L1 error of `values` over the samples of one channel, the mean over incidences.
pub(super) fn error(grid: &Grid, samples: &Samples, column: &Column, values: &[f64]) -> f64 {
    let (mut difference, mut total) = (0.0, 0.0);
    for (j, place) in samples.places.iter().enumerate() {
        let weight = f64::from(column.weight[j]);
        if weight > 0.0 {
            let log = grid.at(values, place) - f64::from(column.log[j]);
            difference += weight * (log.exp() - 1.0).abs();
            total += weight;
        }
    }
    if total > 0.0 { difference / total } else { 0.0 }
}
