//! How many readings are below zero.

use crate::verdict::graded;
use crate::{Flags, Slice, Verdict};

use super::name;

const ID: &str = "negative_readings";
const TITLE: &str = "Readings are positive";
const WARN: f64 = 5.0;
const FAIL: f64 = 50.0;

/// Worst share of negative readings of a slice. Noise alone makes half of them negative where there is no signal.
pub(super) fn check(slices: &[Slice]) -> Verdict {
    let share = |s: &Slice| {
        let usable = s.flags.iter().filter(|f| f.usable()).count();
        let negative = s
            .flags
            .iter()
            .filter(|f| f.usable() && f.intersects(Flags::NEGATIVE))
            .count();
        100.0 * negative as f64 / usable.max(1) as f64
    };
    let Some((worst, value)) = slices
        .iter()
        .map(|s| (s, share(s)))
        .max_by(|a, b| a.1.total_cmp(&b.1))
    else {
        return Verdict::not_applicable(ID, TITLE, "No slice.");
    };
    let level = graded(value, WARN, FAIL);
    let mut sentence = if value == 0.0 {
        "No reading is negative.".to_owned()
    } else {
        format!(
            "At most {value:.2} % of the readings are negative ({}).",
            name(worst)
        )
    };
    if value >= FAIL {
        sentence.push_str(
            " Most of the signal is below the blank: measure the blank again with the stray light of the sample scan, \
             or take the sample as darker than this instrument resolves.",
        );
    } else if value >= WARN {
        sentence.push_str(" They are kept; average before comparing, and do not clip.");
    }
    Verdict {
        id: ID,
        title: TITLE,
        level,
        value: Some(value),
        unit: "%",
        sentence,
    }
}
