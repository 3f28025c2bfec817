//! The sum of models.

use gonio_geom::{Component, Direction};

use crate::albedo::directional_albedo;
use crate::{Bsdf, BsdfError, Channel, Lobe, Properties, Sample};

/// Adds models that answer for the same channels, as plastic adds a diffuse part and a gloss lobe.
pub struct Sum {
    parts: Vec<Box<dyn Bsdf>>,
    /// Cumulative probability of drawing from each part.
    cumulative: Vec<f64>,
    properties: Properties,
}

/// Polar angles of incidence, degrees, at which the albedo of a sum is checked.
const CHECKED: [f64; 8] = [0.0, 20.0, 40.0, 60.0, 70.0, 80.0, 85.0, 89.0];

impl Sum {
    /// The sum of `parts`: at least one, all with the same channels in the same order. A sum of parts that conserve
    /// energy can still exceed 1; it is called energy conserving when its albedo, by quadrature at eight incidences
    /// up to 89 degrees (of four azimuths if it is anisotropic) on both sides, does not.
    pub fn new(parts: Vec<Box<dyn Bsdf>>) -> Result<Self, BsdfError> {
        let Some(first) = parts.first() else {
            return Err(BsdfError::Domain {
                field: "parts",
                found: "none".into(),
                allowed: "at least one model".into(),
            });
        };
        if let Some(other) = parts.iter().find(|p| p.channels() != first.channels()) {
            return Err(BsdfError::Domain {
                field: "parts",
                found: format!("channels {}", names(other.channels())),
                allowed: format!("channels {} in every part", names(first.channels())),
            });
        }
        // Parts are drawn by their albedo at 30 degrees, none less often than one time in fifty.
        let wi = Direction::from_degrees(30.0, 0.0);
        let albedo: Vec<f64> = parts
            .iter()
            .map(|p| {
                [Component::Reflection, Component::Transmission]
                    .map(|c| directional_albedo(p.as_ref(), wi, c, 0))
                    .iter()
                    .sum()
            })
            .collect();
        let total: f64 = albedo.iter().sum();
        let share: Vec<f64> = if total > 0.0 {
            albedo.iter().map(|a| (a / total).max(0.02)).collect()
        } else {
            vec![1.0; parts.len()]
        };
        let norm: f64 = share.iter().sum();
        let mut sum = 0.0;
        let cumulative = share
            .iter()
            .map(|s| {
                sum += s / norm;
                sum
            })
            .collect();
        let all = |of: fn(&Properties) -> bool| parts.iter().all(|p| of(&p.properties()));
        let mut model = Sum {
            properties: Properties {
                reciprocal: all(|p| p.reciprocal),
                energy_conserving: all(|p| p.energy_conserving),
                isotropic: all(|p| p.isotropic),
            },
            cumulative,
            parts,
        };
        if model.parts.len() > 1 && model.properties.energy_conserving {
            model.properties.energy_conserving = model.albedo_stays_below_one();
        }
        Ok(model)
    }

    /// The parts in order.
    pub fn parts(&self) -> &[Box<dyn Bsdf>] {
        &self.parts
    }

    fn albedo_stays_below_one(&self) -> bool {
        let azimuths: &[f64] = if self.properties.isotropic {
            &[0.0]
        } else {
            &[0.0, 45.0, 90.0, 135.0]
        };
        CHECKED.iter().flat_map(|&t| [t, 180.0 - t]).all(|theta| {
            azimuths.iter().all(|&phi| {
                let wi = Direction::from_degrees(theta, phi);
                (0..self.channels().len()).all(|channel| {
                    let albedo: f64 = [Component::Reflection, Component::Transmission]
                        .map(|c| directional_albedo(self, wi, c, channel))
                        .iter()
                        .sum();
                    albedo <= 1.0 + 1e-6
                })
            })
        })
    }

    fn probability(&self, k: usize) -> f64 {
        self.cumulative[k] - if k > 0 { self.cumulative[k - 1] } else { 0.0 }
    }
}

fn names(channels: &[Channel]) -> String {
    channels
        .iter()
        .map(Channel::to_string)
        .collect::<Vec<_>>()
        .join(", ")
}

impl Bsdf for Sum {
    fn channels(&self) -> &[Channel] {
        self.parts[0].channels()
    }

    fn properties(&self) -> Properties {
        self.properties
    }

    fn eval(&self, wi: Direction, ws: Direction, f: &mut [f64]) {
        f.fill(0.0);
        let mut small = [0.0; 4];
        let mut large = Vec::new();
        let term: &mut [f64] = if f.len() <= small.len() {
            &mut small[..f.len()]
        } else {
            large.resize(f.len(), 0.0);
            &mut large
        };
        for part in &self.parts {
            part.eval(wi, ws, term);
            f.iter_mut().zip(term.iter()).for_each(|(f, t)| *f += t);
        }
    }

    fn pdf(&self, w: Direction, sampled: Direction) -> f64 {
        (0..self.parts.len())
            .map(|k| self.probability(k) * self.parts[k].pdf(w, sampled))
            .sum()
    }

    /// Draws one part, then a direction from it; the density is that of the mixture, so the weight holds for the sum.
    fn sample(&self, w: Direction, u: [f64; 3]) -> Option<Sample> {
        let k = self
            .cumulative
            .partition_point(|&c| c <= u[2])
            .min(self.parts.len() - 1);
        let p = self.probability(k);
        let rest = ((u[2] - (self.cumulative[k] - p)) / p).clamp(0.0, 1.0 - f64::EPSILON);
        let drawn = self.parts[k].sample(w, [u[0], u[1], rest])?;
        if drawn.lobe == Lobe::Delta {
            return Some(Sample {
                weight: drawn.weight / p,
                ..drawn
            });
        }
        let pdf = Bsdf::pdf(self, w, drawn.direction);
        let weight = self.eval_first(w, drawn.direction) * drawn.direction.cos_theta().abs() / pdf;
        (pdf > 0.0 && weight > 0.0).then_some(Sample { weight, pdf, ..drawn })
    }
}
