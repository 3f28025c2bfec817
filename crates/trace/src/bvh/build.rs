//! From triangles to nodes of eight.

use glam::Vec3A;
use obvhs::aabb::Aabb;
use obvhs::bvh2::Bvh2;
use obvhs::bvh2::builder::build_bvh2;
use obvhs::bvh2::node::Bvh2Node;
use obvhs::{Boundable, BvhBuildParams};

use super::few::pairs;
use super::forest::Forest;
use super::group::Few;
use super::memory::settled;
use super::node::{LEAF, NONE, Node, Packet, WIDTH};
use super::traverse::STACK;
use super::{Bvh, Triangles};

struct Bounds(Aabb);

impl Boundable for Bounds {
    fn aabb(&self) -> Aabb {
        self.0
    }
}

/// A tree of triangles of finite coordinates.
pub(super) fn build(triangles: &Triangles<'_>) -> Bvh {
    let bounds: Vec<Bounds> = (0..triangles.len())
        .map(|k| Bounds(Aabb::from_points(&triangles.corners(k).map(Vec3A::from_array))))
        .collect();
    if bounds.is_empty() {
        return Bvh {
            nodes: vec![Node::EMPTY],
            packets: Vec::new(),
            root: 0,
            extent: 0.0,
            few: None,
        };
    }
    let settings = BvhBuildParams {
        max_prims_per_leaf: 1,
        ..BvhBuildParams::medium_build()
    };
    let tree = build_bvh2(&bounds, settings, &mut std::time::Duration::default());
    let whole = *tree.nodes[0].aabb();
    // Many triangles in one place make chains, longer than the stack of a ray.
    let (nodes, packets, root) = Collapse::run(triangles, &tree)
        .or_else(|| Collapse::run(triangles, &halved(&bounds)))
        .unwrap_or_default();
    Bvh {
        nodes: settled(nodes),
        packets: settled(packets),
        root,
        extent: whole.min.abs().max(whole.max.abs()).max_element(),
        few: pairs(triangles).map(Few::new),
    }
}

/// A tree in which every node halves its triangles by their place along the longest axis: as deep as the logarithm of
/// their number, whatever their places.
fn halved(bounds: &[Bounds]) -> Bvh2 {
    let mut tree = Bvh2 {
        nodes: vec![Bvh2Node::new(Aabb::INVALID, 0, 0)],
        primitive_indices: (0..bounds.len() as u32).collect(),
        ..Bvh2::default()
    };
    let mut open = vec![(0, 0, bounds.len())];
    while let Some((node, start, end)) = open.pop() {
        let part = &mut tree.primitive_indices[start..end];
        let join = |all: Aabb, k: &u32| all.union(&bounds[*k as usize].0);
        let whole = part.iter().fold(Aabb::INVALID, join);
        if part.len() == 1 {
            tree.nodes[node] = Bvh2Node::new(whole, 1, start as u32);
            continue;
        }
        let size = whole.max - whole.min;
        let axis = (0..3).fold(0, |a, b| if size[b] > size[a] { b } else { a });
        let place = |k: &u32| bounds[*k as usize].0.min[axis] + bounds[*k as usize].0.max[axis];
        let half = part.len() / 2;
        part.select_nth_unstable_by(half, |a, b| place(a).total_cmp(&place(b)));
        let first = tree.nodes.len();
        tree.nodes.resize(first + 2, Bvh2Node::new(Aabb::INVALID, 0, 0));
        tree.nodes[node] = Bvh2Node::new(whole, 0, first as u32);
        open.extend([(first, start, start + half), (first + 1, start + half, end)]);
    }
    tree
}

/// Most levels of nodes: each leaves all but one of its children on the stack of a ray.
const DEEPEST: usize = (STACK - 1) / (WIDTH - 1);

struct Collapse<'a> {
    triangles: &'a Triangles<'a>,
    tree: &'a Bvh2,
    forest: Forest,
    nodes: Vec<Node>,
    packets: Vec<Packet>,
    too_deep: bool,
}

impl<'a> Collapse<'a> {
    /// Nodes, packets and root of a binary tree; `None` when they are too deep.
    fn run(triangles: &'a Triangles<'a>, tree: &'a Bvh2) -> Option<(Vec<Node>, Vec<Packet>, u32)> {
        let mut collapse = Collapse {
            triangles,
            tree,
            forest: Forest::new(tree),
            nodes: Vec::new(),
            packets: Vec::new(),
            too_deep: false,
        };
        let root = collapse.child(0, 1);
        (!collapse.too_deep).then_some((collapse.nodes, collapse.packets, root))
    }

    /// The node or packet for a node of the binary tree.
    fn child(&mut self, k: usize, depth: usize) -> u32 {
        if self.forest.ends(self.tree, k) {
            return self.packet(k);
        }
        if depth > DEEPEST {
            self.too_deep = true;
            return LEAF;
        }
        let index = self.nodes.len();
        self.nodes.push(Node::EMPTY);
        let open = self.forest.children(self.tree, k);
        let children: Vec<_> = open
            .into_iter()
            .map(|k| {
                let b = self.tree.nodes[k].aabb();
                (self.child(k, depth + 1), [b.min.to_array(), b.max.to_array()])
            })
            .collect();
        self.nodes[index] = Node::new(&children);
        index as u32
    }

    /// The triangles below a node of the binary tree as one packet.
    fn packet(&mut self, k: usize) -> u32 {
        let mut packet = Packet::EMPTY;
        let (mut open, mut lane) = (vec![k], 0);
        while let Some(k) = open.pop() {
            let node = &self.tree.nodes[k];
            let first = node.first_index as usize;
            if node.prim_count == 0 {
                open.extend([first, first + 1]);
                continue;
            }
            for place in first..first + node.prim_count as usize {
                let triangle = self.tree.primitive_indices[place];
                let corners = self.triangles.corners(triangle as usize);
                for (corner, rows) in corners.iter().zip(&mut packet.vertices) {
                    for (row, x) in rows.iter_mut().zip(corner) {
                        row[lane] = *x;
                    }
                }
                packet.triangle[lane] = triangle;
                lane += 1;
            }
        }
        debug_assert!(packet.triangle.iter().any(|t| *t != NONE));
        self.packets.push(packet);
        LEAF | (self.packets.len() - 1) as u32
    }
}
