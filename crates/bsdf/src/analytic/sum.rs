//! The sum of models.

use std::sync::OnceLock;

use gonio_geom::{Component, Direction};

use crate::albedo::directional_albedo;
use crate::batch::{Directions, Number};

use crate::{Bsdf, BsdfError, Channel, Lobe, Properties, Sample};

/// Adds models that answer for the same channels, as plastic adds a diffuse part and a gloss lobe.
pub struct Sum {
    parts: Vec<Box<dyn Bsdf>>,
    /// Cumulative probability of drawing from each part; from the albedos when the first sample is drawn, unless given.
    cumulative: OnceLock<Vec<f64>>,
    /// Whether the sum conserves energy; from the albedos when first asked, unless known.
    energy_conserving: OnceLock<bool>,
}

/// Pairs that the parts are evaluated at together.
const STRETCH: usize = 1024;

/// Polar angles of incidence, degrees, at which the albedo of a sum is checked.
const CHECKED: [f64; 8] = [0.0, 20.0, 40.0, 60.0, 70.0, 80.0, 85.0, 89.0];

impl Sum {
    /// The sum of `parts`: at least one, all with the same channels in the same order. A sum of parts that conserve
    /// energy can still exceed 1; it is called energy conserving when its albedo, by quadrature at eight incidences
    /// up to 89 degrees (of four azimuths if it is anisotropic) on both sides, does not.
    ///
    /// The quadratures behind [`Bsdf::properties`] and behind the first sample or density wait until those are asked
    /// for: a sum that is only evaluated is made at once.
    ///
    /// # Errors
    /// [`BsdfError::Domain`] for no part, parts with different channels, and ideal parts that take different directions.
    pub fn new(parts: Vec<Box<dyn Bsdf>>) -> Result<Self, BsdfError> {
        compatible(&parts)?;
        Ok(Sum {
            parts,
            cumulative: OnceLock::new(),
            energy_conserving: OnceLock::new(),
        })
    }

    /// The sum of `parts`, each drawn in proportion to the weight beside it (at least one time in fifty), for a caller
    /// who knows whether the sum conserves energy.
    ///
    /// # Errors
    /// As [`Sum::new`].
    pub fn weighted(parts: Vec<(Box<dyn Bsdf>, f64)>, energy_conserving: bool) -> Result<Self, BsdfError> {
        let (parts, weights): (Vec<_>, Vec<_>) = parts.into_iter().unzip();
        compatible(&parts)?;
        Ok(Sum {
            parts,
            cumulative: cumulative(&weights).into(),
            energy_conserving: energy_conserving.into(),
        })
    }

    /// Parts are drawn by their albedo at 30 degrees in all channels, none less often than one time in fifty.
    fn cumulative(&self) -> &[f64] {
        self.cumulative.get_or_init(|| {
            let wi = Direction::from_degrees(30.0, 0.0);
            let albedo = |part: &dyn Bsdf| -> f64 {
                (0..part.channels().len())
                    .flat_map(|channel| {
                        [Component::Reflection, Component::Transmission]
                            .map(|c| directional_albedo(part, wi, c, channel))
                    })
                    .sum()
            };
            let weights: Vec<f64> = self.parts.iter().map(|p| albedo(p.as_ref())).collect();
            cumulative(&weights)
        })
    }

    fn all(&self, of: fn(&Properties) -> bool) -> bool {
        self.parts.iter().all(|p| of(&p.properties()))
    }

    /// The parts in order.
    pub fn parts(&self) -> &[Box<dyn Bsdf>] {
        &self.parts
    }

    fn albedo_stays_below_one(&self) -> bool {
        let azimuths: &[f64] = if self.all(|p| p.isotropic) {
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

    /// Every part in turn over stretches of pairs that stay in the cache.
    fn eval_batch<T: Number>(&self, wi: Directions<'_, T>, ws: Directions<'_, T>, f: &mut [&mut [T]]) {
        let n = f.first().map_or(0, |row| row.len());
        let mut term = vec![T::default(); STRETCH.min(n) * f.len()];
        for start in (0..n).step_by(STRETCH) {
            let range = start..(start + STRETCH).min(n);
            let (wi, ws) = (wi.range(range.clone()), ws.range(range.clone()));
            let mut rows: Vec<&mut [T]> = f.iter_mut().map(|row| &mut row[range.clone()]).collect();
            for (k, part) in self.parts.iter().enumerate() {
                if k == 0 {
                    T::eval(part.as_ref(), wi, ws, &mut rows);
                    continue;
                }
                let mut terms: Vec<&mut [T]> = term.chunks_mut(range.len()).take(rows.len()).collect();
                T::eval(part.as_ref(), wi, ws, &mut terms);
                for (row, term) in rows.iter_mut().zip(&terms) {
                    for (f, t) in row.iter_mut().zip(term.iter()) {
                        *f = T::of(f.fast() + t.fast());
                    }
                }
            }
        }
    }

    fn probability(&self, k: usize) -> f64 {
        let cumulative = self.cumulative();
        cumulative[k] - if k > 0 { cumulative[k - 1] } else { 0.0 }
    }
}

/// Cumulative probabilities in proportion to `weights`, each at least one in fifty.
fn cumulative(weights: &[f64]) -> Vec<f64> {
    let total: f64 = weights.iter().sum();
    let share: Vec<f64> = if total > 0.0 {
        weights.iter().map(|w| (w / total).max(0.02)).collect()
    } else {
        vec![1.0; weights.len()]
    };
    let norm: f64 = share.iter().sum();
    let mut sum = 0.0;
    share
        .iter()
        .map(|s| {
            sum += s / norm;
            sum
        })
        .collect()
}

/// At least one part, all for the same channels, ideal parts of one component in one direction.
fn compatible(parts: &[Box<dyn Bsdf>]) -> Result<(), BsdfError> {
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
    if let Some(found) = bent_apart(parts) {
        return Err(BsdfError::Domain {
            field: "parts",
            found,
            allowed: "ideal parts of one component that take one direction".into(),
        });
    }
    Ok(())
}

/// Two parts whose ideal directions differ, in words.
fn bent_apart(parts: &[Box<dyn Bsdf>]) -> Option<String> {
    let mut shares = vec![0.0; parts[0].channels().len()];
    for theta in [30.0, 150.0] {
        for component in [Component::Reflection, Component::Transmission] {
            let mut known: Option<Direction> = None;
            for part in parts {
                let Some(d) = part.delta(Direction::from_degrees(theta, 0.0), component, &mut shares) else {
                    continue;
                };
                let other = *known.get_or_insert(d);
                if other.angle_to(d) > 1e-9 {
                    return Some(format!(
                        "{component} to {:.3} and {:.3} degrees from an incidence at {theta}",
                        other.theta().to_degrees(),
                        d.theta().to_degrees()
                    ));
                }
            }
        }
    }
    None
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
        let energy_conserving = *self.energy_conserving.get_or_init(|| {
            self.all(|p| p.energy_conserving) && (self.parts.len() == 1 || self.albedo_stays_below_one())
        });
        Properties {
            reciprocal: self.all(|p| p.reciprocal),
            energy_conserving,
            isotropic: self.all(|p| p.isotropic),
        }
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

    fn delta(&self, w: Direction, component: Component, shares: &mut [f64]) -> Option<Direction> {
        shares.fill(0.0);
        let mut term = vec![0.0; shares.len()];
        let mut direction = None;
        for part in &self.parts {
            if let Some(d) = part.delta(w, component, &mut term) {
                direction = Some(d);
                shares.iter_mut().zip(&term).for_each(|(s, t)| *s += t);
            }
        }
        direction
    }

    fn pdf(&self, w: Direction, sampled: Direction) -> f64 {
        (0..self.parts.len())
            .map(|k| self.probability(k) * self.parts[k].pdf(w, sampled))
            .sum()
    }

    /// Draws one part, then a direction from it; the density is that of the mixture, so the weight holds for the sum.
    fn sample(&self, w: Direction, u: [f64; 3]) -> Option<Sample> {
        let cumulative = self.cumulative();
        let k = cumulative
            .partition_point(|&c| c <= u[2])
            .min(self.parts.len() - 1);
        let p = self.probability(k);
        let rest = ((u[2] - (cumulative[k] - p)) / p).clamp(0.0, 1.0 - f64::EPSILON);
        let drawn = self.parts[k].sample(w, [u[0], u[1], rest])?;
        if drawn.lobe == Lobe::Delta {
            return Some(Sample {
                weight: drawn.weight / p,
                pdf: drawn.pdf * p,
                ..drawn
            });
        }
        let pdf = Bsdf::pdf(self, w, drawn.direction);
        let weight = self.eval_first(w, drawn.direction) * drawn.direction.cos_theta().abs() / pdf;
        (pdf > 0.0 && weight.is_finite()).then_some(Sample { weight, pdf, ..drawn })
    }

    fn eval_f32(&self, wi: Directions<'_, f32>, ws: Directions<'_, f32>, f: &mut [&mut [f32]]) {
        self.eval_batch(wi, ws, f);
    }

    fn eval_f64(&self, wi: Directions<'_, f64>, ws: Directions<'_, f64>, f: &mut [&mut [f64]]) {
        self.eval_batch(wi, ws, f);
    }
}
