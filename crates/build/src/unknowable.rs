//! Cases in which no error that is stated can be trusted.

use std::sync::Arc;

use crate::hold_out::SliceError;
use crate::incidence::Part;
use crate::layout::Neighbour;
use crate::leave_one_out::{Held, LooError};
use crate::node::Node;
use crate::symmetry::polar;

/// Error between readings (relative L1) from which a slice is called undersampled.
const UNDERSAMPLED: f64 = 0.02;

/// Distance of readings in half widths (1/e) of a lobe from which they undersample it, however well a base fills the gaps between
/// them: what scans are planned by.
const APART: f64 = 0.5;

/// Factor between a slice and its neighbour's prediction of it from which light counts as not there.
const GONE: f64 = 5.0;

/// Share of light that is there in one of two neighbouring incidences only from which that is said.
const SWITCHED: f64 = 0.1;

/// Factor between the error at the last incidence left out and the usual one, and least error (relative L1), from which errors
/// grow too fast towards grazing incidence for the last gap to be known.
const GROWING: f64 = 2.0;
const GROWN: f64 = 0.03;

/// What to say of the last gap of an isotropic sample, whose middle no incidence left out can tell of, from the errors at
/// `interior` incidences left out (ascending) and the polar angle of the last incidence, radians.
pub(crate) fn last_gap(label: &str, interior: &[LooError], last: f64) -> Option<String> {
    let (outer, rest) = interior.split_last()?;
    let mut usual: Vec<f64> = rest.iter().map(|e| e.rel_l1_smooth).collect();
    usual.sort_unstable_by(f64::total_cmp);
    let usual = *usual.get(usual.len() / 2)?;
    let found = outer.rel_l1_smooth;
    (found > GROWN && found > GROWING * usual).then(|| {
        let theta = polar(outer.incidence).to_degrees();
        format!(
            "{label}: errors of interpolation grow towards grazing incidence ({:.1} % at theta_i {theta:.1} deg left out, {:.1} % \
             usually); between there and {:.1} deg they may be several times what is stated",
            100.0 * found,
            100.0 * usual,
            last.to_degrees()
        )
    })
}

/// What to say about slices with too few readings, and about lobes that are there at one incidence and not at the next.
pub(crate) fn notes(
    label: &str,
    all: &[Held],
    (slices, spacings): (&[SliceError], &[f64]),
    part: &Part,
) -> Vec<String> {
    let mut notes = Vec::new();
    let theta = |node: &Arc<Node>| node.direction.z.clamp(-1.0, 1.0).acos().to_degrees();
    let coarse: Vec<usize> = (0..all.len()).filter(|&k| slices[k].gap > UNDERSAMPLED).collect();
    if let Some(&worst) = coarse
        .iter()
        .max_by(|&&a, &&b| slices[a].gap.total_cmp(&slices[b].gap))
    {
        notes.push(format!(
            "{label}: undersampled, the peak is narrower than the distance of its readings at {} of {} incidences, worst at \
             theta_i {:.1} deg (about {:.0} % between readings): errors there are known roughly at best",
            coarse.len(),
            all.len(),
            theta(&all[worst].node),
            100.0 * slices[worst].gap
        ));
    } else {
        let sparse = || (0..all.len()).filter(|&k| spacings[k] > APART);
        if let Some(worst) = sparse().max_by(|&a, &b| spacings[a].total_cmp(&spacings[b])) {
            notes.push(format!(
                "{label}: undersampled, readings lie more than half of the peak's narrow half width apart at {} of {} incidences, worst \
                 at theta_i {:.1} deg ({:.1} half widths): between them the shape of the fitted model is taken for that of the \
                 sample",
                sparse().count(),
                all.len(),
                theta(&all[worst].node),
                spacings[worst]
            ));
        }
    }
    let mut switched: Option<(f64, usize, usize)> = None;
    let mut pairs: Vec<(usize, usize)> = Vec::new();
    for (a, b) in part.layout().pairs() {
        let share = unlike(part, all, a, b);
        if share > SWITCHED {
            pairs.push((a.node.min(b), a.node.max(b)));
        }
        if share > switched.map_or(SWITCHED, |s| s.0) {
            switched = Some((share, a.node.min(b), a.node.max(b)));
        }
    }
    if let Some((share, a, b)) = switched {
        pairs.sort_unstable();
        pairs.dedup();
        let more = match pairs.len() - 1 {
            0 => String::new(),
            n => format!(", and of {n} more pairs of neighbours"),
        };
        notes.push(format!(
            "{label}: between theta_i {:.1} and {:.1} deg {:.0} % of the light appears, vanishes or moves by more than a \
             lobe's width: what happens between them{more} is not known",
            theta(&all[a].node),
            theta(&all[b].node),
            100.0 * share
        ));
    }
    notes
}

/// Share of the light of incidence `b` that its neighbour `a` does not predict within [`GONE`].
fn unlike(part: &Part, all: &[Held], a: Neighbour, b: usize) -> f64 {
    let (i, readings) = (all[b].node.direction, &all[b].readings);
    let (mut gone, mut all_light) = (0.0, 0.0);
    for j in 0..readings.len() {
        let s = readings.direction[j];
        let there = all[b].node.value(s).max(0.0);
        let Some(predicted) = part.alone(a, i, s) else {
            continue;
        };
        let light = readings.omega[j] * s.z;
        all_light += light * there;
        if there > GONE * predicted {
            gone += light * (there - predicted);
        }
    }
    if all_light > 0.0 { gone / all_light } else { 0.0 }
}
