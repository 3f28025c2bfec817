//! How well repeated measurements of one sample agree.

use crate::field::Field;
use crate::robust::quantile;
use crate::verdict::graded;
use crate::{Level, Measurement, ScanError, Slice, Verdict};
use gonio_geom::Angles;

const ID: &str = "repeatability";
const TITLE: &str = "Repeated measurements agree";
/// Mean relative difference (percent) that warns, and fails.
const WARN: f64 = 5.0;
const FAIL: f64 = 20.0;
/// Incidences within this angle are the same, radians.
const SAME: f64 = 5e-3;
/// Readings of a slice that are compared, at most.
const READINGS: usize = 20_000;

/// Compares measurements of one sample slice by slice, in directions relative to the azimuth of incidence (so that a
/// sample turned between them compares as it should when it is isotropic).
///
/// The value is the worst mean relative difference `sum |D1 - D2| Omega / sum D Omega` in percent over all pairs of
/// matching slices; the sentence adds the worst 95 % quantile of single relative differences and the largest relative
/// difference of two hemispherical integrals.
///
/// # Errors
/// [`ScanError::Mismatch`] for fewer than two measurements, or when two of them share no incidence and channel.
pub fn repeatability(measurements: &[&Measurement]) -> Result<Verdict, ScanError> {
    if measurements.len() < 2 {
        return Err(ScanError::Mismatch {
            what: "measurements to compare".into(),
            found: measurements.len().to_string(),
            needed: "at least two of one sample".into(),
        });
    }
    let mut worst = (f64::NEG_INFINITY, String::new());
    let (mut spread, mut single) = (0.0_f64, 0.0_f64);
    let mut matched = 0;
    for (a, first) in measurements.iter().enumerate() {
        for (b, second) in measurements.iter().enumerate().skip(a + 1) {
            let before = matched;
            for x in &first.slices {
                for y in second.slices.iter().filter(|y| same(x, y)) {
                    let Some(found) = compare(x, y) else { continue };
                    matched += 1;
                    single = single.max(found.quantile);
                    spread = spread.max(integral_spread(x, y));
                    if found.mean > worst.0 {
                        worst = (
                            found.mean,
                            format!("{}, measurements {} and {}", super::name(x), a + 1, b + 1),
                        );
                    }
                }
            }
            if matched == before {
                return Err(ScanError::Mismatch {
                    what: format!("incidences and channels of measurements {} and {}", a + 1, b + 1),
                    found: "none in common".into(),
                    needed: "the same incidence and channel in both".into(),
                });
            }
        }
    }
    let value = 100.0 * worst.0;
    let level = graded(value, WARN, FAIL);
    let mut sentence = format!(
        "Of {} measurements of one sample, two differ by at most {value:.1} % on average over directions ({}), in 95 % \
         of single directions by up to {:.1} %, and in a hemispherical integral by up to {:.1} % (difference over mean).",
        measurements.len(),
        worst.1,
        100.0 * single,
        100.0 * spread
    );
    if level > Level::Pass {
        sentence.push_str(
            " Quote this as reproducibility, and look for a remounted, tilted or anisotropic sample.",
        );
    }
    Ok(Verdict {
        id: ID,
        title: TITLE,
        level,
        value: Some(value),
        unit: "%",
        sentence,
    })
}

fn same(x: &Slice, y: &Slice) -> bool {
    x.channel == y.channel && (x.incidence.theta - y.incidence.theta).abs() < SAME
}

struct Difference {
    mean: f64,
    quantile: f64,
}

fn compare(x: &Slice, y: &Slice) -> Option<Difference> {
    let field = Field::new(y);
    let turn = y.incidence.phi - x.incidence.phi;
    let (mut difference, mut sum) = (0.0, 0.0);
    let mut singles = Vec::new();
    for j in (0..x.len()).step_by((x.len() / READINGS).max(1)) {
        if !x.flags[j].usable() {
            continue;
        }
        let to = Angles::canonical(x.theta_s[j], x.phi_s[j] + turn).direction();
        let Some(other) = field.at(to) else { continue };
        let other = other.f * x.theta_s[j].cos().abs();
        difference += (x.dsf[j] - other).abs() * x.omega[j];
        sum += 0.5 * (x.dsf[j] + other) * x.omega[j];
        let noise = 3.0 * x.u_independent(j);
        if x.dsf[j] > noise && other > noise && other > 0.0 {
            singles.push((x.dsf[j] - other).abs() / (0.5 * (x.dsf[j] + other)));
        }
    }
    Some(Difference {
        mean: (sum > 0.0).then(|| difference / sum)?,
        quantile: quantile(&mut singles, 0.95).unwrap_or(0.0),
    })
}

/// Relative difference of the hemispherical integrals that both slices hold, over their mean, the worse side.
fn integral_spread(x: &Slice, y: &Slice) -> f64 {
    x.integrals
        .iter()
        .filter_map(|h| {
            let other = y.integral(h.side)?.value;
            let mean = 0.5 * (h.value + other);
            (mean > 0.0).then(|| (h.value - other).abs() / mean)
        })
        .fold(0.0, f64::max)
}
