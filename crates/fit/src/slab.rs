//! The readings of one slice and component, and what the models take of them.

use gonio_bsdf::analytic::Pairs;
use gonio_geom::{Component, Direction};
use gonio_scan::Slice;

use crate::NoiseLaw;
use crate::cells::Cells;
use crate::noise_law::quantile;
use crate::profile::offset;

/// The usable readings of one slice and one component.
#[derive(Clone, Debug)]
pub(crate) struct Slab {
    /// Position of the slice in the measurement.
    pub(crate) slice: usize,
    /// Position of its channel.
    pub(crate) channel: usize,
    /// Position of its incidence among the distinct ones.
    pub(crate) incidence: usize,
    pub(crate) component: Component,
    pub(crate) wi: Direction,
    pub(crate) ws: Vec<Direction>,
    /// Position of each reading in its slice.
    pub(crate) position: Vec<u32>,
    /// DSF, 1/sr.
    pub(crate) y: Vec<f64>,
    /// Solid-angle weight, mean one over all readings.
    pub(crate) omega: Vec<f64>,
    /// Stated independent variance; 0 where unknown.
    pub(crate) stated: Vec<f64>,
    /// Variance beyond the noise law (pointing on steep slopes).
    pub(crate) extra: Vec<f64>,
    pub(crate) cell: Vec<u8>,
    pub(crate) law: NoiseLaw,
    pub(crate) law_known: bool,
    pub(crate) u_common: f64,
}

/// Readings of one slab that share a quadrature rule, ready for the models.
#[derive(Clone, Debug)]
pub(crate) struct Block {
    pub(crate) slab: usize,
    /// Position of each reading in its slab.
    pub(crate) index: Vec<u32>,
    pub(crate) y: Vec<f64>,
    pub(crate) omega: Vec<f64>,
    /// `1 / sigma^2` of chi-square.
    pub(crate) inverse_variance: Vec<f64>,
    /// Pairs, `weights.len()` a reading.
    pub(crate) pairs: Pairs,
    /// Weights of the nodes of the rule; one entry: no convolution.
    pub(crate) weights: Vec<f64>,
}

impl Block {
    pub(crate) fn len(&self) -> usize {
        self.y.len()
    }
}

/// Relative standard deviation assumed where nothing is known of the noise.
const ASSUMED_RELATIVE: f64 = 0.05;
/// Noise floor assumed where nothing is known, as a fraction of the highest reading.
const ASSUMED_FLOOR: f64 = 1e-5;
/// Least noise floor, as a fraction of the highest reading: a prediction of zero must not weigh without bound.
const LEAST_FLOOR: f64 = 1e-7;
/// Part of the law's variance that a stated one must exceed it by to count as a further source.
const EXTRA: f64 = 0.5;

impl Slab {
    pub(crate) fn new(
        (position, channel, incidence): (usize, usize, usize),
        component: Component,
        (slice, directions): (&Slice, &[Direction]),
        index: &[u32],
        resolution: Option<&[f64]>,
    ) -> Self {
        let wi = slice.incidence.direction();
        let take = |f: &dyn Fn(usize) -> f64| -> Vec<f64> { index.iter().map(|&j| f(j as usize)).collect() };
        let y = take(&|j| slice.dsf[j]);
        let u = take(&|j| {
            let r = resolution.map_or(0.0, |r| r[j]);
            let u = (slice.u_independent(j).powi(2) - r * r).max(0.0).sqrt();
            if u.is_finite() { u } else { 0.0 }
        });
        let known = NoiseLaw::of_uncertainties(&y, &u);
        let top = quantile(y.iter().map(|y| y.abs()), 0.999);
        let mut law = known.unwrap_or(NoiseLaw {
            constant: (ASSUMED_FLOOR * top).powi(2),
            relative: ASSUMED_RELATIVE.powi(2),
        });
        law.constant = law.constant.max((LEAST_FLOOR * top).powi(2)).max(1e-200);
        let extra = y
            .iter()
            .zip(&u)
            .map(|(&y, &u)| {
                let own = law.variance(y);
                let more = u * u - own;
                if known.is_some() && more > EXTRA * own {
                    more
                } else {
                    0.0
                }
            })
            .collect();
        let cells = Cells::new(component, wi);
        let ws: Vec<Direction> = index.iter().map(|&j| directions[j as usize]).collect();
        Slab {
            slice: position,
            channel,
            incidence,
            component,
            wi,
            cell: ws.iter().map(|ws| cells.cell(*ws)).collect(),
            ws,
            position: index.to_vec(),
            y,
            omega: take(&|j| slice.omega[j]),
            stated: u.iter().map(|u| u * u).collect(),
            extra,
            law_known: known.is_some(),
            law,
            u_common: if slice.u_common.is_finite() {
                slice.u_common
            } else {
                0.0
            },
        }
    }

    pub(crate) fn subset(&self, index: &[u32]) -> Self {
        fn take<T: Copy>(from: &[T], index: &[u32]) -> Vec<T> {
            index.iter().map(|&j| from[j as usize]).collect()
        }
        Slab {
            ws: take(&self.ws, index),
            position: take(&self.position, index),
            y: take(&self.y, index),
            omega: take(&self.omega, index),
            stated: take(&self.stated, index),
            extra: take(&self.extra, index),
            cell: take(&self.cell, index),
            ..*self
        }
    }

    pub(crate) fn block(&self, slab: usize, index: Vec<u32>, rule: Option<&[crate::profile::Node]>) -> Block {
        let nodes = rule.map_or(1, <[_]>::len);
        let mut pairs = Pairs::with_capacity(index.len() * nodes);
        for &j in &index {
            let ws = self.ws[j as usize];
            match rule {
                None => pairs.push(self.wi, ws),
                Some(rule) => rule.iter().for_each(|node| pairs.push(self.wi, offset(ws, node))),
            }
        }
        let y: Vec<f64> = index.iter().map(|&j| self.y[j as usize]).collect();
        Block {
            slab,
            inverse_variance: index
                .iter()
                .zip(&y)
                .map(|(&j, y)| 1.0 / (self.law.variance(*y) + self.extra[j as usize]))
                .collect(),
            omega: index.iter().map(|&j| self.omega[j as usize]).collect(),
            y,
            index,
            pairs,
            weights: rule.map_or_else(|| vec![1.0], |r| r.iter().map(|n| n.weight).collect()),
        }
    }
}
