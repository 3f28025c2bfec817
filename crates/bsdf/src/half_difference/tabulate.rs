//! Tables of other models.

use super::{HalfDifference, cells_of, domain};
use crate::{Bsdf, BsdfError, Channel};

/// What a cell without a value holds.
const EMPTY: f64 = -1.0;

impl HalfDifference {
    /// The reflection of `model` on its front, evaluated at the centres of the cells: `channels` names the channels of
    /// the table, each with the index of the model's channel that it takes.
    ///
    /// Ideal parts of the model have no value and are left out. Cells whose centre lies below a horizon are empty.
    ///
    /// # Errors
    /// [`BsdfError::Domain`] for a model that is not isotropic, an index past its channels, and as
    /// [`HalfDifference::new`].
    pub fn of(
        model: &dyn Bsdf,
        shape: [usize; 3],
        channels: &[(Channel, usize)],
    ) -> Result<HalfDifference, BsdfError> {
        if !model.properties().isotropic {
            return Err(domain("model", "an anisotropic one", "an isotropic one"));
        }
        let there = model.channels().len();
        if let Some((name, index)) = channels.iter().find(|(_, index)| *index >= there) {
            let found = format!("channel {index} of the model for {name}");
            return Err(domain(
                "channels",
                found,
                format!("up to {}", there.saturating_sub(1)),
            ));
        }
        let cells = cells_of(shape)?;
        let mut values = vec![EMPTY; cells * channels.len()];
        let mut f = vec![0.0; there];
        let mut cell = 0;
        for i in 0..shape[0] {
            for j in 0..shape[1] {
                for k in 0..shape[2] {
                    let (wi, ws) = HalfDifference::centre(shape, [i, j, k]).pair();
                    if wi.cos_theta() > 0.0 && ws.cos_theta() > 0.0 {
                        model.eval(wi, ws, &mut f);
                        for (c, &(_, index)) in channels.iter().enumerate() {
                            values[c * cells + cell] = f[index];
                        }
                    }
                    cell += 1;
                }
            }
        }
        let names = channels.iter().map(|(channel, _)| *channel).collect();
        HalfDifference::new(shape, names, values)
    }
}
