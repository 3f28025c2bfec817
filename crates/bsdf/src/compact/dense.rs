//! Logarithms of ratios laid out for interpolation: what one pair reads lies side by side.

use super::frame::Frame;
use super::symmetry::Axis;
use super::table::Quantised;

/// Numbers at a node.
const WIDTH: usize = 4;

/// The numbers at a node: one a channel; of a table of one channel those of the node, of the next along `p_h`, of the next
/// along `u` and of the next along both.
pub(super) type Node = [f32; WIDTH];

/// How positions along one axis become places in the table. An axis that goes round has its first node once more at its
/// end.
#[derive(Clone, Copy, Debug)]
struct Steps {
    /// Last node with another after it.
    last: i32,
    stride: i32,
}

impl Steps {
    /// Place of the node before `position` (in nodes), and how far it lies past it.
    #[inline(always)]
    fn bracket(self, position: f32) -> (i32, f32) {
        // NaN becomes 0
        let k = (position as i32).clamp(0, self.last);
        let t = position - k as f32;
        (k * self.stride, if t < 1.0 { t } else { 1.0 })
    }
}

/// Values ready to interpolate.
#[derive(Clone, Debug)]
pub(super) struct Dense {
    axes: [Steps; 4],
    channels: usize,
    /// Nodes along `u` and `p_h` together.
    plane: usize,
    /// The nodes of each four channels.
    groups: Vec<Vec<Node>>,
}

/// A table at one incidence.
pub(super) struct Slab(Vec<Vec<Node>>);

/// Where `N` pairs lie: the node before each, and the shares of the next along `x`, `p_i`, `u` and `p_h`.
pub(super) struct Places<const N: usize> {
    node: [i32; N],
    share: [[f32; N]; 4],
}

impl Dense {
    pub(super) fn new(frame: &Frame, quantised: &Quantised, channels: usize) -> Self {
        let n = frame.shape;
        let round = [0, 1, 2, 3].map(|k| frame.axis(k) == Axis::Round);
        let kept = [0, 1, 2, 3].map(|k| n[k] + usize::from(round[k]));
        let stride = |k: usize| kept[k + 1..].iter().product::<usize>();
        let axes = [0, 1, 2, 3].map(|k| Steps {
            last: kept[k].saturating_sub(2) as i32,
            stride: if kept[k] > 1 { stride(k) as i32 } else { 0 },
        });
        let values = quantised.values(frame);
        let value = |c: usize, at: [usize; 4]| {
            let node = (0..4).fold(0, |sum, k| {
                let place = if round[k] {
                    at[k] % n[k]
                } else {
                    at[k].min(n[k] - 1)
                };
                sum * n[k] + place
            });
            values[c * frame.len() + node] as f32
        };
        let total: usize = kept.iter().product();
        let groups = (0..channels.div_ceil(WIDTH))
            .map(|group| {
                let nodes = (0..total).map(|k| {
                    let at = [0, 1, 2, 3].map(|a| k / stride(a) % kept[a]);
                    let next = |u: usize, p: usize| value(0, [at[0], at[1], at[2] + u, at[3] + p]);
                    if channels == 1 {
                        return [next(0, 0), next(0, 1), next(1, 0), next(1, 1)];
                    }
                    let mut node = [0.0; WIDTH];
                    for (v, c) in node.iter_mut().zip(group * WIDTH..channels) {
                        *v = value(c, at);
                    }
                    node
                });
                nodes.collect()
            })
            .collect();
        Dense {
            axes,
            channels,
            plane: kept[2] * kept[3],
            groups,
        }
    }

    /// Nodes of a slab.
    pub(super) fn plane(&self) -> usize {
        self.plane
    }

    /// The table at the incidence of position `x` and `p_i` (in nodes).
    pub(super) fn slab(&self, x: f32, p_i: f32) -> Slab {
        let [(x, tx), (i, ti)] = [self.axes[0].bracket(x), self.axes[1].bracket(p_i)];
        let [sx, si] = [self.axes[0].stride, self.axes[1].stride];
        let of = |nodes: &Vec<Node>| {
            (0..self.plane as i32)
                .map(|k| {
                    let at = |by: i32| node(nodes, x + i + k + by);
                    mix(mix(at(0), at(si), ti), mix(at(sx), at(sx + si), ti), tx)
                })
                .collect()
        };
        Slab(self.groups.iter().map(of).collect())
    }

    /// Places of positions (in nodes, one row an axis), in the table or (`D` of 2) in a slab.
    #[inline(always)]
    #[expect(
        clippy::needless_range_loop,
        reason = "loops over lanes of several arrays, which vectorise as they are"
    )]
    pub(super) fn places<const D: usize, const N: usize>(&self, positions: &[[f32; N]; 4]) -> Places<N> {
        let mut places = Places {
            node: [0; N],
            share: [[0.0; N]; 4],
        };
        for k in 0..4 {
            if (D == 2 && k < 2) || (D == 3 && k == 1) {
                continue;
            }
            let axis = self.axes[k];
            for l in 0..N {
                let (node, t) = axis.bracket(positions[k][l]);
                places.node[l] += node;
                places.share[k][l] = t;
            }
        }
        places
    }

    /// Logarithms of the channels of group `group` (four each), one row a channel; `D` is 2 with a slab, without one the rank of
    /// the table.
    #[inline(always)]
    pub(super) fn interpolate<const D: usize, const N: usize>(
        &self,
        group: usize,
        slab: Option<&Slab>,
        places: &Places<N>,
        out: &mut [[f32; N]; WIDTH],
    ) {
        let nodes = match slab {
            Some(slab) => &slab.0[group],
            None => &self.groups[group],
        };
        let mut found = [[0.0; WIDTH]; N];
        let [tx, ti, tu, tp] = &places.share;
        let [sx, si, su, _] = self.axes.map(|a| a.stride);
        if self.channels == 1 {
            for l in 0..N {
                let at = |by: i32| node(nodes, places.node[l] + by);
                found[l] = match D {
                    2 => at(0),
                    3 => mix(at(0), at(sx), tx[l]),
                    _ => mix(mix(at(0), at(si), ti[l]), mix(at(sx), at(sx + si), ti[l]), tx[l]),
                };
            }
            for l in 0..N {
                let [a, b, c, d] = found[l];
                let (near, far) = (a + tp[l] * (b - a), c + tp[l] * (d - c));
                out[0][l] = near + tu[l] * (far - near);
            }
            return;
        }
        for l in 0..N {
            let at = |by: i32| two(nodes, places.node[l] + by);
            let edge = |by: i32| mix(at(by), at(by + su), tu[l]);
            let both = match D {
                2 => edge(0),
                3 => mix(edge(0), edge(sx), tx[l]),
                _ => mix(
                    mix(edge(0), edge(si), ti[l]),
                    mix(edge(sx), edge(sx + si), ti[l]),
                    tx[l],
                ),
            };
            for c in 0..WIDTH {
                found[l][c] = both[c] + tp[l] * (both[c + WIDTH] - both[c]);
            }
        }
        for c in 0..WIDTH {
            for l in 0..N {
                out[c][l] = found[l][c];
            }
        }
    }
}

#[inline(always)]
fn node(nodes: &[Node], at: i32) -> Node {
    nodes.get(at as usize).copied().unwrap_or([0.0; WIDTH])
}

/// A node and the next along `p_h`.
#[inline(always)]
fn two(nodes: &[Node], at: i32) -> [f32; 2 * WIDTH] {
    let values = nodes.as_flattened().get(WIDTH * at as usize..);
    values
        .and_then(|v| v.first_chunk())
        .copied()
        .unwrap_or([0.0; 2 * WIDTH])
}

#[inline(always)]
fn mix<const W: usize>(a: [f32; W], b: [f32; W], t: f32) -> [f32; W] {
    let mut out = a;
    for c in 0..W {
        out[c] = a[c] + t * (b[c] - a[c]);
    }
    out
}
