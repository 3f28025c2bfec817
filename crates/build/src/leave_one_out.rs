//! How well an incidence that was not measured is predicted: each interior incidence is left out in turn, the part is
//! built from the others, and its prediction compared with the readings that were held out.

use std::sync::Arc;

use gonio_geom::{Angles, Component, DVec3};
use rayon::prelude::*;

use crate::incidence::Part;
use crate::node::{HeldOut, Node};
use crate::warp::Candidate;

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
}

/// The errors of every interior incidence under one candidate.
pub(crate) fn leave_one_out(
    nodes: &[Arc<Node>],
    held_out: &[HeldOut],
    isotropic: bool,
    component: Component,
    candidate: Candidate,
) -> Vec<LooError> {
    Part::new(nodes.to_vec(), isotropic, candidate)
        .interior()
        .into_iter()
        .map(|k| {
            let mut others = nodes.to_vec();
            let left_out = others.remove(k);
            let part = Part::new(others, isotropic, candidate);
            let (rel_rms, rel_l1) = compare(&part, left_out.direction, &held_out[k]);
            LooError {
                incidence: left_out.incidence,
                component,
                rel_rms,
                rel_l1,
            }
        })
        .collect()
}

fn compare(part: &Part, i: DVec3, readings: &HeldOut) -> (f64, f64) {
    let [apart2, size2, apart, size] = (0..readings.bsdf.len())
        .into_par_iter()
        .with_min_len(256)
        .map(|j| {
            let s = readings.direction[j];
            // The weight holds one cosine; the square of a DSF needs the second.
            let (f, w) = (readings.bsdf[j], readings.weight[j]);
            let d = part.eval(i, s) - f;
            [w * s.z * d * d, w * s.z * f * f, w * d.abs(), w * f.abs()]
        })
        .reduce(|| [0.0; 4], |a, b| std::array::from_fn(|k| a[k] + b[k]));
    ((apart2 / size2).sqrt(), apart / size)
}
