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
mod sample;

use std::sync::OnceLock;

use gonio_geom::{Component, Direction, Side};

use crate::batch::{Directions, SampleColumns};
use crate::{Bsdf, Channel, FourComponents, Properties, Sample};
use column::Columns;
use grid::Grid;
pub use lookup::Cell;
pub use node::{MAX_DEPTH, Node, Rank, Tree, TreeBuilder};

/// A tensor-tree model: up to four trees.
///
/// Transmission that is absent for one side is answered from the other side's tree by reciprocity
/// (`f_t(wi, ws) = f_t(ws, wi)`), as Radiance does; a rank-3 tree read that way is sampled only by the broad default.
/// Everything else that is absent is 0.
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
    reversed: Columns,
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
                let at = batch::isotropic_coordinates([i[0], i[1]], [o[0], o[1]]);
                s.grid().value(s.tree, at.map(mapping::fixed))
            }
            Rank::Four => {
                let ((a, b), (u, v)) = (mapping::square(-i[0], -i[1]), mapping::square(o[0], o[1]));
                s.grid().value(s.tree, [a, b, u, v].map(mapping::fixed))
            }
        })
    }

    /// Directional-hemispherical reflectance or transmittance at `wi`; 0 where the model has no such component. A
    /// rank-3 tree read in reverse is integrated on a grid of 128 x 128 directions.
    pub fn directional_albedo(&self, wi: Direction, component: Component) -> f64 {
        let Some(s) = self.source(wi.side(), component) else {
            return 0.0;
        };
        let c = lookup::coordinates(s.tree.rank(), wi, wi);
        if !s.reversed {
            return s.tree.albedo([c[0], c[1]]);
        }
        if s.tree.rank() == Rank::Four {
            let mut sum = 0.0;
            s.tree
                .reversed_cross_section([c[2], c[3]], |c| sum += f64::from(c.value) * c.side * c.side);
            return std::f64::consts::PI * sum;
        }
        let n = 128u32;
        let step = 1.0 / f64::from(n);
        let mut sum = 0.0;
        for a in 0..n {
            for b in 0..n {
                let (u, v) = (step * (f64::from(a) + 0.5), step * (f64::from(b) + 0.5));
                let ws = lookup::exit_direction(Rank::Four, wi, u, v, wi.side().opposite());
                sum += self.eval_first(wi, ws);
            }
        }
        std::f64::consts::PI * step * step * sum
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

    fn pdf(&self, w: Direction, sampled: Direction) -> f64 {
        if !sample::applies(self, w.side()) {
            return broad_pdf(sampled);
        }
        sample::pdf(self, w, sampled)
    }

    /// Exact where the trees are read forwards or have rank 4: the weight is the albedo (reflection and transmission
    /// together).
    fn sample(&self, w: Direction, u: [f64; 3]) -> Option<Sample> {
        if !sample::applies(self, w.side()) {
            return Broad(self).sample(w, u);
        }
        sample::sample(self, w, u)
    }
}

fn broad_pdf(sampled: Direction) -> f64 {
    0.5 * sampled.cos_theta().abs() / std::f64::consts::PI
}

/// The model with the default sampler of [`Bsdf`].
struct Broad<'a>(&'a TensorTree);

impl Bsdf for Broad<'_> {
    fn channels(&self) -> &[Channel] {
        self.0.channels()
    }

    fn properties(&self) -> Properties {
        self.0.properties()
    }

    fn eval(&self, wi: Direction, ws: Direction, f: &mut [f64]) {
        self.0.eval(wi, ws, f);
    }
}

#[cfg(test)]
mod tests;
