//! The readings of one slice and component, and what the models take of them.

use std::borrow::Cow;
use std::ops::Range;

use gonio_bsdf::analytic::{Pairs, PairsView};
use gonio_geom::Component;
use gonio_scan::Slice;

use crate::NoiseLaw;
use crate::cells::Cells;
use crate::footprint::Footprint;
use crate::noise_law::{quantile, thin};
use crate::profile::Profile;

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
    /// Directions of the readings.
    pub(crate) pairs: Pairs,
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
    /// `1 / sigma^2` of chi-square.
    pub(crate) inverse_variance: Vec<f64>,
    pub(crate) cell: Vec<u8>,
    pub(crate) law: NoiseLaw,
    pub(crate) law_known: bool,
    pub(crate) u_common: f64,
}

/// Consecutive readings of one slab that share a quadrature rule.
#[derive(Clone, Debug)]
pub(crate) struct Block {
    pub(crate) slab: usize,
    /// Its readings.
    pub(crate) rows: Range<usize>,
    /// The rule that folds the beam in, and the directions it asks for.
    pub(crate) nodes: Option<Nodes>,
}

/// What a model is asked for so that the mean over a beam can be taken.
#[derive(Clone, Debug)]
pub(crate) struct Nodes {
    /// As many a reading as there are weights.
    pub(crate) pairs: Pairs,
    pub(crate) weights: Vec<f64>,
}

impl Nodes {
    /// The directions of rule `level` of `profile` about the readings `rows` of `slab`, seen through an interface of
    /// `index_ratio`.
    pub(crate) fn new(
        slab: &Slab,
        rows: impl ExactSizeIterator<Item = usize>,
        (profile, level): (&Profile, usize),
        index_ratio: f64,
    ) -> Self {
        let rule = profile.rule(level);
        let wi = slab.pairs.wi();
        let footprint = match slab.component {
            Component::Reflection => Footprint::Round,
            Component::Transmission => Footprint::refracted(profile, wi, index_ratio),
        };
        let mut pairs = Pairs::with_capacity(wi, rows.len() * rule.len());
        for j in rows {
            let centre = slab.pairs.ws(j);
            rule.iter()
                .for_each(|node| pairs.push(footprint.offset(centre, node)));
        }
        Nodes {
            pairs,
            weights: rule.iter().map(|n| n.weight).collect(),
        }
    }
}

impl Block {
    pub(crate) fn len(&self) -> usize {
        self.rows.len()
    }

    /// Pairs a reading.
    pub(crate) fn pairs_each(&self) -> usize {
        self.nodes.as_ref().map_or(1, |n| n.weights.len())
    }

    /// The pairs of readings `range`, counted from the block's first, and the weights of their means.
    pub(crate) fn view<'a>(&'a self, slab: &'a Slab, range: Range<usize>) -> (PairsView<'a>, &'a [f64]) {
        match &self.nodes {
            None => {
                let start = self.rows.start;
                (slab.pairs.view(start + range.start..start + range.end), &[1.0])
            }
            Some(nodes) => {
                let each = nodes.weights.len();
                (
                    nodes.pairs.view(range.start * each..range.end * each),
                    &nodes.weights,
                )
            }
        }
    }

    /// Readings `range`, counted from the block's first, as positions in the slab.
    pub(crate) fn in_slab(&self, range: &Range<usize>) -> Range<usize> {
        self.rows.start + range.start..self.rows.start + range.end
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

/// Where a slab comes from: positions of the slice, its channel and its incidence; the component; the variance that the
/// beam's width adds to each reading of the slice.
pub(crate) struct Origin<'a> {
    pub(crate) slice: usize,
    pub(crate) channel: usize,
    pub(crate) incidence: usize,
    pub(crate) component: Component,
    pub(crate) resolution: Option<&'a [f64]>,
}

impl Slab {
    /// Readings `index` of `slice`, whose directions are `pairs`.
    pub(crate) fn new(origin: &Origin<'_>, slice: &Slice, pairs: Cow<'_, Pairs>, index: Vec<u32>) -> Self {
        let y = take(&slice.dsf, &index);
        let u_common = if slice.u_common.is_finite() {
            slice.u_common
        } else {
            0.0
        };
        let stated: Vec<f64> = index
            .iter()
            .zip(&y)
            .map(|(&j, y)| {
                let j = j as usize;
                let known = origin.resolution.map_or(0.0, |r| r[j] * r[j]) + (u_common * y).powi(2);
                let own = slice.u_dsf[j] * slice.u_dsf[j] - known;
                if own.is_finite() { own.max(0.0) } else { 0.0 }
            })
            .collect();
        let known = NoiseLaw::of_variances(&y, &stated);
        let top = quantile(thin(&y).map(|y| y.abs()), 0.999);
        let mut law = known.unwrap_or(NoiseLaw {
            constant: (ASSUMED_FLOOR * top).powi(2),
            relative: ASSUMED_RELATIVE.powi(2),
        });
        law.constant = law.constant.max((LEAST_FLOOR * top).powi(2)).max(1e-200);
        let extra: Vec<f64> = y
            .iter()
            .zip(&stated)
            .map(|(&y, &stated)| {
                let own = law.variance(y);
                let more = stated - own;
                if known.is_some() && more > EXTRA * own {
                    more
                } else {
                    0.0
                }
            })
            .collect();
        let pairs = if index.len() == slice.len() {
            pairs.into_owned()
        } else {
            pairs.subset(&index)
        };
        let cells = Cells::new(origin.component, pairs.wi());
        Slab {
            slice: origin.slice,
            channel: origin.channel,
            incidence: origin.incidence,
            component: origin.component,
            cell: (0..y.len()).map(|j| cells.cell(pairs.ws(j))).collect(),
            pairs,
            omega: take(&slice.omega, &index),
            position: index,
            inverse_variance: y
                .iter()
                .zip(&extra)
                .map(|(y, extra)| 1.0 / (law.variance(*y) + extra))
                .collect(),
            y,
            stated,
            extra,
            law_known: known.is_some(),
            law,
            u_common,
        }
    }

    /// The readings at positions `index`, in that order.
    pub(crate) fn subset(&self, index: &[u32]) -> Self {
        Slab {
            pairs: self.pairs.subset(index),
            position: take(&self.position, index),
            y: take(&self.y, index),
            omega: take(&self.omega, index),
            stated: take(&self.stated, index),
            extra: take(&self.extra, index),
            inverse_variance: take(&self.inverse_variance, index),
            cell: take(&self.cell, index),
            ..*self
        }
    }
}

fn take<T: Copy>(from: &[T], index: &[u32]) -> Vec<T> {
    if index.len() == from.len() && index.iter().enumerate().all(|(k, &j)| k == j as usize) {
        return from.to_vec();
    }
    index.iter().map(|&j| from[j as usize]).collect()
}
