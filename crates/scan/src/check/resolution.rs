//! Whether the instrument resolves the sharpest lobe.

use gonio_geom::{Component, Side};

use crate::{Level, Measurement, Slice, Verdict, u_beside_resolution};

use super::name;

const ID: &str = "resolution";
const TITLE: &str = "Lobes are wider than the signature";
/// Ratio of lobe width to signature width below which the width is an upper bound.
const WARN: f64 = 2.0;
/// Ratio that no real lobe reaches: a measured lobe is never narrower than the beam.
const FAIL: f64 = 0.8;
/// Readings above half the peak that a lobe needs to be resolved by the path.
const READINGS: usize = 5;

/// Smallest ratio of a lobe's full width at half maximum (of the disk of the solid angle in which the DSF is above
/// half its peak, per component) to that of the signature.
pub(super) fn check(measurement: &Measurement) -> Verdict {
    let Some(signature) = measurement.signature_fwhm.filter(|s| *s > 0.0) else {
        return Verdict::not_applicable(
            ID,
            TITLE,
            "The signature is unknown: give the reference scan of the beam to state the resolution.",
        );
    };
    let mut worst: Option<(f64, usize, String)> = None;
    for slice in &measurement.slices {
        let resolution = measurement
            .resolutions
            .iter()
            .find(|r| r.channel == slice.channel);
        let sharp = resolution.map(|r| Slice {
            u_dsf: u_beside_resolution(slice, r),
            ..slice.clone()
        });
        let slice = sharp.as_ref().unwrap_or(slice);
        for side in Side::BOTH {
            let Some((width, readings)) = lobe(slice, side) else {
                continue;
            };
            let ratio = width / signature;
            if worst.as_ref().is_none_or(|w| ratio < w.0) {
                let component = Component::between(slice.incidence.direction().side(), side);
                worst = Some((ratio, readings, format!("{}, {component}", name(slice))));
            }
        }
    }
    let Some((value, readings, place)) = worst else {
        return Verdict::not_applicable(ID, TITLE, "No lobe above the noise.");
    };
    let mut level = match value {
        v if v < FAIL => Level::Fail,
        v if v < WARN => Level::Warn,
        _ => Level::Pass,
    };
    if readings < READINGS {
        level = level.max(Level::Warn);
    }
    let what = match level {
        Level::Fail => {
            ": narrower than the beam itself; the path is too coarse at the peak or the signature is not of \
                        this set-up."
        }
        Level::Warn => {
            ": take its width as an upper bound, or measure with a narrower beam and a finer path."
        }
        _ => ".",
    };
    Verdict {
        id: ID,
        title: TITLE,
        level,
        value: Some(value),
        unit: "1",
        sentence: format!(
            "The sharpest lobe ({place}) is {value:.1} times as wide as the signature of {:.2} deg and holds \
             {readings} readings above half its peak{what}",
            signature.to_degrees()
        ),
    }
}

/// Width of the lobe on one side and the readings above half its peak; `None` without a peak above the noise.
fn lobe(slice: &Slice, side: Side) -> Option<(f64, usize)> {
    let on_side = |j: &usize| slice.flags[*j].usable() && slice.direction(*j).side() == side;
    let peak = (0..slice.len())
        .filter(on_side)
        .max_by(|&a, &b| slice.dsf[a].total_cmp(&slice.dsf[b]))?;
    let top = slice.dsf[peak];
    if top <= 10.0 * slice.u_independent(peak) || top <= 0.0 {
        return None;
    }
    let above: Vec<usize> = (0..slice.len())
        .filter(on_side)
        .filter(|&j| slice.dsf[j] >= 0.5 * top)
        .collect();
    let omega: f64 = above.iter().map(|&j| slice.omega[j]).sum();
    Some((2.0 * crate::flagging::half_angle(omega), above.len()))
}
