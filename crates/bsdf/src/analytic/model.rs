//! A formula with its parameters: a `Bsdf`.

use gonio_geom::{Component, Direction};

use super::{Formula, Law, Pair, Spectrum, in_range, lanes};
use crate::batch::{Directions, SampleColumns, eval_each, sample_each};
use crate::{Bsdf, BsdfError, Channel, Lobe, Properties, Sample};

/// The model of formula `F` with one set of parameters a channel.
pub struct Analytic<F: Formula> {
    channels: Vec<Channel>,
    parameters: Vec<Vec<f64>>,
    /// For light from the front and from the back.
    shapes: [Vec<F::Shape<f64>>; 2],
    properties: Properties,
}

impl<F: Formula> Analytic<F> {
    /// The model with `parameters`, one list a channel in the order of `F::INFO.parameters`.
    ///
    /// # Errors
    /// [`BsdfError::Domain`] for no channel, a channel given twice, a wrong number of parameters or one out of range.
    pub fn new(parameters: &[(Channel, Vec<f64>)]) -> Result<Self, BsdfError> {
        let mut model = Analytic {
            channels: Vec::new(),
            parameters: Vec::new(),
            shapes: [Vec::new(), Vec::new()],
            properties: Properties {
                reciprocal: F::INFO.keeps(Law::Reciprocity),
                energy_conserving: F::INFO.keeps(Law::Energy),
                isotropic: true,
            },
        };
        if parameters.is_empty() {
            return Err(BsdfError::Domain {
                field: "channels",
                found: "none".into(),
                allowed: "parameters for at least one channel".into(),
            });
        }
        for (channel, p) in parameters {
            let infos = F::INFO.parameters;
            if p.len() != infos.len() {
                return Err(BsdfError::Domain {
                    field: F::INFO.name,
                    found: format!("{} parameters", p.len()),
                    allowed: format!("{}", infos.len()),
                });
            }
            if model.channels.contains(channel) {
                return Err(BsdfError::Domain {
                    field: "channels",
                    found: format!("channel {channel} twice"),
                    allowed: "each channel once".into(),
                });
            }
            for (info, &value) in infos.iter().zip(p) {
                in_range(info.name, value, info.low, info.high)?;
            }
            model.channels.push(*channel);
            model.properties.reciprocal &= F::index_ratio(p) == 1.0;
            model.properties.isotropic &= F::isotropic(p);
            let shape = F::shape::<f64>(p);
            model.shapes[0].push(shape);
            model.shapes[1].push(F::behind::<f64>(&shape));
            model.parameters.push(p.clone());
        }
        Ok(model)
    }

    /// The model whose first parameter has the values of `amplitude` and whose others are `rest` in every channel.
    ///
    /// # Errors
    /// As [`Analytic::new`].
    pub fn of(amplitude: &Spectrum, rest: &[f64]) -> Result<Self, BsdfError> {
        let parameters: Vec<_> = amplitude
            .channels()
            .iter()
            .zip(amplitude.values())
            .map(|(&channel, &a)| (channel, std::iter::once(a).chain(rest.iter().copied()).collect()))
            .collect();
        Analytic::new(&parameters)
    }

    /// The parameters of each channel.
    pub fn parameters(&self) -> &[Vec<f64>] {
        &self.parameters
    }

    /// Prepared parameters of each channel for `w` on its side.
    fn shapes(&self, w: Direction) -> &[F::Shape<f64>] {
        &self.shapes[usize::from(w.cos_theta() < 0.0)]
    }

    /// Whether a pair is lit: off the horizon and of a component the model scatters into.
    fn lit(wi: Direction, ws: Direction) -> bool {
        let product = wi.cos_theta() * ws.cos_theta();
        product != 0.0
            && F::INFO.scatters.into(if product > 0.0 {
                Component::Reflection
            } else {
                Component::Transmission
            })
    }
}

impl<F: Formula> Clone for Analytic<F> {
    fn clone(&self) -> Self {
        Analytic {
            channels: self.channels.clone(),
            parameters: self.parameters.clone(),
            shapes: self.shapes.clone(),
            properties: self.properties,
        }
    }
}

impl<F: Formula> std::fmt::Debug for Analytic<F> {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct(F::INFO.name)
            .field("channels", &self.channels)
            .field("parameters", &self.parameters)
            .finish()
    }
}

/// `d` as seen with `w` in front: mirrored in the sample plane when `w` is on the back.
fn in_front(w: Direction, d: Direction) -> Direction {
    if w.cos_theta() < 0.0 { d.flipped() } else { d }
}

impl<F: Formula> Bsdf for Analytic<F> {
    fn channels(&self) -> &[Channel] {
        &self.channels
    }

    fn properties(&self) -> Properties {
        self.properties
    }

    fn eval(&self, wi: Direction, ws: Direction, f: &mut [f64]) {
        if !Self::lit(wi, ws) {
            f.fill(0.0);
            return;
        }
        let pair = Pair::new(wi, ws);
        for (f, shape) in f.iter_mut().zip(self.shapes(wi)) {
            let value = F::bsdf::<f64>(shape, &pair);
            *f = if value > 0.0 { value } else { 0.0 };
        }
    }

    fn eval_first(&self, wi: Direction, ws: Direction) -> f64 {
        if !Self::lit(wi, ws) {
            return 0.0;
        }
        let value = F::bsdf::<f64>(&self.shapes(wi)[0], &Pair::new(wi, ws));
        if value > 0.0 { value } else { 0.0 }
    }

    fn pdf(&self, w: Direction, sampled: Direction) -> f64 {
        if !Self::lit(w, sampled) {
            return 0.0;
        }
        F::pdf(&self.shapes(w)[0], in_front(w, w), in_front(w, sampled))
    }

    /// Samples the first channel's lobe, whatever its amplitude: another channel, or another part of a sum, may have
    /// something there.
    fn sample(&self, w: Direction, u: [f64; 3]) -> Option<Sample> {
        if w.cos_theta() == 0.0 {
            return None;
        }
        let direction = in_front(w, F::sample(&self.shapes(w)[0], in_front(w, w), u)?);
        let pdf = Bsdf::pdf(self, w, direction);
        let weight = self.eval_first(w, direction) * direction.cos_theta().abs() / pdf;
        (pdf > 0.0 && weight.is_finite()).then_some(Sample {
            direction,
            weight,
            pdf,
            lobe: if F::DIFFUSE { Lobe::Diffuse } else { Lobe::Glossy },
        })
    }

    fn eval_f32(&self, wi: Directions<'_, f32>, ws: Directions<'_, f32>, f: &mut [&mut [f32]]) {
        if F::SIDED {
            return eval_each(self, wi, ws, f);
        }
        lanes::eval_together::<F>(&self.parameters, wi, ws, f);
    }

    fn eval_f64(&self, wi: Directions<'_, f64>, ws: Directions<'_, f64>, f: &mut [&mut [f64]]) {
        if F::SIDED {
            return eval_each(self, wi, ws, f);
        }
        lanes::eval::<F, f64>(&self.parameters, wi, ws, f);
    }

    fn sample_f32(&self, w: Directions<'_, f32>, u: [&[f32]; 3], out: &mut SampleColumns<'_, f32>) {
        if F::SAMPLES_LANES && !F::SIDED {
            lanes::sample_together::<F>(&self.parameters, w, u, out);
        } else {
            sample_each(self, w, u, out);
        }
    }

    fn sample_f64(&self, w: Directions<'_, f64>, u: [&[f64]; 3], out: &mut SampleColumns<'_, f64>) {
        if F::SAMPLES_LANES && !F::SIDED {
            lanes::sample::<F, f64>(&self.parameters, w, u, out);
        } else {
            sample_each(self, w, u, out);
        }
    }
}
