//! A part as the builder leaves it.

use std::sync::Arc;

use gonio_geom::Angles;

use crate::base::Base;
use crate::data_driven::{PartSummary, PeakSummary};
use crate::incidence::Part;
use crate::leave_one_out::LooError;
use crate::local_error::LocalError;
use crate::stated::PartErrors;

/// A peak that falls by this factor from one incidence to the next is said to, where it had this share of the most it has.
const STEEP: f64 = 3.0;
const STEEP_FROM: f64 = 0.1;

/// A part and what is to be said of it.
pub(crate) struct Built {
    pub(crate) part: Part,
    /// The base that describes the slices best, if any.
    pub(crate) base: Option<Arc<Base>>,
    pub(crate) errors: PartErrors,
    pub(crate) local: Vec<LocalError>,
    pub(crate) summary: PartSummary,
    pub(crate) loo: Vec<LooError>,
    pub(crate) notes: Vec<String>,
}

impl Built {
    /// Adds the peak within `radius` of the mirror (through) direction to the rest.
    pub(crate) fn add_peak(&mut self, narrow: Built, radius: f64, label: &str) {
        let shares: Vec<(Angles, f64)> = narrow
            .part
            .nodes()
            .iter()
            .zip(narrow.errors.light())
            .map(|(n, share)| (n.incidence, *share))
            .collect();
        let most = shares.iter().map(|s| s.1).fold(0.0, f64::max);
        let falls = |&(a, b): &(usize, usize)| shares[a].1 - shares[b].1;
        let pairs = narrow.part.layout().pairs().into_iter().map(|(a, b)| (a.node, b));
        let steep = pairs
            .filter(|&(a, b)| shares[a].1 > STEEP_FROM * most && shares[b].1 < shares[a].1 / STEEP)
            .max_by(|x, y| falls(x).total_cmp(&falls(y)));
        let theta = |k: usize| {
            narrow.part.nodes()[k]
                .direction
                .z
                .clamp(-1.0, 1.0)
                .acos()
                .to_degrees()
        };
        if let Some((a, b)) = steep {
            self.notes.push(format!(
                "{label}: between theta_i {:.1} and {:.1} deg the peak falls from {:.2} % to {:.2} % of the light: errors there \
                 are known roughly at best",
                theta(a),
                theta(b),
                100.0 * shares[a].1,
                100.0 * shares[b].1
            ));
        }
        self.notes.push(format!(
            "{label}: a peak within {:.2} deg of the unscattered direction, up to {:.1} % of the light, is interpolated apart",
            radius.to_degrees(),
            100.0 * most
        ));
        self.summary.table_values += narrow.summary.table_values;
        self.summary.peak = Some(PeakSummary {
            radius,
            shares,
            candidate: narrow.summary.candidate,
            base: narrow.summary.base,
            scores: narrow.summary.scores,
        });
        self.errors.add_peak(narrow.errors);
        self.part.add_peak(narrow.part);
    }
}
