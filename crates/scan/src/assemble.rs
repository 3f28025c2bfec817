//! The measurement of processed records, with what is to be said of it.

use crate::assumed::no_dark;
use crate::blank::{place, summed_up};
use crate::dark::DarkSummary;
use crate::{Beam, Measurement, NoiseModel, Processing, Slice, Verdict};

/// One processed record with what was learnt from it.
pub(crate) struct Done {
    pub(crate) slice: Slice,
    pub(crate) noise: NoiseModel,
    pub(crate) dark: Option<DarkSummary>,
    /// Whether the blank matched.
    pub(crate) findings: Vec<Verdict>,
}

/// The measurement of processed records; `assumed` are findings of the whole.
pub(crate) fn assemble(
    done: Vec<Done>,
    beams: Vec<Beam>,
    sample_name: Option<String>,
    mut warnings: Vec<String>,
    without_dark: bool,
    assumed: Vec<Verdict>,
) -> Measurement {
    let mut processing = Processing::default();
    let mut slices = Vec::with_capacity(done.len());
    let mut blanks = Vec::new();
    for d in done {
        processing.noise.push((d.slice.channel, d.noise));
        processing.dark.push(d.dark);
        blanks.extend(d.findings);
        slices.push(d.slice);
    }
    processing.findings.extend(summed_up(blanks));
    if without_dark {
        processing.findings.push(no_dark(&slices));
    }
    processing.findings.extend(assumed);
    for f in processing
        .findings
        .iter()
        .filter(|f| f.level > crate::Level::Pass)
    {
        warnings.push(f.sentence.clone());
    }
    for slice in &slices {
        for h in slice.integrals.iter().filter(|h| h.value > 1.0 + 2.0 * h.u) {
            let (theta, phi) = slice.incidence.to_degrees();
            warnings.push(format!(
                "{} at theta_i {theta:.2}, phi_i {phi:.2} deg, {} side: the hemispherical integral is {:.4}, more than 1 \
                 by more than its uncertainty",
                slice.channel, h.side, h.value
            ));
        }
    }
    warnings.extend(uncertain_integrals(&slices));
    let flat: Vec<&Slice> = slices.iter().filter(|s| s.integrals.is_empty()).collect();
    if let Some(first) = flat.first() {
        warnings.push(format!(
            "no hemispherical integral for {} of {} scans, the first {} at {}: the readings lie near less than {:.0} % \
             of a hemisphere, as those of an in-plane scan; scan more azimuths for DHR or DHT",
            flat.len(),
            slices.len(),
            first.channel,
            place(first.incidence),
            100.0 * crate::weigh::MEASURED
        ));
    }
    let signature_fwhm = beams
        .iter()
        .map(|b| b.signature.fwhm)
        .filter(|w| w.is_finite())
        .max_by(f64::total_cmp);
    let resolutions = beams.iter().filter_map(Beam::resolution).collect();
    processing.beams = beams;
    Measurement {
        slices,
        sample_name,
        signature_fwhm,
        resolutions,
        warnings,
        processing,
    }
}

/// Relative standard uncertainty of the quadrature from which it is worth a warning.
const UNCERTAIN: f64 = 0.05;

/// A warning for the integral that the choice of directions leaves most uncertain.
fn uncertain_integrals(slices: &[Slice]) -> Option<String> {
    let all: Vec<_> = slices
        .iter()
        .flat_map(|s| s.integrals.iter().map(move |h| (s, h)))
        .filter(|(_, h)| h.value > 0.0)
        .map(|(s, h)| (s, h, h.u_quadrature / h.value))
        .filter(|(.., relative)| *relative > UNCERTAIN)
        .collect();
    let (slice, h, relative) = all.iter().max_by(|a, b| a.2.total_cmp(&b.2))?;
    let more = match all.len() - 1 {
        0 => String::new(),
        n => format!(", and {n} more by above 5 %"),
    };
    Some(format!(
        "{} at {}, {} side: the hemispherical integral {:.4} is uncertain by {:.0} % (k = 1) for want of readings{more} \
             ({:.1} % of it extrapolated); where that is little, a peak holds too few of them: scan it on a finer path",
        slice.channel,
        place(slice.incidence),
        h.side,
        h.value,
        100.0 * relative,
        100.0 * h.extrapolated / h.value
    ))
}
