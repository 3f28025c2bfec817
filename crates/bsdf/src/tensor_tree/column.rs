//! Exact sampling over one cross-section of a tree: its cells with cumulative shares, and a guide into them.

use std::f64::consts::PI;
use std::ops::Deref;
use std::sync::OnceLock;

use super::lookup::Cell;
use super::mapping::{BITS, fixed};
use super::{Rank, Tree};

/// More incident cells than this are not kept: columns are then built for each sample.
const MAX_KEPT: usize = 1 << 16;

/// A cell that can be drawn.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Drawn {
    /// Share of the albedo in the cells up to and with this one.
    end: f64,
    /// Lower corner, fixed point.
    corner: [u32; 2],
    /// Value, 1/sr.
    pub(crate) value: f32,
    /// The side is two to the power of minus this.
    level: u8,
}

impl Drawn {
    /// The point `(a, b)` of the cell, both in `[0, 1)`, in the square.
    #[inline(always)]
    pub(crate) fn point(&self, a: f64, b: f64) -> (f64, f64) {
        const STEP: f64 = 1.0 / (1_u64 << BITS) as f64;
        let side = f64::from_bits((1023 - u64::from(self.level)) << 52);
        let [u, v] = self.corner.map(|c| f64::from(c) * STEP);
        (u + a * side, v + b * side)
    }
}

/// Cells over the free square in the order of their cumulative share.
#[derive(Debug, Default)]
pub(crate) struct Column {
    cells: Vec<Drawn>,
    /// First cell that ends past `k / len`: where a search for a share in `[k / len, (k + 1) / len)` begins.
    guide: Vec<u32>,
    /// `integral f cos dw` over the free square.
    pub(crate) albedo: f64,
}

impl Column {
    fn new(tree: &Tree, at: [f64; 2], reversed: bool) -> Self {
        let mut cells = Vec::new();
        let mut sum = 0.0;
        let mut visit = |c: Cell| {
            if c.value > 0.0 {
                sum += f64::from(c.value) * c.side * c.side;
                cells.push(Drawn {
                    end: sum,
                    corner: [c.u, c.v].map(fixed),
                    value: c.value,
                    // Sides are powers of two.
                    level: (1023 - (c.side.to_bits() >> 52)) as u8,
                });
            }
        };
        if reversed {
            tree.reversed_cross_section(at, &mut visit);
        } else {
            tree.cross_section(at, &mut visit);
        }
        let n = cells.len();
        let mut guide = Vec::with_capacity(n);
        for (k, cell) in cells.iter_mut().enumerate() {
            cell.end = if k + 1 == n { 1.0 } else { cell.end / sum };
            while (guide.len() as f64) < cell.end * n as f64 && guide.len() < n {
                guide.push(k as u32);
            }
        }
        Column {
            cells,
            guide,
            albedo: PI * sum,
        }
    }

    /// The cell at `share` in `[0, 1)` of the albedo; `None` without light.
    #[inline(always)]
    pub(crate) fn draw(&self, share: f64) -> Option<Drawn> {
        let bucket = ((share * self.guide.len() as f64) as usize).min(self.guide.len().checked_sub(1)?);
        let rest = self.cells.get(self.guide[bucket] as usize..)?;
        rest.iter().find(|c| c.end > share).or(self.cells.last()).copied()
    }
}

/// A column that is kept, or one of the moment.
pub(crate) enum Held<'a> {
    Kept(&'a Column),
    Own(Column),
}

impl Deref for Held<'_> {
    type Target = Column;
    #[inline(always)]
    fn deref(&self) -> &Column {
        match self {
            Held::Kept(c) => c,
            Held::Own(c) => c,
        }
    }
}

/// The columns of one component, by the cell of the fixed direction.
#[derive(Debug)]
pub(crate) struct Columns {
    log2: u32,
    dimensions: usize,
    kept: Vec<OnceLock<Column>>,
    reversed: bool,
}

impl Columns {
    /// Those over the exit square; `reversed`: over the incident square, rank 4 only.
    pub(crate) fn new(tree: &Tree, reversed: bool) -> Self {
        let log2 = u32::from(tree.depth());
        let dimensions = tree.rank().incident_dimensions();
        let bits = log2 as usize * dimensions;
        let none = reversed && tree.rank() == Rank::Three;
        let n = if bits <= 16 && !none { 1 << bits } else { 0 };
        let mut kept = Vec::new();
        if n <= MAX_KEPT {
            kept.resize_with(n, OnceLock::new);
        }
        Columns {
            log2,
            dimensions,
            kept,
            reversed,
        }
    }

    /// The column where the fixed direction has coordinates `at`; the second counts at rank 4.
    #[inline(always)]
    pub(crate) fn get(&self, tree: &Tree, at: [f64; 2]) -> Held<'_> {
        let shift = BITS - self.log2;
        let index = at[..self.dimensions]
            .iter()
            .fold(0, |n, x| n << self.log2 | (fixed(*x) >> shift) as usize);
        match self.kept.get(index) {
            Some(column) => Held::Kept(column.get_or_init(|| Column::new(tree, at, self.reversed))),
            None => Held::Own(Column::new(tree, at, self.reversed)),
        }
    }
}
