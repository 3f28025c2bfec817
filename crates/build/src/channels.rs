//! Models of single channels as one model of them all.

use std::sync::Arc;

use gonio_bsdf::{Bsdf, BsdfError, Channel, Lobe, Properties, Sample};
use gonio_geom::{Component, Direction};

/// Several models side by side, each for its own channels, as a measurement of three colours gives three data-driven models.
///
/// Samples are drawn from each of them as often. Ideal parts are those of the models; where two have different directions
/// that of the last counts, which no measurement gives.
pub struct SideBySide {
    models: Vec<Arc<dyn Bsdf>>,
    channels: Vec<Channel>,
}

impl SideBySide {
    /// The channels of all `models`, in their order.
    ///
    /// # Errors
    /// [`BsdfError::Domain`] for no model and for a channel that two of them have.
    pub fn new(models: Vec<Arc<dyn Bsdf>>) -> Result<Self, BsdfError> {
        let mut channels: Vec<Channel> = Vec::new();
        let domain = |found: String, allowed: &str| BsdfError::Domain {
            field: "models",
            found,
            allowed: allowed.into(),
        };
        for channel in models.iter().flat_map(|m| m.channels()) {
            if channels.contains(channel) {
                return Err(domain(format!("channel {channel} twice"), "each channel once"));
            }
            channels.push(*channel);
        }
        if channels.is_empty() {
            return Err(domain("none".into(), "at least one"));
        }
        Ok(SideBySide { models, channels })
    }
}

impl Bsdf for SideBySide {
    fn channels(&self) -> &[Channel] {
        &self.channels
    }

    /// What all of them promise.
    fn properties(&self) -> Properties {
        let all = |of: fn(&Properties) -> bool| self.models.iter().all(|m| of(&m.properties()));
        Properties {
            reciprocal: all(|p| p.reciprocal),
            energy_conserving: all(|p| p.energy_conserving),
            isotropic: all(|p| p.isotropic),
        }
    }

    fn eval(&self, wi: Direction, ws: Direction, f: &mut [f64]) {
        let mut rest = f;
        for model in &self.models {
            let (own, others) = rest.split_at_mut(model.channels().len());
            match own {
                [one] => *one = model.eval_first(wi, ws),
                many => model.eval(wi, ws, many),
            }
            rest = others;
        }
    }

    fn delta(&self, w: Direction, component: Component, shares: &mut [f64]) -> Option<Direction> {
        let mut rest = shares;
        let mut direction = None;
        for model in &self.models {
            let (own, others) = rest.split_at_mut(model.channels().len());
            direction = model.delta(w, component, own).or(direction);
            rest = others;
        }
        direction
    }

    fn holds(&self, wi: Direction, ideal: Direction, ws: Direction) -> bool {
        self.models.iter().any(|m| m.holds(wi, ideal, ws))
    }

    fn pdf(&self, w: Direction, sampled: Direction) -> f64 {
        let sum: f64 = self.models.iter().map(|m| m.pdf(w, sampled)).sum();
        sum / self.models.len() as f64
    }

    /// Drawn from each of them as often.
    fn sample(&self, w: Direction, u: [f64; 3]) -> Option<Sample> {
        let n = self.models.len() as f64;
        let k = ((u[2] * n) as usize).min(self.models.len() - 1);
        let rest = (u[2] * n - k as f64).min(1.0 - f64::EPSILON);
        let drawn = self.models[k].sample(w, [u[0], u[1], rest])?;
        if drawn.lobe == Lobe::Delta {
            // the weight is that of the first channel, for which the first model alone draws
            let weight = if k == 0 { drawn.weight * n } else { 0.0 };
            let pdf = drawn.pdf / n;
            return Some(Sample { weight, pdf, ..drawn });
        }
        let pdf = Bsdf::pdf(self, w, drawn.direction);
        let weight = self.eval_first(w, drawn.direction) * drawn.direction.cos_theta().abs() / pdf;
        (pdf > 0.0 && weight.is_finite()).then_some(Sample { weight, pdf, ..drawn })
    }

    /// Whether all of them rest on data.
    fn has_data(&self, wi: Direction, ws: Direction) -> bool {
        self.models.iter().all(|m| m.has_data(wi, ws))
    }
}

#[cfg(test)]
mod tests {
    use gonio_bsdf::analytic::family;

    use super::*;

    fn model(channels: &[(Channel, f64)]) -> Arc<dyn Bsdf> {
        let parameters: Vec<_> = channels.iter().map(|(c, rho)| (*c, vec![*rho])).collect();
        Arc::from(family("lambert").unwrap().model(&parameters).unwrap())
    }

    #[test]
    fn each_channel_answers_as_its_own_model_does() {
        let (red, others) = (
            model(&[(Channel::Red, 0.9)]),
            model(&[(Channel::Green, 0.5), (Channel::Blue, 0.1)]),
        );
        let all = SideBySide::new(vec![red, others]).unwrap();
        assert_eq!(all.channels(), [Channel::Red, Channel::Green, Channel::Blue]);
        let (wi, ws) = (
            Direction::from_degrees(20.0, 0.0),
            Direction::from_degrees(50.0, 90.0),
        );
        let mut f = [0.0; 3];
        all.eval(wi, ws, &mut f);
        for (f, rho) in f.iter().zip([0.9, 0.5, 0.1]) {
            assert!((f * std::f64::consts::PI - rho).abs() < 1e-12);
        }
        assert!(all.properties().isotropic && all.has_data(wi, ws));
        assert!(SideBySide::new(vec![model(&[(Channel::Red, 0.1)]), model(&[(Channel::Red, 0.2)])]).is_err());
        assert!(SideBySide::new(Vec::new()).is_err());
    }
}
