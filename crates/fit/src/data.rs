//! The readings of a fit as columns.

use std::collections::BTreeMap;

use gonio_bsdf::Channel;
use gonio_geom::{Angles, Component, Direction};
use gonio_scan::{Measurement, Slice, resolution_uncertainty};
use rayon::prelude::*;

use crate::FitError;
use crate::cells::CELLS;
use crate::profile::Profile;
use crate::selection::{Exclusion, Reason, Selection};
use crate::slab::{Block, Slab};

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
    /// Components seen in usable readings that the model does not describe.
    pub(crate) other_component: Option<(Component, usize)>,
    /// Share of all readings of the selected channels that are no data.
    pub(crate) missing: f64,
}

impl FitData {
    /// The usable readings of `measurement` in components for which `described` holds. With `signature`, the beam profile
    /// is known to the model, and the uncertainty that the beam's width adds to a reading is taken out.
    pub(crate) fn new(
        measurement: &Measurement,
        selection: &Selection,
        described: impl Fn(Component) -> bool,
        signature: bool,
    ) -> Result<Self, FitError> {
        let channels = chosen_channels(measurement, &selection.channels)?;
        let mut counts = BTreeMap::<Reason, usize>::new();
        let mut others = BTreeMap::<u8, usize>::new();
        let mut incidences: Vec<Angles> = Vec::new();
        let mut slabs = Vec::new();
        let (mut total, mut missing) = (0, 0);
        for (k, slice) in measurement.slices.iter().enumerate() {
            check_columns(k, slice)?;
            let mut leave = |reason, n| *counts.entry(reason).or_insert(0) += n;
            let Some(channel) = channels.iter().position(|c| *c == slice.channel) else {
                leave(Reason::Channel, slice.len());
                continue;
            };
            total += slice.len();
            let wi = slice.incidence.direction();
            if wi.cos_theta().abs() < 1e-6 {
                leave(Reason::Incidence, slice.len());
                continue;
            }
            let at = incidences
                .iter()
                .position(|a| a.direction().angle_to(wi) < 1e-6)
                .unwrap_or_else(|| {
                    incidences.push(slice.incidence);
                    incidences.len() - 1
                });
            let mut kept: [Vec<u32>; 2] = [Vec::new(), Vec::new()];
            let directions: Vec<Direction> = (0..slice.len()).map(|j| slice.direction(j)).collect();
            for (j, &ws) in directions.iter().enumerate() {
                let component = Component::between(wi.side(), ws.side());
                let reason = if !(slice.dsf[j].is_finite() && ws.vec().is_finite()) {
                    Some(Reason::NoData)
                } else if let Some(reason) = Reason::of_flags(slice.flags[j]) {
                    Some(reason)
                } else if ws.cos_theta().abs() < selection.max_theta_s.cos() - 1e-12 {
                    Some(Reason::Grazing)
                } else if selection.retro_radius > 0.0 && ws.angle_to(wi) < selection.retro_radius {
                    Some(Reason::Retro)
                } else if !described(component) || selection.component.is_some_and(|c| c != component) {
                    *others.entry(slot(component) as u8).or_insert(0) += 1;
                    Some(Reason::Component)
                } else {
                    None
                };
                match reason {
                    Some(reason) => {
                        missing += usize::from(reason == Reason::NoData);
                        leave(reason, 1);
                    }
                    None => kept[slot(component)].push(j as u32),
                }
            }
            let mut beams = measurement.processing.beams.iter();
            let beam = beams.find(|b| signature && b.channel == slice.channel);
            let resolution =
                beam.map(|b| resolution_uncertainty(slice, b.signature.second_moment, b.signature.fwhm));
            for (index, component) in kept.iter().zip([Component::Reflection, Component::Transmission]) {
                if !index.is_empty() {
                    slabs.push(Slab::new(
                        (k, channel, at),
                        component,
                        (slice, &directions),
                        index,
                        resolution.as_deref(),
                    ));
                }
            }
        }
        normalise_solid_angles(&mut slabs);
        let profiles = channels
            .iter()
            .map(|c| Profile::of_measurement(measurement, *c).filter(|_| signature))
            .collect();
        let mut data = FitData {
            channels,
            incidences,
            slabs,
            blocks: Vec::new(),
            excluded: counts
                .into_iter()
                .map(|(reason, count)| Exclusion { reason, count })
                .collect(),
            profiles,
            other_component: others.into_iter().max_by_key(|o| o.1).map(|(s, n)| {
                (
                    if s == 0 {
                        Component::Reflection
                    } else {
                        Component::Transmission
                    },
                    n,
                )
            }),
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

    /// Groups the readings by quadrature rule (`levels`: one entry a slab and reading; 0 none, `l` rule `l - 1`).
    pub(crate) fn rebuild(&mut self, levels: Option<&[Vec<u8>]>) {
        let mut keys: Vec<(usize, u8)> = Vec::new();
        for s in 0..self.slabs.len() {
            match levels {
                None => keys.push((s, 0)),
                Some(levels) => {
                    let top = levels[s].iter().copied().max().unwrap_or(0);
                    keys.extend((0..=top).filter(|l| levels[s].contains(l)).map(|l| (s, l)));
                }
            }
        }
        let blocks = keys
            .par_iter()
            .map(|&(s, level)| {
                let slab = &self.slabs[s];
                let index: Vec<u32> = (0..slab.y.len() as u32)
                    .filter(|&j| levels.is_none_or(|l| l[s][j as usize] == level))
                    .collect();
                let profile = self.profiles[slab.channel].as_ref();
                slab.block(
                    s,
                    index,
                    profile.filter(|_| level > 0).map(|p| p.rule(level as usize - 1)),
                )
            })
            .collect();
        self.blocks = blocks;
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
            other_component: self.other_component,
            missing: self.missing,
        }
    }

    /// Sets the weights of chi-square from the predicted DSF of every block; `damped`: to the geometric mean of old and
    /// new ones.
    pub(crate) fn reweigh(&mut self, predicted: &[Vec<f64>], damped: bool) {
        let slabs = &self.slabs;
        self.blocks.par_iter_mut().zip(predicted).for_each(|(block, p)| {
            let slab = &slabs[block.slab];
            for ((w, &d), &j) in block.inverse_variance.iter_mut().zip(p).zip(&block.index) {
                let new = 1.0 / (slab.law.variance(d) + slab.extra[j as usize]);
                *w = if damped { (*w * new).sqrt() } else { new };
            }
        });
    }

    /// Sets the weights of chi-square to the stated uncertainties; where there is none, the noise law at the reading.
    pub(crate) fn weigh_as_stated(&mut self) {
        let slabs = &self.slabs;
        for block in &mut self.blocks {
            let slab = &slabs[block.slab];
            for ((w, &y), &j) in block.inverse_variance.iter_mut().zip(&block.y).zip(&block.index) {
                let stated = slab.stated[j as usize];
                *w = 1.0
                    / if stated > 0.0 {
                        stated
                    } else {
                        slab.law.variance(y) + slab.extra[j as usize]
                    };
            }
        }
    }
}

fn slot(component: Component) -> usize {
    match component {
        Component::Reflection => 0,
        Component::Transmission => 1,
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
