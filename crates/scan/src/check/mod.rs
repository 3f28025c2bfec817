//! Checks of a measurement: each gives a verdict, a number and a sentence.

mod copies;
mod coverage;
mod energy;
mod negative;
mod noise_floor;
mod plausibility;
mod reciprocity;
mod repeatability;
mod resolution;
mod symmetry;

use std::collections::BTreeMap;

use gonio_bsdf::Channel;

use crate::{Measurement, Slice, Verdict};

pub use repeatability::repeatability;

/// Settings of [`check`].
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct CheckOptions {
    /// Whether the sample is taken as isotropic when incidences are compared with one another. `None`: it is when
    /// all incidences share one azimuth, so that nothing says otherwise.
    pub isotropic: Option<bool>,
}

/// Every check that one measurement allows, in a fixed order; what processing found out comes first, the worst case
/// of each kind. Never fails: a check without data says so with [`crate::Level::Info`].
pub fn check(measurement: &Measurement, options: &CheckOptions) -> Vec<Verdict> {
    let mut worst: BTreeMap<&str, &Verdict> = BTreeMap::new();
    for f in &measurement.processing.findings {
        let known = worst.entry(f.id).or_insert(f);
        if (f.level, f.value.unwrap_or(0.0)) > (known.level, known.value.unwrap_or(0.0)) {
            *known = f;
        }
    }
    let mut out: Vec<Verdict> = worst.into_values().cloned().collect();
    let slices = &measurement.slices;
    let pairs = reciprocity::pairs(slices, options.isotropic);
    out.push(copies::check(slices));
    out.push(negative::check(slices));
    out.push(noise_floor::check(slices));
    out.push(coverage::check(slices));
    out.push(energy::check(slices));
    out.push(reciprocity::check(&pairs));
    out.push(plausibility::check(slices, &pairs));
    out.push(symmetry::check(slices));
    out.push(resolution::check(slices, measurement.signature_fwhm));
    out
}

/// `532nm at theta_i 30.00, phi_i 0.00 deg`.
fn name(slice: &Slice) -> String {
    format!("{} at {}", slice.channel, crate::blank::place(slice.incidence))
}

/// Pairs of slices of one channel, each pair once.
fn same_channel_pairs(slices: &[Slice]) -> impl Iterator<Item = (usize, usize)> + '_ {
    (0..slices.len()).flat_map(move |a| {
        (a + 1..slices.len())
            .filter(move |&b| slices[a].channel == slices[b].channel)
            .map(move |b| (a, b))
    })
}

/// Channels in order of appearance.
fn channels(slices: &[Slice]) -> Vec<Channel> {
    let mut out: Vec<Channel> = Vec::new();
    for s in slices {
        if !out.contains(&s.channel) {
            out.push(s.channel);
        }
    }
    out
}

#[cfg(test)]
mod tests;
