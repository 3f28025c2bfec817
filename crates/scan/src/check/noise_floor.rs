//! Noise floor and dynamic range.

use crate::robust::quantile;
use crate::{Level, Slice, Verdict};

use super::name;

const ID: &str = "dynamic_range";
const TITLE: &str = "Signal above the noise floor";
/// Ratio of peak to noise floor below which a slice warns, and fails.
const WARN: f64 = 100.0;
const FAIL: f64 = 5.0;

/// Smallest ratio of the largest DSF to the noise floor: the lower decile of the independent uncertainties.
pub(super) fn check(slices: &[Slice]) -> Verdict {
    let range = |s: &Slice| -> Option<(f64, f64)> {
        let usable: Vec<usize> = (0..s.len()).filter(|&j| s.flags[j].usable()).collect();
        let mut u: Vec<f64> = usable.iter().map(|&j| s.u_independent(j)).collect();
        let floor = quantile(&mut u, 0.1).filter(|f| *f > 0.0)?;
        let peak = usable.iter().map(|&j| s.dsf[j]).fold(f64::NEG_INFINITY, f64::max);
        Some((peak / floor, floor))
    };
    let worst = slices
        .iter()
        .filter_map(|s| range(s).map(|r| (s, r)))
        .min_by(|a, b| a.1.0.total_cmp(&b.1.0));
    let Some((slice, (value, floor))) = worst else {
        return Verdict::not_applicable(
            ID,
            TITLE,
            "The noise is unknown: state the detector's read-out noise or record a dark with at least 30 readings.",
        );
    };
    let level = if value < FAIL {
        Level::Fail
    } else if value < WARN {
        Level::Warn
    } else {
        Level::Pass
    };
    let mut sentence = if value > 0.0 {
        format!(
            "The peak is at least {} times the noise floor, u = {floor:.1e} 1/sr ({}).",
            three_digits(value),
            name(slice)
        )
    } else {
        format!("No reading is above zero ({}).", name(slice))
    };
    if level != Level::Pass {
        sentence.push_str(" Raise the gain, the integration time or the beam power.");
    }
    Verdict {
        id: ID,
        title: TITLE,
        level,
        value: Some(value),
        unit: "1",
        sentence,
    }
}

/// `value` to three significant digits, without an exponent.
fn three_digits(value: f64) -> String {
    if !value.is_finite() || value == 0.0 {
        return format!("{value}");
    }
    let places = 2 - value.abs().log10().floor() as i32;
    let step = 10.0_f64.powi(-places);
    let places = places.max(0) as usize;
    format!("{:.places$}", (value / step).round() * step)
}

#[cfg(test)]
mod tests {
    use super::three_digits;

    #[test]
    fn a_ratio_is_written_to_three_digits_without_an_exponent() {
        assert_eq!(three_digits(2892.4), "2890");
        assert_eq!(three_digits(240_600.0), "241000");
        assert_eq!(three_digits(4.988), "4.99");
        assert_eq!(three_digits(0.05), "0.0500");
        assert_eq!(three_digits(-12.34), "-12.3");
    }
}
