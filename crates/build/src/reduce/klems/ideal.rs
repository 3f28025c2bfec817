//! Light that a model passes on without spreading, in the patches it goes to.

use gonio_bsdf::Bsdf;
use gonio_bsdf::klems::Role;

use super::Filling;

/// Incidences across a patch, in each coordinate.
const POINTS: usize = 8;

impl Filling<'_> {
    /// Adds the ideal part to `values[exit * n + incident]`: the share of the light over the projected solid angle of the
    /// patch it leaves through, averaged over the incident patch.
    pub(super) fn add_ideal(&self, values: &mut [f32]) {
        let model: &dyn Bsdf = self.one.model;
        let basis = &self.options.basis;
        let n = basis.len();
        let mut shares = vec![0.0; model.channels().len()];
        let at = |k: usize| (k as f64 + 0.5) / POINTS as f64;
        for incident in 0..n {
            for k in 0..POINTS * POINTS {
                let wi = basis.point(
                    incident,
                    Role::Incident,
                    self.side,
                    at(k / POINTS),
                    at(k % POINTS),
                );
                let Some(to) = model.delta(wi, self.component, &mut shares) else {
                    continue;
                };
                let exit = basis.patch(to, Role::Exit);
                let mean = shares[self.one.index] / (POINTS * POINTS) as f64;
                values[exit * n + incident] += (mean / basis.lambda()[exit]) as f32;
            }
        }
    }
}
