//! Every part of the parametric base times the ratio read in the frame of that part.

use super::{Across, Counterpart, Frame, MOST_TERMS, Query, View};
use crate::base::Moves;

#[derive(Debug)]
pub(super) struct Components([Frame; 3]);

/// Lobes of facets.
pub(super) static FACETS: Components = Components([Frame::Still, Frame::HalfVector, Frame::Retro]);
/// Lobes that turn with the through (mirror) direction.
pub(super) static TURNED: Components = Components([Frame::Still, Frame::Mirror, Frame::Retro]);

/// What moves in each of the frames.
const MOVES: [Moves; 3] = [Moves::Not, Moves::Mirror, Moves::Retro];

impl Across for Components {
    fn frames(&self) -> &[Frame] {
        &self.0
    }

    fn logarithmic(&self) -> bool {
        true
    }

    #[inline]
    fn read(&self, term: usize, query: &Query<'_>, view: &View<'_>, at: Counterpart) -> f64 {
        match query.base {
            Some(base) if base.has(MOVES[term]) => view.ln_ratio(base, at.direction),
            _ => 0.0,
        }
    }

    #[inline]
    fn join(&self, query: &Query<'_>, terms: &[f64; MOST_TERMS]) -> f64 {
        let Some(base) = query.base else { return 0.0 };
        MOVES
            .iter()
            .zip(terms)
            .filter(|(moves, _)| **moves == Moves::Not || base.has(**moves))
            .map(|(&moves, ln)| base.eval_moving(moves, query.i, query.s) * ln.exp())
            .sum()
    }
}
