//! What the processing had to take for granted because nothing was given.

use std::f64::consts::TAU;

use gonio_bsdf::Quantity;

use crate::robust::quantile;
use crate::{Level, Scan, Slice, Verdict};

const DARK: &str = "dark_subtracted";
const DARK_TITLE: &str = "Dark was subtracted";
const CALIBRATION: &str = "calibration_uncertainty";
const CALIBRATION_TITLE: &str = "Calibration uncertainty is stated";
/// Quantile of the values of a slice that bounds an offset common to all of them.
const LOW: f64 = 0.05;

/// That raw signals were used without a dark.
///
/// The value bounds what an offset may have added to the hemispherical integral: no offset is much larger than the
/// lowest readings, and `2 pi` times it enters the integral. Its largest share over the slices, percent.
pub(crate) fn no_dark(slices: &[Slice]) -> Verdict {
    let share = |s: &Slice| {
        let h = s.integrals.iter().max_by(|a, b| a.value.total_cmp(&b.value))?;
        let mut values: Vec<f64> = (0..s.len())
            .filter(|&j| s.flags[j].usable() && s.direction(j).side() == h.side)
            .map(|j| s.dsf[j])
            .collect();
        let low = quantile(&mut values, LOW)?;
        (low > 0.0 && h.value > 0.0).then(|| 100.0 * TAU * low / h.value)
    };
    let value = slices.iter().filter_map(share).max_by(f64::total_cmp);
    let bound = value.map_or(String::new(), |v| {
        format!(
            " (an offset as large as the lowest readings would be {v:.1} % of the hemispherical integral)"
        )
    });
    Verdict {
        id: DARK,
        title: DARK_TITLE,
        level: Level::Warn,
        value,
        unit: if value.is_some() { "%" } else { "" },
        sentence: format!(
            "No dark was subtracted from the raw signals: an offset of the detector stays in every value{bound}. Give \
             dark readings or a blank with --dark; ignore this only where the instrument has subtracted its dark \
             already."
        ),
    }
}

/// That nothing is known of the scale of values which came calibrated: `None` for raw signals.
pub(crate) fn no_calibration(quantity: Quantity) -> Option<Verdict> {
    (quantity != Quantity::Signal).then(|| unstated(&format!("The values came as {quantity}")))
}

/// That a standard was used without the uncertainty of its reflectance factor.
pub(crate) fn no_u_standard() -> Verdict {
    unstated("The reflectance factor of the standard was given")
}

fn unstated(what: &str) -> Verdict {
    Verdict::not_applicable(
        CALIBRATION,
        CALIBRATION_TITLE,
        format!(
            "{what} without an uncertainty of the calibration: every stated uncertainty holds noise and geometry only, \
             and the scale may be further off than that. State it with --u-calibration (or --u-standard)."
        ),
    )
}

/// Whether `sample` holds raw signals that no dark belongs to.
pub(crate) fn lacks_dark(sample: &[Scan], dark: &[Scan]) -> bool {
    dark.is_empty() && sample.iter().any(|s| s.quantity == Quantity::Signal)
}
