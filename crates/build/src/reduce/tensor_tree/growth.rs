//! Cells that are halved, the worst first.

use std::cmp::Ordering;
use std::collections::BinaryHeap;
use std::f64::consts::PI;

use gonio_bsdf::BsdfError;
use gonio_bsdf::tensor_tree::lookup::{exit_direction, incident_direction};
use gonio_bsdf::tensor_tree::{Rank, Tree, TreeBuilder};
use gonio_geom::{Component, Direction, Side};

use super::TreeOptions;
use super::ideal::Ideal;
use crate::reduce::OneChannel;

/// Depth to which every cell is refined before errors decide: rank 3, rank 4.
const FIRST_DEPTH: [u8; 2] = [4, 3];
/// Depth to which cells about the mirror, unbent and retro directions are refined before errors decide.
const RIDGE_DEPTH: [u8; 2] = [6, 4];
/// Braces, a space and a line's end about a block or a branch, in a file.
const BRACES: usize = 4;
/// Most characters that a new cell takes: a space, a value and a pair of braces.
const MOST_CHARACTERS: usize = 1 + 11 + BRACES;
/// No children yet.
const LEAF: u32 = u32::MAX;

#[derive(Clone, Copy, Debug)]
struct Cell {
    origin: [u16; 4],
    depth: u8,
    children: u32,
    parent: u32,
    /// Average of the scattered light.
    mean: f32,
    /// What light without spread adds.
    ideal: f32,
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

pub(super) struct Growth<'a> {
    one: OneChannel<'a>,
    rank: Rank,
    side: Side,
    to: Side,
    options: &'a TreeOptions,
    ideal: Option<Ideal>,
    max_depth: u8,
    cells: Vec<Cell>,
    queue: BinaryHeap<Worst>,
    leaves: usize,
    /// Characters of the finished tree in a file.
    pub(super) bytes: usize,
    pub(super) evaluations: u64,
    /// Sums over the leaves.
    total: f64,
    error: f64,
}

impl<'a> Growth<'a> {
    pub(super) fn new(
        one: OneChannel<'a>,
        rank: Rank,
        side: Side,
        component: Component,
        options: &'a TreeOptions,
    ) -> Self {
        let max_cells = options.max_bytes.map_or(options.max_cells, |most| {
            options.max_cells.min(most / MOST_CHARACTERS)
        });
        let ideal = Ideal::new(one, rank, side, component, options.max_depth, max_cells);
        let max_depth = match &ideal {
            // RADIANCE's aBSDF takes light for unscattered in the smallest cells of a component only.
            Some(ideal) if component == Component::Transmission => ideal.depth,
            _ => options.max_depth,
        };
        let mut growth = Growth {
            one,
            rank,
            side,
            to: component.scattered_side(side),
            options,
            ideal,
            max_depth,
            cells: Vec::new(),
            queue: BinaryHeap::new(),
            leaves: 1,
            bytes: 0,
            evaluations: 0,
            total: 0.0,
            error: 0.0,
        };
        let root = growth.cell([0; 4], 0, 0);
        growth.bytes = BRACES + growth.characters(&root);
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
    fn cell(&mut self, origin: [u16; 4], depth: u8, parent: u32) -> Cell {
        let mut cell = Cell {
            origin,
            depth,
            children: LEAF,
            parent,
            mean: 0.0,
            ideal: 0.0,
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
        if let Some(ideal) = &self.ideal {
            // f = flux / (incidences, projected solid angle of the exit cell)
            cell.ideal = (ideal.flux(origin, depth) / (self.volume(depth) * PI)) as f32;
        }
        cell.error = (spread * self.volume(depth)) as f32;
        cell
    }

    /// Puts a leaf into the sums and the queue.
    fn add(&mut self, index: u32) {
        let c = self.cells[index as usize];
        self.total += f64::from(c.mean) * self.volume(c.depth);
        self.error += f64::from(c.error);
        let holds = |ideal: &Ideal| c.ideal > 0.0 && c.depth < ideal.depth;
        let error = if self.ideal.as_ref().is_some_and(holds) {
            f32::INFINITY
        } else if self.forced(&c) {
            f32::MAX
        } else {
            c.error
        };
        if c.depth < self.max_depth && error > 0.0 {
            self.queue.push(Worst { error, cell: index });
        }
    }

    pub(super) fn relative_error(&self) -> f64 {
        if self.total > 0.0 {
            (self.error / self.total).max(0.0)
        } else {
            0.0
        }
    }

    pub(super) fn grow(&mut self) {
        let more = self.rank.children() - 1;
        while let Some(worst) = self.queue.pop() {
            let settled = worst.error < f32::MAX && self.relative_error() <= self.options.target;
            let full = self.leaves + more > self.options.max_cells
                || self
                    .options
                    .max_bytes
                    .is_some_and(|most| self.bytes + (more + 1) * MOST_CHARACTERS > most);
            if settled || full {
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
        // The children take the place of the value, whose siblings no longer share a block.
        self.bytes -= self.characters(&c);
        self.bytes += BRACES;
        if index > 0 {
            let siblings = self.cells[c.parent as usize].children as usize;
            let siblings = &self.cells[siblings..siblings + self.rank.children()];
            let alone = siblings.iter().filter(|s| s.children == LEAF).count();
            if alone + 1 == siblings.len() {
                self.bytes += BRACES * alone;
            } else {
                self.bytes -= BRACES;
            }
        } else {
            self.bytes -= BRACES;
        }
        for child in 0..self.rank.children() {
            let cell = self.cell(self.child_origin(c, child), c.depth + 1, index);
            self.bytes += self.characters(&cell);
            self.cells.push(cell);
        }
        self.leaves += self.rank.children() - 1;
        for child in 0..self.rank.children() as u32 {
            self.add(first + child);
        }
    }

    /// The average as it is kept.
    fn value(&self, c: &Cell) -> f32 {
        Tree::rounded(c.mean + c.ideal, f64::from(c.error) / self.volume(c.depth))
    }

    /// Characters of the value of a cell in a file, with the space before it.
    fn characters(&self, c: &Cell) -> usize {
        1 + Tree::text(self.value(c)).len()
    }

    /// The finished tree; children that are all leaves become one block.
    pub(super) fn tree(&self) -> Result<Tree, BsdfError> {
        let mut b = TreeBuilder::new(self.rank);
        self.emit(0, &mut b)?;
        b.finish()
    }

    fn emit(&self, index: u32, b: &mut TreeBuilder) -> Result<(), BsdfError> {
        let c = self.cells[index as usize];
        if c.children == LEAF {
            return b.block(&[self.value(&c)]);
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
                block[place] = self.value(k);
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
