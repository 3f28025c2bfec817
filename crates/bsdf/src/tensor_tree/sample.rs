//! Exact sampling of a tree by cumulative tables over its exit cells, built at the first use of each incident cell.

use std::f64::consts::PI;
use std::sync::{Arc, OnceLock};

use gonio_geom::{Component, Direction, Side};

use super::lookup::{self, Cell};
use super::{Rank, Source, TensorTree, Tree};
use crate::{Bsdf, Lobe, Sample};

/// More incident cells than this are not cached: tables are then built for each sample.
const MAX_CACHED: usize = 1 << 16;

/// Cells over the free square with their cumulative albedo.
#[derive(Debug)]
pub(crate) struct Column {
    cells: Vec<Cell>,
    cumulative: Vec<f64>,
}

impl Column {
    fn new(tree: &Tree, at: [f64; 2], reversed: bool) -> Self {
        let mut column = Column {
            cells: Vec::new(),
            cumulative: Vec::new(),
        };
        let mut sum = 0.0;
        let mut visit = |c: Cell| {
            if c.value > 0.0 {
                sum += PI * f64::from(c.value) * c.side * c.side;
                column.cells.push(c);
                column.cumulative.push(sum);
            }
        };
        if reversed {
            tree.reversed_cross_section(at, &mut visit);
        } else {
            tree.cross_section(at, &mut visit);
        }
        column
    }

    fn albedo(&self) -> f64 {
        self.cumulative.last().copied().unwrap_or(0.0)
    }
}

/// The columns of one component, by incident cell.
#[derive(Debug, Default)]
pub(crate) struct Columns {
    cached: Vec<OnceLock<Arc<Column>>>,
}

impl Columns {
    pub(crate) fn new(tree: &Tree) -> Self {
        let bits = usize::from(tree.depth()) * tree.rank().incident_dimensions();
        let n = if bits <= 16 { 1usize << bits } else { 0 };
        let mut cached = Vec::new();
        if n <= MAX_CACHED {
            cached.resize_with(n, OnceLock::new);
        }
        Columns { cached }
    }

    fn get(&self, tree: &Tree, at: [f64; 2], reversed: bool) -> Arc<Column> {
        if self.cached.is_empty() || reversed {
            return Arc::new(Column::new(tree, at, reversed));
        }
        let n = 1usize << tree.depth();
        let index = |x: f64| ((x * n as f64) as usize).min(n - 1);
        let k = match tree.rank() {
            Rank::Three => index(at[0]),
            Rank::Four => index(at[0]) * n + index(at[1]),
        };
        Arc::clone(self.cached[k].get_or_init(|| Arc::new(Column::new(tree, at, false))))
    }
}

/// The column that answers for `w`; `None` where a rank-3 tree would have to be read in reverse.
pub(crate) fn column(source: Source<'_>, w: Direction) -> Option<Arc<Column>> {
    let tree = source.tree;
    if source.reversed {
        if tree.rank() == Rank::Three {
            return None;
        }
        let c = lookup::coordinates(tree.rank(), w, w);
        return Some(source.columns.get(tree, [c[2], c[3]], true));
    }
    let c = lookup::coordinates(tree.rank(), w, w);
    Some(source.columns.get(tree, [c[0], c[1]], false))
}

/// The column of one component for a direction, when the model has the component.
type Part<'a> = Option<(Source<'a>, Arc<Column>)>;

const COMPONENTS: [Component; 2] = [Component::Reflection, Component::Transmission];

/// The columns of both components for light from `w`; `None` when one of them cannot be tabulated.
fn both(model: &TensorTree, w: Direction) -> Option<[Part<'_>; 2]> {
    let mut out = [None, None];
    for (slot, component) in out.iter_mut().zip(COMPONENTS) {
        if let Some(s) = model.source(w.side(), component) {
            *slot = Some((s, column(s, w)?));
        }
    }
    Some(out)
}

fn albedo(part: &Part<'_>) -> f64 {
    part.as_ref().map_or(0.0, |(_, c)| c.albedo())
}

/// Density of the exact sampler; `None` where it does not apply.
pub(crate) fn pdf(model: &TensorTree, w: Direction, sampled: Direction) -> Option<f64> {
    let parts = both(model, w)?;
    let total = albedo(&parts[0]) + albedo(&parts[1]);
    if total <= 0.0 {
        return Some(0.0);
    }
    Some(model.eval_first(w, sampled) * sampled.cos_theta().abs() / total)
}

/// Whether the exact sampler applies for light from `w`.
pub(crate) fn applies(model: &TensorTree, side: Side) -> bool {
    COMPONENTS.iter().all(|c| {
        model
            .source(side, *c)
            .is_none_or(|s| !(s.reversed && s.tree.rank() == Rank::Three))
    })
}

/// A cell by its share of the albedo, then a point uniform in projected solid angle.
pub(crate) fn sample(model: &TensorTree, w: Direction, u: [f64; 3]) -> Option<Sample> {
    let parts = both(model, w)?;
    let first = albedo(&parts[0]);
    let total = first + albedo(&parts[1]);
    if total <= 0.0 {
        return None;
    }
    let target = u[2] * total;
    let which = usize::from(target >= first);
    let (source, column) = parts[which].as_ref()?;
    let rest = target - which as f64 * first;
    let k = column
        .cumulative
        .partition_point(|c| *c <= rest)
        .min(column.cells.len().checked_sub(1)?);
    let cell = column.cells[k];
    let (a, b) = (cell.u + u[0] * cell.side, cell.v + u[1] * cell.side);
    let side = COMPONENTS[which].scattered_side(w.side());
    let rank = source.tree.rank();
    let direction = if source.reversed {
        lookup::incident_direction(rank, [a, b], side)
    } else {
        lookup::exit_direction(rank, w, a, b, side)
    };
    let pdf = model.eval_first(w, direction) * direction.cos_theta().abs() / total;
    (pdf > 0.0).then_some(Sample {
        direction,
        weight: total,
        pdf,
        lobe: Lobe::Glossy,
    })
}
