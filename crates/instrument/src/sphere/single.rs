//! One channel of a model.

use std::sync::Arc;

use gonio_bsdf::{Bsdf, Lobe};
use gonio_geom::{Component, Direction};

/// One channel of a model, scattering light on its way.
pub(super) struct Single {
    model: Arc<dyn Bsdf>,
    index: usize,
    count: usize,
}

/// Channels up to which values stay off the heap.
const FEW: usize = 16;

impl Single {
    pub(super) fn new(model: Arc<dyn Bsdf>, index: usize) -> Option<Self> {
        let count = model.channels().len();
        (index < count).then_some(Single { model, index, count })
    }

    fn one(&self, fill: impl FnOnce(&mut [f64])) -> f64 {
        if self.count <= FEW {
            let mut f = [0.0; FEW];
            fill(&mut f[..self.count]);
            f[self.index]
        } else {
            let mut f = vec![0.0; self.count];
            fill(&mut f);
            f[self.index]
        }
    }

    /// Where light from `wi` goes on, and what is left of it.
    pub(super) fn scatter(&self, wi: Direction, u: [f64; 3]) -> Option<(Direction, f64)> {
        let drawn = self.model.sample(wi, u)?;
        let ws = drawn.direction;
        let weight = if self.count == 1 {
            drawn.weight
        } else if drawn.lobe == Lobe::Delta {
            let component = match ws.side() == wi.side() {
                true => Component::Reflection,
                false => Component::Transmission,
            };
            self.one(|shares| {
                self.model.delta(wi, component, shares);
            }) / drawn.pdf
        } else {
            self.one(|f| self.model.eval(wi, ws, f)) * ws.cos_theta().abs() / drawn.pdf
        };
        (weight > 0.0).then_some((ws, weight))
    }
}
