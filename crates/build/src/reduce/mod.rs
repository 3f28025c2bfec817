//! Reduction of any model to the tables other tools read: Klems matrices and tensor trees.
//!
//! A reduced model is an average of the model over cells of equal treatment of incidence and exit, so it keeps the
//! energy of the model; what it loses in resolution [`loss`] tells per incidence.

mod apart;
mod compact;
mod comparison;
mod klems;
mod largest;
mod loss;
mod tensor_tree;

use gonio_bsdf::{Bsdf, BsdfError, Channel, FourComponents};
use gonio_geom::{Component, Direction, Side};

pub use compact::{CompactOptions, CompactReduction, to_compact};
pub use comparison::{Comparison, compare, reciprocity};
pub use klems::{KlemsOptions, KlemsReduction, to_klems};
pub use largest::{Largest, largest_albedo};
pub use loss::{Loss, loss};
pub use tensor_tree::{TreeOptions, TreeReduction, to_tensor_tree};

/// One channel of a model.
#[derive(Clone, Copy)]
struct OneChannel<'a> {
    model: &'a dyn Bsdf,
    index: usize,
}

impl<'a> OneChannel<'a> {
    fn with_ideal(model: &'a dyn Bsdf, index: usize) -> Result<Self, BsdfError> {
        let n = model.channels().len();
        if index >= n {
            return Err(BsdfError::Domain {
                field: "channel",
                found: format!("number {index}"),
                allowed: format!("0 to {} ({n} channels)", n.saturating_sub(1)),
            });
        }
        Ok(OneChannel { model, index })
    }

    fn channel(&self) -> Channel {
        self.model.channels()[self.index]
    }

    /// Value of the channel; a model that breaks its promise of finite values counts as 0 there.
    fn eval(&self, wi: Direction, ws: Direction) -> f64 {
        let f = if self.index == 0 {
            self.model.eval_first(wi, ws)
        } else {
            let mut all = vec![0.0; self.model.channels().len()];
            self.model.eval(wi, ws, &mut all);
            all[self.index]
        };
        if f.is_finite() { f.max(0.0) } else { 0.0 }
    }

    /// Whether a component scatters into any of a few hundred directions spread over both hemispheres, the mirror and
    /// unbent directions among them.
    fn scatters(&self, side: Side, component: Component) -> bool {
        let to = component.scattered_side(side);
        (0..64u32).any(|k| {
            let t = f64::from(k) + 0.5;
            let wi = disk_direction(
                (t * 0.754_877_666_25).fract(),
                (t * 0.569_840_290_998).fract(),
                side,
            );
            let straight = match component {
                Component::Reflection => wi.mirror(),
                Component::Transmission => wi.through(),
            };
            let mut shares = vec![0.0; self.model.channels().len()];
            let ideal = self.model.delta(wi, component, &mut shares).is_some();
            ideal
                || self.eval(wi, straight) > 0.0
                || (0..8u32).any(|m| {
                    let s = t * 8.0 + f64::from(m);
                    let ws = disk_direction((s * 0.819_172_513_4).fract(), (s * 0.671_043_606_7).fract(), to);
                    self.eval(wi, ws) > 0.0
                })
        })
    }

    /// The components asked for, or those that scatter.
    fn components(&self, asked: Option<&[(Side, Component)]>) -> Result<Vec<(Side, Component)>, BsdfError> {
        let list: Vec<_> = match asked {
            Some(list) => list.to_vec(),
            None => FourComponents::<()>::KEYS
                .into_iter()
                .filter(|(s, c)| self.scatters(*s, *c))
                .collect(),
        };
        if list.is_empty() {
            return Err(BsdfError::Domain {
                field: "components",
                found: "none that scatters".into(),
                allowed: "at least one".into(),
            });
        }
        Ok(list)
    }
}

/// The direction of a point of the Shirley-Chiu square, uniform in projected solid angle.
fn disk_direction(u: f64, v: f64, side: Side) -> Direction {
    gonio_bsdf::tensor_tree::lookup::incident_direction(gonio_bsdf::tensor_tree::Rank::Four, [u, v], side)
}

#[cfg(test)]
mod ideal_tests;
#[cfg(test)]
mod tests;
