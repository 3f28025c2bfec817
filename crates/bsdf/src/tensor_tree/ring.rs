//! Exact sampling of a tree of rank 3 with incidence and exit exchanged: the exit direction is known, the incidence drawn.
//!
//! The polar angle of the exit direction is all that the tree sees of it; its azimuth is that from the mirror azimuth of
//! the incidence and free. Exit directions of one polar angle lie on the edges of a square about the centre of the
//! square, evenly in azimuth, so cells cut them into pieces of known shares. While the edges stay within one row of the
//! finest cells, the shares of all pieces keep their ratios but for those at the corners, which grow with the square.

use std::f64::consts::{FRAC_PI_4, PI};
use std::sync::OnceLock;

use super::lookup::BELOW_HALF;
use super::mapping::disk;
use super::{Node, Tree};

/// Direction cosines of the known direction are taken this much shorter: those of round angles lie on the edges of cells
/// on one side of the centre and beyond them on the other, and would belong to two rows at once.
pub(crate) const INWARD: f64 = 1.0 - 1e-9;

/// A cell where it meets the edges.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Piece {
    /// Sum of the shares with this one.
    end: f64,
    /// Squares of the sine of incidence, low and high.
    sine2: [f64; 2],
    place: Place,
    /// Value, 1/sr.
    pub(crate) value: f32,
}

#[derive(Clone, Copy, Debug)]
enum Place {
    /// On edge 0 to 3 (right, left, upper, lower), from the first coordinate along it to the second.
    Edge(u8, f64, f64),
    /// At the high or low end of an edge.
    Corner(u8, bool),
    /// At the centre, where all azimuths are.
    Centre,
}

/// The pieces of one row of finest cells.
#[derive(Debug, Default)]
struct Row {
    /// Those of a share that does not depend on the place within the row.
    fixed: Vec<Piece>,
    corners: Vec<Piece>,
}

/// All rows of a tree, each made when it is first asked for.
#[derive(Debug)]
pub(crate) struct Rings {
    /// Finest cells along the square's side.
    n: usize,
    /// From the centre outwards; the last is the centre itself.
    rows: Vec<OnceLock<Row>>,
}

/// The pieces for one exit direction.
pub(crate) struct Ring<'a> {
    row: &'a Row,
    /// Inner edge of the row and half the side of the square; 0 at the centre.
    from: f64,
    half: f64,
    /// Sums of the shares of the pieces; `integral f cos dw`.
    fixed: f64,
    corners: f64,
    pub(crate) albedo: f64,
}

impl Rings {
    pub(crate) fn new(tree: &Tree) -> Self {
        let n = 1usize << tree.depth().max(1);
        let mut rows = Vec::new();
        rows.resize_with(n / 2 + 1, OnceLock::new);
        Rings { n, rows }
    }

    /// Those for an exit direction of sine `sine`.
    #[inline]
    pub(crate) fn get(&self, tree: &Tree, sine: f64) -> Ring<'_> {
        // below, coordinates round to the centre
        const CENTRE: f64 = 1e-17;
        let half = (0.5 * INWARD * sine).clamp(0.0, 0.5);
        let n = self.n as f64;
        let last = self.rows.len() - 1;
        let k = if half < CENTRE {
            last
        } else {
            ((half * n) as usize).min(last - 1)
        };
        let row = self.rows[k].get_or_init(|| Row::new(tree, self.n, k));
        let sum = |pieces: &[Piece]| pieces.last().map_or(0.0, |p| p.end);
        let fixed = sum(&row.fixed);
        if k == last {
            return Ring {
                row,
                from: 0.0,
                half: 0.0,
                fixed,
                corners: 0.0,
                albedo: 2.0 * PI * fixed,
            };
        }
        let from = k as f64 / n;
        let corners = sum(&row.corners) * (half - from);
        Ring {
            row,
            from,
            half,
            fixed,
            corners,
            albedo: FRAC_PI_4 / half * (fixed + corners),
        }
    }
}

impl Row {
    fn new(tree: &Tree, n: usize, k: usize) -> Self {
        let centre = k == n / 2;
        let step = 1.0 / n as f64;
        let (inner, outer) = (k as f64 * step, (k + 1) as f64 * step);
        let mut row = Row::default();
        leaves(tree, |[a, u, v], side, value| {
            if a >= 0.5 || value <= 0.0 {
                return;
            }
            let sine = |a: f64| (1.0 - 2.0 * (a + BELOW_HALF)).clamp(0.0, 1.0);
            let high = if a == 0.0 { 1.0 } else { sine(a) };
            let sine2 = [sine(a + side).powi(2), high * high];
            let share = f64::from(value) * 0.5 * (sine2[1] - sine2[0]);
            let piece = |place| Piece {
                end: share,
                sine2,
                place,
                value,
            };
            let holds = |from: f64, x: f64| from <= x && x < from + side;
            if centre {
                if holds(u, 0.5) && holds(v, 0.5) {
                    row.fixed.push(piece(Place::Centre));
                }
                return;
            }
            for edge in 0..4u8 {
                let (across, along) = if edge < 2 { (u, v) } else { (v, u) };
                let outwards = if edge % 2 == 0 { 0.5 } else { -0.5 };
                let middle = 0.5 + outwards * (inner + outer);
                if !holds(across, middle) {
                    continue;
                }
                let (low, high) = (along.max(0.5 - inner), (along + side).min(0.5 + inner));
                if high > low {
                    let end = share * (high - low);
                    let whole = piece(Place::Edge(edge, low, high));
                    row.fixed.push(Piece { end, ..whole });
                }
                for (upper, middle) in [
                    (true, 0.5 + inner + 0.5 * step),
                    (false, 0.5 - inner - 0.5 * step),
                ] {
                    if holds(along, middle) {
                        row.corners.push(piece(Place::Corner(edge, upper)));
                    }
                }
            }
        });
        for pieces in [&mut row.fixed, &mut row.corners] {
            let mut sum = 0.0;
            for p in pieces {
                sum += p.end;
                p.end = sum;
            }
        }
        row
    }
}

/// Every leaf: its lower corner, side and value.
fn leaves(tree: &Tree, mut visit: impl FnMut([f64; 3], f64, f32)) {
    let mut stack = vec![(0usize, [0.0; 3], 1.0)];
    while let Some((index, corner, side)) = stack.pop() {
        match tree.nodes()[index] {
            Node::Branch { first } => {
                let half = 0.5 * side;
                for child in 0..8usize {
                    let mut at: [f64; 3] = corner;
                    for (d, x) in at.iter_mut().enumerate() {
                        *x += half * (child >> d & 1) as f64;
                    }
                    stack.push((first as usize + child, at, half));
                }
            }
            Node::Block { first, log2_side } => {
                let m = 1usize << log2_side;
                let cell = side / m as f64;
                for (k, value) in tree.values()[first as usize..][..m * m * m].iter().enumerate() {
                    let at = [k / (m * m), k / m % m, k % m];
                    let mut place = corner;
                    for (x, at) in place.iter_mut().zip(at) {
                        *x += cell * at as f64;
                    }
                    visit(place, cell, *value);
                }
            }
        }
    }
}

impl Ring<'_> {
    /// The piece at `share` in `[0, 1)` of the albedo; `None` without light.
    pub(crate) fn draw(&self, share: f64) -> Option<Piece> {
        let target = share * (self.fixed + self.corners);
        let (pieces, target) = if target < self.fixed || self.corners == 0.0 {
            (&self.row.fixed, target)
        } else {
            (&self.row.corners, (target - self.fixed) / (self.half - self.from))
        };
        let k = pieces.partition_point(|p| p.end <= target);
        pieces.get(k).or(pieces.last()).copied()
    }

    /// The incident direction cosines at point `(a, b)` of a piece, for the exit direction of cosines `(x, y)`.
    pub(crate) fn point(&self, piece: &Piece, [a, b]: [f64; 2], [x, y]: [f64; 2]) -> [f64; 2] {
        let [low, high] = piece.sine2;
        let sine = (low + a * (high - low)).sqrt();
        let (edge, along) = match piece.place {
            Place::Centre => {
                let (s, c) = (2.0 * PI * b).sin_cos();
                return [sine * c, sine * s];
            }
            Place::Edge(edge, low, high) => (edge, low + b * (high - low)),
            Place::Corner(edge, true) => (edge, 0.5 + self.from + b * (self.half - self.from)),
            Place::Corner(edge, false) => (edge, 0.5 - self.from - b * (self.half - self.from)),
        };
        let across = 0.5 + if edge % 2 == 0 { self.half } else { -self.half };
        // The exit direction as the tree has it, turned by minus the mirror azimuth.
        let (p, q) = if edge < 2 {
            disk(across, along)
        } else {
            disk(along, across)
        };
        let scale = sine / (p.hypot(q) * x.hypot(y));
        [-(p * x + q * y) * scale, -(p * y - q * x) * scale]
    }
}
