//! Exact sampling of a model of trees: a cell by its share of the albedo, then a point even in projected solid angle.

use gonio_geom::{Component, DVec3, Direction, Side};

use super::column::{Drawn, Held};
use super::mapping::{disk, isotropic_incidence, mirror_azimuth, square};
use super::{Rank, Source, TensorTree};
use crate::{Lobe, Sample};

const COMPONENTS: [Component; 2] = [Component::Reflection, Component::Transmission];

/// Whether the exact sampler applies for light from `side`.
pub(crate) fn applies(model: &TensorTree, side: Side) -> bool {
    COMPONENTS.iter().all(|c| {
        model
            .source(side, *c)
            .is_none_or(|s| !(s.reversed && s.tree.rank() == Rank::Three))
    })
}

/// The components there are for light from one side; the exact sampler must apply.
pub(crate) struct Sampler<'a> {
    parts: [Option<Source<'a>>; 2],
    side: Side,
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

    /// The columns of both components for light from `w`.
    #[inline(always)]
    fn columns(&self, w: [f64; 3]) -> [Option<(Rank, Held<'a>)>; 2] {
        let mut out = [None, None];
        for (slot, source) in out.iter_mut().zip(&self.parts) {
            let Some(s) = source else { continue };
            let rank = s.tree.rank();
            let at = match (rank, s.reversed) {
                (Rank::Three, _) => [isotropic_incidence(w[0], w[1]), 0.0],
                (Rank::Four, false) => square(-w[0], -w[1]).into(),
                (Rank::Four, true) => square(w[0], w[1]).into(),
            };
            *slot = Some((rank, s.columns().get(s.tree, at)));
        }
        out
    }

    /// Albedo of reflection and transmission together.
    pub(crate) fn albedo(&self, w: [f64; 3]) -> f64 {
        let columns = self.columns(w);
        columns.iter().flatten().map(|(_, c)| c.albedo).sum()
    }

    /// The cell drawn with `u` in `[0, 1)`: its component, the cell and the albedo of both.
    #[inline(always)]
    pub(crate) fn cell(&self, w: [f64; 3], u: f64) -> Option<(usize, Drawn, f64)> {
        let columns = self.columns(w);
        let albedo = |k: usize| columns[k].as_ref().map_or(0.0, |(_, c)| c.albedo);
        let (first, total) = (albedo(0), albedo(0) + albedo(1));
        let target = u * total;
        let which = usize::from(target >= first);
        let column = &columns[which].as_ref()?.1;
        let share = (target - which as f64 * first) / column.albedo;
        Some((which, column.draw(share)?, total))
    }

    /// The direction at point `(a, b)` of a cell that [`Sampler::cell`] gave for `w`.
    #[inline(always)]
    pub(crate) fn point(&self, w: [f64; 3], (which, cell, total): (usize, Drawn, f64), u: [f64; 2]) -> Point {
        let (a, b) = cell.point(u[0], u[1]);
        let (x, y) = disk(a, b);
        let (x, y) = match &self.parts[which] {
            Some(s) if s.tree.rank() == Rank::Three => {
                let (c, s) = mirror_azimuth(w[0], w[1]);
                (c * x - s * y, c * y + s * x)
            }
            Some(s) if s.reversed => (-x, -y),
            _ => (x, y),
        };
        let z = (1.0 - x * x - y * y).max(0.0).sqrt();
        let sign = COMPONENTS[which].scattered_side(self.side).sign();
        Point {
            direction: [x, y, sign * z],
            pdf: f64::from(cell.value) * z / total,
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
