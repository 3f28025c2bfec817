//! No more light leaves than arrived.

use crate::{Level, Slice, Verdict};

use super::name;

const ID: &str = "energy";
const TITLE: &str = "DHR + DHT does not exceed 1";

/// Largest `DHR + DHT` against 1 and its expanded uncertainty (k = 2); before that, one below 0.
pub(super) fn check(slices: &[Slice]) -> Verdict {
    let total = |s: &Slice| -> Option<(f64, f64)> {
        if s.integrals.is_empty() {
            return None;
        }
        let value = s.integrals.iter().map(|h| h.value).sum::<f64>();
        // The common part of both hemispheres is one quantity: the uncertainties add.
        let u = s.integrals.iter().map(|h| h.u).sum::<f64>();
        value.is_finite().then_some((value, u))
    };
    let totals = || slices.iter().filter_map(|s| total(s).map(|t| (s, t)));
    let lowest = totals().min_by(|a, b| (a.1.0 + 2.0 * a.1.1).total_cmp(&(b.1.0 + 2.0 * b.1.1)));
    if let Some((slice, (value, u))) = lowest.filter(|(_, (value, u))| value + 2.0 * u < 0.0) {
        return Verdict {
            id: ID,
            title: TITLE,
            level: Level::Fail,
            value: Some(value),
            unit: "1",
            sentence: format!(
                "DHR + DHT is {value:.4} ± {:.4} (k = 2) ({}), below 0 beyond its uncertainty: check the dark, the blank and the \
                 sign of the readings.",
                2.0 * u,
                name(slice)
            ),
        };
    }
    let worst = totals().max_by(|a, b| (a.1.0 - 2.0 * a.1.1).total_cmp(&(b.1.0 - 2.0 * b.1.1)));
    let Some((slice, (value, u))) = worst else {
        return Verdict::not_applicable(ID, TITLE, "No hemisphere was measured.");
    };
    let (level, what) = if value > 1.0 + 2.0 * u {
        (
            Level::Fail,
            ", above 1 beyond its uncertainty: check the beam power, the quantity and the dark.",
        )
    } else if value > 1.0 {
        (Level::Warn, ", above 1 within its uncertainty.")
    } else {
        (Level::Pass, ".")
    };
    Verdict {
        id: ID,
        title: TITLE,
        level,
        value: Some(value),
        unit: "1",
        sentence: format!(
            "DHR + DHT is {value:.4} ± {:.4} (k = 2) at most ({}){what}",
            2.0 * u,
            name(slice)
        ),
    }
}
