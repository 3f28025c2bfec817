//! Helmholtz reciprocity: source and receiver exchanged give the same BSDF \[Nicodemus1977\].

use gonio_geom::{Angles, Direction};

use crate::field::{Field, Value};
use crate::{Level, Slice, Verdict};

use super::{incidences, one_azimuth, same_channel_pairs};

const ID: &str = "reciprocity";
const TITLE: &str = "Helmholtz reciprocity";
/// Rms relative difference (percent) that warns, and fails when it also stands out of the uncertainty.
const WARN: f64 = 5.0;
const FAIL: f64 = 15.0;
/// Rms of difference over uncertainty that stands out.
const SCORE: f64 = 3.0;
/// Uncertainty of a pair's difference, as a fraction of its mean, up to which the pair is judged.
const KNOWN: f64 = 0.25;
/// Step of the relative azimuth along which isotropic slices are compared, degrees.
const AZIMUTH_STEP: usize = 10;

/// One pair of exchanged directions.
pub(super) struct Pair {
    /// `f(i, s)` and `f(s, i)`.
    values: [Value; 2],
    /// `ln(cos theta_s / cos theta_i)` of the first.
    pub(super) log_cos_ratio: f64,
    /// `cos theta_i cos theta_s`: what the pair weighs in an exchange of light, times its BSDF.
    cosines: f64,
    /// Whether both directions were read themselves, so that nothing is interpolated.
    read: bool,
    /// Whether both directions lie in the plane of incidence: exchanged so, they need no isotropic sample, only one
    /// that half a turn about the normal leaves as it is.
    pub(super) in_plane: bool,
}

impl Pair {
    fn mean(&self) -> f64 {
        0.5 * (self.values[0].f + self.values[1].f)
    }

    fn difference(&self) -> f64 {
        self.values[0].f - self.values[1].f
    }

    fn u(&self) -> f64 {
        self.values[0].u().hypot(self.values[1].u())
    }

    /// Whether the pair can tell anything: positive, and the uncertainty of its difference is below [`KNOWN`].
    fn known(&self) -> bool {
        self.mean() > 0.0 && self.u() < KNOWN * self.mean()
    }

    fn weight(&self) -> f64 {
        self.mean() * self.cosines
    }

    /// `ln(f(i, s) / f(s, i))` and its uncertainty, where both stand out of the noise.
    pub(super) fn log_ratio(&self) -> Option<(f64, f64)> {
        let [a, b] = self.values;
        let clear = |v: Value| v.f > 3.0 * v.u() && v.f > 0.0;
        (clear(a) && clear(b)).then(|| ((a.f / b.f).ln(), (a.u() / a.f).hypot(b.u() / b.f)))
    }
}

/// Exchanged pairs, and whether they rest on the sample being isotropic.
pub(super) struct Pairs {
    pub(super) pairs: Vec<Pair>,
    rotated: bool,
    /// Whether nothing but the single azimuth of incidence says that the sample is isotropic.
    pub(super) assumed: bool,
}

/// What to do where a verdict would rest on the sample being isotropic.
pub(super) const ASSUMED: &str = "One azimuth of incidence does not tell whether the sample is isotropic: measure a second one, or state it with \
     --isotropic or --anisotropic.";

/// Directions whose exchange two slices of one channel both hold. With one azimuth of incidence (or `isotropic`) the
/// comparison runs over all relative azimuths, else over the two directions of incidence only.
pub(super) fn pairs(slices: &[Slice], isotropic: Option<bool>) -> Pairs {
    let rotated = isotropic.unwrap_or_else(|| one_azimuth(&incidences(slices)));
    let fields: Vec<Field<'_>> = slices.iter().map(Field::new).collect();
    let mut out = Vec::new();
    for (a, b) in same_channel_pairs(slices) {
        let (wa, wb) = (slices[a].incidence, slices[b].incidence);
        let mut offer = |to_b: Direction, to_a: Direction, in_plane: bool| {
            if let (Some(x), Some(y)) = (fields[a].at(to_b), fields[b].at(to_a)) {
                let ratio = (wb.theta.cos() / wa.theta.cos()).abs();
                out.push(Pair {
                    values: [x, y],
                    log_cos_ratio: ratio.ln(),
                    cosines: (wa.theta.cos() * wb.theta.cos()).abs(),
                    read: fields[a].read_at(to_b) && fields[b].read_at(to_a),
                    in_plane,
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
                offer(to_b, to_a, step % 180 == 0);
            }
        } else {
            offer(wb.direction(), wa.direction(), true);
        }
    }
    Pairs {
        pairs: out,
        rotated,
        assumed: rotated && isotropic.is_none(),
    }
}

/// Rms over `pairs` of `of`, each pair with its weight.
fn rms(pairs: &[&Pair], of: impl Fn(&Pair) -> f64) -> f64 {
    let total: f64 = pairs.iter().map(|p| p.weight()).sum();
    let square: f64 = pairs.iter().map(|p| p.weight() * of(p).powi(2)).sum();
    (square / total).sqrt()
}

/// Rms relative difference in percent, rms of difference over uncertainty, and what they mean.
fn judge(pairs: &[&Pair]) -> (f64, Option<f64>, Level) {
    let value = rms(pairs, |p| 100.0 * p.difference() / p.mean());
    let score = pairs
        .iter()
        .all(|p| p.u() > 0.0)
        .then(|| rms(pairs, |p| p.difference() / p.u()));
    let stands_out = score.is_none_or(|s| s > SCORE);
    let level = match value {
        v if v >= FAIL && stands_out => Level::Fail,
        v if v >= WARN && stands_out => Level::Warn,
        _ => Level::Pass,
    };
    (value, score, level)
}

/// `sqrt(sum w (df / f)^2 / sum w)` with `df = f(i, s) - f(s, i)`, `f` their mean and `w = f cos theta_i cos theta_s`,
/// and the same of `df / u(df)`, whose expectation is 1 for a reciprocal sample. `u` holds noise and interpolation.
/// Pairs that noise or interpolation leave unknown are counted, not judged.
pub(super) fn check(pairs: &Pairs) -> Verdict {
    let judged: Vec<&Pair> = pairs.pairs.iter().filter(|p| p.known()).collect();
    let unknown = pairs.pairs.len() - judged.len();
    if pairs.pairs.is_empty() {
        return Verdict::not_applicable(
            ID,
            TITLE,
            "No direction was measured both ways: scan incidences that lie within the receiver's range of one another.",
        );
    }
    if judged.is_empty() {
        return Verdict::not_applicable(
            ID,
            TITLE,
            format!(
                "{unknown} directions were measured both ways, none well enough to compare: the readings are in the \
                 noise or too far apart for so steep a lobe; choose incidences closer to one another."
            ),
        );
    }
    let relative = |p: &Pair| 100.0 * p.difference() / p.mean();
    let (value, score, mut level) = judge(&judged);
    let mut unsettled = String::new();
    if level > Level::Pass && pairs.assumed {
        let in_plane: Vec<&Pair> = judged.iter().copied().filter(|p| p.in_plane).collect();
        let (difference, _, of_plane) = judge(&in_plane);
        if of_plane <= Level::Pass || in_plane.is_empty() {
            level = Level::Info;
            unsettled = match in_plane.len() {
                0 => format!(" {ASSUMED}"),
                n => format!(
                    " The {n} in the plane of incidence, which hold for other samples too, differ by {difference:.2} %. \
                     {ASSUMED}"
                ),
            };
        }
    }
    let mut sentence = format!(
        "{} exchanged pairs differ by {value:.2} % rms{}{}",
        judged.len(),
        score.map_or(String::new(), |s| format!(", {s:.1} times their uncertainty")),
        if pairs.rotated {
            " (the sample taken as isotropic)"
        } else {
            ""
        },
    );
    let read: Vec<&Pair> = judged.iter().copied().filter(|p| p.read).collect();
    if !read.is_empty() && read.len() < judged.len() {
        sentence.push_str(&format!(
            "; the {} read in both directions themselves, without interpolation, by {:.2} %",
            read.len(),
            rms(&read, relative)
        ));
    }
    if unknown > 0 {
        sentence.push_str(&format!(
            "; {unknown} more are in the noise or on flanks too steep to interpolate"
        ));
    }
    match score {
        Some(s) if level == Level::Pass && s > SCORE => {
            sentence.push_str(&format!(
                "; they stand out of their uncertainty, below {WARN} % it does not matter"
            ));
        }
        Some(_) if level == Level::Pass && value >= WARN => {
            sentence.push_str(&format!("; up to {SCORE} times it is no contradiction"));
        }
        _ => {}
    }
    sentence.push('.');
    sentence.push_str(&unsettled);
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
