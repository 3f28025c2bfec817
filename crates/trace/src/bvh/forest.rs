//! Which nodes of a binary tree become nodes of eight, and which leaves.

use obvhs::bvh2::Bvh2;

use super::node::{PACKET, WIDTH};

/// Cost of testing the boxes of a node, in tests of a packet of triangles.
const NODE: f32 = 0.8;

/// Least expected cost of every subtree of a binary tree, as at most `i` nodes or packets
/// [YlitieKarrasLaine2017, sec. 3: dynamic programming over surface areas].
pub(super) struct Forest {
    /// Triangles below each node.
    counts: Vec<u32>,
    /// `cost[n][i - 1]` of at most `i` nodes or packets, `i` up to 7; the least cost as one child first.
    cost: Vec<[f32; WIDTH - 1]>,
}

impl Forest {
    pub(super) fn new(tree: &Bvh2) -> Self {
        let mut forest = Forest {
            counts: vec![0; tree.nodes.len()],
            cost: vec![[0.0; WIDTH - 1]; tree.nodes.len()],
        };
        let mut order = vec![0_usize];
        let mut k = 0;
        while k < order.len() {
            let node = &tree.nodes[order[k]];
            if node.prim_count == 0 {
                order.extend([node.first_index as usize, node.first_index as usize + 1]);
            }
            k += 1;
        }
        for &k in order.iter().rev() {
            forest.weigh(tree, k);
        }
        forest
    }

    /// Whether the triangles below `k` are one packet.
    pub(super) fn is_packet(&self, k: usize) -> bool {
        self.counts[k] as usize <= PACKET
    }

    fn weigh(&mut self, tree: &Bvh2, k: usize) {
        let node = &tree.nodes[k];
        let area = node.aabb().half_area();
        let first = node.first_index as usize;
        if node.prim_count > 0 {
            self.counts[k] = node.prim_count;
            self.cost[k] = [area; WIDTH - 1];
            return;
        }
        self.counts[k] = self.counts[first] + self.counts[first + 1];
        let split = |i: usize| self.best_split(first, i).0;
        let mut cost = [0.0; WIDTH - 1];
        cost[0] = split(WIDTH) + NODE * area;
        if self.is_packet(k) {
            cost[0] = cost[0].min(area);
        }
        for i in 2..WIDTH {
            cost[i - 1] = cost[i - 2].min(split(i));
        }
        self.cost[k] = cost;
    }

    /// The cheapest way to share `i` places between `first` and its sibling: cost and places of `first`.
    fn best_split(&self, first: usize, i: usize) -> (f32, usize) {
        (1..i)
            .map(|left| {
                (
                    self.cost[first][left - 1] + self.cost[first + 1][i - left - 1],
                    left,
                )
            })
            .fold(
                (f32::INFINITY, 1),
                |best, one| if one.0 < best.0 { one } else { best },
            )
    }

    /// The children of the node of eight that stands for `k`: nodes of the binary tree.
    pub(super) fn children(&self, tree: &Bvh2, k: usize) -> Vec<usize> {
        let mut out = Vec::with_capacity(WIDTH);
        self.share(tree, tree.nodes[k].first_index as usize, WIDTH, &mut out);
        out
    }

    fn share(&self, tree: &Bvh2, first: usize, places: usize, out: &mut Vec<usize>) {
        let (_, left) = self.best_split(first, places);
        for (k, places) in [(first, left), (first + 1, places - left)] {
            self.roots(tree, k, places, out);
        }
    }

    /// Adds the at most `places` children that stand for `k`.
    fn roots(&self, tree: &Bvh2, k: usize, places: usize, out: &mut Vec<usize>) {
        let mut places = places;
        while places > 1 && self.cost[k][places - 1] == self.cost[k][places - 2] {
            places -= 1;
        }
        if places == 1 || tree.nodes[k].prim_count > 0 {
            out.push(k);
        } else {
            self.share(tree, tree.nodes[k].first_index as usize, places, out);
        }
    }

    /// Whether a child that stands for `k` is a packet rather than a node.
    pub(super) fn ends(&self, tree: &Bvh2, k: usize) -> bool {
        self.is_packet(k)
            && (tree.nodes[k].prim_count > 0 || self.cost[k][0] >= tree.nodes[k].aabb().half_area())
    }
}
