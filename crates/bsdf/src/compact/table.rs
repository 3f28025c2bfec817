//! Quantised logarithms of ratios, and their interpolation.

use crate::BsdfError;

use super::domain;
use super::frame::{Axis, Frame};

/// Codes of 8 or 16 bits, `[channel][x][p_i][u][p_h]`.
#[derive(Clone, Debug, PartialEq)]
pub enum Codes {
    /// One byte each.
    Eight(Vec<i8>),
    /// Two bytes each.
    Sixteen(Vec<i16>),
}

impl Codes {
    /// Number of codes.
    pub fn len(&self) -> usize {
        match self {
            Codes::Eight(v) => v.len(),
            Codes::Sixteen(v) => v.len(),
        }
    }

    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// Bits of a code.
    pub fn bits(&self) -> u32 {
        match self {
            Codes::Eight(_) => 8,
            Codes::Sixteen(_) => 16,
        }
    }

    fn at(&self, k: usize) -> f64 {
        match self {
            Codes::Eight(v) => f64::from(v[k]),
            Codes::Sixteen(v) => f64::from(v[k]),
        }
    }
}

/// Largest logarithm of a ratio that a table may hold, either sign.
pub const LARGEST: f64 = 30.0;

/// Logarithms of ratios at the nodes of a frame: `offset + step code`, one offset and step for each channel and `x`.
#[derive(Clone, Debug, PartialEq)]
pub struct Quantised {
    /// The codes.
    pub codes: Codes,
    /// `[channel][x]`.
    pub offset: Vec<f32>,
    /// `[channel][x]`, positive or 0.
    pub step: Vec<f32>,
}

impl Quantised {
    /// Quantises `values` (`[channel][node]`, of `frame`) to 8 or 16 `bits`: the range of each channel and `x` is divided
    /// evenly, and values are within half a step. Values beyond [`LARGEST`] are drawn to it.
    ///
    /// # Errors
    /// [`BsdfError::Domain`] for other numbers of bits, and values that are not as many as the frame says or not finite.
    pub fn of(frame: &Frame, values: &[f64], bits: u32) -> Result<Self, BsdfError> {
        frame.check()?;
        let row = frame.len() / frame.shape[0];
        if values.is_empty() || !values.len().is_multiple_of(frame.len()) {
            let allowed = format!("a multiple of {} nodes", frame.len());
            return Err(domain("values", format!("{} values", values.len()), allowed));
        }
        if let Some(bad) = values.iter().find(|v| !v.is_finite()) {
            return Err(domain("values", bad.to_string(), "finite numbers"));
        }
        let half = match bits {
            8 => 127.0,
            16 => 32767.0,
            _ => return Err(domain("bits", bits.to_string(), "8 or 16")),
        };
        let (mut offset, mut step, mut codes) = (Vec::new(), Vec::new(), Vec::new());
        for row in values.chunks(row) {
            let drawn = row.iter().map(|v| v.clamp(-LARGEST, LARGEST));
            let (low, high) = drawn
                .clone()
                .fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), v| {
                    (a.min(v), b.max(v))
                });
            // rounded first, so that codes belong to the numbers that are kept
            let centre = (0.5 * (low + high)) as f32;
            let width = ((high - low) / (2.0 * half)) as f32;
            codes.extend(drawn.map(|v| {
                let code = if width > 0.0 {
                    (v - f64::from(centre)) / f64::from(width)
                } else {
                    0.0
                };
                code.round().clamp(-half, half)
            }));
            offset.push(centre);
            step.push(width);
        }
        Ok(Quantised {
            codes: if bits == 8 {
                Codes::Eight(codes.iter().map(|c| *c as i8).collect())
            } else {
                Codes::Sixteen(codes.iter().map(|c| *c as i16).collect())
            },
            offset,
            step,
        })
    }

    /// Checks lengths and ranges for `channels` channels of `frame`.
    pub(super) fn check(&self, frame: &Frame, channels: usize) -> Result<(), BsdfError> {
        let lengths = [
            ("codes", self.codes.len(), frame.len() * channels),
            ("offset", self.offset.len(), frame.shape[0] * channels),
            ("step", self.step.len(), frame.shape[0] * channels),
        ];
        for (field, found, needed) in lengths {
            if found != needed {
                let allowed = format!("{needed} for {channels} channels of {:?} nodes", frame.shape);
                return Err(domain(field, format!("{found} values"), allowed));
            }
        }
        let half = if self.codes.bits() == 8 { 128.0 } else { 32768.0 };
        for (offset, step) in self.offset.iter().zip(&self.step) {
            let largest = f64::from(offset.abs()) + half * f64::from(*step);
            // false for NaN
            if !(*step >= 0.0 && largest <= 2.1 * LARGEST) {
                let found = format!("offset {offset}, step {step}");
                return Err(domain(
                    "offset",
                    found,
                    format!("logarithms up to {}", 2.0 * LARGEST),
                ));
            }
        }
        Ok(())
    }

    /// The values, `[channel][node]`.
    pub fn values(&self, frame: &Frame) -> Vec<f64> {
        let row = frame.len() / frame.shape[0];
        (0..self.codes.len())
            .map(|k| f64::from(self.offset[k / row]) + f64::from(self.step[k / row]) * self.codes.at(k))
            .collect()
    }
}

/// Neighbouring nodes along one axis, as the factors of their place in the table.
#[derive(Clone, Copy, Debug)]
struct AxisNodes {
    nodes: usize,
    round: bool,
    stride: usize,
}

impl AxisNodes {
    /// Place of the node before and after `position` (in nodes), and the share of the latter.
    #[inline(always)]
    fn bracket(&self, position: f32) -> (usize, usize, f32) {
        // a negative position and NaN become 0
        let k = position as usize;
        if self.round {
            let t = position - k as f32;
            let k = if k >= self.nodes { 0 } else { k };
            let next = if k + 1 == self.nodes { 0 } else { k + 1 };
            (k * self.stride, next * self.stride, t)
        } else {
            let k = k.min(self.nodes - 2);
            let t = (position - k as f32).min(1.0);
            (k * self.stride, (k + 1) * self.stride, t)
        }
    }
}

/// Values ready to interpolate.
#[derive(Clone, Debug)]
pub(super) struct Dense {
    axes: [AxisNodes; 4],
    /// One channel.
    one: Vec<[f32; 1]>,
    /// More than one: groups of four.
    groups: Vec<Vec<[f32; 4]>>,
}

impl Dense {
    pub(super) fn new(frame: &Frame, quantised: &Quantised, channels: usize) -> Self {
        let stride = |k: usize| frame.shape[k + 1..].iter().product();
        let axes = [0, 1, 2, 3].map(|k| AxisNodes {
            nodes: frame.shape[k],
            round: frame.axis(k) == Axis::Round,
            stride: stride(k),
        });
        let values = quantised.values(frame);
        let (mut one, mut groups) = (Vec::new(), Vec::new());
        if channels == 1 {
            one = values.iter().map(|v| [*v as f32]).collect();
        } else {
            groups = values
                .chunks(4 * frame.len())
                .map(|rows| together(rows, frame.len()))
                .collect();
        }
        Dense { axes, one, groups }
    }

    /// Rank 3: the azimuth of incidence does not count.
    fn is_rank_3(&self) -> bool {
        self.axes[1].nodes == 1
    }

    /// Logarithms at `positions` (in nodes, one row an axis) of the channels of group `group` (four each) into `out`, one row a
    /// channel; only where `wanted` is not 0.
    #[inline(always)]
    pub(super) fn interpolate_group<const N: usize>(
        &self,
        group: usize,
        positions: &[[f32; N]; 4],
        wanted: &[f32; N],
        out: &mut [[f32; N]],
    ) {
        match self.groups.get(group) {
            Some(nodes) => self.pass(nodes, positions, wanted, out),
            None => self.pass(&self.one, positions, wanted, out),
        }
    }

    #[inline(always)]
    fn pass<const W: usize, const N: usize>(
        &self,
        nodes: &[[f32; W]],
        positions: &[[f32; N]; 4],
        wanted: &[f32; N],
        out: &mut [[f32; N]],
    ) {
        if self.is_rank_3() {
            for l in 0..N {
                if wanted[l] == 0.0 {
                    continue;
                }
                let at = [positions[0][l], 0.0, positions[2][l], positions[3][l]];
                let sum = self.rank_3(nodes, at);
                for (row, v) in out.iter_mut().zip(sum) {
                    row[l] = v;
                }
            }
        } else {
            for l in 0..N {
                if wanted[l] == 0.0 {
                    continue;
                }
                let at = [positions[0][l], positions[1][l], positions[2][l], positions[3][l]];
                let sum = self.rank_4(nodes, at);
                for (row, v) in out.iter_mut().zip(sum) {
                    row[l] = v;
                }
            }
        }
    }

    #[inline(always)]
    fn rank_3<const W: usize>(&self, nodes: &[[f32; W]], at: [f32; 4]) -> [f32; W] {
        let [x, _, u, p] = &self.axes;
        let (x0, x1, tx) = x.bracket(at[0]);
        let near = face(nodes, x0, u.bracket(at[2]), p.bracket(at[3]));
        let far = face(nodes, x1, u.bracket(at[2]), p.bracket(at[3]));
        mix(near, far, tx)
    }

    #[inline(always)]
    fn rank_4<const W: usize>(&self, nodes: &[[f32; W]], at: [f32; 4]) -> [f32; W] {
        let [x, i, u, p] = &self.axes;
        let (x0, x1, tx) = x.bracket(at[0]);
        let (i0, i1, ti) = i.bracket(at[1]);
        let (u, p) = (u.bracket(at[2]), p.bracket(at[3]));
        let near = mix(face(nodes, x0 + i0, u, p), face(nodes, x0 + i1, u, p), ti);
        let far = mix(face(nodes, x1 + i0, u, p), face(nodes, x1 + i1, u, p), ti);
        mix(near, far, tx)
    }
}

/// Up to four rows of `n` values as one row of four values a node, 0 where there is no row.
fn together(rows: &[f64], n: usize) -> Vec<[f32; 4]> {
    let mut nodes = vec![[0.0; 4]; n];
    for (c, row) in rows.chunks(n).enumerate() {
        for (node, v) in nodes.iter_mut().zip(row) {
            node[c] = *v as f32;
        }
    }
    nodes
}

#[inline(always)]
fn mix<const W: usize>(a: [f32; W], b: [f32; W], t: f32) -> [f32; W] {
    let mut out = a;
    for c in 0..W {
        out[c] += t * (b[c] - a[c]);
    }
    out
}

type Bracket = (usize, usize, f32);

#[inline(always)]
fn face<const W: usize>(nodes: &[[f32; W]], base: usize, u: Bracket, p: Bracket) -> [f32; W] {
    let (u0, u1, tu) = u;
    let (p0, p1, tp) = p;
    let near = mix(nodes[base + u0 + p0], nodes[base + u0 + p1], tp);
    let far = mix(nodes[base + u1 + p0], nodes[base + u1 + p1], tp);
    mix(near, far, tu)
}
