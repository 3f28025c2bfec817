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
use gonio_geom::Angles;

use crate::{Measurement, Slice, Verdict};

pub use copies::{CopyPair, copies};
pub use repeatability::repeatability;

/// Settings of [`check`].
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct CheckOptions {
    /// Whether the sample is taken as isotropic when incidences are compared with one another. `None`: it is when
    /// all incidences share one azimuth, so that nothing says otherwise, and no verdict below pass rests on it alone.
    pub isotropic: Option<bool>,
    /// Whether the directions were corrected for the tilt of the sample already.
    pub aligned: bool,
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
    out.push(symmetry::check(slices, options.aligned));
    out.push(resolution::check(measurement));
    out
}

/// The reciprocity check of [`check`] alone, of `slices`: what a reciprocal model asks of a measurement. `isotropic` as in
/// [`CheckOptions`].
pub fn reciprocity(slices: &[Slice], isotropic: Option<bool>) -> Verdict {
    reciprocity::check(&reciprocity::pairs(slices, isotropic))
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

/// Polar angle up to which an incidence counts as normal and has no azimuth, radians.
const NORMAL: f64 = 0.02;
/// Distance of a direction of incidence from the common half plane up to which it shares its azimuth: what correcting
/// a tilt of up to 3 degrees does.
const PLANE: f64 = 0.05;

/// Azimuth of the most oblique incidence; zero when all are normal.
fn main_azimuth(incidences: &[Angles]) -> f64 {
    let oblique = incidences
        .iter()
        .max_by(|a, b| a.theta.sin().total_cmp(&b.theta.sin()));
    oblique.filter(|a| a.theta.sin() > NORMAL).map_or(0.0, |a| a.phi)
}

/// Whether all incidences lie in one half plane through the normal; normal incidence lies in every one.
fn one_azimuth(incidences: &[Angles]) -> bool {
    let main = main_azimuth(incidences);
    incidences.iter().all(|a| {
        let turn = a.phi - main;
        let off = a.theta.sin() * turn.sin().abs();
        off < PLANE && (turn.cos() > 0.0 || a.theta.sin() < PLANE)
    })
}

/// Directions of incidence in the order of the slices.
fn incidences<'a>(slices: impl IntoIterator<Item = &'a Slice>) -> Vec<Angles> {
    slices.into_iter().map(|s| s.incidence).collect()
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
