//! What a path would give: measured with the virtual instrument and processed like a recording.

use gonio_bsdf::Bsdf;
use gonio_geom::{Angles, Component, Direction};
use gonio_scan::{Highest, ProcessOptions, ScanKind, Slice, highest, process_owned};

use crate::campaign::{Trial, trials};
use crate::{Campaign, Instrument, InstrumentError};

/// What one trial over one hemisphere gives.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Outcome {
    pub(super) readings: usize,
    /// Seconds from the first reading to the last.
    pub(super) seconds: f64,
    pub(super) integral: f64,
    /// By how much it is off, relative: what is read is known here.
    pub(super) error: f64,
    /// Standard uncertainties relative to the integral: claimed, its part from the quadrature, and that which nothing
    /// but a better beam scan or calibration would lower.
    pub(super) u_integral: f64,
    pub(super) u_quadrature: f64,
    pub(super) u_common: f64,
    /// Highest reading with its relative standard uncertainty and the part of it that comes from the path.
    pub(super) peak: f64,
    pub(super) peak_at: Angles,
    pub(super) u_peak: f64,
    pub(super) u_sampling: f64,
}

impl Outcome {
    /// Of nothing.
    pub(super) const NONE: Outcome = Outcome {
        readings: 0,
        seconds: 0.0,
        integral: 0.0,
        error: f64::INFINITY,
        u_integral: f64::INFINITY,
        u_quadrature: f64::INFINITY,
        u_common: 0.0,
        peak: 0.0,
        peak_at: Angles { theta: 0.0, phi: 0.0 },
        u_peak: f64::INFINITY,
        u_sampling: f64::INFINITY,
    };
}

/// A path to be tried.
pub(super) struct Asked {
    pub(super) incidence: Angles,
    pub(super) component: Component,
    pub(super) path: Vec<Direction>,
    /// The true integral.
    pub(super) integral: f64,
}

/// Outcomes of trials in their order, by the first detector; `None` where readings say nothing of a hemisphere.
///
/// # Errors
/// [`InstrumentError`] where the campaign cannot be simulated.
pub(super) fn outcomes(
    model: &dyn Bsdf,
    instrument: &Instrument,
    campaign: &Campaign,
    u_calibration: f64,
    paths: Vec<Asked>,
) -> Result<Vec<Option<Outcome>>, InstrumentError> {
    let known: Vec<(Component, f64)> = paths.iter().map(|p| (p.component, p.integral)).collect();
    let asked = paths.into_iter().map(|p| Trial {
        incidence: p.incidence,
        directions: p.path,
    });
    let records = trials(model, instrument, campaign, asked.collect())?;
    let of = |kind: ScanKind| records.iter().filter(move |r| r.kind == kind);
    let channel = match of(ScanKind::Beam).next() {
        Some(beam) => beam.channel,
        None => return Ok(vec![None; known.len()]),
    };
    let first = |kind: ScanKind| {
        of(kind)
            .filter(|r| r.channel == channel)
            .cloned()
            .collect::<Vec<_>>()
    };
    let sample = first(ScanKind::Sample);
    let seconds: Vec<f64> = sample
        .iter()
        .map(|s| match s.time.as_deref() {
            Some([first, .., last]) => last - first,
            _ => 0.0,
        })
        .collect();
    let options = ProcessOptions {
        u_calibration,
        ..ProcessOptions::default()
    };
    let processed = process_owned(sample, &first(ScanKind::Beam), &first(ScanKind::Dark), &options);
    let measurement = processed.map_err(|error| InstrumentError::Domain {
        field: "plan",
        found: error.to_string(),
        allowed: "an instrument whose readings can be processed".into(),
    })?;
    let outcome = |(slice, (&(component, truth), &seconds)): (&Slice, (&(Component, f64), &f64))| {
        let side = component.scattered_side(slice.incidence.direction().side());
        let integral = slice.integral(side)?;
        let peak: Highest = highest(slice, side)?;
        let relative = |u: f64| u / integral.value.abs().max(f64::MIN_POSITIVE);
        Some(Outcome {
            readings: slice.len(),
            seconds,
            integral: integral.value,
            error: (integral.value / truth - 1.0).abs(),
            u_integral: relative(integral.u),
            u_quadrature: relative(integral.u_quadrature),
            u_common: slice.u_common,
            peak: peak.value,
            peak_at: peak.at,
            u_peak: peak.u / peak.value,
            u_sampling: peak.u_sampling / peak.value,
        })
    };
    Ok(measurement
        .slices
        .iter()
        .zip(known.iter().zip(&seconds))
        .map(outcome)
        .collect())
}
