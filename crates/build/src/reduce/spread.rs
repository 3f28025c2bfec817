//! A model whose ideal part has been given a width, for tables that hold nothing narrower than their cells.

use std::f64::consts::PI;

use gonio_bsdf::{Bsdf, Channel, Properties};
use gonio_geom::{Component, Direction};

/// `f + share exp(-d^2 / w^2) / (pi w^2)`, `d` the distance of direction cosines from the ideal direction: the light that
/// leaves without spreading, in a lobe of 1/e half width `w`. Its energy is kept but for what falls past the horizon.
pub(super) struct Spread<'a> {
    model: &'a dyn Bsdf,
    width: f64,
}

impl<'a> Spread<'a> {
    pub(super) fn new(model: &'a dyn Bsdf, width: f64) -> Self {
        Spread { model, width }
    }
}

impl Bsdf for Spread<'_> {
    fn channels(&self) -> &[Channel] {
        self.model.channels()
    }

    fn properties(&self) -> Properties {
        self.model.properties()
    }

    fn eval(&self, wi: Direction, ws: Direction, f: &mut [f64]) {
        let mut shares = vec![0.0; f.len()];
        self.model.eval(wi, ws, f);
        let component = Component::between(wi.side(), ws.side());
        if let Some(to) = self.model.delta(wi, component, &mut shares) {
            let (a, b) = (to.vec(), ws.vec());
            let d2 = (a.x - b.x).powi(2) + (a.y - b.y).powi(2);
            let w2 = self.width * self.width;
            let lobe = (-d2 / w2).exp() / (PI * w2);
            f.iter_mut()
                .zip(&shares)
                .for_each(|(f, share)| *f += share * lobe);
        }
    }

    fn has_data(&self, wi: Direction, ws: Direction) -> bool {
        self.model.has_data(wi, ws)
    }
}
