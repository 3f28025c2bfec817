//! Designs a step finer or coarser than another.

use super::PlanOptions;
use super::lay::{Design, Pitch};
use super::search::{Part, STRETCH};

/// Factor of a pitch from one trial to the next.
const STEP: f64 = std::f64::consts::FRAC_1_SQRT_2;
/// The finest pitch on the sphere, radians.
const FINEST: f64 = 2e-4;

/// Designs one step finer.
pub(super) fn steps(part: &Part) -> Vec<Design> {
    let mut out = Vec::new();
    let design = &part.design;
    if design.base * STEP > FINEST {
        let mut finer = design.clone();
        finer.base *= STEP;
        out.push(finer);
    }
    for (k, lobe) in part
        .survey
        .lobes
        .iter()
        .enumerate()
        .filter(|(_, l)| l.height > 0.0)
    {
        let now = design.lobes[k];
        let mut add = |pitch: Pitch| {
            if pitch.peak * lobe.width[1] > FINEST {
                let mut finer = design.clone();
                finer.lobes[k] = pitch;
                out.push(finer);
            }
        };
        let flank = (now.flank * STEP).max(0.3 * now.peak);
        add(Pitch {
            flank,
            peak: now.peak.min(flank),
            ..now
        });
        add(Pitch {
            peak: now.peak * STEP,
            ..now
        });
        if lobe.width[0] > 1.5 * lobe.width[1] && now.stretch > 1.0 {
            add(Pitch {
                stretch: (now.stretch * STEP).max(1.0),
                ..now
            });
        }
    }
    let mut all = design.clone();
    all.base *= STEP;
    for (pitch, lobe) in all.lobes.iter_mut().zip(&part.survey.lobes) {
        if lobe.height > 0.0 {
            pitch.flank *= STEP;
            pitch.peak = (pitch.peak * STEP).min(pitch.flank);
        }
    }
    out.push(all);
    out
}

/// Designs one step coarser: the way to a design that meets its targets takes more than it needs.
pub(super) fn savings(part: &Part, options: &PlanOptions) -> Vec<Design> {
    let design = &part.design;
    let mut out = Vec::new();
    if design.base < options.largest_pitch {
        let mut coarser = design.clone();
        coarser.base = (design.base / STEP).min(options.largest_pitch);
        out.push(coarser);
    }
    for (k, _) in part
        .survey
        .lobes
        .iter()
        .enumerate()
        .filter(|(_, l)| l.height > 0.0)
    {
        let mut add = |change: &dyn Fn(&mut Pitch)| {
            let mut coarser = design.clone();
            change(&mut coarser.lobes[k]);
            out.push(coarser);
        };
        add(&|p| p.flank /= STEP);
        add(&|p| p.peak = (p.peak / STEP).min(p.flank));
        add(&|p| p.stretch = (p.stretch / STEP).min(STRETCH));
    }
    out
}
