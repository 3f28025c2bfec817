//! How well an incidence that was not measured is predicted: incidences are left out in turn, the base is fitted again
//! to the others, and the prediction from these compared with what was held out.

use std::sync::Arc;

use gonio_geom::{Angles, Component, DVec3};
use rayon::prelude::*;

use crate::across::Candidate;
use crate::base::{Base, Picked};
use crate::images::Symmetry;
use crate::incidence::{Part, Rule};
use crate::layout::Layout;
use crate::node::Node;

/// Most incidences at the edge of what was measured that are predicted from the others.
const MOST_RIM: usize = 8;

/// The error of predicting one measured incidence from the others. It contains the noise of the readings held out,
/// and the gap is twice the spacing of the incidences: between measured incidences the model does better.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LooError {
    /// The incidence left out.
    pub incidence: Angles,
    /// The component predicted.
    pub component: Component,
    /// Root of `sum w (f' - f)^2 / sum w f^2`, with `f` the DSF and `w` the solid angle of each reading.
    pub rel_rms: f64,
    /// `sum w |f' - f| / sum w f`.
    pub rel_l1: f64,
    /// The same against the slice that was left out, smoothed within its noise, in place of its readings.
    pub rel_l1_smooth: f64,
}

/// A measured incidence and some of its readings.
#[derive(Clone, Debug)]
pub(crate) struct Held {
    pub(crate) node: Arc<Node>,
    pub(crate) readings: Picked,
    /// Incidences with equal readings share a number.
    pub(crate) group: usize,
}

/// Incidences predicted and those they are predicted from.
#[derive(Clone, Debug)]
pub(crate) struct Fold {
    pub(crate) left_out: usize,
    pub(crate) kept: Vec<usize>,
    /// Whether the incidence lies past those kept.
    pub(crate) beyond: bool,
}

/// The folds of interior incidences, and those of incidences at the edge. Copies of an incidence are left out with it.
pub(crate) fn folds(all: &[Held], symmetry: Symmetry) -> Vec<Fold> {
    let directions: Vec<DVec3> = all.iter().map(|h| h.node.direction).collect();
    let layout = Layout::new(&directions, symmetry);
    let without =
        |k: usize| -> Vec<usize> { (0..all.len()).filter(|&j| all[j].group != all[k].group).collect() };
    let mut out: Vec<Fold> = layout
        .interior()
        .into_iter()
        .map(|k| Fold {
            left_out: k,
            kept: without(k),
            beyond: false,
        })
        .collect();
    if symmetry.is_isotropic() {
        // The last one from those before it, and the one before it from those before that.
        for k in [all.len().wrapping_sub(1), all.len().wrapping_sub(2)] {
            if k < all.len() && k >= 2 {
                let mut kept = without(k);
                kept.retain(|&j| j < k);
                out.push(Fold {
                    left_out: k,
                    kept,
                    beyond: true,
                });
            }
        }
    } else {
        let rim = layout.rim();
        let step = rim.len().div_ceil(MOST_RIM).max(1);
        out.extend(rim.into_iter().step_by(step).map(|k| Fold {
            left_out: k,
            kept: without(k),
            beyond: true,
        }));
    }
    out.retain(|f| f.kept.len() >= 2);
    out
}

/// The errors of `fold` under one candidate and base.
pub(crate) fn error(
    all: &[Held],
    fold: &Fold,
    symmetry: Symmetry,
    component: Component,
    candidate: Candidate,
    base: Option<&Arc<Base>>,
    exchange: bool,
) -> LooError {
    let nodes: Vec<Arc<Node>> = fold.kept.iter().map(|&k| Arc::clone(&all[k].node)).collect();
    let rule = Rule {
        candidate,
        base: base.cloned(),
        exchange,
    };
    let part = Part::new(nodes, symmetry, rule.clone(), rule);
    let held = &all[fold.left_out];
    let (i, readings) = (held.node.direction, &held.readings);
    let sums = (0..readings.len())
        .collect::<Vec<_>>()
        .par_chunks(128)
        .flat_map_iter(|chunk| {
            let predicted = part.eval_each(i, chunk.iter().map(|&j| readings.direction[j]));
            chunk.iter().copied().zip(predicted)
        })
        .map(|(j, predicted)| {
            let s = readings.direction[j];
            let (f, w) = (readings.bsdf[j], readings.omega[j] * s.z);
            let smooth = held.node.value(s);
            let d = predicted - f;
            // The weight holds one cosine; the square of a DSF needs the second.
            [
                w * s.z * d * d,
                w * s.z * f * f,
                w * d.abs(),
                w * f.abs(),
                w * (predicted - smooth).abs(),
                w * smooth.abs(),
            ]
        })
        .collect::<Vec<_>>();
    // One after the other, so that the sums do not depend on the number of threads.
    let [apart2, size2, apart, size, apart_smooth, size_smooth] = sums
        .into_iter()
        .fold([0.0; 6], |a, b| std::array::from_fn(|k| a[k] + b[k]));
    LooError {
        incidence: held.node.incidence,
        component,
        rel_rms: (apart2 / size2).sqrt(),
        rel_l1: apart / size,
        rel_l1_smooth: apart_smooth / size_smooth,
    }
}
