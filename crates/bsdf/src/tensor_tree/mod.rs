//! Tensor trees: a BSDF constant over cells that are as fine as the function needs.
//!
//! Coordinates are squares mapped to the disk of direction cosines [ShirleyChiu1997], so that a cell of side `w` has
//! the projected solid angle `pi w^2`. Layout and lookup are Radiance's [WardEtAl2012].

mod batch;
mod column;
mod grid;
pub mod lookup;
mod mapping;
mod node;
mod ring;
mod sample;

use std::sync::OnceLock;

use gonio_geom::{Component, Direction, Side};

use crate::batch::{Directions, SampleColumns};
use crate::{Bsdf, Channel, FourComponents, Properties, Sample};
use column::Columns;
use grid::Grid;
pub use lookup::Cell;
pub use node::{MAX_DEPTH, Node, Rank, Tree, TreeBuilder};
use ring::{INWARD, Rings};

/// A tensor-tree model: up to four trees.
///
/// Transmission that is absent for one side is answered from the other side's tree by reciprocity
/// (`f_t(wi, ws) = f_t(ws, wi)`), as Radiance does, and sampled exactly too. Everything else that is absent is 0.
#[derive(Debug)]
pub struct TensorTree {
    channels: [Channel; 1],
    trees: FourComponents<Tree>,
    tables: FourComponents<Tables>,
}

/// What is made of a tree at its first use: a flat top for evaluation, columns for sampling.
#[derive(Debug)]
struct Tables {
    grid: OnceLock<Grid>,
    forward: Columns,
    /// Rank 4 only.
    reversed: Columns,
    /// Rank 3 only: what stands for `reversed`.
    rings: OnceLock<Rings>,
}

impl Clone for TensorTree {
    fn clone(&self) -> Self {
        TensorTree::new(self.channels[0], self.trees.clone())
    }
}

impl PartialEq for TensorTree {
    fn eq(&self, other: &Self) -> bool {
        self.channels == other.channels && self.trees == other.trees
    }
}

/// Where the answer for one (side of incidence, component) comes from.
#[derive(Clone, Copy)]
pub(crate) struct Source<'a> {
    pub(crate) tree: &'a Tree,
    tables: &'a Tables,
    /// Looked up with incidence and exit exchanged.
    pub(crate) reversed: bool,
}

impl<'a> Source<'a> {
    /// The columns for the direction that is known.
    fn columns(&self) -> &'a Columns {
        if self.reversed {
            &self.tables.reversed
        } else {
            &self.tables.forward
        }
    }

    fn rings(&self) -> &'a Rings {
        self.tables.rings.get_or_init(|| Rings::new(self.tree))
    }

    fn grid(&self) -> &'a Grid {
        self.tables.grid.get_or_init(|| Grid::new(self.tree))
    }
}

impl TensorTree {
    /// A model of the given trees for `channel`.
    pub fn new(channel: Channel, trees: FourComponents<Tree>) -> Self {
        let tables = trees.map(|_, _, t| Tables {
            grid: OnceLock::new(),
            forward: Columns::new(t, false),
            reversed: Columns::new(t, true),
            rings: OnceLock::new(),
        });
        TensorTree {
            channels: [channel],
            trees,
            tables,
        }
    }

    /// The trees.
    pub fn trees(&self) -> &FourComponents<Tree> {
        &self.trees
    }

    /// The tree for light that arrives on `side`, when there is one.
    pub fn tree(&self, side: Side, component: Component) -> Option<&Tree> {
        self.trees.get(side, component)
    }

    pub(crate) fn source(&self, side: Side, component: Component) -> Option<Source<'_>> {
        let from = |side, reversed| {
            Some(Source {
                tree: self.trees.get(side, component)?,
                tables: self.tables.get(side, component)?,
                reversed,
            })
        };
        from(side, false).or_else(|| {
            (component == Component::Transmission)
                .then(|| from(side.opposite(), true))
                .flatten()
        })
    }

    /// `f(wi, ws)` of unit vectors, 1/sr.
    fn value(&self, wi: [f64; 3], ws: [f64; 3]) -> f64 {
        let (from, to) = (Side::of_z(wi[2]), Side::of_z(ws[2]));
        if ws[2] == 0.0 {
            return 0.0;
        }
        let Some(s) = self.source(from, Component::between(from, to)) else {
            return 0.0;
        };
        let (i, o) = if s.reversed { (ws, wi) } else { (wi, ws) };
        f64::from(match s.tree.rank() {
            Rank::Three => {
                let scale = if s.reversed { INWARD } else { 1.0 };
                let at = batch::isotropic_coordinates([i[0], i[1]], [o[0] * scale, o[1] * scale]);
                s.grid().value(s.tree, at.map(mapping::fixed))
            }
            Rank::Four => {
                let ((a, b), (u, v)) = (mapping::square(-i[0], -i[1]), mapping::square(o[0], o[1]));
                s.grid().value(s.tree, [a, b, u, v].map(mapping::fixed))
            }
        })
    }

    /// Greatest directional albedo, reflection and transmission of one side together, over the incident cells of the
    /// finest tree (at rank 4 over cells of depth 8 at most).
    pub fn max_albedo(&self) -> f64 {
        let depth = self.trees.iter().map(|(_, _, t)| t.depth()).max().unwrap_or(0);
        let four = self.trees.iter().any(|(_, _, t)| t.rank() == Rank::Four);
        let n = 1usize << if four { depth.min(8) } else { depth.max(1) };
        let centre = |k: usize| (k as f64 + 0.5) / n as f64;
        // at rank 3 the incident coordinate says all, with the azimuth that makes it the first of rank 4
        let incidences = if four { n * n } else { n / 2 };
        let rank = if four { Rank::Four } else { Rank::Three };
        let mut most = 0.0f64;
        for side in Side::BOTH {
            let there = |c: &Component| self.trees.get(side, *c).is_some();
            let filled = [Component::Reflection, Component::Transmission]
                .into_iter()
                .filter(there);
            let filled: Vec<Component> = filled.collect();
            for k in 0..if filled.is_empty() { 0 } else { incidences } {
                let at = if four {
                    [centre(k / n), centre(k % n)]
                } else {
                    [centre(k), 0.0]
                };
                let wi = lookup::incident_direction(rank, at, side);
                most = most.max(filled.iter().map(|c| self.directional_albedo(wi, *c)).sum());
            }
        }
        most
    }

    /// Directional-hemispherical reflectance or transmittance at `wi`; 0 where the model has no such component.
    pub fn directional_albedo(&self, wi: Direction, component: Component) -> f64 {
        self.source(wi.side(), component)
            .map_or(0.0, |s| sample::albedo(s, wi.vec().to_array()))
    }
}

impl Bsdf for TensorTree {
    fn channels(&self) -> &[Channel] {
        &self.channels
    }

    fn properties(&self) -> Properties {
        Properties {
            reciprocal: false,
            energy_conserving: false,
            isotropic: !self.trees.is_empty() && self.trees.iter().all(|(_, _, t)| t.rank() == Rank::Three),
        }
    }

    fn eval(&self, wi: Direction, ws: Direction, f: &mut [f64]) {
        f[0] = self.eval_first(wi, ws);
    }

    fn eval_first(&self, wi: Direction, ws: Direction) -> f64 {
        self.value(wi.vec().to_array(), ws.vec().to_array())
    }

    fn eval_f32(&self, wi: Directions<'_, f32>, ws: Directions<'_, f32>, f: &mut [&mut [f32]]) {
        batch::eval(self, wi, ws, f[0]);
    }

    fn eval_f64(&self, wi: Directions<'_, f64>, ws: Directions<'_, f64>, f: &mut [&mut [f64]]) {
        batch::eval(self, wi, ws, f[0]);
    }

    fn sample_f32(&self, w: Directions<'_, f32>, u: [&[f32]; 3], out: &mut SampleColumns<'_, f32>) {
        batch::sample(self, w, u, out);
    }

    fn sample_f64(&self, w: Directions<'_, f64>, u: [&[f64]; 3], out: &mut SampleColumns<'_, f64>) {
        batch::sample(self, w, u, out);
    }

    fn holds(&self, wi: Direction, ideal: Direction, ws: Direction) -> bool {
        let component = Component::between(wi.side(), ws.side());
        ideal.side() == ws.side()
            && self.source(wi.side(), component).is_some_and(|s| {
                let at = |w| {
                    let (i, o) = if s.reversed { (w, wi) } else { (wi, w) };
                    lookup::coordinates(s.tree.rank(), i, o)
                };
                let (ideal, ws) = (at(ideal), at(ws));
                let reach = 1.5 * s.tree.cell_side(&ideal);
                ideal.iter().zip(&ws).all(|(a, b)| (a - b).abs() <= reach)
            })
    }

    fn pdf(&self, w: Direction, sampled: Direction) -> f64 {
        sample::pdf(self, w, sampled)
    }

    /// Exact: the weight is the albedo (reflection and transmission together).
    fn sample(&self, w: Direction, u: [f64; 3]) -> Option<Sample> {
        sample::sample(self, w, u)
    }
}

#[cfg(test)]
mod tests;
