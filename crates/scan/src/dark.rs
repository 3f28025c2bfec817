//! Dark and blank subtraction.
//!
//! A *dark* is the reading without light; it depends on time (drift) and gain. A *blank* is a scan over the sample's
//! directions with a beam trap or nothing in the sample's place; it also holds the stray light of each direction.

use std::fmt;

use gonio_geom::{DVec3, Direction};

use crate::clock::{reading_time, started};
use crate::nearest::DirectionIndex;
use crate::robust::mean_and_deviation;
use crate::{NoiseModel, Scan, ScanError};

/// How dark readings are assigned to sample readings.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum DarkMethod {
    /// By direction when a blank covers every direction of the sample scan at its incidence; else by time when both
    /// say when they were taken; else one level.
    #[default]
    Auto,
    /// By direction: the nearest blank reading within the tolerance.
    Direction,
    /// By time: linear between dark records (or stretches of one record).
    Time,
    /// One level: the mean of all dark readings.
    Level,
}

impl DarkMethod {
    /// Name used in files and Python.
    pub fn name(self) -> &'static str {
        match self {
            DarkMethod::Auto => "auto",
            DarkMethod::Direction => "direction",
            DarkMethod::Time => "time",
            DarkMethod::Level => "level",
        }
    }
}

impl fmt::Display for DarkMethod {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}

/// Settings of the dark subtraction.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DarkOptions {
    /// How dark readings are assigned.
    pub method: DarkMethod,
    /// Largest angle between a sample reading and its blank reading, and between the incidences of their records,
    /// radians.
    pub tolerance: f64,
}

impl Default for DarkOptions {
    fn default() -> Self {
        DarkOptions {
            method: DarkMethod::Auto,
            tolerance: 0.25_f64.to_radians(),
        }
    }
}

/// What was subtracted from one record.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DarkSummary {
    /// The method used (never [`DarkMethod::Auto`]).
    pub method: DarkMethod,
    /// Mean of what was subtracted, in the unit of the readings.
    pub mean: f64,
    /// Standard uncertainty that each reading has for itself, in the unit of the readings.
    pub u_independent: f64,
    /// Standard uncertainty shared by all readings of the record, in the unit of the readings.
    pub u_common: f64,
}

/// The dark readings that belong to a record: same channel, and same gain where both state one.
///
/// # Errors
/// [`ScanError::Mismatch`] when `darks` is not empty and none belongs to the record, or when one that does holds
/// another quantity.
fn candidates<'a>(scan: &Scan, darks: &'a [Scan]) -> Result<Vec<&'a Scan>, ScanError> {
    let gain = |s: &Scan| s.meta.other.get("gain").map(|g| g.trim().to_owned());
    let (of_scan, channel) = (gain(scan), scan.channel);
    let found: Vec<&Scan> = darks
        .iter()
        .filter(|d| d.channel == channel)
        .filter(|d| match (&of_scan, gain(d)) {
            (Some(a), Some(b)) => *a == b,
            _ => true,
        })
        .filter(|d| d.value.iter().any(|v| v.is_finite()))
        .collect();
    if found.is_empty() {
        let have: Vec<String> = darks
            .iter()
            .map(|d| match gain(d) {
                Some(g) => format!("{} at gain {g}", d.channel),
                None => d.channel.to_string(),
            })
            .collect();
        return Err(ScanError::Mismatch {
            what: "channel and gain of the dark".into(),
            found: have.join(", "),
            needed: match of_scan {
                Some(g) => format!("{channel} at gain {g}, with readings"),
                None => format!("{channel}, with readings"),
            },
        });
    }
    if let Some(other) = found.iter().find(|d| d.quantity != scan.quantity) {
        return Err(ScanError::Mismatch {
            what: "quantity of the dark".into(),
            found: other.quantity.to_string(),
            needed: scan.quantity.to_string(),
        });
    }
    Ok(found)
}

/// Subtracts the dark from the values of `scan` in place. An empty `darks` subtracts nothing and returns `None`.
///
/// `noise` describes a single dark reading; its scatter carries over to what is subtracted.
///
/// # Errors
/// [`ScanError::Mismatch`] when no dark has the channel, gain and quantity of the scan, or when the demanded method
/// finds no partner for a reading (by direction) or no times (by time).
pub fn subtract(
    scan: &mut Scan,
    darks: &[Scan],
    noise: &NoiseModel,
    options: &DarkOptions,
) -> Result<Option<DarkSummary>, ScanError> {
    if darks.is_empty() {
        return Ok(None);
    }
    let darks = candidates(scan, darks)?;
    let found = match options.method {
        DarkMethod::Direction => by_direction(scan, &darks, noise, options.tolerance)?,
        DarkMethod::Time => by_time(scan, &darks, noise)?,
        DarkMethod::Level => Some(by_level(&darks, noise)),
        DarkMethod::Auto => {
            let blank = by_direction(scan, &darks, noise, options.tolerance)
                .ok()
                .flatten();
            match blank {
                Some(found) => Some(found),
                None => by_time(scan, &darks, noise)?.or_else(|| Some(by_level(&darks, noise))),
            }
        }
    };
    let Some(found) = found else {
        return Err(ScanError::Mismatch {
            what: "times of the dark and the sample record".into(),
            found: "no start time in one of them".into(),
            needed: "a start time in both, or another method".into(),
        });
    };
    let level = |j: usize| found.levels.get(j).copied().unwrap_or(found.constant);
    let (mut sum, mut n) = (0.0, 0_usize);
    for (j, v) in scan.value.iter_mut().enumerate() {
        if v.is_finite() {
            *v -= level(j);
            sum += level(j);
            n += 1;
        }
    }
    Ok(Some(DarkSummary {
        mean: if n > 0 { sum / n as f64 } else { 0.0 },
        ..found.summary
    }))
}

struct Levels {
    /// One level a reading, or empty for `constant` everywhere.
    levels: Vec<f64>,
    constant: f64,
    summary: DarkSummary,
}

/// Distinct directions enough to be a scan rather than a shutter reading.
fn has_directions(dark: &Scan) -> bool {
    dark.len() > 1 && (1..dark.len()).any(|j| dark.direction(j).angle_to(dark.direction(0)) > 1e-6)
}

fn by_direction(
    scan: &Scan,
    darks: &[&Scan],
    noise: &NoiseModel,
    tolerance: f64,
) -> Result<Option<Levels>, ScanError> {
    let at = scan.incidence.direction();
    let blanks: Vec<&Scan> = darks
        .iter()
        .copied()
        .filter(|d| has_directions(d) && d.incidence.direction().angle_to(at) <= tolerance)
        .collect();
    if blanks.is_empty() {
        let (theta, phi) = scan.incidence.to_degrees();
        return Err(ScanError::Mismatch {
            what: "incidence of the blank".into(),
            found: darks
                .iter()
                .map(|d| format!("{:.2}", d.incidence.theta.to_degrees()))
                .collect::<Vec<_>>()
                .join(", "),
            needed: format!("a scan over directions at theta_i {theta:.2}, phi_i {phi:.2} deg"),
        });
    }
    let mut levels = vec![0.0; scan.len()];
    let mut first_missing = None;
    for blank in &blanks {
        // Most instruments scan the blank along the path of the sample: no search then.
        let same_path = blank.len() == scan.len()
            && (0..scan.len()).all(|j| blank.direction(j).angle_to(scan.direction(j)) <= tolerance);
        let index = (!same_path).then(|| {
            let usable = |j: usize| blank.value[j].is_finite();
            DirectionIndex::new(
                (0..blank.len())
                    .map(|j| {
                        if usable(j) {
                            blank.direction(j).vec()
                        } else {
                            DVec3::NAN
                        }
                    })
                    .collect(),
            )
        });
        for (j, level) in levels.iter_mut().enumerate() {
            if !scan.value[j].is_finite() {
                continue;
            }
            let partner = match &index {
                None => Some(j),
                Some(index) => index
                    .nearest(scan.direction(j).vec(), tolerance)
                    .map(|n| n.0)
                    .filter(|&k| blank.direction(k).side() == scan.direction(j).side()),
            };
            match partner.map(|k| blank.value[k]).filter(|v| v.is_finite()) {
                Some(v) => *level += v / blanks.len() as f64,
                None => first_missing = first_missing.or(Some(scan.direction(j))),
            }
        }
    }
    if let Some(d) = first_missing {
        return Err(missing_direction(d, tolerance));
    }
    Ok(Some(Levels {
        levels,
        constant: 0.0,
        summary: DarkSummary {
            method: DarkMethod::Direction,
            mean: 0.0,
            u_independent: noise.readout / (blanks.len() as f64).sqrt(),
            u_common: 0.0,
        },
    }))
}

fn missing_direction(d: Direction, tolerance: f64) -> ScanError {
    let (theta, phi) = d.angles().to_degrees();
    ScanError::Mismatch {
        what: "directions of the blank".into(),
        found: format!("no reading near theta_s {theta:.3}, phi_s {phi:.3} deg"),
        needed: format!(
            "one within {:.3} deg of every sample reading",
            tolerance.to_degrees()
        ),
    }
}

/// A stretch of dark readings taken together.
struct Knot {
    time: f64,
    level: f64,
    u: f64,
}

/// Part of the time the sample record took that one knot may span. Within a knot the dark may drift evenly.
const KNOT_SPAN: f64 = 0.5;

fn by_time(scan: &Scan, darks: &[&Scan], noise: &NoiseModel) -> Result<Option<Levels>, ScanError> {
    let Some(start) = started(scan)? else {
        return Ok(None);
    };
    let (first, last) = (0..scan.len())
        .map(|j| reading_time(scan, start, j))
        .fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), t| {
            (a.min(t), b.max(t))
        });
    let span = (KNOT_SPAN * (last - first)).max(0.0);
    let mut readings: Vec<(f64, f64)> = Vec::new();
    for dark in darks {
        let Some(from) = started(dark)? else {
            return Ok(None);
        };
        let timed = (0..dark.len()).filter(|&j| dark.value[j].is_finite());
        readings.extend(timed.map(|j| (reading_time(dark, from, j), dark.value[j])));
    }
    readings.sort_by(|a, b| a.0.total_cmp(&b.0));
    let mut knots: Vec<Knot> = Vec::new();
    let mut from = 0;
    while from < readings.len() {
        let begin = readings[from].0;
        let mut to = from;
        while to < readings.len() && readings[to].0 - begin <= span {
            to += 1;
        }
        let values: Vec<f64> = readings[from..to].iter().map(|r| r.1).collect();
        if let Some((level, deviation)) = mean_and_deviation(&values) {
            knots.push(Knot {
                time: readings[from..to].iter().map(|r| r.0).sum::<f64>() / values.len() as f64,
                level,
                u: deviation.max(noise.readout) / (values.len() as f64).sqrt(),
            });
        }
        from = to;
    }
    let (mut sum_u2, n) = (0.0, scan.len().max(1));
    let levels: Vec<f64> = (0..scan.len())
        .map(|j| {
            let (level, u) = interpolate(&knots, reading_time(scan, start, j));
            sum_u2 += u * u;
            level
        })
        .collect();
    Ok(Some(Levels {
        levels,
        constant: 0.0,
        summary: DarkSummary {
            method: DarkMethod::Time,
            mean: 0.0,
            u_independent: 0.0,
            u_common: (sum_u2 / n as f64).sqrt(),
        },
    }))
}

/// Linear between knots, constant beyond them.
fn interpolate(knots: &[Knot], time: f64) -> (f64, f64) {
    let after = knots.partition_point(|k| k.time < time);
    match (after.checked_sub(1).and_then(|b| knots.get(b)), knots.get(after)) {
        (Some(a), Some(b)) => {
            let w = (time - a.time) / (b.time - a.time);
            (
                a.level + w * (b.level - a.level),
                ((1.0 - w) * a.u).hypot(w * b.u),
            )
        }
        (Some(k), None) | (None, Some(k)) => (k.level, k.u),
        (None, None) => (0.0, 0.0),
    }
}

fn by_level(darks: &[&Scan], noise: &NoiseModel) -> Levels {
    let values: Vec<f64> = darks
        .iter()
        .flat_map(|d| d.value.iter().copied())
        .filter(|v| v.is_finite())
        .collect();
    let (level, deviation) = mean_and_deviation(&values).unwrap_or((0.0, 0.0));
    // Records that differ by more than their noise tell of a drift, which no number of readings averages out.
    let means: Vec<f64> = darks
        .iter()
        .filter_map(|d| {
            let finite: Vec<f64> = d.value.iter().copied().filter(|v| v.is_finite()).collect();
            mean_and_deviation(&finite).map(|m| m.0)
        })
        .collect();
    let drift = mean_and_deviation(&means).map_or(0.0, |m| m.1);
    let noise_of_mean = deviation.max(noise.readout) / (values.len().max(1) as f64).sqrt();
    Levels {
        levels: Vec::new(),
        constant: level,
        summary: DarkSummary {
            method: DarkMethod::Level,
            mean: level,
            u_independent: 0.0,
            u_common: noise_of_mean.max(drift),
        },
    }
}

#[cfg(test)]
mod tests;
