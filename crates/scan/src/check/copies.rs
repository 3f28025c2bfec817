//! The same readings under more than one angle of incidence.

use std::collections::BTreeMap;

use crate::{Level, Slice, Verdict};

use super::name;

const ID: &str = "exact_copies";
const TITLE: &str = "No scan is a copy of another";
/// Share of equal values from which two scans are copies.
const COPY: f64 = 0.99;

/// Two slices of one channel that hold the same values.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct CopyPair {
    /// Position of the first.
    pub first: usize,
    /// Position of the second.
    pub second: usize,
    /// Whether both are free of noise and the same at every azimuth, as of an ideal diffuser computed by a model: then
    /// equal values mean nothing.
    pub noise_free: bool,
}

/// Every pair of `slices` of one channel that holds the same readings, by their sorted values: noise makes equal readings of
/// different scans impossible.
pub fn copies(slices: &[&Slice]) -> Vec<CopyPair> {
    let sorted: Vec<Vec<f64>> = slices
        .iter()
        .map(|s| {
            let usable = |&(&d, f): &(&f64, &crate::Flags)| f.usable() && d.is_finite() && d != 0.0;
            let mut v: Vec<f64> = s.dsf.iter().zip(&s.flags).filter(usable).map(|p| *p.0).collect();
            v.sort_by(f64::total_cmp);
            v
        })
        .collect();
    let mut copies = Vec::new();
    for first in 0..slices.len() {
        for second in first + 1..slices.len() {
            let (a, b) = (&sorted[first], &sorted[second]);
            if slices[first].channel != slices[second].channel || a.len() != b.len() || a.len() < 3 {
                continue;
            }
            let equal = a
                .iter()
                .zip(b)
                .filter(|(x, y)| (*x - *y).abs() <= 1e-12 * x.abs())
                .count();
            if equal as f64 >= COPY * a.len() as f64 {
                copies.push(CopyPair {
                    first,
                    second,
                    noise_free: noise_free(slices[first]) && noise_free(slices[second]),
                });
            }
        }
    }
    copies
}

/// Judges the copies: those of a model without noise warn only.
pub(super) fn check(slices: &[Slice]) -> Verdict {
    let copies = copies(&slices.iter().collect::<Vec<_>>());
    let smooth = copies.iter().filter(|c| c.noise_free).count();
    let (level, sentence) = match copies.first() {
        Some(&CopyPair { first, second, .. }) if smooth == copies.len() => (
            Level::Warn,
            format!(
                "{} hold the same values, the first {} and {}. They are free of noise and the same at every azimuth, \
                 as those of an ideal diffuser computed by a model; if they were measured, one is a copy to be dropped.",
                counted(copies.len()),
                name(&slices[first]),
                name(&slices[second])
            ),
        ),
        None => (
            Level::Pass,
            format!("{} scans, none the copy of another.", slices.len()),
        ),
        Some(&CopyPair { first, second, .. }) => (
            Level::Fail,
            format!(
                "{} hold the same readings, the first {} and {}: drop all but the one that was measured.",
                counted(copies.len()),
                name(&slices[first]),
                name(&slices[second])
            ),
        ),
    };
    Verdict {
        id: ID,
        title: TITLE,
        level,
        value: Some(copies.len() as f64),
        unit: "1",
        sentence,
    }
}

fn counted(pairs: usize) -> String {
    match pairs {
        1 => "1 pair of scans".into(),
        n => format!("{n} pairs of scans"),
    }
}

/// Largest relative spread of the BSDF of an ideal diffuser: that of values written with four digits.
const FLAT: f64 = 1e-3;
/// Relative difference up to which values are equal.
const EQUAL: f64 = 1e-9;

/// Whether the values are those of a model that depends on `theta_s` alone: the BSDF is the same everywhere, or the
/// readings of each polar angle are equal, where there are three or more. Noise allows neither.
fn noise_free(slice: &Slice) -> bool {
    let usable: Vec<usize> = (0..slice.len())
        .filter(|&j| slice.flags[j].usable() && slice.bsdf(j).is_finite())
        .collect();
    let of = |j: &usize| slice.bsdf(*j);
    let low = usable.iter().map(of).fold(f64::INFINITY, f64::min);
    let high = usable.iter().map(of).fold(f64::NEG_INFINITY, f64::max);
    if high - low <= FLAT * high.abs() {
        return true;
    }
    let mut rings: BTreeMap<i64, Vec<f64>> = BTreeMap::new();
    for &j in &usable {
        let ring = (slice.theta_s[j] * 1e6).round() as i64;
        rings.entry(ring).or_default().push(slice.dsf[j]);
    }
    let of_three: Vec<&Vec<f64>> = rings.values().filter(|r| r.len() >= 3).collect();
    of_three.len() >= 5
        && of_three
            .iter()
            .all(|r| r.iter().all(|v| (v - r[0]).abs() <= EQUAL * r[0].abs()))
}
