//! A slice resampled for evaluation: a grid over the stereographic disk whose cells carry their own sub-grids.
//!
//! A look-up reads one cell header and four values, whatever the slice. The sub-grids follow the data: each is
//! refined until bilinear interpolation reproduces the surface, and no further than the readings are dense.

use rayon::prelude::*;

use crate::plane::{Point, into_disk};

/// Cells along one side of the square `[-1, 1]^2`: 3.6 degrees at the normal, 1.8 degrees at the horizon.
const CELLS: usize = 64;

/// Finest sub-grid of a cell.
const FINEST: usize = 256;

/// Points along each side of a cell at which the floor is asked for.
const FLOOR_POINTS: usize = 4;

/// The bilinear error at which the refinement of a cell stops: `relative` times the value plus its floor.
#[derive(Clone, Debug)]
pub(crate) struct Accuracy {
    pub(crate) relative: f64,
    floors: Vec<f64>,
}

impl Accuracy {
    /// The same floor in every cell.
    pub(crate) fn even(relative: f64, floor: f64) -> Self {
        Accuracy {
            relative,
            floors: vec![floor; CELLS * CELLS],
        }
    }

    /// In every cell the least floor of a few points; `floor` takes all points at once.
    pub(crate) fn of_points(relative: f64, floor: impl FnOnce(&[Point]) -> Vec<f64>) -> Self {
        let n = FLOOR_POINTS;
        let width = 2.0 / (CELLS * n) as f64;
        let mut points = Vec::with_capacity(CELLS * CELLS * n * n);
        for k in 0..CELLS * CELLS {
            let at = |cell: usize, j: usize| width * ((cell * n + j) as f64 + 0.5) - 1.0;
            points.extend((0..n * n).map(|j| into_disk([at(k % CELLS, j % n), at(k / CELLS, j / n)], 1.0)));
        }
        let floors = floor(&points);
        let least = |c: &[f64]| c.iter().copied().fold(f64::INFINITY, f64::min);
        Accuracy {
            relative,
            floors: floors.chunks(n * n).map(least).collect(),
        }
    }
}

#[derive(Clone, Copy, Debug, Default)]
struct Cell {
    offset: u32,
    /// Intervals along one side of the sub-grid; 0 outside the disk.
    intervals: u32,
}

/// A function over the disk.
#[derive(Clone, Debug)]
pub(crate) struct Table {
    cells: Vec<Cell>,
    values: Vec<f32>,
}

impl Table {
    /// Resamples `surface`. `density` are the points of the readings: they say where detail can be.
    pub(crate) fn new(surface: impl Fn(Point) -> f64 + Sync, density: &[Point], accuracy: &Accuracy) -> Self {
        let mut counts = vec![0usize; CELLS * CELLS];
        for p in density {
            counts[cell_of(*p).0] += 1;
        }
        let grids: Vec<(usize, Vec<f32>)> = (0..CELLS * CELLS)
            .into_par_iter()
            .map(|k| resample(&surface, k, counts[k], accuracy.relative, accuracy.floors[k]))
            .collect();
        let mut table = Table {
            cells: Vec::with_capacity(grids.len()),
            values: Vec::new(),
        };
        for (intervals, values) in grids {
            table.cells.push(Cell {
                offset: table.values.len() as u32,
                intervals: intervals as u32,
            });
            table.values.extend(values);
        }
        table
    }

    /// The value at `p`; outside the disk that of the nearest point on the horizon. 0 for a point that is not finite.
    #[inline]
    pub(crate) fn value(&self, p: Point) -> f64 {
        let p = into_disk(p, 1.0);
        let (k, [u, v]) = cell_of(p);
        let cell = self.cells[k];
        let n = cell.intervals as usize;
        if n == 0 {
            return 0.0;
        }
        let (x, y) = (u * n as f64, v * n as f64);
        let (i, j) = ((x as usize).min(n - 1), (y as usize).min(n - 1));
        let (x, y) = (x - i as f64, y - j as f64);
        let row = cell.offset as usize + j * (n + 1) + i;
        let at = |k: usize| f64::from(self.values[k]);
        let low = at(row) + x * (at(row + 1) - at(row));
        let high = at(row + n + 1) + x * (at(row + n + 2) - at(row + n + 1));
        low + y * (high - low)
    }

    /// Number of stored values.
    pub(crate) fn len(&self) -> usize {
        self.values.len()
    }
}

/// The cell around `p` and the position within it, both coordinates in `[0, 1]`.
#[inline]
fn cell_of(p: Point) -> (usize, Point) {
    let n = CELLS as f64;
    let (x, y) = ((p[0] + 1.0) * 0.5 * n, (p[1] + 1.0) * 0.5 * n);
    let (i, j) = ((x as usize).min(CELLS - 1), (y as usize).min(CELLS - 1));
    (j * CELLS + i, [(x - i as f64).min(1.0), (y - j as f64).min(1.0)])
}

fn resample(
    surface: &(impl Fn(Point) -> f64 + Sync),
    k: usize,
    readings: usize,
    relative: f64,
    floor: f64,
) -> (usize, Vec<f32>) {
    let width = 2.0 / CELLS as f64;
    let corner = [(k % CELLS) as f64 * width - 1.0, (k / CELLS) as f64 * width - 1.0];
    let nearest = |low: f64| 0f64.clamp(low, low + width);
    if nearest(corner[0]).hypot(nearest(corner[1])) > 1.0 {
        return (0, Vec::new());
    }
    let sample = |n: usize| -> Vec<f64> {
        let mut values = Vec::with_capacity((n + 1) * (n + 1));
        for j in 0..=n {
            for i in 0..=n {
                let step = width / n as f64;
                values.push(surface([
                    corner[0] + i as f64 * step,
                    corner[1] + j as f64 * step,
                ]));
            }
        }
        values
    };
    let per_side = (readings as f64).sqrt();
    let finest = ((2.0 * per_side) as usize).next_power_of_two().clamp(4, FINEST);
    let mut n = ((0.5 * per_side) as usize).next_power_of_two().clamp(2, finest);
    let mut values = sample(n);
    while n < finest {
        let fine = sample(2 * n);
        let good = bilinear_error_is_small(&values, &fine, n, relative, floor);
        if good {
            break;
        }
        n *= 2;
        values = fine;
    }
    (n, values.iter().map(|&v| v as f32).collect())
}

/// Whether the `n`-grid interpolates every vertex of the `2 n`-grid well.
fn bilinear_error_is_small(coarse: &[f64], fine: &[f64], n: usize, relative: f64, floor: f64) -> bool {
    let c = |i: usize, j: usize| coarse[j * (n + 1) + i];
    for j in 0..=2 * n {
        for i in 0..=2 * n {
            let (a, b) = (i / 2, j / 2);
            let (a1, b1) = (a + i % 2, b + j % 2);
            let guess = 0.25 * (c(a, b) + c(a1, b) + c(a, b1) + c(a1, b1));
            let value = fine[j * (2 * n + 1) + i];
            if (guess - value).abs() > relative * value.abs() + floor {
                return false;
            }
        }
    }
    true
}

#[cfg(test)]
mod tests {
    use super::*;

    fn fine() -> Accuracy {
        Accuracy::even(1e-3, 1e-4)
    }

    fn spiral(n: usize) -> impl Iterator<Item = Point> {
        let golden = std::f64::consts::PI * (1.0 + 5f64.sqrt());
        (0..n).map(move |k| {
            let (r, a) = (((k as f64 + 0.5) / n as f64).sqrt(), golden * k as f64);
            [r * a.cos(), r * a.sin()]
        })
    }

    #[test]
    fn a_lobe_the_readings_resolve_survives_resampling_within_two_per_mille() {
        let width = 0.01; // 1.15 degrees
        let lobe = |p: Point| 0.1 + 100.0 * (-((p[0] - 0.3).powi(2) + p[1].powi(2)) / (width * width)).exp();
        let dense: Vec<Point> = spiral(80_000).map(|p| [0.3 + 0.1 * p[0], 0.1 * p[1]]).collect();
        let table = Table::new(lobe, &dense, &fine());
        let worst = spiral(50_000)
            .map(|p| [0.3 + 0.05 * p[0], 0.05 * p[1]])
            .map(|p| (table.value(p) / lobe(p) - 1.0).abs())
            .fold(0.0, f64::max);
        assert!(worst < 2e-3, "{worst}");
    }

    #[test]
    fn a_bilinear_function_needs_the_coarsest_sub_grids_only() {
        let plane = |p: Point| 1.0 + 0.5 * p[0] - 0.2 * p[1];
        let table = Table::new(plane, &[], &fine());
        assert!(table.len() <= CELLS * CELLS * 9);
        for p in spiral(1000) {
            assert!((table.value(p) - plane(p)).abs() < 1e-6);
        }
    }

    #[test]
    fn points_outside_the_disk_answer_as_on_the_horizon() {
        let table = Table::new(|p| p[0], &[], &fine());
        assert!((table.value([2.0, 0.0]) - 1.0).abs() < 1e-3);
    }
}
