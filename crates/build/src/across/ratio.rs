//! A parametric base times the interpolated ratio of the slices to it. The base moves by its own law; the logarithm of
//! the ratio is read where the frame finds the same part of the lobe.

use super::{Across, Counterpart, Frame, MOST_TERMS, Query, View};

#[derive(Debug)]
struct Ratio([Frame; 1]);

pub(super) fn of(frame: Frame) -> &'static dyn Across {
    match frame {
        Frame::Still => &Ratio([Frame::Still]),
        Frame::Mirror => &Ratio([Frame::Mirror]),
        Frame::HalfVector => &Ratio([Frame::HalfVector]),
        Frame::CosineShift => &Ratio([Frame::CosineShift]),
        Frame::Retro => &Ratio([Frame::Retro]),
    }
}

impl Across for Ratio {
    fn frames(&self) -> &[Frame] {
        &self.0
    }

    fn logarithmic(&self) -> bool {
        true
    }

    #[inline]
    fn read(&self, _term: usize, query: &Query<'_>, view: &View<'_>, at: Counterpart) -> f64 {
        query.base.map_or(0.0, |base| view.ln_ratio(base, at.direction))
    }

    #[inline]
    fn join(&self, query: &Query<'_>, terms: &[f64; MOST_TERMS]) -> f64 {
        query
            .base
            .map_or(0.0, |base| base.eval(query.i, query.s) * terms[0].exp())
    }
}
