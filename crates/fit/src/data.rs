//! The readings of a fit as columns.

use std::borrow::Cow;
use std::collections::BTreeMap;

use gonio_bsdf::Channel;
use gonio_geom::{Angles, Component};
use gonio_scan::{Measurement, Slice, resolution_uncertainty};
use rayon::prelude::*;

use crate::FitError;
use crate::cells::CELLS;
use crate::profile::Profile;
use crate::selection::{Exclusion, Reason, Selection};
use crate::slab::{Block, Nodes, Origin, Slab};
use crate::sorting::{COMPONENTS, is_grazing, slot, sort};

/// Where the weights of chi-square come from.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
pub enum Weights {
    /// The slice's noise law at the DSF that the model predicts. Weights from a noisy reading itself favour readings that
    /// happen to be low.
    #[default]
    Predicted,
    /// The stated independent uncertainty of each reading as it is.
    Stated,
}

/// Least prediction that a weight is taken at, as a share of the reading. Noise alone never takes a reading so far above
/// the prediction, except in the floor, where the weight does not depend on it. A model whose tails are too faint would
/// otherwise give them weight without bound, widen until the weights are gone, narrow again, and never settle.
const LEAST_PREDICTED: f64 = 1.0 / 3.0;

/// Everything a fit looks at.
#[derive(Clone, Debug)]
pub(crate) struct FitData {
    pub(crate) channels: Vec<Channel>,
    pub(crate) incidences: Vec<Angles>,
    pub(crate) slabs: Vec<Slab>,
    pub(crate) blocks: Vec<Block>,
    pub(crate) excluded: Vec<Exclusion>,
    /// Beam profile of each channel.
    pub(crate) profiles: Vec<Option<Profile>>,
    /// Ratio of the sines of incidence and of unscattered transmission, each channel: the model's at hand.
    pub(crate) index_ratios: Vec<f64>,
    /// Components seen in usable readings that the model does not describe.
    pub(crate) other_component: Option<(Component, usize)>,
    /// Share of all readings of the selected channels that are no data.
    pub(crate) missing: f64,
}

impl FitData {
    /// Channels of which there is no reading: for what other instruments read.
    pub(crate) fn without_readings(channels: Vec<Channel>) -> Self {
        FitData {
            profiles: vec![None; channels.len()],
            index_ratios: vec![1.0; channels.len()],
            channels,
            incidences: Vec::new(),
            slabs: Vec::new(),
            blocks: Vec::new(),
            excluded: Vec::new(),
            other_component: None,
            missing: 0.0,
        }
    }

    /// The usable readings of `measurement` in components for which `described` holds. With `signature`, the beam profile
    /// is known to the model, and the uncertainty that the beam's width adds to a reading is taken out.
    pub(crate) fn new(
        measurement: &Measurement,
        selection: &Selection,
        described: impl Fn(Component) -> bool,
        signature: bool,
    ) -> Result<Self, FitError> {
        let channels = chosen_channels(measurement, &selection.channels)?;
        for (k, slice) in measurement.slices.iter().enumerate() {
            check_columns(k, slice)?;
        }
        let described = COMPONENTS.map(described);
        let channel_of = |slice: &Slice| channels.iter().position(|c| *c == slice.channel);
        let mut counts = BTreeMap::<Reason, usize>::new();
        let mut leave = |reason, n| *counts.entry(reason).or_insert(0) += n;
        let mut incidences: Vec<Angles> = Vec::new();
        let mut chosen = Vec::new();
        for (k, slice) in measurement.slices.iter().enumerate() {
            let Some(channel) = channel_of(slice) else {
                leave(Reason::Channel, slice.len());
                continue;
            };
            let wi = slice.incidence.direction();
            let known = incidences.iter().position(|a| a.direction().angle_to(wi) < 1e-6);
            let incidence = known.unwrap_or(incidences.len());
            if known.is_none() && !is_grazing(slice.incidence) {
                incidences.push(slice.incidence);
            }
            chosen.push((k, channel, incidence));
        }
        let total: usize = chosen.iter().map(|c| measurement.slices[c.0].len()).sum();
        let of_slice = |&(k, channel, incidence): &(usize, usize, usize)| {
            let slice = &measurement.slices[k];
            let mut sorted = sort(slice, selection, described);
            let mut resolutions = measurement.resolutions.iter();
            let resolution = resolutions
                .find(|r| signature && r.channel == slice.channel)
                .map(|r| resolution_uncertainty(slice, r.second_moment, r.fwhm));
            let mut slabs = Vec::new();
            for component in COMPONENTS {
                let index = std::mem::take(&mut sorted.kept[slot(component)]);
                if index.is_empty() {
                    continue;
                }
                // Readings of one component alone take the directions as they are.
                let pairs = if index.len() == slice.len() {
                    sorted.pairs.take().map(Cow::Owned)
                } else {
                    sorted.pairs.as_ref().map(Cow::Borrowed)
                };
                let origin = Origin {
                    slice: k,
                    channel,
                    incidence,
                    component,
                    resolution: resolution.as_deref(),
                };
                slabs.extend(pairs.map(|pairs| Slab::new(&origin, slice, pairs, index)));
            }
            (slabs, sorted.left_out, sorted.others)
        };
        let done: Vec<_> = chosen.par_iter().map(of_slice).collect();
        let mut slabs = Vec::new();
        let mut others = [0; 2];
        for (some, left_out, usable) in done {
            slabs.extend(some);
            left_out.into_iter().for_each(|(reason, n)| leave(reason, n));
            (0..2).for_each(|k| others[k] += usable[k]);
        }
        let missing = counts.get(&Reason::NoData).copied().unwrap_or(0);
        normalise_solid_angles(&mut slabs);
        let profiles = channels
            .iter()
            .map(|c| Profile::of_measurement(measurement, *c).filter(|_| signature))
            .collect();
        let mut data = FitData {
            index_ratios: vec![1.0; channels.len()],
            channels,
            incidences,
            slabs,
            blocks: Vec::new(),
            excluded: counts
                .into_iter()
                .map(|(reason, count)| Exclusion { reason, count })
                .collect(),
            profiles,
            other_component: COMPONENTS
                .map(|c| (c, others[slot(c)]))
                .into_iter()
                .filter(|(_, n)| *n > 0)
                .max_by_key(|(_, n)| *n),
            missing: if total == 0 {
                0.0
            } else {
                missing as f64 / total as f64
            },
        };
        data.rebuild(None);
        Ok(data)
    }

    /// Number of readings.
    pub(crate) fn len(&self) -> usize {
        self.slabs.iter().map(|s| s.y.len()).sum()
    }

    /// Groups the readings by quadrature rule: `levels` has one entry a slab and reading; 0 none, `l` rule `l - 1`. Puts
    /// the readings of each slab, and `levels` with them, in the order of their rules.
    pub(crate) fn rebuild(&mut self, levels: Option<&mut [Vec<u8>]>) {
        let Some(levels) = levels else {
            self.blocks = (0..self.slabs.len())
                .map(|slab| Block {
                    slab,
                    rows: 0..self.slabs[slab].y.len(),
                    nodes: None,
                })
                .collect();
            return;
        };
        let (profiles, index_ratios) = (&self.profiles, &self.index_ratios);
        let blocks: Vec<Vec<Block>> = self
            .slabs
            .par_iter_mut()
            .zip(levels)
            .enumerate()
            .map(|(s, (slab, levels))| {
                if !levels.is_sorted() {
                    let mut order: Vec<u32> = (0..levels.len() as u32).collect();
                    order.sort_by_key(|&j| levels[j as usize]);
                    *slab = slab.subset(&order);
                    levels.sort_unstable();
                }
                let profile = profiles[slab.channel].as_ref();
                let index_ratio = index_ratios[slab.channel];
                let mut blocks = Vec::new();
                for run in levels.chunk_by(|a, b| a == b) {
                    let start = blocks.last().map_or(0, |b: &Block| b.rows.end);
                    let rows = start..start + run.len();
                    let rule = profile.filter(|_| run[0] > 0).map(|p| (p, run[0] as usize - 1));
                    blocks.push(Block {
                        slab: s,
                        nodes: rule.map(|rule| Nodes::new(slab, rows.clone(), rule, index_ratio)),
                        rows,
                    });
                }
                blocks
            })
            .collect();
        self.blocks = blocks.into_iter().flatten().collect();
    }

    /// At most about `target` readings, evenly taken from every cell of every slab, so that peaks stay resolved.
    pub(crate) fn thinned(&self, target: usize) -> Self {
        if self.len() <= target {
            return self.clone();
        }
        let mut counts = Vec::with_capacity(self.slabs.len());
        for slab in &self.slabs {
            let mut n = [0_usize; CELLS];
            slab.cell.iter().for_each(|c| n[*c as usize] += 1);
            counts.push(n);
        }
        // The largest number a cell that keeps the total below the target.
        let total = |most: usize| -> usize { counts.iter().flatten().map(|n| (*n).min(most)).sum() };
        let (mut low, mut high) = (1, target);
        while low < high {
            let middle = (low + high).div_ceil(2);
            if total(middle) <= target {
                low = middle;
            } else {
                high = middle - 1;
            }
        }
        let kept: Vec<Slab> = self
            .slabs
            .iter()
            .zip(&counts)
            .map(|(slab, n)| {
                let mut seen = [0_usize; CELLS];
                let index: Vec<u32> = (0..slab.y.len())
                    .filter(|&j| {
                        let c = slab.cell[j] as usize;
                        let before = seen[c] * low.min(n[c]) / n[c];
                        seen[c] += 1;
                        seen[c] * low.min(n[c]) / n[c] > before
                    })
                    .map(|j| j as u32)
                    .collect();
                slab.subset(&index)
            })
            .collect();
        let mut out = self.with_slabs(kept);
        out.rebuild(None);
        out
    }

    /// The readings of every incidence for which `keep` holds.
    pub(crate) fn of_incidences(&self, keep: impl Fn(usize) -> bool) -> Self {
        let slabs = self.slabs.iter().filter(|s| keep(s.incidence)).cloned().collect();
        let mut out = self.with_slabs(slabs);
        out.rebuild(None);
        out
    }

    fn with_slabs(&self, slabs: Vec<Slab>) -> Self {
        FitData {
            slabs,
            blocks: Vec::new(),
            channels: self.channels.clone(),
            incidences: self.incidences.clone(),
            excluded: self.excluded.clone(),
            profiles: self.profiles.clone(),
            index_ratios: self.index_ratios.clone(),
            other_component: self.other_component,
            missing: self.missing,
        }
    }

    /// Sets the weights of chi-square from the predicted DSF of every block, no less than [`LEAST_PREDICTED`] of the
    /// reading; `damped`: to the geometric mean of old and new ones.
    pub(crate) fn reweigh(&mut self, predicted: &[Vec<f64>], damped: bool) {
        for (block, predicted) in self.blocks.iter().zip(predicted) {
            let slab = &mut self.slabs[block.slab];
            let (law, rows) = (slab.law, block.rows.clone());
            let weights = &mut slab.inverse_variance[rows.clone()];
            let readings = slab.y[rows.clone()].iter().zip(&slab.extra[rows]);
            for ((w, &d), (&y, extra)) in weights.iter_mut().zip(predicted).zip(readings) {
                let new = 1.0 / (law.variance(d.max(LEAST_PREDICTED * y)) + extra);
                *w = if damped { (*w * new).sqrt() } else { new };
            }
        }
    }

    /// Sets the weights of chi-square to the stated uncertainties; where there is none, the noise law at the reading.
    pub(crate) fn weigh_as_stated(&mut self) {
        self.slabs.par_iter_mut().for_each(|slab| {
            for (j, w) in slab.inverse_variance.iter_mut().enumerate() {
                let stated = slab.stated[j];
                *w = 1.0
                    / if stated > 0.0 {
                        stated
                    } else {
                        slab.law.variance(slab.y[j]) + slab.extra[j]
                    };
            }
        });
    }
}

/// Solid-angle weights of mean one; all one where the slices have none.
fn normalise_solid_angles(slabs: &mut [Slab]) {
    let positive = |w: &f64| w.is_finite() && *w > 0.0;
    let (mut sum, mut n) = (0.0, 0_usize);
    for w in slabs.iter().flat_map(|s| &s.omega).filter(|w| positive(w)) {
        sum += w;
        n += 1;
    }
    let mean = if n > 0 { sum / n as f64 } else { 0.0 };
    for w in slabs.iter_mut().flat_map(|s| &mut s.omega) {
        *w = match (mean > 0.0, positive(w)) {
            (true, true) => *w / mean,
            (true, false) => 0.0,
            (false, _) => 1.0,
        };
    }
}

fn chosen_channels(measurement: &Measurement, wanted: &[Channel]) -> Result<Vec<Channel>, FitError> {
    let mut measured: Vec<Channel> = Vec::new();
    for slice in &measurement.slices {
        if !measured.contains(&slice.channel) {
            measured.push(slice.channel);
        }
    }
    if let Some(missing) = wanted.iter().find(|c| !measured.contains(c)) {
        return Err(FitError::Channel {
            found: missing.to_string(),
            allowed: measured
                .iter()
                .map(Channel::to_string)
                .collect::<Vec<_>>()
                .join(", "),
        });
    }
    Ok(if wanted.is_empty() {
        measured
    } else {
        wanted.to_vec()
    })
}

fn check_columns(position: usize, slice: &Slice) -> Result<(), FitError> {
    let needed = slice.len();
    for (field, found) in [
        ("theta_s", slice.theta_s.len()),
        ("phi_s", slice.phi_s.len()),
        ("u_dsf", slice.u_dsf.len()),
        ("omega", slice.omega.len()),
        ("flags", slice.flags.len()),
    ] {
        if found != needed {
            return Err(FitError::Columns {
                field,
                slice: position,
                found,
                needed,
            });
        }
    }
    Ok(())
}
