//! Pairs of directions as formulas and loops take them.

use gonio_geom::{Component, Direction};

use super::Real;

/// Two directions in the frame of a formula: `wi.z > 0`, whichever side the light arrives on.
#[derive(Clone, Copy, Debug)]
pub struct Pair<R> {
    /// Direction to the source.
    pub wi: [R; 3],
    /// Direction to the receiver; `z > 0` for reflection, `z < 0` for transmission.
    pub ws: [R; 3],
}

impl<R: Real> Pair<R> {
    /// `wi + ws`, not normalised.
    #[inline(always)]
    pub fn sum(&self) -> [R; 3] {
        [
            self.wi[0] + self.ws[0],
            self.wi[1] + self.ws[1],
            self.wi[2] + self.ws[2],
        ]
    }

    /// `wi . ws`.
    #[inline(always)]
    pub fn dot(&self) -> R {
        self.wi[0] * self.ws[0] + self.wi[1] * self.ws[1] + self.wi[2] * self.ws[2]
    }

    /// `|cos theta_i|` and `|cos theta_s|`.
    #[inline(always)]
    pub fn cosines(&self) -> (R, R) {
        (self.wi[2], self.ws[2].abs())
    }

    /// The two directions swapped (the sides of a transmission with them).
    #[inline(always)]
    pub fn swapped(&self) -> Self {
        let side = R::select(self.ws[2].plain(), R::constant(1.0), R::constant(-1.0));
        let turn = |v: [R; 3]| [v[0], v[1], v[2] * side];
        Pair {
            wi: turn(self.ws),
            ws: turn(self.wi),
        }
    }
}

impl Pair<f64> {
    /// The pair of `wi` and `ws`, both mirrored in the sample plane when `wi` is on the back.
    #[inline(always)]
    pub fn new(wi: Direction, ws: Direction) -> Self {
        let side = if wi.cos_theta() < 0.0 { -1.0 } else { 1.0 };
        let (i, s) = (wi.vec(), ws.vec());
        Pair {
            wi: [i.x, i.y, i.z * side],
            ws: [s.x, s.y, s.z * side],
        }
    }
}

/// Many pairs as columns.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Pairs {
    columns: [Vec<f64>; 6],
    /// `z` of `wi` before a pair from the back was mirrored.
    origin: Vec<f64>,
}

impl Pairs {
    /// No pair, with room for `n`.
    pub fn with_capacity(n: usize) -> Self {
        Pairs {
            columns: std::array::from_fn(|_| Vec::with_capacity(n)),
            origin: Vec::with_capacity(n),
        }
    }

    /// Adds a pair.
    pub fn push(&mut self, wi: Direction, ws: Direction) {
        let pair = Pair::new(wi, ws);
        for (column, v) in self.columns.iter_mut().zip(pair.wi.into_iter().chain(pair.ws)) {
            column.push(v);
        }
        self.origin.push(wi.cos_theta());
    }

    /// Number of pairs.
    pub fn len(&self) -> usize {
        self.columns[0].len()
    }

    /// Whether there is none.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// The pairs in `range` (panics past the end, as slices do).
    pub fn view(&self, range: std::ops::Range<usize>) -> PairsView<'_> {
        PairsView {
            columns: std::array::from_fn(|k| &self.columns[k][range.clone()]),
            origin: &self.origin[range],
        }
    }

    /// Component that pair `j` belongs to; `None` with a direction on the horizon.
    pub fn component(&self, j: usize) -> Option<Component> {
        let (ci, cs) = (self.columns[2][j], self.columns[5][j]);
        (ci * cs != 0.0).then_some(if cs > 0.0 {
            Component::Reflection
        } else {
            Component::Transmission
        })
    }
}

/// Some of the columns' rows: `wi.x, wi.y, wi.z, ws.x, ws.y, ws.z`.
#[derive(Clone, Copy, Debug)]
pub struct PairsView<'a> {
    pub(super) columns: [&'a [f64]; 6],
    /// Negative where light came from the back.
    pub(super) origin: &'a [f64],
}

impl PairsView<'_> {
    /// Number of pairs.
    pub fn len(&self) -> usize {
        self.columns[0].len()
    }

    /// Whether there is none.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }
}
