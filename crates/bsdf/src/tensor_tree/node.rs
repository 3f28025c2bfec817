//! Compact storage of one component's tree.

use crate::BsdfError;
use crate::klems::check_values;

/// Deepest cell a tree may have: cells of side `2^-20` are far below any instrument's resolution.
pub const MAX_DEPTH: u8 = 20;

/// Number of dimensions of a tree.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Rank {
    /// Isotropic: incident polar angle, exit square.
    Three,
    /// Anisotropic: incident square, exit square.
    Four,
}

impl Rank {
    /// 3 or 4.
    pub fn dimensions(self) -> usize {
        match self {
            Rank::Three => 3,
            Rank::Four => 4,
        }
    }

    /// Number of dimensions of the incident direction: 1 or 2. They come first.
    pub fn incident_dimensions(self) -> usize {
        self.dimensions() - 2
    }

    /// Children of a branch: 8 or 16.
    pub fn children(self) -> usize {
        1 << self.dimensions()
    }
}

/// A node of a [`Tree`].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Node {
    /// `2^rank` children from index `first` on; bit `k` of a child's place is the upper half of dimension `k`.
    Branch {
        /// Index of the first child in [`Tree::nodes`].
        first: u32,
    },
    /// A block of `2^log2_side` cells along each dimension; dimension 0 is slowest.
    Block {
        /// Index of the first value in [`Tree::values`].
        first: u32,
        /// Logarithm of the side: 0 is a single value.
        log2_side: u8,
    },
}

/// One component as a tree of cells of equal projected solid angle, each with a constant value in 1/sr (single
/// precision, as Radiance keeps them). Node 0 is the root.
#[derive(Clone, Debug, PartialEq)]
pub struct Tree {
    rank: Rank,
    nodes: Vec<Node>,
    values: Vec<f32>,
    depth: u8,
}

impl Tree {
    /// The shortest text of a value that Radiance reads back as the same number: no zero before the point.
    pub fn text(v: f32) -> String {
        if v == 0.0 || (1e-3..1e6).contains(&v) {
            let text = v.to_string();
            match text.strip_prefix("0.") {
                Some(rest) => format!(".{rest}"),
                None => text,
            }
        } else {
            format!("{v:e}")
        }
    }

    /// `v` with so many significant digits, two to five, that rounding takes less than a twentieth of `spread`.
    pub fn rounded(v: f32, spread: f64) -> f32 {
        if v == 0.0 {
            return 0.0;
        }
        let v = f64::from(v);
        let leading = v.abs().log10().floor();
        let least = if spread > 0.0 {
            (0.1 * spread).log10().floor()
        } else {
            f64::NEG_INFINITY
        };
        let digits = (leading - least).clamp(1.0, 4.0) as i32 - leading as i32;
        let scale = 10f64.powi(digits.abs());
        (if digits >= 0 {
            (v * scale).round() / scale
        } else {
            (v / scale).round() * scale
        }) as f32
    }

    /// The rank.
    pub fn rank(&self) -> Rank {
        self.rank
    }

    /// The nodes; the root is the first.
    pub fn nodes(&self) -> &[Node] {
        &self.nodes
    }

    /// The values of all blocks, 1/sr.
    pub fn values(&self) -> &[f32] {
        &self.values
    }

    /// Depth of the finest cell: its side is `2^-depth` of the square's.
    pub fn depth(&self) -> u8 {
        self.depth
    }

    /// Number of cells.
    pub fn len(&self) -> usize {
        self.values.len()
    }

    /// Whether there is no cell (never, by construction).
    pub fn is_empty(&self) -> bool {
        self.values.is_empty()
    }
}

/// Builds a [`Tree`] in the order a file has it: a branch before its children, children in order.
#[derive(Debug)]
pub struct TreeBuilder {
    rank: Rank,
    nodes: Vec<Node>,
    values: Vec<f32>,
    /// Open branches: index of the first child and how many children are there.
    open: Vec<(u32, usize)>,
    depth: u8,
    done: bool,
}

impl TreeBuilder {
    /// An empty builder.
    pub fn new(rank: Rank) -> Self {
        TreeBuilder {
            rank,
            nodes: Vec::new(),
            values: Vec::new(),
            open: Vec::new(),
            depth: 0,
            done: false,
        }
    }

    fn place(&mut self, node: Node) -> Result<(), BsdfError> {
        if self.done {
            return Err(structure("a node after the root was complete", "one root"));
        }
        match self.open.last_mut() {
            None => self.nodes.push(node),
            Some((first, filled)) => {
                if *filled == self.rank.children() {
                    return Err(structure(
                        "one more child than a branch has",
                        &format!("{} children", self.rank.children()),
                    ));
                }
                self.nodes[*first as usize + *filled] = node;
                *filled += 1;
            }
        }
        Ok(())
    }

    /// Starts a branch; its children follow.
    ///
    /// # Errors
    /// [`BsdfError::Domain`] when the tree is complete, the parent is full or the branch lies deeper than
    /// [`MAX_DEPTH`].
    pub fn branch(&mut self) -> Result<(), BsdfError> {
        if self.open.len() >= usize::from(MAX_DEPTH) {
            return Err(structure("a deeper tree", &format!("at most {MAX_DEPTH} levels")));
        }
        let root = usize::from(self.nodes.is_empty());
        let first = u32::try_from(self.nodes.len() + root)
            .ok()
            .filter(|f| *f < u32::MAX - 16)
            .ok_or_else(|| structure("more nodes", "fewer than 2^32"))?;
        self.place(Node::Branch { first })?;
        let empty = Node::Block {
            first: 0,
            log2_side: 0,
        };
        self.nodes.resize(self.nodes.len() + self.rank.children(), empty);
        self.open.push((first, 0));
        Ok(())
    }

    /// Ends the innermost branch.
    ///
    /// # Errors
    /// [`BsdfError::Domain`] when no branch is open or it lacks children.
    pub fn end(&mut self) -> Result<(), BsdfError> {
        let wanted = self.rank.children();
        match self.open.pop() {
            Some((_, filled)) if filled == wanted => {}
            Some((_, filled)) => {
                return Err(structure(
                    &format!("a branch of {filled} children"),
                    &format!("{wanted} children"),
                ));
            }
            None => return Err(structure("an end without a branch", "matching braces")),
        }
        self.done = self.open.is_empty();
        Ok(())
    }

    /// Adds a block of `2^(rank k)` values, dimension 0 slowest.
    ///
    /// # Errors
    /// [`BsdfError::Domain`] when the number of values is no such power, a value is negative or not finite, or there
    /// is no place for the block.
    pub fn block(&mut self, values: &[f32]) -> Result<(), BsdfError> {
        let d = self.rank.dimensions();
        let log2_side = (0..=MAX_DEPTH / 2)
            .find(|k| values.len() == 1usize << (usize::from(*k) * d))
            .ok_or_else(|| {
                structure(
                    &format!("a block of {} values", values.len()),
                    &format!("1, {}, {} or a higher power", 1 << d, 1 << (2 * d)),
                )
            })?;
        check_values(values)?;
        let first =
            u32::try_from(self.values.len()).map_err(|_| structure("more values", "fewer than 2^32"))?;
        self.place(Node::Block { first, log2_side })?;
        self.values.extend_from_slice(values);
        let depth = self.open.len() + usize::from(log2_side);
        self.depth = self.depth.max(depth.min(255) as u8);
        self.done = self.open.is_empty();
        Ok(())
    }

    /// The finished tree.
    ///
    /// # Errors
    /// [`BsdfError::Domain`] when a branch is still open or nothing was added.
    pub fn finish(self) -> Result<Tree, BsdfError> {
        if !self.done {
            return Err(structure("an unfinished tree", "a complete one"));
        }
        Ok(Tree {
            rank: self.rank,
            nodes: self.nodes,
            values: self.values,
            depth: self.depth,
        })
    }
}

fn structure(found: &str, allowed: &str) -> BsdfError {
    BsdfError::Domain {
        field: "tensor tree",
        found: found.into(),
        allowed: allowed.into(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_branch_needs_all_its_children() {
        let mut b = TreeBuilder::new(Rank::Three);
        b.branch().unwrap();
        for _ in 0..7 {
            b.block(&[0.5]).unwrap();
        }
        assert!(b.end().is_err());
    }

    #[test]
    fn a_block_needs_a_power_of_its_side() {
        let mut b = TreeBuilder::new(Rank::Four);
        assert!(b.block(&[0.1; 8]).is_err());
        b.block(&[0.1; 16]).unwrap();
        assert!(b.block(&[0.1]).is_err());
        let t = b.finish().unwrap();
        assert_eq!((t.depth(), t.len()), (1, 16));
    }

    #[test]
    fn a_tree_without_end_is_refused() {
        let mut b = TreeBuilder::new(Rank::Three);
        for _ in 0..MAX_DEPTH {
            b.branch().unwrap();
        }
        assert!(b.branch().is_err());
        assert!(b.finish().is_err());
        assert!(TreeBuilder::new(Rank::Three).finish().is_err());
    }
}
