//! Trees from averages over equal cells that are known with an error: cells become one where that is nearer to the truth.

mod energy;
#[cfg(test)]
mod tests;

use std::cmp::Ordering;
use std::collections::BinaryHeap;

use gonio_bsdf::BsdfError;
use gonio_bsdf::tensor_tree::{Rank, Tree, TreeBuilder};

/// Averages over all cells of side `2^-log2`, dimension 0 slowest.
#[derive(Clone, Debug)]
pub(super) struct Averages {
    /// Rank of the tree.
    pub(super) rank: Rank,
    /// Cells along each dimension are two to the power of this.
    pub(super) log2: u8,
    /// Averages, 1/sr.
    pub(super) values: Vec<f32>,
    /// Squares of their standard errors, estimates without bias.
    pub(super) variances: Vec<f32>,
    /// Whether a cell and the one with incidence and exit exchanged hold one and the same average (rank 4).
    pub(super) reciprocal: bool,
}

/// How cells are merged.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PruneOptions {
    /// Cells that differ by more than their errors are merged too, the most alike first, until the differences add up to this share
    /// of all values.
    pub tolerance: f64,
    /// And further until there are no more cells than this.
    pub max_cells: usize,
}

/// A tree that cells were merged to.
#[derive(Clone, Debug)]
pub struct Pruned {
    /// The averages.
    pub tree: Tree,
    /// Their standard errors in the same cells.
    pub errors: Tree,
    /// Mean of all values in use, 1/sr.
    pub mean: f64,
    /// Root mean square of the deviations from the truth over the fine cells that are used, estimated, 1/sr: by the errors of the
    /// averages and by what merging makes equal.
    pub deviation: f64,
    /// Differences of the values that were merged beyond their errors, as a share of all values, at most.
    pub merged: f64,
}

/// Sums over the fine cells of a node.
#[derive(Clone, Copy, Debug, Default)]
struct Node {
    sum: f64,
    squares: f64,
    variance: f64,
    /// Of the best tree below.
    risk: f64,
    split: bool,
}

/// Nodes by depth and Morton code: children of `k` begin at `k << dimensions`.
struct Pyramid {
    dimensions: usize,
    log2: usize,
    reciprocal: bool,
    /// Down to the depth above the fine cells.
    levels: Vec<Vec<Node>>,
    /// Fine cells.
    fine: Vec<(f32, f32)>,
}

/// Merges cells where one value for all of them is expected to be nearer to the truth than their own values, by the unbiased estimate
/// of the squared error [Stein1981] for averages: the children of a cell stay where
/// `sum (v - m)^2 > (2 - 2 / n) sum variance`, or where theirs do. Then, the most alike first, as `options` say. What adds up over
/// many exits is looked at in the end: cells are split again until the energy that each incidence sends out, and at rank 4 what each
/// exit would, is that of its averages within [`energy::ENERGY`] standard errors and the tolerance, as far as the number of cells allows.
///
/// # Errors
/// [`BsdfError::Domain`] for other than `2^(rank log2)` values and variances, none below 0, and `log2` above 6.
pub(super) fn prune(averages: &Averages, options: &PruneOptions) -> Result<Pruned, BsdfError> {
    let d = averages.rank.dimensions();
    let log2 = usize::from(averages.log2);
    let domain = |field, found: String, allowed: String| BsdfError::Domain {
        field,
        found,
        allowed,
    };
    if !(1..=6).contains(&log2) {
        return Err(domain("log2", log2.to_string(), "1 to 6".into()));
    }
    let n = 1usize << (d * log2);
    for (field, list) in [("values", &averages.values), ("variances", &averages.variances)] {
        if list.len() != n {
            return Err(domain(field, list.len().to_string(), n.to_string()));
        }
        if let Some(bad) = list.iter().find(|x| !(x.is_finite() && **x >= 0.0)) {
            return Err(domain(field, bad.to_string(), "0 or more".into()));
        }
    }
    let mut pyramid = Pyramid::new(averages);
    let merged = pyramid.merge(options);
    pyramid.keep_energy(options);
    let mut trees = [TreeBuilder::new(averages.rank), TreeBuilder::new(averages.rank)];
    let mut risk = 0.0;
    pyramid.emit(0, 0, &mut trees, &mut risk)?;
    let [tree, errors] = trees;
    // At rank 3 half of them is empty.
    let used = match averages.rank {
        Rank::Three => 0.5 * n as f64,
        Rank::Four => n as f64,
    };
    Ok(Pruned {
        tree: tree.finish()?,
        errors: errors.finish()?,
        mean: pyramid.levels[0][0].sum / used,
        deviation: (risk / used).sqrt(),
        merged,
    })
}

impl Pyramid {
    fn new(averages: &Averages) -> Self {
        let d = averages.rank.dimensions();
        let log2 = usize::from(averages.log2);
        let spread: Vec<usize> = (0..1usize << log2)
            .map(|x| (0..log2).map(|b| (x >> b & 1) << (b * d)).sum())
            .collect();
        let mask = (1usize << log2) - 1;
        let mut fine = vec![(0.0, 0.0); averages.values.len()];
        for (place, pair) in averages.values.iter().zip(&averages.variances).enumerate() {
            let code: usize = (0..d)
                .map(|k| spread[place >> (log2 * (d - 1 - k)) & mask] << k)
                .sum();
            fine[code] = (*pair.0, *pair.1);
        }
        let mut pyramid = Pyramid {
            dimensions: d,
            log2,
            reciprocal: averages.reciprocal && averages.rank == Rank::Four,
            levels: vec![Vec::new(); log2],
            fine,
        };
        for depth in (0..log2).rev() {
            let nodes = (0..1usize << (d * depth))
                .map(|k| pyramid.node(depth, k))
                .collect();
            pyramid.levels[depth] = nodes;
        }
        pyramid
    }

    /// A node over children that are known: whether they stay.
    fn node(&self, depth: usize, code: usize) -> Node {
        let mut node = Node::default();
        let mut below = 0.0;
        for k in self.children(code) {
            let child = self.at(depth + 1, k);
            node.sum += child.sum;
            node.squares += child.squares;
            node.variance += child.variance;
            below += child.risk;
        }
        let alone = self.risk(depth, code, &node);
        node.split = below < alone;
        node.risk = below.min(alone);
        node
    }

    fn children(&self, code: usize) -> std::ops::Range<usize> {
        code << self.dimensions..(code + 1) << self.dimensions
    }

    fn at(&self, depth: usize, code: usize) -> Node {
        if depth < self.log2 {
            return self.levels[depth][code];
        }
        let (value, variance) = self.fine[code];
        let (value, variance) = (f64::from(value), f64::from(variance));
        Node {
            sum: value,
            squares: value * value,
            variance,
            risk: variance,
            split: false,
        }
    }

    /// Fine cells in a node.
    fn size(&self, depth: usize) -> f64 {
        (1u64 << (self.dimensions * (self.log2 - depth))) as f64
    }

    /// How often each independent average is in a node.
    fn copies(&self, depth: usize, code: usize) -> f64 {
        // Where the exit is the turned incidence, whose coordinates are those of the other end of the square.
        let itself = || (0..depth).all(|b| (code >> (4 * b) ^ code >> (4 * b + 2)) & 3 == 3);
        if self.reciprocal && depth < self.log2 && itself() {
            2.0
        } else {
            1.0
        }
    }

    /// Expected sum of squared deviations from the truth, of one value for all of a node.
    fn risk(&self, depth: usize, code: usize, node: &Node) -> f64 {
        let n = self.size(depth);
        let scatter = (node.squares - node.sum * node.sum / n).max(0.0);
        let own = self.copies(depth, code) * node.variance / n;
        scatter - node.variance + 2.0 * own
    }

    /// Merges what differs least; the differences as a share of all values.
    fn merge(&mut self, options: &PruneOptions) -> f64 {
        let total: f64 = self.levels[0][0].sum;
        let mut leaves = 1;
        let mut queue = BinaryHeap::new();
        let mut walk = vec![(0, 0)];
        while let Some((depth, code)) = walk.pop() {
            if !self.at(depth, code).split {
                continue;
            }
            leaves += (1 << self.dimensions) - 1;
            walk.extend(self.children(code).map(|k| (depth + 1, k)));
            queue.extend(self.alike(depth, code));
        }
        let mut sum = 0.0;
        while let Some(next) = queue.pop() {
            let share = (sum + next.cost) / total.max(f64::MIN_POSITIVE);
            if leaves <= options.max_cells && share > options.tolerance {
                break;
            }
            sum += next.cost;
            leaves -= (1 << self.dimensions) - 1;
            self.levels[next.depth][next.code].split = false;
            if next.depth > 0 {
                queue.extend(self.alike(next.depth - 1, next.code >> self.dimensions));
            }
        }
        if total > 0.0 { sum / total } else { 0.0 }
    }

    /// A node whose children are all leaves, to be merged.
    fn alike(&self, depth: usize, code: usize) -> Option<Alike> {
        let children = || self.children(code).map(|k| self.at(depth + 1, k));
        if children().any(|c| c.split) {
            return None;
        }
        let mean = self.at(depth, code).sum / (1 << self.dimensions) as f64;
        let cost = children().map(|c| (c.sum - mean).abs()).sum();
        Some(Alike { cost, depth, code })
    }

    /// Value and standard error of a leaf.
    fn leaf(&self, depth: usize, code: usize, risk: &mut f64) -> [f32; 2] {
        let node = self.at(depth, code);
        let n = self.size(depth);
        let own = self.copies(depth, code) * node.variance / n;
        *risk += self.risk(depth, code, &node).max(own);
        let error = (own / n).sqrt();
        [
            Tree::rounded((node.sum / n) as f32, error),
            Tree::rounded(error as f32, error),
        ]
    }

    fn emit(
        &self,
        depth: usize,
        code: usize,
        trees: &mut [TreeBuilder; 2],
        risk: &mut f64,
    ) -> Result<(), BsdfError> {
        if !self.at(depth, code).split {
            let values = self.leaf(depth, code, risk);
            return (0..2).try_for_each(|t| trees[t].block(&[values[t]]));
        }
        let d = self.dimensions;
        if self.children(code).all(|k| !self.at(depth + 1, k).split) {
            let mut blocks = [[0f32; 16]; 2];
            for (child, k) in self.children(code).enumerate() {
                let values = self.leaf(depth + 1, k, risk);
                // Places of children have dimension 0 lowest, blocks have it slowest.
                let place = (0..d).fold(0, |p, k| p | (child >> k & 1) << (d - 1 - k));
                (0..2).for_each(|t| blocks[t][place] = values[t]);
            }
            return (0..2).try_for_each(|t| trees[t].block(&blocks[t][..1 << d]));
        }
        trees.iter_mut().try_for_each(TreeBuilder::branch)?;
        for k in self.children(code) {
            self.emit(depth + 1, k, trees, risk)?;
        }
        trees.iter_mut().try_for_each(TreeBuilder::end)
    }
}

/// A node that may be merged: the cheapest is the greatest.
struct Alike {
    cost: f64,
    depth: usize,
    code: usize,
}

impl PartialEq for Alike {
    fn eq(&self, other: &Self) -> bool {
        self.cmp(other) == Ordering::Equal
    }
}
impl Eq for Alike {}
impl PartialOrd for Alike {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}
impl Ord for Alike {
    fn cmp(&self, other: &Self) -> Ordering {
        let order = other.cost.total_cmp(&self.cost);
        order.then((other.depth, other.code).cmp(&(self.depth, self.code)))
    }
}
