//! Reduction to tensor trees: cells are halved where the model varies most.

use std::cmp::Ordering;
use std::collections::BinaryHeap;

use gonio_bsdf::tensor_tree::lookup::{exit_direction, incident_direction};
use gonio_bsdf::tensor_tree::{Rank, TensorTree, Tree, TreeBuilder};
use gonio_bsdf::{Bsdf, BsdfError, FourComponents};
use gonio_geom::{Component, Direction, Side};

use super::OneChannel;

/// How to reduce a model to tensor trees.
#[derive(Clone, Debug, PartialEq)]
pub struct TreeOptions {
    /// Rank; `None` takes 3 for isotropic models and 4 for others.
    pub rank: Option<Rank>,
    /// Components to fill; `None` fills every component that scatters.
    pub components: Option<Vec<(Side, Component)>>,
    /// Number of the model's channel.
    pub channel: usize,
    /// Finest cells have the side `2^-max_depth`; 1 to 10.
    pub max_depth: u8,
    /// Refinement of a component stops when the estimated `integral |f - f_cell| / integral f` (projected solid angles,
    /// all incidences) is below this.
    pub target: f64,
    /// Refinement of a component stops at this number of cells (about 9 bytes each in a file).
    pub max_cells: usize,
}

impl Default for TreeOptions {
    /// The rank the model needs, all components, depth 8, 3 %, 40 000 cells.
    fn default() -> Self {
        TreeOptions {
            rank: None,
            components: None,
            channel: 0,
            max_depth: 8,
            target: 0.03,
            max_cells: 40_000,
        }
    }
}

/// A tensor-tree model with what the reduction found.
#[derive(Clone, Debug)]
pub struct TreeReduction {
    /// The model.
    pub model: TensorTree,
    /// Estimated `integral |f - f_cell| / integral f` of each component.
    pub error: FourComponents<f64>,
    /// Greatest directional albedo (reflection and transmission of one side) over the incident cells.
    pub max_albedo: f64,
    /// Number of evaluations of the model.
    pub evaluations: u64,
}

/// Averages `model` over cells of incidence and exit that are halved, the worst first, until the target, the number of
/// cells or the depth is reached. Each average is a Gauss-Legendre product rule of two points a dimension; values are
/// rounded to five significant digits.
///
/// Cells about the mirror, unbent and retro directions are always looked into; a feature elsewhere that is narrower than
/// about 1/16 in direction cosine can be missed.
///
/// # Errors
/// [`BsdfError::Domain`] for a channel the model does not have, no component that scatters, rank 3 for a model that is
/// not isotropic, an ideal part ([`Bsdf::delta`]), or a depth, target or number of cells out of range.
pub fn to_tensor_tree(model: &dyn Bsdf, options: &TreeOptions) -> Result<TreeReduction, BsdfError> {
    let one = OneChannel::new(model, options.channel)?;
    let rank = check(model, options)?;
    let components = one.components(options.components.as_deref())?;
    let mut trees = FourComponents::default();
    let mut error = FourComponents::default();
    let mut evaluations = 0;
    for (side, component) in components {
        let mut growth = Growth::new(one, rank, side, component, options);
        growth.grow();
        evaluations += growth.evaluations;
        error.set(side, component, Some(growth.relative_error()));
        trees.set(side, component, Some(growth.tree()?));
    }
    let max_albedo = max_albedo(&trees, rank);
    Ok(TreeReduction {
        model: TensorTree::new(one.channel(), trees),
        error,
        max_albedo,
        evaluations,
    })
}

fn check(model: &dyn Bsdf, options: &TreeOptions) -> Result<Rank, BsdfError> {
    let domain = |field, found: String, allowed: &str| {
        Err(BsdfError::Domain {
            field,
            found,
            allowed: allowed.into(),
        })
    };
    let isotropic = model.properties().isotropic;
    if options.rank == Some(Rank::Three) && !isotropic {
        return domain("rank", "3 for a model that is not isotropic".into(), "4");
    }
    if !(1..=10).contains(&options.max_depth) {
        return domain("max_depth", options.max_depth.to_string(), "1 to 10");
    }
    if !(options.target >= 0.0 && options.target.is_finite()) {
        return domain("target", options.target.to_string(), "0 or more");
    }
    if options.max_cells < 16 || options.max_cells > 1 << 26 {
        return domain("max_cells", options.max_cells.to_string(), "16 to 67108864");
    }
    Ok(options
        .rank
        .unwrap_or(if isotropic { Rank::Three } else { Rank::Four }))
}

/// Greatest sum of reflection and transmission albedo, at the centre of every incident cell of the finest tree.
fn max_albedo(trees: &FourComponents<Tree>, rank: Rank) -> f64 {
    let depth = trees.iter().map(|(_, _, t)| t.depth()).max().unwrap_or(0);
    let n = 1usize << depth.min(7);
    let centre = |k: usize| (k as f64 + 0.5) / n as f64;
    let incident: Vec<[f64; 2]> = match rank {
        Rank::Three => (0..n.div_ceil(2)).map(|a| [centre(a).min(0.499), 0.0]).collect(),
        Rank::Four => (0..n * n).map(|k| [centre(k / n), centre(k % n)]).collect(),
    };
    let mut max = 0.0f64;
    for side in Side::BOTH {
        for at in &incident {
            let albedo: f64 = [Component::Reflection, Component::Transmission]
                .iter()
                .filter_map(|c| trees.get(side, *c))
                .map(|t| t.albedo(*at))
                .sum();
            max = max.max(albedo);
        }
    }
    max
}

/// Depth to which every cell is refined before errors decide: rank 3, rank 4.
const FIRST_DEPTH: [u8; 2] = [4, 3];
/// Depth to which cells about the mirror, unbent and retro directions are refined before errors decide.
const RIDGE_DEPTH: [u8; 2] = [6, 4];
/// No children yet.
const LEAF: u32 = u32::MAX;

#[derive(Clone, Copy, Debug)]
struct Cell {
    origin: [u16; 4],
    depth: u8,
    children: u32,
    mean: f32,
    /// `integral |f - mean|` over the cell, in units of its measure.
    error: f32,
}

/// A leaf in the queue, ordered by its error.
#[derive(Clone, Copy, Debug)]
struct Worst {
    error: f32,
    cell: u32,
}

impl PartialEq for Worst {
    fn eq(&self, other: &Self) -> bool {
        self.cmp(other) == Ordering::Equal
    }
}
impl Eq for Worst {}
impl PartialOrd for Worst {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}
impl Ord for Worst {
    fn cmp(&self, other: &Self) -> Ordering {
        self.error
            .total_cmp(&other.error)
            .then(other.cell.cmp(&self.cell))
    }
}

struct Growth<'a> {
    one: OneChannel<'a>,
    rank: Rank,
    side: Side,
    to: Side,
    options: &'a TreeOptions,
    cells: Vec<Cell>,
    queue: BinaryHeap<Worst>,
    leaves: usize,
    evaluations: u64,
    /// Sums over the leaves.
    total: f64,
    error: f64,
}

impl<'a> Growth<'a> {
    fn new(
        one: OneChannel<'a>,
        rank: Rank,
        side: Side,
        component: Component,
        options: &'a TreeOptions,
    ) -> Self {
        let mut growth = Growth {
            one,
            rank,
            side,
            to: component.scattered_side(side),
            options,
            cells: Vec::new(),
            queue: BinaryHeap::new(),
            leaves: 1,
            evaluations: 0,
            total: 0.0,
            error: 0.0,
        };
        let root = growth.cell([0; 4], 0);
        growth.cells.push(root);
        growth.add(0);
        growth
    }

    /// Whether errors do not decide yet.
    fn forced(&self, c: &Cell) -> bool {
        let slot = usize::from(self.rank == Rank::Four);
        if c.depth >= RIDGE_DEPTH[slot] {
            return false;
        }
        !self.unused(c.origin, c.depth) && (c.depth < FIRST_DEPTH[slot] || self.on_ridge(c))
    }

    /// Whether the cell touches the mirror (unbent) or the retro direction of its incidence.
    fn on_ridge(&self, c: &Cell) -> bool {
        let n = 1u16 << c.depth;
        let [a, b, u, v] = c.origin;
        match self.rank {
            Rank::Three => {
                // exit (u, v) = (1 - g0, 1/2) mirrors, (g0, 1/2) returns; the square is cut at v = 1/2
                let (u, v) = (b, u);
                let middle = v == n / 2 || v + 1 == n / 2;
                middle && (u + 1 + a == n || u == a)
            }
            Rank::Four => (a, b) == (u, v) || (n - 1 - a, n - 1 - b) == (u, v),
        }
    }

    /// Whether the cell lies in the unused half of a rank-3 tree.
    fn unused(&self, origin: [u16; 4], depth: u8) -> bool {
        self.rank == Rank::Three && depth > 0 && origin[0] >= 1 << (depth - 1)
    }

    fn volume(&self, depth: u8) -> f64 {
        (-(f64::from(depth)) * self.rank.dimensions() as f64).exp2()
    }

    /// A new cell with its average.
    fn cell(&mut self, origin: [u16; 4], depth: u8) -> Cell {
        let mut cell = Cell {
            origin,
            depth,
            children: LEAF,
            mean: 0.0,
            error: 0.0,
        };
        if self.unused(origin, depth) {
            return cell;
        }
        const GAUSS: [f64; 2] = [0.211_324_865_405_187_1, 0.788_675_134_594_812_9];
        let step = (-f64::from(depth)).exp2();
        let at = |k: usize, p: usize| step * (f64::from(origin[k]) + GAUSS[p]);
        let d = self.rank.incident_dimensions();
        let mut values = [0f64; 16];
        let mut n = 0;
        let exits: [[f64; 2]; 4] = [0, 1, 2, 3].map(|p| [at(d, p & 1), at(d + 1, p >> 1)]);
        let mut directions: [Option<Direction>; 4] = [None; 4];
        for p in 0..1usize << d {
            let incident = [at(0, p & 1), if d == 2 { at(1, p >> 1) } else { 0.0 }];
            let wi = incident_direction(self.rank, incident, self.side);
            for (e, slot) in exits.iter().zip(&mut directions) {
                // the incident azimuth is fixed at rank 3, so exit directions are common to all incidences
                let ws = *slot.get_or_insert_with(|| exit_direction(self.rank, wi, e[0], e[1], self.to));
                values[n] = self.one.eval(wi, ws);
                n += 1;
            }
        }
        self.evaluations += n as u64;
        let mean = values[..n].iter().sum::<f64>() / n as f64;
        let spread = values[..n].iter().map(|v| (v - mean).abs()).sum::<f64>() / n as f64;
        cell.mean = mean as f32;
        cell.error = (spread * self.volume(depth)) as f32;
        cell
    }

    /// Puts a leaf into the sums and the queue.
    fn add(&mut self, index: u32) {
        let c = self.cells[index as usize];
        self.total += f64::from(c.mean) * self.volume(c.depth);
        self.error += f64::from(c.error);
        let error = if self.forced(&c) { f32::INFINITY } else { c.error };
        if c.depth < self.options.max_depth && error > 0.0 {
            self.queue.push(Worst { error, cell: index });
        }
    }

    fn relative_error(&self) -> f64 {
        if self.total > 0.0 {
            (self.error / self.total).max(0.0)
        } else {
            0.0
        }
    }

    fn grow(&mut self) {
        let more = self.rank.children() - 1;
        while let Some(worst) = self.queue.pop() {
            let settled = worst.error.is_finite() && self.relative_error() <= self.options.target;
            if settled || self.leaves + more > self.options.max_cells {
                return;
            }
            self.split(worst.cell);
        }
    }

    fn child_origin(&self, c: Cell, child: usize) -> [u16; 4] {
        let mut origin = c.origin;
        for (k, x) in origin.iter_mut().enumerate().take(self.rank.dimensions()) {
            *x = 2 * *x + (child >> k & 1) as u16;
        }
        origin
    }

    fn split(&mut self, index: u32) {
        let c = self.cells[index as usize];
        let first = self.cells.len() as u32;
        self.cells[index as usize].children = first;
        self.total -= f64::from(c.mean) * self.volume(c.depth);
        self.error -= f64::from(c.error);
        for child in 0..self.rank.children() {
            let cell = self.cell(self.child_origin(c, child), c.depth + 1);
            self.cells.push(cell);
        }
        self.leaves += self.rank.children() - 1;
        for child in 0..self.rank.children() as u32 {
            self.add(first + child);
        }
    }

    /// The finished tree; children that are all leaves become one block.
    fn tree(&self) -> Result<Tree, BsdfError> {
        let mut b = TreeBuilder::new(self.rank);
        self.emit(0, &mut b)?;
        b.finish()
    }

    fn emit(&self, index: u32, b: &mut TreeBuilder) -> Result<(), BsdfError> {
        let c = self.cells[index as usize];
        if c.children == LEAF {
            return b.block(&[rounded(c.mean)]);
        }
        let n = self.rank.children();
        let d = self.rank.dimensions();
        let first = c.children as usize;
        let children = &self.cells[first..first + n];
        if children.iter().all(|k| k.children == LEAF) {
            let mut block = [0f32; 16];
            for (child, k) in children.iter().enumerate() {
                // places of children have dimension 0 lowest, blocks have it slowest
                let place = (0..d).fold(0, |p, k| p | (child >> k & 1) << (d - 1 - k));
                block[place] = rounded(k.mean);
            }
            return b.block(&block[..n]);
        }
        b.branch()?;
        for child in 0..n as u32 {
            self.emit(c.children + child, b)?;
        }
        b.end()
    }
}

/// Five significant digits: far finer than a cell's own error, and a third less to write.
fn rounded(v: f32) -> f32 {
    if v == 0.0 {
        return 0.0;
    }
    let v = f64::from(v);
    let digits = 4 - v.abs().log10().floor() as i32;
    let scale = 10f64.powi(digits.abs());
    (if digits >= 0 {
        (v * scale).round() / scale
    } else {
        (v / scale).round() * scale
    }) as f32
}
