//! The top of a tree laid out flat, so that most lookups are one.

use super::mapping::BITS;
use super::{Node, Rank, Tree};

/// Marks an entry that refers to [`Grid::finer`]; values have no sign.
const FINER: u32 = 1 << 31;
/// Levels of the flat part: 2^21 entries at rank 3, 2^20 at rank 4, both in a few megabytes.
const MOST: [u8; 2] = [7, 5];

/// What every cell of a regular grid holds: a value, or where in the tree to go on.
#[derive(Debug)]
pub(crate) struct Grid {
    log2: u32,
    dimensions: usize,
    entries: Vec<u32>,
    /// Nodes that are finer than the grid, with their levels.
    finer: Vec<(u32, u8)>,
}

impl Grid {
    pub(crate) fn new(tree: &Tree) -> Self {
        let most = match tree.rank() {
            Rank::Three => MOST[0],
            Rank::Four => MOST[1],
        };
        let log2 = tree.depth().min(most);
        let dimensions = tree.rank().dimensions();
        let mut grid = Grid {
            log2: u32::from(log2),
            dimensions,
            entries: vec![0; 1 << (usize::from(log2) * dimensions)],
            finer: Vec::new(),
        };
        let mut stack = vec![(0_u32, 0_u8, [0_usize; 4])];
        while let Some((index, level, corner)) = stack.pop() {
            match tree.nodes()[index as usize] {
                Node::Branch { first } if level < log2 => {
                    let half = 1 << (log2 - level - 1);
                    for child in 0..tree.rank().children() {
                        let mut at = corner;
                        for (k, c) in at.iter_mut().take(dimensions).enumerate() {
                            *c += half * (child >> k & 1);
                        }
                        stack.push((first + child as u32, level + 1, at));
                    }
                }
                Node::Block { first, log2_side } if level + log2_side <= log2 => {
                    let values = &tree.values()[first as usize..];
                    grid.spread(values, log2_side, log2 - level - log2_side, corner);
                }
                _ => {
                    let entry = FINER | grid.finer.len() as u32;
                    grid.finer.push((index, level));
                    grid.fill(corner, 1 << (log2 - level), entry);
                }
            }
        }
        grid
    }

    /// The values of a block of side `2^log2_side` from `corner` on, each over a cube of side `2^log2_cell`.
    fn spread(&mut self, values: &[f32], log2_side: u8, log2_cell: u8, corner: [usize; 4]) {
        let d = self.dimensions;
        let mask = (1_usize << log2_side) - 1;
        for (k, value) in values[..1 << (usize::from(log2_side) * d)].iter().enumerate() {
            let mut at = corner;
            for (j, c) in at.iter_mut().take(d).enumerate() {
                *c += (k >> (usize::from(log2_side) * (d - 1 - j)) & mask) << log2_cell;
            }
            // Minus zero is a value without its sign, too.
            self.fill(at, 1 << log2_cell, value.abs().to_bits());
        }
    }

    /// Sets the cube of `side` entries from `corner` on.
    fn fill(&mut self, corner: [usize; 4], side: usize, entry: u32) {
        let (d, log2) = (self.dimensions, self.log2 as usize);
        for row in 0..side.pow(d as u32 - 1) {
            let (mut rest, mut index) = (row, 0);
            for (k, c) in corner.iter().take(d - 1).enumerate().rev() {
                index |= (c + rest % side) << (log2 * (d - 1 - k));
                rest /= side;
            }
            index |= corner[d - 1];
            self.entries[index..index + side].fill(entry);
        }
    }

    /// The value of the cell of `tree` that holds fixed-point coordinates.
    #[inline(always)]
    pub(crate) fn value<const D: usize>(&self, tree: &Tree, position: [u32; D]) -> f32 {
        let shift = BITS - self.log2;
        let index = position
            .iter()
            .fold(0, |n, p| n << self.log2 | (p >> shift) as usize);
        let entry = self.entries[index];
        if entry & FINER == 0 {
            return f32::from_bits(entry);
        }
        let (node, level) = self.finer[(entry & !FINER) as usize];
        tree.descend(node as usize, u32::from(level), position)
    }
}
