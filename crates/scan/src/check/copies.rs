//! The same readings under more than one angle of incidence.

use crate::{Level, Slice, Verdict};

use super::{name, same_channel_pairs};

const ID: &str = "exact_copies";
const TITLE: &str = "No scan is a copy of another";
/// Share of equal values from which two scans are copies.
const COPY: f64 = 0.99;

/// Compares the sorted values of every pair of slices: noise makes equal readings of different scans impossible.
pub(super) fn check(slices: &[Slice]) -> Verdict {
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
    for (a, b) in same_channel_pairs(slices) {
        if sorted[a].len() != sorted[b].len() || sorted[a].len() < 3 {
            continue;
        }
        let equal = sorted[a]
            .iter()
            .zip(&sorted[b])
            .filter(|(x, y)| (*x - *y).abs() <= 1e-12 * x.abs())
            .count();
        if equal as f64 >= COPY * sorted[a].len() as f64 {
            copies.push((a, b));
        }
    }
    let (level, sentence) = match copies.first() {
        None => (
            Level::Pass,
            format!("{} scans, none the copy of another.", slices.len()),
        ),
        Some(&(a, b)) => (
            Level::Fail,
            format!(
                "{} pair(s) of scans hold the same readings, the first {} and {}: drop all but the one that was \
                 measured.",
                copies.len(),
                name(&slices[a]),
                name(&slices[b])
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
