//! Whether the values are the quantity they are said to be.

use crate::robust::{median, sigma_about_zero};
use crate::{Level, Slice, Verdict};

use super::name;
use super::reciprocity::{ASSUMED, Pairs};

const ID: &str = "quantity";
const TITLE: &str = "Values are the stated quantity";
/// Smallest spread of the cosines, as |ln|, that tells a cosine apart.
const SPREAD: f64 = 0.2;
/// Exponent of a surplus cosine that is told from none.
const EXPONENT: f64 = 0.5;

/// Two confusions leave a trace. A reflectance factor passed as BSDF is too large by pi, so that the hemispherical
/// integral passes 1 and, divided by pi, is plausible. A surplus or missing cosine breaks reciprocity as
/// `f(i,s) / f(s,i) = (cos theta_s / cos theta_i)^k` with `k` = 1 (a DSF passed as BSDF) or -1 (the reverse), whatever
/// the material.
pub(super) fn check(slices: &[Slice], pairs: &Pairs) -> Verdict {
    let verdict = |level, value: Option<f64>, sentence: String| Verdict {
        id: ID,
        title: TITLE,
        level,
        value,
        unit: if value.is_some() { "1" } else { "" },
        sentence,
    };
    let totals = slices.iter().filter(|s| !s.integrals.is_empty()).map(|s| {
        let value: f64 = s.integrals.iter().map(|h| h.value).sum();
        let u: f64 = s.integrals.iter().map(|h| h.u).sum();
        (s, value, u)
    });
    let largest = totals.max_by(|a, b| a.1.total_cmp(&b.1));
    if let Some((s, value, u)) = largest
        && value > 1.2 + 3.0 * u
        && value / std::f64::consts::PI <= 1.1
    {
        return verdict(
            Level::Fail,
            Some(value),
            format!(
                "DHR + DHT is {value:.3} ({}), {:.3} after division by pi: the values look like a reflectance factor; \
                 read them as reflectance_factor.",
                name(s),
                value / std::f64::consts::PI
            ),
        );
    }
    let mut exponents: Vec<f64> = pairs
        .pairs
        .iter()
        .filter(|p| p.log_cos_ratio.abs() > SPREAD)
        .filter_map(|p| p.log_ratio().map(|(r, _)| r / p.log_cos_ratio))
        .collect();
    if exponents.len() < 5 {
        return match largest {
            Some((_, value, _)) if value <= 1.2 => verdict(
                Level::Info,
                Some(value),
                format!("DHR + DHT reaches {value:.3}; too few exchanged directions to test the cosine."),
            ),
            _ => Verdict::not_applicable(
                ID,
                TITLE,
                "Neither integrals nor exchanged directions to judge by.",
            ),
        };
    }
    let n = exponents.len() as f64;
    let k = median(&mut exponents).unwrap_or(0.0);
    let mut around: Vec<f64> = exponents.iter().map(|e| e - k).collect();
    let u = 1.25 * sigma_about_zero(&mut around).unwrap_or(0.0) / n.sqrt();
    let clear = k.abs() > EXPONENT + 2.0 * u;
    let (level, what) = match (clear, k > 0.0) {
        _ if clear && pairs.assumed && !confirmed(pairs, k) => {
            let sentence = format!(
                "Exchanged directions differ as the power {k:.3} of the ratio of their cosines if the sample is \
                 isotropic, and less in the plane of incidence. {ASSUMED}"
            );
            return verdict(Level::Info, Some(k), sentence);
        }
        (true, true) => (
            Level::Fail,
            ": a cosine too many; the values look like a DSF, read them as dsf.",
        ),
        (true, false) => (
            Level::Fail,
            ": a cosine is missing; the values look like a BSDF, read them as bsdf.",
        ),
        (false, _) => (Level::Pass, ": no surplus cosine."),
    };
    verdict(
        level,
        Some(k),
        format!(
            "Exchanged directions differ as the power {:.3} ± {:.3} (k = 2) of the ratio of their cosines{what}",
            (k * 1e3).round() / 1e3 + 0.0,
            2.0 * u
        ),
    )
}

/// Whether the pairs in the plane of incidence tell the same surplus cosine.
fn confirmed(pairs: &Pairs, k: f64) -> bool {
    let mut exponents: Vec<f64> = pairs
        .pairs
        .iter()
        .filter(|p| p.in_plane && p.log_cos_ratio.abs() > SPREAD)
        .filter_map(|p| p.log_ratio().map(|(r, _)| r / p.log_cos_ratio))
        .collect();
    median(&mut exponents).is_some_and(|m| m * k.signum() > EXPONENT)
}
