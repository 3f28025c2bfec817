//! Nodes of eight boxes and packets of eight triangles, and the tests against them.

use super::ray::Prepared;

/// Children of a node.
pub(super) const WIDTH: usize = 8;
/// Triangles of a leaf.
pub(super) const PACKET: usize = 8;
/// Bit that tells a packet of triangles from a node.
pub(super) const LEAF: u32 = 1 << 31;
/// No triangle in a lane of a packet.
pub(super) const NONE: u32 = u32::MAX;

/// Eight child boxes on a grid of 256 steps an axis, axis by axis: minima in rows 0 to 2, maxima in 3 to 5. A box on the grid
/// holds the true one.
#[derive(Clone, Copy)]
#[repr(C, align(64))]
pub(super) struct Node {
    pub(super) origin: [f32; 3],
    /// Powers of two.
    pub(super) step: [f32; 3],
    /// Index of a node, or of a packet with [`LEAF`].
    pub(super) child: [u32; WIDTH],
    pub(super) bounds: [[u8; WIDTH]; 6],
}

/// Bounds of a child: minima and maxima.
pub(super) type Extent = [[f32; 3]; 2];

impl Node {
    /// A node without children: their boxes are inside out.
    pub(super) const EMPTY: Node = Node {
        origin: [0.0; 3],
        step: [1.0; 3],
        child: [LEAF; WIDTH],
        bounds: [[255; 8], [255; 8], [255; 8], [0; 8], [0; 8], [0; 8]],
    };

    /// The node of at most eight children and their boxes.
    pub(super) fn new(children: &[(u32, Extent)]) -> Self {
        let mut node = Node::EMPTY;
        for axis in 0..3 {
            let low = children
                .iter()
                .map(|c| c.1[0][axis])
                .fold(f32::INFINITY, f32::min);
            let high = children
                .iter()
                .map(|c| c.1[1][axis])
                .fold(f32::NEG_INFINITY, f32::max);
            let (origin, step) = grid(low, high);
            node.origin[axis] = origin;
            node.step[axis] = step;
            for (lane, (_, extent)) in children.iter().enumerate() {
                node.bounds[axis][lane] = below(origin, step, extent[0][axis]);
                node.bounds[axis + 3][lane] = above(origin, step, extent[1][axis]);
            }
        }
        for (lane, (child, _)) in children.iter().enumerate() {
            node.child[lane] = *child;
        }
        node
    }
}

/// Where step `q` of a grid lies: one rounding, as in the tests.
fn at(origin: f32, step: f32, q: u8) -> f32 {
    f32::from(q).mul_add(step, origin)
}

/// Origin and step of a grid whose 255 steps reach from `low` to `high`.
fn grid(low: f32, high: f32) -> (f32, f32) {
    // Never so small that all steps round to one place: the boxes of absent children would not be inside out.
    let least = (f32::EPSILON * low.abs().max(high.abs())).max(f32::MIN_POSITIVE);
    let wanted = ((high - low) / 255.0).max(least);
    let mut step = f32::from_bits(wanted.to_bits() & 0x7f80_0000).max(f32::MIN_POSITIVE);
    while at(low, step, 255) < high && step < 1e37 {
        step *= 2.0;
    }
    (low, step)
}

/// The last step that does not lie above `x`.
fn below(origin: f32, step: f32, x: f32) -> u8 {
    let mut q = ((x - origin) / step).floor().clamp(0.0, 255.0) as u8;
    while q > 0 && at(origin, step, q) > x {
        q -= 1;
    }
    q
}

/// The first step that does not lie below `x`.
fn above(origin: f32, step: f32, x: f32) -> u8 {
    let mut q = ((x - origin) / step).ceil().clamp(0.0, 255.0) as u8;
    while q < 255 && at(origin, step, q) < x {
        q += 1;
    }
    q
}

/// Eight triangles, coordinate by coordinate.
#[derive(Clone, Copy)]
#[repr(C, align(32))]
pub(super) struct Packet {
    /// `vertices[k][axis][lane]`.
    pub(super) vertices: [[[f32; PACKET]; 3]; 3],
    pub(super) triangle: [u32; PACKET],
}

impl Packet {
    /// Lanes without a triangle fail every comparison.
    pub(super) const EMPTY: Packet = Packet {
        vertices: [[[f32::NAN; PACKET]; 3]; 3],
        triangle: [NONE; PACKET],
    };
}

/// The lane of a packet that is hit.
#[derive(Clone, Copy)]
pub(super) struct LaneHit {
    pub(super) lane: usize,
    pub(super) t: f32,
    pub(super) u: f32,
    pub(super) v: f32,
}

/// A box is taken larger by this factor of the far distance: three roundings of half a unit in the last place each on
/// both planes, so that no box that a triangle reaches is missed.
pub(super) const WIDER: f32 = 1.0 + 6.0 * (0.5 * f32::EPSILON);

/// The two tests, for one instruction set.
pub(super) trait Tests {
    /// Bit mask of the children that the ray enters before `t_max`, and where it enters each.
    ///
    /// # Safety
    /// The processor has the instruction set.
    unsafe fn boxes(node: &Node, ray: &Prepared, t_max: f32, entry: &mut [f32; WIDTH]) -> u32;

    /// The nearest triangle of a packet between `ray.t_min` and `t_max`.
    ///
    /// # Safety
    /// The processor has the instruction set.
    unsafe fn triangles(packet: &Packet, ray: &Prepared, t_max: f32) -> Option<LaneHit>;
}

/// Any processor.
pub(super) struct Portable;

impl Tests for Portable {
    #[inline(always)]
    unsafe fn boxes(node: &Node, ray: &Prepared, t_max: f32, entry: &mut [f32; WIDTH]) -> u32 {
        let mut far = [t_max; WIDTH];
        *entry = [ray.t_min; WIDTH];
        for axis in 0..3 {
            let (near, beyond) = (
                &node.bounds[ray.near[axis]],
                &node.bounds[(ray.near[axis] + 3) % 6],
            );
            let distance = |q: u8, from: [f32; 3]| {
                (at(node.origin[axis], node.step[axis], q) - from[axis]) * ray.inverse[axis]
            };
            for k in 0..WIDTH {
                entry[k] = entry[k].max(distance(near[k], ray.from[0]));
                far[k] = far[k].min(distance(beyond[k], ray.from[1]));
            }
        }
        (0..WIDTH).fold(0, |mask, k| mask | (u32::from(entry[k] <= far[k] * WIDER) << k))
    }

    #[inline(always)]
    unsafe fn triangles(packet: &Packet, ray: &Prepared, t_max: f32) -> Option<LaneHit> {
        let mut best: Option<LaneHit> = None;
        for lane in 0..PACKET {
            let limit = best.as_ref().map_or(t_max, |b| b.t);
            if let Some((t, u, v)) = lane_hit(packet, lane, ray, limit) {
                best = Some(LaneHit { lane, t, u, v });
            }
        }
        best
    }
}

/// One triangle, after [WoopBenthinWald2013]: the corners are sheared until the ray is an axis, which rounds each corner the
/// same way in every triangle that has it, and the ray passes on one side or the other of each edge in that plane. The
/// signs of the edge functions are exact (products of single precision in double precision; the paper turns to double
/// precision only at zero), so neighbours agree about the edges and corners they share and no ray passes between them.
fn lane_hit(packet: &Packet, lane: usize, ray: &Prepared, t_max: f32) -> Option<(f32, f32, f32)> {
    if packet.triangle[lane] == NONE {
        return None;
    }
    let corner = |k: usize| {
        let at = |axis: usize| packet.vertices[k][axis][lane] - ray.origin[axis];
        let z = at(ray.along);
        let [x, y] = ray.across.map(at);
        [x - ray.shear[0] * z, y - ray.shear[1] * z, z]
    };
    let (a, b, c) = (corner(0), corner(1), corner(2));
    let edge = |p: [f32; 3], q: [f32; 3]| {
        let product = |x: f32, y: f32| f64::from(x) * f64::from(y);
        (product(p[0], q[1]) - product(p[1], q[0])) as f32
    };
    // Opposite to a, b and c.
    let (wa, wb, wc) = (edge(c, b), edge(a, c), edge(b, a));
    let least = wa.min(wb).min(wc);
    let most = wa.max(wb).max(wc);
    let sum = wa + wb + wc;
    if (least < 0.0 && most > 0.0) || sum == 0.0 {
        return None;
    }
    let t = ray.shear[2] * (wa * a[2] + wb * b[2] + wc * c[2]) / sum;
    (t >= ray.t_min && t <= t_max).then(|| (t, wb / sum, wc / sum))
}
