//! The BSDF itself, moved or not.

use super::{Across, Counterpart, Frame, MOST_TERMS, Query, View};

#[derive(Debug)]
struct Plain([Frame; 1]);

pub(super) fn of(frame: Frame) -> &'static dyn Across {
    match frame {
        Frame::Still => &Plain([Frame::Still]),
        Frame::Mirror => &Plain([Frame::Mirror]),
        Frame::HalfVector => &Plain([Frame::HalfVector]),
        Frame::CosineShift => &Plain([Frame::CosineShift]),
        Frame::Retro => &Plain([Frame::Retro]),
    }
}

impl Across for Plain {
    fn frames(&self) -> &[Frame] {
        &self.0
    }

    #[inline]
    fn read(&self, _term: usize, _query: &Query<'_>, view: &View<'_>, at: Counterpart) -> f64 {
        at.factor * view.bsdf(at.direction)
    }

    #[inline]
    fn join(&self, _query: &Query<'_>, terms: &[f64; MOST_TERMS]) -> f64 {
        terms[0]
    }
}
