//! What a path would give: measured with the virtual instrument and processed like a recording.

use gonio_bsdf::Channel;
use gonio_geom::{Angles, Component, Direction};
use gonio_scan::{Highest, ProcessOptions, ScanKind, Slice, highest, process_owned};

use crate::InstrumentError;
use crate::trial::{Trial, Trials};

/// What one trial over one hemisphere gives.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Outcome {
    pub(super) readings: usize,
    /// Seconds from the first reading to the last.
    pub(super) seconds: f64,
    /// What each detector that sees light there would claim.
    pub(super) claims: Vec<Claims>,
}

/// What one detector would claim.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Claims {
    pub(super) channel: Channel,
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

impl Claims {
    /// The uncertainty of the integral: a claim that the known error exceeds is none to rely on.
    pub(super) fn of_integral(&self) -> f64 {
        self.u_integral.max(self.error)
    }
}

impl Outcome {
    /// The detector that decides on the integral, and the one that decides on the peak; `None` where nothing was read.
    pub(super) fn deciding(&self) -> Option<[&Claims; 2]> {
        let worst = |of: fn(&Claims) -> f64| self.claims.iter().max_by(|a, b| of(a).total_cmp(&of(b)));
        Some([worst(Claims::of_integral)?, worst(|c| c.u_peak)?])
    }
}

/// A path to be tried.
pub(super) struct Asked {
    pub(super) incidence: Angles,
    pub(super) component: Component,
    pub(super) path: Vec<Direction>,
    /// The true integral, one an output of the detector.
    pub(super) integrals: Vec<f64>,
}

/// DHR or DHT up to which a hemisphere is dark to a detector.
pub(super) const DARK: f64 = 1e-9;

/// A hemisphere and its true integrals, one an output of the detector.
type Known = (Component, Vec<f64>);

/// Outcomes of trials in their order; `None` where readings say nothing of a hemisphere that a detector sees light from.
///
/// # Errors
/// [`InstrumentError`] where the records cannot be processed.
pub(super) fn outcomes(
    trials: &mut Trials<'_>,
    u_calibration: f64,
    paths: Vec<Asked>,
) -> Result<Vec<Option<Outcome>>, InstrumentError> {
    let known: Vec<Known> = paths.iter().map(|p| (p.component, p.integrals.clone())).collect();
    let asked = paths.into_iter().map(|p| Trial {
        incidence: p.incidence,
        directions: p.path,
    });
    let sample = trials.read(asked.collect());
    let detectors = trials.detectors();
    let of = |kind: ScanKind| -> Vec<_> {
        let records = trials.reference().iter();
        records.filter(|r| r.kind == kind).cloned().collect()
    };
    let seconds: Vec<f64> = sample
        .iter()
        .step_by(detectors)
        .map(|s| match s.time.as_deref() {
            Some([first, .., last]) => last - first,
            _ => 0.0,
        })
        .collect();
    let options = ProcessOptions {
        u_calibration,
        ..ProcessOptions::default()
    };
    let processed = process_owned(sample, &of(ScanKind::Beam), &of(ScanKind::Dark), &options);
    let measurement = processed.map_err(|error| InstrumentError::Domain {
        field: "plan",
        found: error.to_string(),
        allowed: "an instrument whose readings can be processed".into(),
    })?;
    let claims = |slice: &Slice, component: Component, truth: f64| {
        let side = component.scattered_side(slice.incidence.direction().side());
        let integral = slice.integral(side)?;
        let peak: Highest = highest(slice, side)?;
        let relative = |u: f64| u / integral.value.abs().max(f64::MIN_POSITIVE);
        Some(Claims {
            channel: slice.channel,
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
    let outcome = |slices: &[Slice], (component, truths): &Known, seconds: f64| {
        let lit = slices.iter().zip(truths).filter(|(_, t)| **t > DARK);
        let claims: Option<Vec<Claims>> = lit.map(|(s, t)| claims(s, *component, *t)).collect();
        Some(Outcome {
            readings: slices.first()?.len(),
            seconds,
            claims: claims.filter(|c| !c.is_empty())?,
        })
    };
    let all = measurement.slices.chunks_exact(detectors).zip(&known);
    Ok(all
        .zip(seconds)
        .map(|((slices, known), seconds)| outcome(slices, known, seconds))
        .collect())
}
