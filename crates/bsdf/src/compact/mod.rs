//! gonio's compact model: a sum of analytic lobes times a table of ratios.
//!
//! `f = b(wi, ws) exp(q)`, `b` a sum of models of the registry, `q` interpolated linearly between quantised nodes in the
//! coordinates of a [`Frame`], in which peaks about the mirror (unbent) direction stay resolved at every incidence. Samples
//! are drawn from `b`, whose mixture density they have exactly; their weight is bounded, as the ratio is. Light that leaves
//! without spreading is kept apart, as shares over the incidence.

mod batch;
mod coding;
mod dense;
mod frame;
mod ideal;
mod range_coder;
mod symmetry;
mod table;
#[cfg(test)]
mod tests;

use gonio_geom::{Component, Direction, Side};

use crate::analytic::{Parametric, Scatters, Sum, lobe_named};
use crate::batch::{Directions, SampleColumns, eval_each, sample_each};
use crate::{Bsdf, BsdfError, Channel, FourComponents, Lobe, Properties, Sample};

use dense::Dense;
pub use frame::Frame;
pub use ideal::IdealPart;
pub use symmetry::Symmetry;
pub use table::{Coded, LARGEST, Quantised};

/// One lobe of a base.
#[derive(Clone, Debug, PartialEq)]
pub struct BaseLobe {
    /// Name of an analytic model ([`lobe_named`]) that scatters into the part's component alone.
    pub model: String,
    /// Its parameters, one list a channel.
    pub parameters: Vec<Vec<f64>>,
    /// How often it is drawn from, relative to the other lobes of the side; positive.
    pub weight: f64,
}

/// One component of a compact model, as it is stored.
#[derive(Clone, Debug, PartialEq)]
pub struct CompactPart {
    /// The lobes whose sum is multiplied.
    pub base: Vec<BaseLobe>,
    /// Coordinates and nodes of the table.
    pub frame: Frame,
    /// The logarithms of the ratios.
    pub table: Quantised,
}

impl CompactPart {
    /// Bytes of the table for one channel as stored, those of the largest: codes, offsets and steps, and what tells where its
    /// nodes are (numbers, widths, azimuth).
    pub fn bytes_per_channel(&self) -> usize {
        let coded = self.table.coded(&self.frame);
        FRAME_BYTES + coded.iter().map(Coded::len).max().unwrap_or(0)
    }
}

/// A part made ready.
struct Part {
    side: Side,
    component: Component,
    base: Sum,
    frame: Frame,
    dense: Dense,
    /// Probability of drawing from it for light on its side.
    probability: f64,
}

/// A compact model; see docs/models/compact.md.
pub struct Compact {
    channels: Vec<Channel>,
    energy_conserving: bool,
    stored: FourComponents<CompactPart>,
    ideal: FourComponents<IdealPart>,
    parts: Vec<Part>,
    /// What the lobes of the front and of the back stand for together, the unit of their weights.
    lit: [f64; 2],
}

/// Four numbers of nodes, two widths and an azimuth.
pub const FRAME_BYTES: usize = 4 * 4 + 3 * 8;
/// Least probability of drawing lobes beside an ideal part, and an ideal part beside lobes.
const LEAST_CHANCE: f64 = 0.02;

/// Pairs whose base is evaluated at once.
const STRETCH: usize = 1024;

impl Compact {
    /// The model of `parts`. `energy_conserving` is what [`Bsdf::properties`] answers.
    ///
    /// # Errors
    /// [`BsdfError::Domain`] for no channel, no part, a frame or table out of its range, and a base without a lobe, with one
    /// that is unknown, of another component, without positive weight or with parameters out of range.
    pub fn new(
        channels: Vec<Channel>,
        parts: FourComponents<CompactPart>,
        energy_conserving: bool,
    ) -> Result<Self, BsdfError> {
        Self::with_ideal(channels, parts, FourComponents::default(), energy_conserving)
    }

    /// The model of `parts` and of light that is mirrored or passes straight through. A component may have either or both.
    ///
    /// # Errors
    /// As [`Compact::new`], and for shares that are not as many as the nodes or outside 0 to 1.
    pub fn with_ideal(
        channels: Vec<Channel>,
        parts: FourComponents<CompactPart>,
        ideal: FourComponents<IdealPart>,
        energy_conserving: bool,
    ) -> Result<Self, BsdfError> {
        let components = parts.len() + ideal.len();
        if channels.is_empty() || components == 0 {
            let found = format!("{} channels, {components} components", channels.len());
            return Err(domain("parts", found, "at least one channel and component"));
        }
        for (.., part) in ideal.iter() {
            part.check(channels.len())?;
        }
        let mut ready = Vec::new();
        let mut lit = [0.0; 2];
        for (side, component, part) in parts.iter() {
            part.frame.check()?;
            part.table.check(&part.frame, channels.len())?;
            let of_side = |p: &CompactPart| p.base.iter().map(|l| l.weight).sum::<f64>();
            let total: f64 = parts
                .iter()
                .filter(|(s, ..)| *s == side)
                .map(|(.., p)| of_side(p))
                .sum();
            lit[usize::from(side == Side::Back)] = total;
            ready.push(Part {
                side,
                component,
                base: base(&channels, component, &part.base)?,
                frame: part.frame,
                dense: Dense::new(&part.frame, &part.table, channels.len()),
                probability: of_side(part) / total,
            });
        }
        Ok(Compact {
            channels,
            energy_conserving,
            stored: parts,
            ideal,
            parts: ready,
            lit,
        })
    }

    /// The components as they are stored.
    pub fn parts(&self) -> &FourComponents<CompactPart> {
        &self.stored
    }

    /// The shares of light that does not spread.
    pub fn ideal(&self) -> &FourComponents<IdealPart> {
        &self.ideal
    }

    /// Probability of drawing the ideal direction of either component, for light from `w`.
    fn chances(&self, w: Direction) -> [(Component, f64); 2] {
        let mut chances = [Component::Reflection, Component::Transmission].map(|c| (c, 0.0));
        if self.ideal.is_empty() || w.cos_theta() == 0.0 {
            return chances;
        }
        let mut shares = vec![0.0; self.channels.len()];
        for (component, chance) in &mut chances {
            if self.delta(w, *component, &mut shares).is_some() {
                *chance = shares.iter().sum();
            }
        }
        let ideal: f64 = chances.iter().map(|c| c.1).sum();
        if ideal > 0.0 {
            let lit = self.lit[usize::from(w.side() == Side::Back)];
            let share = if lit > 0.0 {
                (ideal / (ideal + lit)).clamp(LEAST_CHANCE, 1.0 - LEAST_CHANCE)
            } else {
                1.0
            };
            chances.iter_mut().for_each(|c| c.1 *= share / ideal);
        }
        chances
    }

    fn part(&self, w: Direction, s: Direction) -> Option<&Part> {
        if w.cos_theta() == 0.0 || s.cos_theta() == 0.0 {
            return None;
        }
        let (side, component) = (w.side(), Component::between(w.side(), s.side()));
        self.parts
            .iter()
            .find(|p| p.side == side && p.component == component)
    }
}

/// The sum of a part's lobes, drawn by their weights.
fn base(channels: &[Channel], component: Component, lobes: &[BaseLobe]) -> Result<Sum, BsdfError> {
    let mut parts = Vec::with_capacity(lobes.len());
    for lobe in lobes {
        let family: &dyn Parametric = lobe_named(&lobe.model)?;
        let only = match component {
            Component::Reflection => Scatters::Reflection,
            Component::Transmission => Scatters::Transmission,
        };
        if family.info().scatters != only {
            let allowed = format!("models of {component} alone");
            return Err(domain("base", lobe.model.clone(), allowed));
        }
        if !(lobe.weight > 0.0 && lobe.weight.is_finite()) {
            return Err(domain("weight", lobe.weight.to_string(), "positive numbers"));
        }
        if lobe.parameters.len() != channels.len() {
            let found = format!("{} of {}", lobe.parameters.len(), lobe.model);
            return Err(domain(
                "parameters",
                found,
                format!("one list a channel, {}", channels.len()),
            ));
        }
        let parameters: Vec<_> = channels
            .iter()
            .copied()
            .zip(lobe.parameters.iter().cloned())
            .collect();
        parts.push((family.model(&parameters)?, lobe.weight));
    }
    Sum::weighted(parts, true)
}

fn domain(field: &'static str, found: impl Into<String>, allowed: impl Into<String>) -> BsdfError {
    BsdfError::Domain {
        field,
        found: found.into(),
        allowed: allowed.into(),
    }
}

impl Part {
    /// Both directions above the sample plane.
    fn up(d: Direction) -> [f64; 3] {
        let v = d.vec();
        [v.x, v.y, v.z.abs()]
    }

    /// `f` of every channel.
    fn eval(&self, wi: Direction, ws: Direction, f: &mut [f64]) {
        let at = self.frame.coordinates(Self::up(wi), Self::up(ws));
        let density = self.frame.density();
        let positions = [0, 1, 2, 3].map(|k| [(at[k] * density[k]) as f32]);
        self.base.eval(wi, ws, f);
        let isotropic = self.frame.symmetry.is_isotropic();
        let places = if isotropic {
            self.dense.places::<3, 1>(&positions)
        } else {
            self.dense.places::<4, 1>(&positions)
        };
        for (group, rows) in f.chunks_mut(4).enumerate() {
            let mut logs = [[0.0]; 4];
            if isotropic {
                self.dense.interpolate::<3, 1>(group, None, &places, &mut logs);
            } else {
                self.dense.interpolate::<4, 1>(group, None, &places, &mut logs);
            }
            for (f, log) in rows.iter_mut().zip(logs) {
                let value = *f * f64::from(log[0]).exp();
                *f = if value.is_finite() { value } else { 0.0 };
            }
        }
    }
}

impl Bsdf for Compact {
    fn channels(&self) -> &[Channel] {
        &self.channels
    }

    /// Not reciprocal by construction.
    fn properties(&self) -> Properties {
        Properties {
            reciprocal: false,
            energy_conserving: self.energy_conserving,
            isotropic: self.parts.iter().all(|p| p.frame.symmetry.is_isotropic())
                && self.ideal.iter().all(|(.., p)| p.symmetry.is_isotropic()),
        }
    }

    fn eval(&self, wi: Direction, ws: Direction, f: &mut [f64]) {
        match self.part(wi, ws) {
            Some(part) => part.eval(wi, ws, f),
            None => f.fill(0.0),
        }
    }

    fn delta(&self, w: Direction, component: Component, shares: &mut [f64]) -> Option<Direction> {
        shares.fill(0.0);
        let part = self.ideal.get(w.side(), component)?;
        if w.cos_theta() == 0.0 {
            return None;
        }
        part.shares(w, shares);
        shares
            .iter()
            .any(|s| *s > 0.0)
            .then(|| ideal::straight(w, component))
    }

    fn pdf(&self, w: Direction, sampled: Direction) -> f64 {
        let scattered = 1.0 - self.chances(w).iter().map(|c| c.1).sum::<f64>();
        self.part(w, sampled).map_or(0.0, |part| {
            scattered * part.probability * part.base.pdf(w, sampled)
        })
    }

    /// Draws the ideal part or a component, a lobe of its base and a direction from it; the density is that of the mixture.
    fn sample(&self, w: Direction, u: [f64; 3]) -> Option<Sample> {
        if w.cos_theta() == 0.0 {
            return None;
        }
        let mut rest = u[2];
        let chances = self.chances(w);
        for (component, chance) in chances {
            if rest < chance {
                let mut shares = vec![0.0; self.channels.len()];
                let direction = self.delta(w, component, &mut shares)?;
                return Some(Sample {
                    direction,
                    weight: shares[0] / chance,
                    pdf: chance,
                    lobe: Lobe::Delta,
                });
            }
            rest -= chance;
        }
        let scattered = 1.0 - chances.iter().map(|c| c.1).sum::<f64>();
        rest = (rest / scattered).clamp(0.0, 1.0 - f64::EPSILON);
        let mut parts = self.parts.iter().filter(|p| p.side == w.side()).peekable();
        let part = loop {
            let part = parts.next()?;
            if rest < part.probability || parts.peek().is_none() {
                break part;
            }
            rest -= part.probability;
        };
        let rest = (rest / part.probability).clamp(0.0, 1.0 - f64::EPSILON);
        let drawn = part.base.sample(w, [u[0], u[1], rest])?;
        let pdf = Bsdf::pdf(self, w, drawn.direction);
        let weight = self.eval_first(w, drawn.direction) * drawn.direction.cos_theta().abs() / pdf;
        (pdf > 0.0 && weight.is_finite()).then_some(Sample { weight, pdf, ..drawn })
    }

    fn eval_f32(&self, wi: Directions<'_, f32>, ws: Directions<'_, f32>, f: &mut [&mut [f32]]) {
        let n = f.first().map_or(0, |row| row.len());
        assert!(
            f.len() == self.channels.len()
                && f.iter().all(|row| row.len() == n)
                && wi.serves(n)
                && ws.serves(n),
            "one row a channel and one entry a pair"
        );
        let mut base = vec![0.0_f32; STRETCH.min(n) * f.len()];
        let slabs: Vec<_> = self.parts.iter().map(|p| batch::slab(p, wi, n)).collect();
        for start in (0..n).step_by(STRETCH) {
            let range = start..(start + STRETCH).min(n);
            let (wi, ws) = (wi.range(range.clone()), ws.range(range.clone()));
            let mut rows: Vec<&mut [f32]> = f.iter_mut().map(|row| &mut row[range.clone()]).collect();
            rows.iter_mut().for_each(|row| row.fill(0.0));
            for (part, slab) in self.parts.iter().zip(&slabs) {
                if !batch::any_in(part.side, part.component, wi, ws, range.len()) {
                    continue;
                }
                let mut base: Vec<&mut [f32]> = base.chunks_mut(range.len()).take(rows.len()).collect();
                part.base.eval_f32(wi, ws, &mut base);
                batch::add(part, slab.as_ref(), wi, ws, &base, &mut rows);
            }
        }
    }

    fn eval_f64(&self, wi: Directions<'_, f64>, ws: Directions<'_, f64>, f: &mut [&mut [f64]]) {
        eval_each(self, wi, ws, f);
    }

    fn sample_f64(&self, w: Directions<'_, f64>, u: [&[f64]; 3], out: &mut SampleColumns<'_, f64>) {
        sample_each(self, w, u, out);
    }
}
