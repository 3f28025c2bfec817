//! How many readings are below zero.

use crate::verdict::graded;
use crate::{Flags, Level, Slice, Verdict};

use super::name;

const ID: &str = "negative_readings";
const TITLE: &str = "Readings are positive";
const WARN: f64 = 5.0;
const FAIL: f64 = 50.0;
/// Percentage of readings below zero by more than three standard uncertainties up to which noise explains the
/// negative ones; noise alone has 0.13.
const BEYOND_NOISE: f64 = 1.0;

/// Worst share of negative readings of a slice. Noise alone makes half of them negative where there is no signal:
/// that is no defect of the data, and passes.
pub(super) fn check(slices: &[Slice]) -> Verdict {
    let found = slices.iter().map(|s| (s, Shares::of(s)));
    let gravity = |s: &Shares| (s.level(), s.negative);
    let Some((worst, shares)) = found.max_by(|a, b| {
        let (x, y) = (gravity(&a.1), gravity(&b.1));
        x.0.cmp(&y.0).then(x.1.total_cmp(&y.1))
    }) else {
        return Verdict::not_applicable(ID, TITLE, "No slice.");
    };
    if let Some(dark) = slices.iter().find(|s| nothing_positive(s)) {
        return Verdict {
            id: ID,
            title: TITLE,
            level: Level::Fail,
            value: Some(Shares::of(dark).negative),
            unit: "%",
            sentence: format!(
                "No reading is above zero ({}): nothing was measured there, or the sign or the dark is wrong.",
                name(dark)
            ),
        };
    }
    let level = shares.level();
    let mut sentence = if shares.negative == 0.0 {
        "No reading is negative.".to_owned()
    } else {
        format!(
            "At most {:.2} % of the readings are negative ({}), {:.2} % by more than three standard uncertainties.",
            shares.negative,
            name(worst),
            shares.beyond
        )
    };
    sentence.push_str(match level {
        Level::Fail => {
            " Most of the signal is below the blank: measure the blank again with the stray light of the sample scan, \
             or take the sample as darker than this instrument resolves."
        }
        Level::Warn => {
            " Noise does not explain them: the dark or the blank is too high there. They are kept; measure the dark \
             again, and do not clip."
        }
        _ if shares.negative >= WARN => {
            " Noise about zero explains them: the sample scatters less there than the instrument resolves. They are \
             kept; average before comparing, and do not clip."
        }
        _ => "",
    });
    Verdict {
        id: ID,
        title: TITLE,
        level,
        value: Some(shares.negative),
        unit: "%",
        sentence,
    }
}

/// Whether a slice has usable readings, none of them positive.
fn nothing_positive(slice: &Slice) -> bool {
    let mut usable = (0..slice.len()).filter(|&j| slice.flags[j].usable()).peekable();
    usable.peek().is_some() && usable.all(|j| slice.dsf[j] <= 0.0)
}

/// Percentages of the usable readings of a slice.
struct Shares {
    negative: f64,
    /// Below zero by more than three standard uncertainties; all negative ones where the noise is unknown.
    beyond: f64,
}

impl Shares {
    fn of(slice: &Slice) -> Self {
        let usable: Vec<usize> = (0..slice.len()).filter(|&j| slice.flags[j].usable()).collect();
        let share = |is: &dyn Fn(usize) -> bool| {
            100.0 * usable.iter().filter(|&&j| is(j)).count() as f64 / usable.len().max(1) as f64
        };
        Shares {
            negative: share(&|j| slice.flags[j].intersects(Flags::NEGATIVE)),
            beyond: share(&|j| slice.dsf[j] < -3.0 * slice.u_independent(j)),
        }
    }

    fn level(&self) -> Level {
        if self.beyond <= BEYOND_NOISE {
            Level::Pass
        } else {
            graded(self.negative, WARN, FAIL)
        }
    }
}
