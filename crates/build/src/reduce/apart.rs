//! Light without spread, told apart from scattered light where two models are compared.

use gonio_bsdf::{Bsdf, directional_albedo};
use gonio_geom::{Component, Direction};

/// Two models, each with the number of its channel, at one incidence and component.
pub(super) struct Apart<'a> {
    models: [(&'a dyn Bsdf, usize); 2],
    wi: Direction,
    component: Component,
    /// Direction and share of what each leaves without spread.
    ideal: [Option<(Direction, f64)>; 2],
}

/// Sums of `f |cos| domega` of each model over the directions that are compared, and over those that are not.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Sums {
    pub(super) compared: [f64; 2],
    pub(super) held: [f64; 2],
}

/// The light of each model.
#[derive(Clone, Copy, Debug)]
pub(super) struct Light {
    /// Directional albedo, everything included.
    pub(super) albedo: [f64; 2],
    /// Share of the light without spread.
    pub(super) ideal: [f64; 2],
}

impl<'a> Apart<'a> {
    pub(super) fn new(models: [(&'a dyn Bsdf, usize); 2], wi: Direction, component: Component) -> Self {
        let ideal = models.map(|(model, channel)| {
            let mut shares = vec![0.0; model.channels().len()];
            let to = model.delta(wi, component, &mut shares)?;
            Some((to, shares[channel])).filter(|(_, share)| *share > 0.0)
        });
        Apart {
            models,
            wi,
            component,
            ideal,
        }
    }

    /// The model that holds the ideal light of the other in its cells, with the direction of that light.
    fn table(&self) -> Option<(usize, Direction)> {
        match self.ideal {
            [Some((to, _)), None] => Some((1, to)),
            [None, Some((to, _))] => Some((0, to)),
            _ => None,
        }
    }

    /// Whether the answer of a table for `ws` may hold ideal light of the other model: nothing to compare there.
    pub(super) fn held(&self, ws: Direction) -> bool {
        self.table()
            .is_some_and(|(k, to)| self.models[k].0.holds(self.wi, to, ws))
    }

    /// What each has in all. In the cells of a table that hold ideal light, what is more than the scattered light of the
    /// other model is ideal.
    pub(super) fn light(&self, sums: &Sums) -> Light {
        let mut ideal = self.ideal.map(|i| i.map_or(0.0, |(_, share)| share));
        let mut albedo = [0, 1].map(|k| sums.compared[k] + sums.held[k] + ideal[k]);
        if let Some((k, to)) = self.table()
            && self.models[k].0.holds(self.wi, to, to)
        {
            let (model, channel) = self.models[k];
            albedo[k] = directional_albedo(model, self.wi, self.component, channel);
            ideal[k] = albedo[k] - sums.compared[k] - sums.held[1 - k];
        }
        Light { albedo, ideal }
    }
}
