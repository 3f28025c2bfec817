//! The diffuse level as it is, and what lies above it moved: warping a diffuse floor would bend it.

use super::{Across, Counterpart, Frame, MOST_TERMS, Query, View};

#[derive(Debug)]
struct Split([Frame; 2]);

pub(super) fn of(frame: Frame) -> &'static dyn Across {
    match frame {
        Frame::Still => &Split([Frame::Still, Frame::Still]),
        Frame::Mirror => &Split([Frame::Still, Frame::Mirror]),
        Frame::HalfVector => &Split([Frame::Still, Frame::HalfVector]),
        Frame::CosineShift => &Split([Frame::Still, Frame::CosineShift]),
        Frame::Retro => &Split([Frame::Still, Frame::Retro]),
    }
}

impl Across for Split {
    fn frames(&self) -> &[Frame] {
        &self.0
    }

    #[inline]
    fn read(&self, term: usize, _query: &Query<'_>, view: &View<'_>, at: Counterpart) -> f64 {
        let level = view.node.level;
        if term == 0 {
            level
        } else {
            at.factor * (view.bsdf(at.direction) - level)
        }
    }

    #[inline]
    fn join(&self, _query: &Query<'_>, terms: &[f64; MOST_TERMS]) -> f64 {
        terms[0] + terms[1]
    }
}
