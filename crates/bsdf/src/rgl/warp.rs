//! Bilinear tables over the unit square: values, their inverse marginal-conditional map, and sampling by it.

use std::ops::Range;

use super::Table;

/// The tables that answer for one incidence: up to four of a stack, with weights that sum to 1.
#[derive(Clone, Copy, Debug)]
pub(super) struct Blend {
    parts: [(usize, f64); 4],
    len: usize,
}

impl Blend {
    /// Bilinear weights of `(azimuth, polar)` brackets `(index, share of the next)` in a stack whose rows of `n_polar`
    /// tables are azimuths. Tables of weight zero are left out.
    pub(super) fn new(azimuth: (usize, f64), polar: (usize, f64), n_polar: usize) -> Self {
        let mut blend = Blend {
            parts: [(0, 0.0); 4],
            len: 0,
        };
        for (a, wa) in [(azimuth.0, 1.0 - azimuth.1), (azimuth.0 + 1, azimuth.1)] {
            for (p, wp) in [(polar.0, 1.0 - polar.1), (polar.0 + 1, polar.1)] {
                if wa * wp > 0.0 {
                    blend.parts[blend.len] = (a * n_polar + p, wa * wp);
                    blend.len += 1;
                }
            }
        }
        blend
    }

    /// `(index, weight)` of each table.
    pub(super) fn parts(&self) -> &[(usize, f64)] {
        &self.parts[..self.len]
    }
}

/// A stack of bilinear tables over the unit square. The last dimension is `x`, the one before `y`; nodes lie on the
/// edges too.
#[derive(Clone, Debug)]
pub(super) struct Grid {
    width: usize,
    height: usize,
    values: Vec<f32>,
}

/// The cell that holds a point: lower node and position inside.
#[derive(Clone, Copy, Debug)]
pub(super) struct Cell {
    /// Column and row of the lower node.
    pub(super) node: (usize, usize),
    /// Position in the cell, `[0, 1]`.
    pub(super) at: (f64, f64),
}

impl Grid {
    /// `table` has at least two dimensions of at least two nodes each (checked by the caller).
    pub(super) fn new(table: Table) -> Self {
        let [.., height, width] = table.shape[..] else {
            return Grid {
                width: 0,
                height: 0,
                values: Vec::new(),
            };
        };
        Grid {
            width,
            height,
            values: table.values,
        }
    }

    /// Rows and columns.
    pub(super) fn size(&self) -> (usize, usize) {
        (self.height, self.width)
    }

    fn nodes(&self) -> usize {
        self.width * self.height
    }

    /// Number of tables.
    pub(super) fn len(&self) -> usize {
        self.values.len() / self.nodes()
    }

    /// The cell that holds `(x, y)`, clamped to the unit square.
    pub(super) fn cell(&self, x: f64, y: f64) -> Cell {
        let place = |x: f64, n: usize| {
            let p = x.clamp(0.0, 1.0) * (n - 1) as f64;
            let i = (p as usize).min(n - 2);
            (i, p - i as f64)
        };
        let ((i, s), (j, t)) = (place(x, self.width), place(y, self.height));
        Cell {
            node: (i, j),
            at: (s, t),
        }
    }

    /// The four corner values of a cell of table `k`, `[y][x]`.
    fn corners(&self, k: usize, node: (usize, usize)) -> [[f64; 2]; 2] {
        let lower = k * self.nodes() + node.1 * self.width + node.0;
        let pair = |n: usize| [f64::from(self.values[n]), f64::from(self.values[n + 1])];
        [pair(lower), pair(lower + self.width)]
    }

    /// Indices of the four corners of a cell of table `k`, as in the flat array.
    pub(super) fn corner_indices(&self, k: usize, node: (usize, usize)) -> [usize; 4] {
        let lower = k * self.nodes() + node.1 * self.width + node.0;
        [lower, lower + 1, lower + self.width, lower + self.width + 1]
    }

    /// Bilinear value of table `k` at a point of a cell.
    pub(super) fn value(&self, k: usize, cell: Cell) -> f64 {
        let [low, high] = self.corners(k, cell.node);
        let (s, t) = cell.at;
        lerp(lerp(low[0], low[1], s), lerp(high[0], high[1], s), t)
    }

    /// Number of values in all tables.
    pub(super) fn total(&self) -> usize {
        self.values.len()
    }
}

fn lerp(a: f64, b: f64, t: f64) -> f64 {
    (1.0 - t) * a + t * b
}

/// The root in `[0, 1]` of `a t + (b - a) t^2 / 2 = d`: where a density that runs from `a` to `b` has given off `d`.
fn solve(a: f64, b: f64, d: f64) -> f64 {
    let root = (a * a + 2.0 * d * (b - a)).max(0.0).sqrt();
    let t = 2.0 * d / (a + root);
    if t.is_finite() { t.clamp(0.0, 1.0) } else { 0.0 }
}

/// Densities over the unit square, each table normalised to 1, with the map that turns uniform points into points of
/// that density: `y` by its marginal, then `x` given `y`. Blends of tables are linear in density and in cumulatives,
/// so that the map of a blend is exact as well.
#[derive(Clone, Debug)]
pub(super) struct Warp {
    grid: Grid,
    /// `1 / integral` of each table.
    scale: Vec<f64>,
    /// Normalised integral over `x` up to each node, for every row of every table.
    along: Vec<f64>,
    /// Normalised integral over `x` and over `y` up to each row of every table.
    across: Vec<f64>,
}

impl Warp {
    /// Tables of values `>= 0`. `Err` holds the number of a table whose integral is zero.
    pub(super) fn new(table: Table) -> Result<Self, usize> {
        let grid = Grid::new(table);
        let (w, h) = (grid.width, grid.height);
        let mut warp = Warp {
            scale: Vec::with_capacity(grid.len()),
            along: Vec::with_capacity(grid.total()),
            across: Vec::with_capacity(grid.len() * h),
            grid,
        };
        let (dx, dy) = (1.0 / (w - 1) as f64, 1.0 / (h - 1) as f64);
        for k in 0..warp.grid.len() {
            let first = (warp.along.len(), warp.across.len());
            let mut sum = 0.0;
            let mut last = 0.0;
            for j in 0..h {
                let row = k * w * h + j * w;
                let values = &warp.grid.values[row..row + w];
                let mut integral = 0.0;
                warp.along.push(0.0);
                for pair in values.windows(2) {
                    integral += 0.5 * dx * (f64::from(pair[0]) + f64::from(pair[1]));
                    warp.along.push(integral);
                }
                if j > 0 {
                    sum += 0.5 * dy * (last + integral);
                }
                last = integral;
                warp.across.push(sum);
            }
            let scale = 1.0 / sum;
            if !(sum > 0.0 && scale.is_finite()) {
                return Err(k);
            }
            warp.along[first.0..].iter_mut().for_each(|v| *v *= scale);
            warp.across[first.1..].iter_mut().for_each(|v| *v *= scale);
            warp.scale.push(scale);
        }
        Ok(warp)
    }

    /// The underlying tables.
    pub(super) fn grid(&self) -> &Grid {
        &self.grid
    }

    fn blended(&self, blend: &Blend, f: impl Fn(usize) -> f64) -> f64 {
        blend.parts().iter().map(|&(k, w)| w * f(k)).sum()
    }

    /// Normalised density at a point.
    pub(super) fn density(&self, blend: &Blend, x: f64, y: f64) -> f64 {
        let cell = self.grid.cell(x, y);
        self.blended(blend, |k| self.scale[k] * self.grid.value(k, cell))
    }

    /// Normalised corner values of a cell, `[y][x]`.
    fn corners(&self, blend: &Blend, node: (usize, usize)) -> [[f64; 2]; 2] {
        let mut sum = [[0.0; 2]; 2];
        for &(k, w) in blend.parts() {
            let c = self.grid.corners(k, node);
            for (s, c) in sum.as_flattened_mut().iter_mut().zip(c.as_flattened()) {
                *s += w * self.scale[k] * c;
            }
        }
        sum
    }

    /// Integral over `x` up to node `i` of row `j`.
    fn along(&self, blend: &Blend, j: usize, i: usize) -> f64 {
        let (w, n) = (self.grid.width, self.grid.nodes());
        self.blended(blend, |k| self.along[k * n + j * w + i])
    }

    fn across(&self, blend: &Blend, j: usize) -> f64 {
        self.blended(blend, |k| self.across[k * self.grid.height + j])
    }

    /// The uniform point that is mapped to `(x, y)`, and the density there. Where a whole line has no density its
    /// first coordinate is 0.
    pub(super) fn invert(&self, blend: &Blend, x: f64, y: f64) -> ([f64; 2], f64) {
        let Cell {
            node: (i, j),
            at: (s, t),
        } = self.grid.cell(x, y);
        let (dx, dy) = (
            1.0 / (self.grid.width - 1) as f64,
            1.0 / (self.grid.height - 1) as f64,
        );
        let [low, high] = self.corners(blend, (i, j));
        let (c0, c1) = (lerp(low[0], high[0], t), lerp(low[1], high[1], t));
        let before = lerp(self.along(blend, j, i), self.along(blend, j + 1, i), t);
        let end = self.grid.width - 1;
        let (r0, r1) = (self.along(blend, j, end), self.along(blend, j + 1, end));
        let total = lerp(r0, r1, t);
        let u = if total > 0.0 {
            (before + dx * s * (c0 + 0.5 * s * (c1 - c0))) / total
        } else {
            0.0
        };
        let v = self.across(blend, j) + dy * t * (r0 + 0.5 * t * (r1 - r0));
        ([u.clamp(0.0, 1.0), v.clamp(0.0, 1.0)], lerp(c0, c1, s))
    }

    /// The point that the uniform point `(u, v)` is mapped to, and the density there; `None` where there is none.
    pub(super) fn sample(&self, blend: &Blend, u: f64, v: f64) -> Option<([f64; 2], f64)> {
        let (at, density) = self.map(blend, u, v);
        (density > 0.0).then_some((at, density))
    }

    /// The point that the uniform point `(u, v)` is mapped to, whatever its density.
    pub(super) fn place(&self, blend: &Blend, u: f64, v: f64) -> [f64; 2] {
        self.map(blend, u, v).0
    }

    fn map(&self, blend: &Blend, u: f64, v: f64) -> ([f64; 2], f64) {
        let (w, h) = (self.grid.width, self.grid.height);
        let last = |range: Range<usize>, target: f64, f: &dyn Fn(usize) -> f64| {
            // the last place below the end whose cumulative does not exceed the target
            let (mut low, mut high) = (range.start, range.end - 1);
            while low + 1 < high {
                let middle = low.midpoint(high);
                if f(middle) <= target {
                    low = middle;
                } else {
                    high = middle;
                }
            }
            low
        };
        let v = v * self.across(blend, h - 1);
        let j = last(0..h, v, &|j| self.across(blend, j));
        let (r0, r1) = (self.along(blend, j, w - 1), self.along(blend, j + 1, w - 1));
        let t = solve(r0, r1, (v - self.across(blend, j)) * (h - 1) as f64);
        let row = |i: usize| lerp(self.along(blend, j, i), self.along(blend, j + 1, i), t);
        let u = u * row(w - 1);
        let i = last(0..w, u, &row);
        let [low, high] = self.corners(blend, (i, j));
        let (c0, c1) = (lerp(low[0], high[0], t), lerp(low[1], high[1], t));
        let s = solve(c0, c1, (u - row(i)) * (w - 1) as f64);
        let density = lerp(c0, c1, s);
        let at = [(i as f64 + s) / (w - 1) as f64, (j as f64 + t) / (h - 1) as f64];
        (at, density)
    }
}
