//! The parametric base of a data-driven model: an analytic sum fitted to the slices, which the readings are divided by
//! so that what is left to interpolate is smooth and close to 1.

mod diffuse;
mod divisor;
mod drawing;
mod fitting;
mod recipes;
mod search;
mod zernike;

use std::fmt;

use gonio_bsdf::Bsdf;
use gonio_bsdf::analytic::{Family, Pairs};
use gonio_geom::{Component, DVec3, Direction};

pub(crate) use divisor::Divisor;
pub(crate) use fitting::{Fitting, Picked};
pub(crate) use recipes::Recipe;
pub(crate) use search::{bases, orders};
pub(crate) use zernike::Expansion;

/// How a part of a base moves with the incidence.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Moves {
    /// It stays: diffuse parts.
    Not,
    /// With the mirror (through) direction.
    Mirror,
    /// With the direction of incidence.
    Retro,
}

/// One fitted model of a base.
struct Fitted {
    model: Box<dyn Bsdf>,
    family: &'static dyn Family,
    values: Vec<f64>,
    moves: Moves,
}

/// An analytic sum in the local frame, 1/sr, positive everywhere.
pub(crate) struct Base {
    /// Its parts joined by `+`.
    pub(crate) name: String,
    parts: Vec<Fitted>,
    /// Probability with which a direction is drawn from each part.
    probabilities: Vec<f64>,
    component: Component,
    /// What the parts are multiplied with.
    scale: f64,
    /// Added to the parts that stay, so that ratios to the base stay finite.
    floor: f64,
    /// In place of parts: a matte sample.
    expansion: Option<Expansion>,
}

impl fmt::Debug for Base {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Base")
            .field("name", &self.name)
            .finish_non_exhaustive()
    }
}

impl Base {
    /// BSDF for local directions on the upper hemisphere.
    #[inline]
    pub(crate) fn eval(&self, i: DVec3, s: DVec3) -> f64 {
        match &self.expansion {
            Some(expansion) => expansion.eval(i, s),
            None => self.sum(i, s, |_| true) + self.floor,
        }
    }

    /// Whether it is an expansion, which holds between measured incidences only.
    pub(crate) fn is_expansion(&self) -> bool {
        self.expansion.is_some()
    }

    /// The parts that move as `moves`, together.
    #[inline]
    pub(crate) fn eval_moving(&self, moves: Moves, i: DVec3, s: DVec3) -> f64 {
        let sum = self.sum(i, s, |m| m == moves);
        if moves == Moves::Not {
            sum + self.floor
        } else {
            sum
        }
    }

    #[inline]
    fn sum(&self, i: DVec3, s: DVec3, of: impl Fn(Moves) -> bool) -> f64 {
        let wi = Direction::from_unit(raised(i));
        let ws = self.scattered(s);
        let parts = self.parts.iter().filter(|p| of(p.moves));
        self.scale * parts.map(|p| p.model.eval_first(wi, ws)).sum::<f64>()
    }

    /// [`Base::eval`] of one incidence and many directions, faster.
    pub(crate) fn eval_all(&self, i: DVec3, directions: impl ExactSizeIterator<Item = DVec3>) -> Vec<f64> {
        if let Some(expansion) = &self.expansion {
            return directions.map(|s| expansion.eval(i, s)).collect();
        }
        let n = directions.len();
        let mut pairs = Pairs::with_capacity(Direction::from_unit(raised(i)), n);
        for s in directions {
            pairs.push(self.scattered(s));
        }
        let (mut sum, mut dsf) = (vec![0.0; n], vec![0.0; n]);
        for part in &self.parts {
            part.family.dsf(&part.values, pairs.view(0..n), &mut dsf);
            sum.iter_mut().zip(&dsf).for_each(|(sum, d)| *sum += d);
        }
        let view = pairs.view(0..n);
        let cosines = view.scattered()[2];
        sum.iter()
            .zip(cosines)
            .map(|(d, z)| self.scale * d / z.abs() + self.floor)
            .collect()
    }

    /// A local direction of scattering as the models take it.
    #[inline]
    fn scattered(&self, s: DVec3) -> Direction {
        let s = raised(s);
        match self.component {
            Component::Reflection => Direction::from_unit(s),
            Component::Transmission => Direction::from_unit(DVec3::new(s.x, s.y, -s.z)),
        }
    }

    /// The parameters of all parts, one after the other, as [`Fitting::fit`] takes them to begin with.
    pub(crate) fn values(&self) -> Vec<f64> {
        self.parts.iter().flat_map(|p| p.values.iter().copied()).collect()
    }

    /// Whether some part moves as `moves`.
    pub(crate) fn has(&self, moves: Moves) -> bool {
        self.parts.iter().any(|p| p.moves == moves)
    }
}

/// Formulas end at the horizon, slices a little before it: the direction raised to where both hold.
#[inline]
fn raised(v: DVec3) -> DVec3 {
    const LEAST: f64 = 1e-3;
    if v.z >= LEAST {
        v
    } else {
        DVec3::new(v.x, v.y, LEAST).normalize()
    }
}
