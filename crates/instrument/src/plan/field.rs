//! What the instrument sees of the material, without noise.

use gonio_bsdf::batch::Directions;
use gonio_bsdf::{Bsdf, directional_albedo};
use gonio_geom::{Component, DVec3, Direction};

use crate::detector::Output;
use crate::signal::{SampleSignal, Signal};
use crate::{Holder, Instrument};

/// DSF over directions for one incidence and one detector.
pub(super) struct Field<'a> {
    model: &'a dyn Bsdf,
    signal: SampleSignal<'a>,
    holder: &'a Holder,
    wi: Direction,
    output: &'a Output,
    power: f64,
}

impl<'a> Field<'a> {
    /// For light from `wi`; the first of `outputs`, one at least, is the detector.
    pub(super) fn new(
        model: &'a dyn Bsdf,
        instrument: &'a Instrument,
        outputs: &'a [Output],
        wi: Direction,
    ) -> Self {
        let wi = instrument.holder.to_sample(wi);
        Field {
            model,
            signal: SampleSignal::new(model, instrument, outputs, wi),
            holder: &instrument.holder,
            wi,
            output: &outputs[0],
            power: instrument.beam.power * outputs[0].power,
        }
    }

    /// The DSF as the instrument sees it: averaged over beam, spot and aperture.
    pub(super) fn seen(&self, at: &[Direction]) -> Vec<f64> {
        let turned: Vec<Direction> = at.iter().map(|d| self.holder.to_sample(*d)).collect();
        let still = vec![DVec3::ZERO; at.len()];
        let mut signals = self.signal.all(&turned, &still);
        let mut first = if signals.is_empty() {
            Vec::new()
        } else {
            signals.swap_remove(0)
        };
        first.iter_mut().for_each(|s| *s /= self.power);
        first
    }

    /// DHR or DHT of what meets the sample: the material's own, in the share of the beam that does.
    pub(super) fn integral(&self, component: Component) -> f64 {
        let of = |channel| directional_albedo(self.model, self.wi, component, channel);
        let weighted = self.output.weights.iter().enumerate();
        let sum: f64 = weighted.filter(|(_, w)| **w != 0.0).map(|(k, w)| w * of(k)).sum();
        sum * self.signal.fill()
    }

    /// The DSF of the material itself.
    pub(super) fn bare(&self, at: &[Direction]) -> Vec<f64> {
        let turned: Vec<DVec3> = at.iter().map(|d| self.holder.to_sample(*d).vec()).collect();
        let columns: [Vec<f64>; 3] = [0, 1, 2].map(|k| turned.iter().map(|v| v[k]).collect());
        let mut f = vec![vec![0.0; at.len()]; self.model.channels().len()];
        let mut rows: Vec<&mut [f64]> = f.iter_mut().map(Vec::as_mut_slice).collect();
        let to = [&*columns[0], &*columns[1], &*columns[2]];
        self.model.eval_f64(
            Directions::One(self.wi.vec().to_array()),
            Directions::Each(to),
            &mut rows,
        );
        (0..at.len())
            .map(|j| {
                let mixed: f64 = self.output.weights.iter().zip(&f).map(|(w, f)| w * f[j]).sum();
                mixed * columns[2][j].abs()
            })
            .collect()
    }
}
