//! Exact sampling of a model of trees: a cell by its share of the albedo, then a point even in projected solid angle.

use gonio_geom::{Component, DVec3, Direction, Side};

use super::column::{Drawn, Held};
use super::mapping::{disk, isotropic_incidence, mirror_azimuth, square};
use super::ring::{Piece, Ring};
use super::{Rank, Source, TensorTree};
use crate::{Lobe, Sample};

const COMPONENTS: [Component; 2] = [Component::Reflection, Component::Transmission];

/// The components there are for light from one side.
pub(crate) struct Sampler<'a> {
    parts: [Option<Source<'a>>; 2],
    side: Side,
}

/// What there is to draw from for one direction, of one component.
enum Across<'a> {
    Column(Held<'a>),
    Ring(Ring<'a>),
}

/// A cell that was drawn.
#[derive(Clone, Copy)]
pub(crate) enum Found {
    Cell(Drawn),
    Piece(Piece),
}

impl Across<'_> {
    #[inline(always)]
    fn albedo(&self) -> f64 {
        match self {
            Across::Column(c) => c.albedo,
            Across::Ring(r) => r.albedo,
        }
    }

    #[inline(always)]
    fn draw(&self, share: f64) -> Option<Found> {
        match self {
            Across::Column(c) => c.draw(share).map(Found::Cell),
            Across::Ring(r) => r.draw(share).map(Found::Piece),
        }
    }
}

/// Coordinates of the direction `w` that is known, in the columns of `source`.
#[inline(always)]
fn fixed_coordinates(source: Source<'_>, w: [f64; 3]) -> [f64; 2] {
    match (source.tree.rank(), source.reversed) {
        (Rank::Three, _) => [isotropic_incidence(w[0], w[1]), 0.0],
        (Rank::Four, false) => square(-w[0], -w[1]).into(),
        (Rank::Four, true) => square(w[0], w[1]).into(),
    }
}

/// What there is to draw from of `source` for light from `w`.
fn across(source: Source<'_>, w: [f64; 3]) -> Across<'_> {
    if source.reversed && source.tree.rank() == Rank::Three {
        return Across::Ring(source.rings().get(source.tree, w[0].hypot(w[1])));
    }
    Across::Column(source.columns().get(source.tree, fixed_coordinates(source, w)))
}

/// `integral f cos` of one component for light from `w`.
pub(crate) fn albedo(source: Source<'_>, w: [f64; 3]) -> f64 {
    across(source, w).albedo()
}

/// What was drawn: the direction, its density, and the albedo, which is the weight.
pub(crate) struct Point {
    pub(crate) direction: [f64; 3],
    pub(crate) pdf: f64,
    pub(crate) weight: f64,
}

impl<'a> Sampler<'a> {
    pub(crate) fn new(model: &'a TensorTree, side: Side) -> Self {
        Sampler {
            parts: COMPONENTS.map(|c| model.source(side, c)),
            side,
        }
    }

    /// Albedo of reflection and transmission together.
    pub(crate) fn albedo(&self, w: [f64; 3]) -> f64 {
        self.parts.iter().flatten().map(|s| albedo(*s, w)).sum()
    }

    /// Whether no component is a tree of rank 3 in reverse: then [`Sampler::column_cell`] and [`Sampler::column_point`] do, which
    /// are faster.
    pub(crate) fn only_columns(&self) -> bool {
        let ring = |s: &Source<'_>| s.reversed && s.tree.rank() == Rank::Three;
        !self.parts.iter().flatten().any(ring)
    }

    /// The cell drawn with `u` in `[0, 1)`, of columns: its component, the cell and the albedo of both.
    #[inline(always)]
    pub(crate) fn column_cell(&self, w: [f64; 3], u: f64) -> Option<(usize, Drawn, f64)> {
        let column = |k: usize| self.parts[k].map(|s| s.columns().get(s.tree, fixed_coordinates(s, w)));
        let columns = [column(0), column(1)];
        let albedo = |k: usize| columns[k].as_ref().map_or(0.0, |c| c.albedo);
        let (first, total) = (albedo(0), albedo(0) + albedo(1));
        let target = u * total;
        let which = usize::from(target >= first);
        let column = columns[which].as_ref()?;
        let share = (target - which as f64 * first) / column.albedo;
        Some((which, column.draw(share)?, total))
    }

    /// The cell drawn with `u` in `[0, 1)`: its component, the cell and the albedo of both.
    pub(crate) fn cell(&self, w: [f64; 3], u: f64) -> Option<(usize, Found, f64)> {
        let parts = self.parts.map(|s| s.map(|s| across(s, w)));
        let albedo = |k: usize| parts[k].as_ref().map_or(0.0, Across::albedo);
        let (first, total) = (albedo(0), albedo(0) + albedo(1));
        let target = u * total;
        let which = usize::from(target >= first);
        let part = parts[which].as_ref()?;
        let share = (target - which as f64 * first) / part.albedo();
        Some((which, part.draw(share)?, total))
    }

    /// The direction at point `(a, b)` of a cell that [`Sampler::cell`] gave for `w`.
    pub(crate) fn point(&self, w: [f64; 3], (which, cell, total): (usize, Found, f64), u: [f64; 2]) -> Point {
        match cell {
            Found::Cell(cell) => self.column_point(w, (which, cell, total), u),
            Found::Piece(piece) => {
                let at = self.parts[which].map_or([0.0; 2], |s| {
                    let ring = s.rings().get(s.tree, w[0].hypot(w[1]));
                    ring.point(&piece, u, [w[0], w[1]])
                });
                self.found(at, piece.value, which, total)
            }
        }
    }

    /// The same for a cell of [`Sampler::column_cell`].
    #[inline(always)]
    pub(crate) fn column_point(
        &self,
        w: [f64; 3],
        (which, cell, total): (usize, Drawn, f64),
        u: [f64; 2],
    ) -> Point {
        let (a, b) = cell.point(u[0], u[1]);
        let (x, y) = disk(a, b);
        let at = match &self.parts[which] {
            Some(s) if s.tree.rank() == Rank::Three => {
                let (c, s) = mirror_azimuth(w[0], w[1]);
                [c * x - s * y, c * y + s * x]
            }
            Some(s) if s.reversed => [-x, -y],
            _ => [x, y],
        };
        self.found(at, cell.value, which, total)
    }

    #[inline(always)]
    fn found(&self, [x, y]: [f64; 2], value: f32, which: usize, total: f64) -> Point {
        let z = (1.0 - x * x - y * y).max(0.0).sqrt();
        let sign = COMPONENTS[which].scattered_side(self.side).sign();
        Point {
            direction: [x, y, sign * z],
            pdf: f64::from(value) * z / total,
            weight: total,
        }
    }
}

/// Density of the exact sampler.
pub(crate) fn pdf(model: &TensorTree, w: Direction, sampled: Direction) -> f64 {
    let total = Sampler::new(model, w.side()).albedo(w.vec().to_array());
    if total <= 0.0 {
        return 0.0;
    }
    model.value(w.vec().to_array(), sampled.vec().to_array()) * sampled.cos_theta().abs() / total
}

/// One sample; `u[2]` draws the cell.
pub(crate) fn sample(model: &TensorTree, w: Direction, u: [f64; 3]) -> Option<Sample> {
    let sampler = Sampler::new(model, w.side());
    let w = w.vec().to_array();
    let point = sampler.point(w, sampler.cell(w, u[2])?, [u[0], u[1]]);
    let direction = Direction::new(DVec3::from_array(point.direction))?;
    (point.pdf > 0.0).then_some(Sample {
        direction,
        weight: point.weight,
        pdf: point.pdf,
        lobe: Lobe::Glossy,
    })
}
