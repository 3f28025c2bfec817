//! Helmholtz reciprocity: source and receiver exchanged give the same BSDF \[Nicodemus1977\].

use gonio_geom::{Angles, Direction};

use crate::field::{Field, Value};
use crate::{Level, Slice, Verdict};

use super::same_channel_pairs;

const ID: &str = "reciprocity";
const TITLE: &str = "Helmholtz reciprocity";
/// Rms relative difference (percent) that warns, and fails when it also stands out of the noise.
const WARN: f64 = 5.0;
const FAIL: f64 = 15.0;
/// Rms of difference over uncertainty that stands out of the noise.
const SCORE: f64 = 3.0;
/// Step of the relative azimuth along which isotropic slices are compared, degrees.
const AZIMUTH_STEP: usize = 10;

/// One pair of exchanged directions.
pub(super) struct Pair {
    /// `f(i, s)` and `f(s, i)`.
    values: [Value; 2],
    /// `ln(cos theta_s / cos theta_i)` of the first.
    pub(super) log_cos_ratio: f64,
}

impl Pair {
    fn mean(&self) -> f64 {
        0.5 * (self.values[0].f + self.values[1].f)
    }

    fn difference(&self) -> f64 {
        self.values[0].f - self.values[1].f
    }

    fn u(&self) -> f64 {
        self.values[0].u.hypot(self.values[1].u)
    }

    /// `ln(f(i, s) / f(s, i))` and its uncertainty, where both stand out of the noise.
    pub(super) fn log_ratio(&self) -> Option<(f64, f64)> {
        let [a, b] = self.values;
        let clear = |v: Value| v.f > 3.0 * v.u && v.f > 0.0;
        (clear(a) && clear(b)).then(|| ((a.f / b.f).ln(), (a.u / a.f).hypot(b.u / b.f)))
    }
}

/// Exchanged pairs, and whether they rest on the sample being isotropic.
pub(super) struct Pairs {
    pub(super) pairs: Vec<Pair>,
    rotated: bool,
}

/// Directions whose exchange two slices of one channel both hold. With one azimuth of incidence (or `isotropic`) the
/// comparison runs over all relative azimuths, else over the two directions of incidence only.
pub(super) fn pairs(slices: &[Slice], isotropic: Option<bool>) -> Pairs {
    let one_azimuth = slices.windows(2).all(|w| {
        let turn = (w[0].incidence.phi - w[1].incidence.phi).abs();
        turn < 1e-6 || w[0].incidence.theta < 0.02 || w[1].incidence.theta < 0.02
    });
    let rotated = isotropic.unwrap_or(one_azimuth);
    let fields: Vec<Field<'_>> = slices.iter().map(Field::new).collect();
    let mut out = Vec::new();
    for (a, b) in same_channel_pairs(slices) {
        let (wa, wb) = (slices[a].incidence, slices[b].incidence);
        let mut offer = |to_b: Direction, to_a: Direction| {
            if let (Some(x), Some(y)) = (fields[a].at(to_b), fields[b].at(to_a)) {
                let ratio = (wb.theta.cos() / wa.theta.cos()).abs();
                out.push(Pair {
                    values: [x, y],
                    log_cos_ratio: ratio.ln(),
                });
            }
        };
        if (wa.theta - wb.theta).abs() < 1e-3 && rotated {
            continue; // the same incidence: an exchange maps the slice onto its own mirror image
        }
        if rotated {
            for step in (0..360).step_by(AZIMUTH_STEP) {
                let turn = (step as f64).to_radians();
                let to_b = Angles::canonical(wb.theta, wa.phi + turn).direction();
                let to_a = Angles::canonical(wa.theta, wb.phi - turn).direction();
                offer(to_b, to_a);
            }
        } else {
            offer(wb.direction(), wa.direction());
        }
    }
    Pairs { pairs: out, rotated }
}

/// Rms relative difference of exchanged pairs, and its ratio to the claimed uncertainty.
pub(super) fn check(pairs: &Pairs) -> Verdict {
    let usable: Vec<&Pair> = pairs
        .pairs
        .iter()
        .filter(|p| p.mean() > p.u() && p.mean() > 0.0)
        .collect();
    if usable.is_empty() {
        return Verdict::not_applicable(
            ID,
            TITLE,
            "No direction was measured both ways: scan incidences that lie within the receiver's range of one another.",
        );
    }
    let n = usable.len() as f64;
    let rms = |f: &dyn Fn(&Pair) -> f64| (usable.iter().map(|p| f(p).powi(2)).sum::<f64>() / n).sqrt();
    let value = 100.0 * rms(&|p| p.difference() / p.mean());
    let known = usable.iter().all(|p| p.u() > 0.0);
    let score = known.then(|| rms(&|p| p.difference() / p.u()));
    let stands_out = score.is_none_or(|s| s > SCORE);
    let level = match value {
        v if v >= FAIL && stands_out => Level::Fail,
        v if v >= WARN && stands_out => Level::Warn,
        _ => Level::Pass,
    };
    let mut sentence = format!(
        "{} exchanged pairs differ by {value:.2} % rms{}{}.",
        usable.len(),
        score.map_or(String::new(), |s| format!(", {s:.1} times their uncertainty")),
        if pairs.rotated {
            " (the sample taken as isotropic)"
        } else {
            ""
        },
    );
    if level > Level::Pass {
        sentence.push_str(
            " Look for a tilted sample, an over-filled detector field at grazing incidence or a wrong quantity; do not \
             fit a reciprocal model before.",
        );
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
