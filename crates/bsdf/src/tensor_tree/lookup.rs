//! Coordinates of a pair of directions in a tree, and lookup.

use gonio_geom::disk::{disk_to_square, square_to_disk};
use gonio_geom::{DVec3, Direction, Side};

use super::mapping::{BITS, fixed};
use super::{Node, Rank, Tree};

/// Keeps normal incidence in the used half of a rank-3 tree, as Radiance does.
pub(crate) const BELOW_HALF: f64 = 1e-7;

/// Coordinates of a pair, `(incident..., exit x, exit y)`, each in `[0, 1]`; the last entry is unused at rank 3.
///
/// Rank 4: the square of the incident direction with its azimuth turned by 180 degrees, then the square of the exit
/// direction. Rank 3: `1/2 - sin(theta_i) / 2`, then the square of the exit direction turned about the normal so that
/// the mirror azimuth lies on `+x` [WardEtAl2012].
pub fn coordinates(rank: Rank, wi: Direction, ws: Direction) -> [f64; 4] {
    let (i, o) = (wi.vec(), ws.vec());
    match rank {
        Rank::Three => {
            let r = i.x.hypot(i.y);
            let (c, s) = mirror_azimuth(i);
            let (x, y) = (c * o.x + s * o.y, c * o.y - s * o.x);
            let (u, v) = disk_to_square(x, y);
            [incident_coordinate(r), u, v, 0.0]
        }
        Rank::Four => {
            let (a, b) = disk_to_square(-i.x, -i.y);
            let (u, v) = disk_to_square(o.x, o.y);
            [a, b, u, v]
        }
    }
}

fn incident_coordinate(sin_theta: f64) -> f64 {
    (0.5 - BELOW_HALF - 0.5 * sin_theta).max(0.0)
}

/// Cosine and sine of the azimuth of the mirror direction.
fn mirror_azimuth(i: DVec3) -> (f64, f64) {
    let r = i.x.hypot(i.y);
    if r > 0.0 {
        (-i.x / r, -i.y / r)
    } else {
        (-1.0, 0.0)
    }
}

/// The incident direction at the incident coordinates of a tree, on `side`; at rank 3 its azimuth is 180 degrees, so
/// that the mirror azimuth is 0.
pub fn incident_direction(rank: Rank, coordinate: [f64; 2], side: Side) -> Direction {
    match rank {
        Rank::Three => {
            let r = (1.0 - 2.0 * coordinate[0]).clamp(0.0, 1.0);
            lift(-r, 0.0, side)
        }
        Rank::Four => {
            let (x, y) = square_to_disk(coordinate[0], coordinate[1]);
            lift(-x, -y, side)
        }
    }
}

/// The exit direction at exit coordinates `(u, v)` for light from `wi`, on `side`.
pub fn exit_direction(rank: Rank, wi: Direction, u: f64, v: f64, side: Side) -> Direction {
    let (x, y) = square_to_disk(u, v);
    match rank {
        Rank::Three => {
            let (c, s) = mirror_azimuth(wi.vec());
            lift(c * x - s * y, c * y + s * x, side)
        }
        Rank::Four => lift(x, y, side),
    }
}

/// The direction of the given direction cosines.
fn lift(x: f64, y: f64, side: Side) -> Direction {
    let z = (1.0 - x * x - y * y).max(0.0).sqrt();
    Direction::new(DVec3::new(x, y, side.sign() * z)).unwrap_or(Direction::NORMAL)
}

/// A cell of a cross-section: its lower corner and side in the free square, and its value.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Cell {
    /// Lower corner along the first free dimension.
    pub u: f64,
    /// Lower corner along the second free dimension.
    pub v: f64,
    /// Side.
    pub side: f64,
    /// Value, 1/sr.
    pub value: f32,
}

impl Tree {
    /// Value of the cell that holds `coordinates` (the first `rank` entries count; clamped to `[0, 1]`), 1/sr. No
    /// interpolation.
    pub fn lookup(&self, coordinates: &[f64; 4]) -> f64 {
        let [a, b, c, d] = coordinates.map(fixed);
        f64::from(match self.rank() {
            Rank::Three => self.descend(0, 0, [a, b, c]),
            Rank::Four => self.descend(0, 0, [a, b, c, d]),
        })
    }

    /// Side of the cell that holds `coordinates`.
    pub fn cell_side(&self, coordinates: &[f64; 4]) -> f64 {
        let position = coordinates.map(fixed);
        let mut node = self.nodes()[0];
        let mut level = 0u32;
        loop {
            match node {
                Node::Branch { first } => {
                    level += 1;
                    let bit = |k: usize| ((position[k] >> (BITS - level)) & 1) as usize;
                    let child = (0..self.rank().dimensions()).fold(0, |n, k| n | bit(k) << k);
                    node = self.nodes()[first as usize + child];
                }
                Node::Block { log2_side, .. } => {
                    return (-f64::from(level + u32::from(log2_side))).exp2();
                }
            }
        }
    }

    /// The value at a fixed-point position below node `index`, which lies `level` levels deep.
    pub(crate) fn descend<const D: usize>(&self, index: usize, level: u32, position: [u32; D]) -> f32 {
        let mut node = self.nodes()[index];
        let mut shift = BITS - level;
        loop {
            match node {
                Node::Branch { first } => {
                    shift -= 1;
                    let child = (0..D).fold(0, |n, k| n | (((position[k] >> shift) & 1) as usize) << k);
                    node = self.nodes()[first as usize + child];
                }
                Node::Block { first, log2_side } => {
                    let mask = (1u32 << log2_side) - 1;
                    let shift = shift - u32::from(log2_side);
                    let offset = position
                        .iter()
                        .fold(0, |n, p| n << log2_side | (p >> shift & mask) as usize);
                    return self.values()[first as usize + offset];
                }
            }
        }
    }

    /// Visits the cells whose incident coordinates hold `incident`, over the exit square.
    pub fn cross_section(&self, incident: [f64; 2], mut visit: impl FnMut(Cell)) {
        let fixed = self.rank().incident_dimensions();
        self.slice(0, 0, fixed, incident, &mut visit);
    }

    /// Visits the cells whose exit coordinates hold `exit`, over the incident square (rank 4 only; nothing at rank 3,
    /// where the incident azimuth turns the exit square).
    pub fn reversed_cross_section(&self, exit: [f64; 2], mut visit: impl FnMut(Cell)) {
        if self.rank() == Rank::Four {
            self.slice(0, 2, 2, exit, &mut visit);
        }
    }

    fn slice(&self, root: usize, from: usize, fixed: usize, at: [f64; 2], visit: &mut impl FnMut(Cell)) {
        let free = if from == 0 { fixed } else { 0 };
        let whole = Cell {
            u: 0.0,
            v: 0.0,
            side: 1.0,
            value: 0.0,
        };
        let mut stack = vec![(root, whole, at.map(|x| x.clamp(0.0, 1.0 - 1e-12)))];
        while let Some((index, cell, at)) = stack.pop() {
            match self.nodes()[index] {
                Node::Branch { first } => {
                    let mut base = 0;
                    let mut rest = at;
                    for (k, x) in rest.iter_mut().take(fixed).enumerate() {
                        *x *= 2.0;
                        if *x >= 1.0 {
                            *x -= 1.0;
                            base |= 1 << (from + k);
                        }
                    }
                    let side = 0.5 * cell.side;
                    for bits in [3usize, 2, 1, 0] {
                        let child = Cell {
                            u: cell.u + side * (bits & 1) as f64,
                            v: cell.v + side * (bits >> 1) as f64,
                            side,
                            value: 0.0,
                        };
                        stack.push((first as usize + (base | bits << free), child, rest));
                    }
                }
                Node::Block { first, log2_side } => {
                    let n = 1usize << log2_side;
                    let d = self.rank().dimensions();
                    let stride = |k: usize| 1usize << (usize::from(log2_side) * (d - 1 - k));
                    let base: usize = (0..fixed)
                        .map(|k| ((at[k] * n as f64) as usize).min(n - 1) * stride(from + k))
                        .sum();
                    let side = cell.side / n as f64;
                    for a in 0..n {
                        for b in 0..n {
                            let offset = base + a * stride(free) + b * stride(free + 1);
                            visit(Cell {
                                u: cell.u + side * a as f64,
                                v: cell.v + side * b as f64,
                                side,
                                value: self.values()[first as usize + offset],
                            });
                        }
                    }
                }
            }
        }
    }

    /// `integral f cos dws` over the exit hemisphere at the given incident coordinates.
    pub fn albedo(&self, incident: [f64; 2]) -> f64 {
        let mut sum = 0.0;
        self.cross_section(incident, |c| sum += f64::from(c.value) * c.side * c.side);
        std::f64::consts::PI * sum
    }
}
