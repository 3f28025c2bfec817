//! What the readings of a slice are divided by before they are interpolated.

use std::sync::Arc;

use gonio_geom::DVec3;

use super::Base;
use crate::lobes::Lobes;

/// A BSDF of one incidence, positive everywhere.
#[derive(Clone, Debug)]
pub(crate) enum Divisor {
    /// The base of all incidences, at this one.
    Joint(Arc<Base>, DVec3),
    /// Lobes of this incidence.
    Own(Arc<Lobes>),
}

impl Divisor {
    /// Its value in the local direction `s`, 1/sr.
    #[inline]
    pub(crate) fn eval(&self, s: DVec3) -> f64 {
        match self {
            Divisor::Joint(base, i) => base.eval(*i, s),
            Divisor::Own(lobes) => lobes.eval(s),
        }
    }

    /// [`Divisor::eval`] of many directions, faster.
    pub(crate) fn eval_all(&self, directions: impl ExactSizeIterator<Item = DVec3>) -> Vec<f64> {
        match self {
            Divisor::Joint(base, i) => base.eval_all(*i, directions),
            Divisor::Own(lobes) => directions.map(|s| lobes.eval(s)).collect(),
        }
    }

    /// Whether it is `base`.
    #[inline]
    pub(crate) fn is(&self, base: &Arc<Base>) -> bool {
        matches!(self, Divisor::Joint(own, _) if Arc::ptr_eq(own, base))
    }
}
