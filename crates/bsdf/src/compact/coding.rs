//! Codes of a table as few bytes: each is predicted from its neighbours, and what the prediction misses is range coded.
//!
//! The prediction is a linear one of up to fifteen neighbours that come before, its weights those of least squares, in
//! 256ths: whole numbers all through, so that every machine restores the same codes. What it misses is coded in
//! decisions (none or some, sign, magnitude one by one, then an Elias gamma code), whose probabilities adapt apart for eight
//! sizes of what it missed at the neighbours.

use crate::BsdfError;

use super::domain;
use super::range_coder::{Chance, Coder, Decoder, Encoder};

/// Neighbours: how far back along `x`, `p_i`, `u` and `p_h`. Those back along `p_i` count for tables of rank 4.
const NEIGHBOURS: [[isize; 4]; 15] = [
    [0, 0, 0, 1],
    [0, 0, 1, 0],
    [0, 0, 1, 1],
    [0, 0, 1, -1],
    [1, 0, 0, 0],
    [1, 0, 0, 1],
    [1, 0, 0, -1],
    [1, 0, 1, 0],
    [1, 0, 1, 1],
    [1, 0, 1, -1],
    [0, 1, 0, 0],
    [0, 1, 0, 1],
    [0, 1, 0, -1],
    [0, 1, 1, 0],
    [1, 1, 0, 0],
];
/// Neighbours of tables of rank 3.
const RANK_3: usize = 10;
/// Neighbours that stand in for those that are missing, and whose misses tell how large the next will be: the nearest along
/// each axis.
const NEAREST: [usize; 4] = [0, 1, 10, 4];
/// Parts of one that the weights are counted in.
const UNIT: f64 = 256.0;
/// Misses at the neighbours from which on the next size is counted.
const SIZES: [u32; 7] = [1, 2, 3, 5, 8, 12, 20];
/// Magnitudes that are counted one by one.
const UNARY: usize = 14;
/// Largest code, either sign.
pub(super) const MOST: i32 = 32_767;

/// Weights of the neighbours, in 256ths.
pub(super) type Weights = Vec<i16>;

/// Places of the neighbours of a node.
struct Walk {
    shape: [usize; 4],
    back: Vec<usize>,
    count: usize,
}

impl Walk {
    fn new(shape: [usize; 4]) -> Self {
        let stride = [0, 1, 2, 3].map(|k| shape[k + 1..].iter().product::<usize>() as isize);
        let count = if shape[1] == 1 { RANK_3 } else { NEIGHBOURS.len() };
        let back = NEIGHBOURS[..count]
            .iter()
            .map(|n| (0..4).map(|k| n[k] * stride[k]).sum::<isize>() as usize)
            .collect();
        Walk { shape, back, count }
    }

    fn len(&self) -> usize {
        self.shape.iter().product()
    }

    /// Calls `f` with each node in order and the nodes of its neighbours, `None` for the first node. A neighbour that is not
    /// there is the nearest one that is.
    fn each(&self, mut f: impl FnMut(usize, Option<&[usize]>)) {
        let [_, n1, n2, n3] = self.shape;
        let mut nodes = vec![0; self.count];
        for k in 0..self.len() {
            let at = [k / (n1 * n2 * n3), k / (n2 * n3) % n1, k / n3 % n2, k % n3];
            let is_there = |j: usize| {
                let n = &NEIGHBOURS[j];
                (0..4).all(|a| {
                    let place = at[a] as isize - n[a];
                    place >= 0 && place < self.shape[a] as isize
                })
            };
            let near = NEAREST.iter().find(|j| **j < self.count && is_there(**j));
            let Some(&near) = near else {
                f(k, None);
                continue;
            };
            for (j, node) in nodes.iter_mut().enumerate() {
                *node = k - self.back[if is_there(j) { j } else { near }];
            }
            f(k, Some(&nodes));
        }
    }
}

/// The weights of least squares for `values`.
pub(super) fn weights(shape: [usize; 4], values: &[f64]) -> Weights {
    let walk = Walk::new(shape);
    let n = walk.count;
    let mut normal = vec![vec![0.0; n + 1]; n];
    walk.each(|k, nodes| {
        let Some(nodes) = nodes else { return };
        // differences from the nearest neighbour: the weights sum to 1
        let base = values[nodes[0]];
        let mut row = [0.0; NEIGHBOURS.len() + 1];
        for (r, node) in row.iter_mut().zip(nodes) {
            *r = values[*node] - base;
        }
        row[n] = values[k] - base;
        for (a, line) in normal.iter_mut().enumerate() {
            if row[a] != 0.0 {
                for (sum, b) in line.iter_mut().zip(&row[..=n]) {
                    *sum += row[a] * b;
                }
            }
        }
    });
    let scale = normal.iter().enumerate().map(|(k, l)| l[k]).fold(0.0, f64::max);
    for (k, line) in normal.iter_mut().enumerate() {
        line[k] += 1e-6 * scale + 1e-12;
    }
    let mut parts: Weights = solve(normal)
        .iter()
        .map(|w| (w * UNIT).round().clamp(-2000.0, 2000.0) as i16)
        .collect();
    parts[0] = UNIT as i16 - parts[1..].iter().sum::<i16>();
    parts
}

/// Solves a positive definite system by elimination; the right side is the last column.
fn solve(mut lines: Vec<Vec<f64>>) -> Vec<f64> {
    let n = lines.len();
    for k in 0..n {
        let (done, rest) = lines.split_at_mut(k + 1);
        let pivot = &done[k];
        for line in rest {
            let factor = line[k] / pivot[k];
            line[k..]
                .iter_mut()
                .zip(&pivot[k..])
                .for_each(|(a, b)| *a -= factor * b);
        }
    }
    let mut x = vec![0.0; n];
    for k in (0..n).rev() {
        let known: f64 = (k + 1..n).map(|j| lines[k][j] * x[j]).sum();
        x[k] = (lines[k][n] - known) / lines[k][k];
    }
    x
}

fn predicted(weights: &[i16], codes: &[i32], nodes: &[usize]) -> i32 {
    let sum: i64 = weights
        .iter()
        .zip(nodes)
        .map(|(w, node)| i64::from(*w) * i64::from(codes[*node]))
        .sum();
    ((sum + (UNIT as i64) / 2) >> 8).clamp(i64::from(-MOST), i64::from(MOST)) as i32
}

/// The codes of `values` in steps of `step`, each as close to its prediction as `slack` (half widths, in steps, at least a
/// half) allows: where little light is, a code follows its neighbours.
pub(super) fn near(
    shape: [usize; 4],
    weights: &[i16],
    values: &[f64],
    step: f64,
    slack: impl Fn(usize) -> f64,
) -> Vec<i32> {
    let mut codes = vec![0; values.len()];
    Walk::new(shape).each(|k, nodes| {
        let value = values[k] / step;
        let nearest = value.round();
        let room = slack(k).max(0.5);
        let low = (value - room).ceil().min(nearest);
        let high = (value + room).floor().max(nearest);
        let wanted = nodes.map_or(0, |nodes| predicted(weights, &codes, nodes));
        let most = f64::from(MOST);
        codes[k] = f64::from(wanted).clamp(low, high).clamp(-most, most) as i32;
    });
    codes
}

/// Probabilities of one size of misses.
#[derive(Clone)]
struct Chances {
    some: Chance,
    sign: Chance,
    more: [Chance; UNARY],
    length: [Chance; 17],
}

/// Codes or decodes one miss.
fn miss(coder: &mut impl Coder, chances: &mut Chances, value: i32) -> i32 {
    if !coder.bit(&mut chances.some, value != 0) {
        return 0;
    }
    let negative = coder.bit(&mut chances.sign, value < 0);
    let size = value.unsigned_abs() as usize;
    let mut found = 1;
    for chance in &mut chances.more {
        if !coder.bit(chance, size > found) {
            break;
        }
        found += 1;
    }
    if found > UNARY {
        // Elias gamma code of what is beyond
        let rest = (size.wrapping_sub(UNARY)) as u32;
        let mut length = 0;
        while length < 16 && coder.bit(&mut chances.length[length], rest >> (length + 1) != 0) {
            length += 1;
        }
        let mut number = 1_u32;
        for k in (0..length).rev() {
            let mut even = Chance::EVEN;
            number = number << 1 | u32::from(coder.bit(&mut even, rest >> k & 1 == 1));
        }
        found = UNARY + number as usize;
    }
    if negative { -(found as i32) } else { found as i32 }
}

/// Codes all of `codes`, or decodes them into it.
fn pass(coder: &mut impl Coder, shape: [usize; 4], weights: &[i16], codes: &mut [i32]) {
    let fresh = Chances {
        some: Chance::EVEN,
        sign: Chance::EVEN,
        more: [Chance::EVEN; UNARY],
        length: [Chance::EVEN; 17],
    };
    let mut chances = vec![fresh; SIZES.len() + 1];
    let mut missed = vec![0_u32; codes.len()];
    let axes = if shape[1] == 1 { 3 } else { 4 };
    Walk::new(shape).each(|k, nodes| {
        let (wanted, around) = nodes.map_or((0, 0), |nodes| {
            let near = NEAREST.iter().filter_map(|j| nodes.get(*j));
            let sum: u32 = near.map(|node| missed[*node].min(64)).sum();
            (predicted(weights, codes, nodes), sum * 3 / axes)
        });
        let size = SIZES.partition_point(|s| *s <= around);
        let found = miss(coder, &mut chances[size], codes[k] - wanted);
        missed[k] = found.unsigned_abs();
        codes[k] = (wanted + found).clamp(-MOST, MOST);
    });
}

/// The bytes of `codes`: the weights, then what the prediction misses.
pub(super) fn encode(shape: [usize; 4], weights: &[i16], codes: &[i32]) -> Vec<u8> {
    let mut coder = Encoder::new();
    pass(&mut coder, shape, weights, &mut codes.to_vec());
    let mut bytes: Vec<u8> = weights.iter().flat_map(|w| w.to_le_bytes()).collect();
    bytes.extend(coder.finish());
    bytes
}

/// Weights and codes of the bytes that [`encode`] made for a table of `shape`.
///
/// # Errors
/// [`BsdfError::Domain`] for bytes that are too few, or more than the codes take.
pub(super) fn decode(shape: [usize; 4], bytes: &[u8]) -> Result<(Weights, Vec<i32>), BsdfError> {
    let walk = Walk::new(shape);
    let Some((head, rest)) = bytes.split_at_checked(2 * walk.count) else {
        let allowed = format!("at least {} of a table of {shape:?} nodes", 2 * walk.count);
        return Err(domain("codes", format!("{} bytes", bytes.len()), allowed));
    };
    let weights: Weights = head
        .chunks_exact(2)
        .map(|pair| i16::from_le_bytes([pair[0], pair[1]]))
        .collect();
    let mut codes = vec![0; walk.len()];
    let mut coder = Decoder::new(rest);
    pass(&mut coder, shape, &weights, &mut codes);
    if !coder.is_whole() {
        let found = format!("{} bytes", bytes.len());
        return Err(domain(
            "codes",
            found,
            format!("fewer, for a table of {shape:?} nodes"),
        ));
    }
    Ok((weights, codes))
}

#[cfg(test)]
#[path = "coding_tests.rs"]
mod tests;
