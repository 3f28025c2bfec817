//! The sky through openings of rooms [Bitterli2015].

use glam::{DVec3, Vec3};

/// Cells of a table on each axis.
const CELLS: usize = 64;
/// Lines between them.
const LINES: usize = CELLS + 1;

/// What the sky brings by the two slopes with which a direction leaves an opening: sums over all cells up to both. The paper
/// takes angles; any coordinate that each slope has of its own keeps a rectangle a rectangle.
#[derive(Clone, Debug)]
struct Table {
    /// Rows by the first slope.
    sums: Vec<f64>,
}

/// Solid angle by the two coordinates of a direction with these slopes.
fn stretch(s: f64, t: f64) -> f64 {
    let (ds, dt) = (1.0 + s.abs(), 1.0 + t.abs());
    let r2 = 1.0 + s * s + t * t;
    (ds * ds) * (dt * dt) / (r2 * r2.sqrt())
}

/// The coordinate of a slope, in cells: a map of all slopes to a finite range that takes neither sines nor roots.
fn cell(slope: f64) -> f64 {
    (0.5 + 0.5 * slope / (1.0 + slope.abs())) * CELLS as f64
}

fn slope(cell: f64) -> f64 {
    let x = 2.0 * cell / CELLS as f64 - 1.0;
    x / (1.0 - x.abs()).max(1e-12)
}

/// A cell and where in it.
fn split(at: f64) -> (usize, f64) {
    let k = (at.max(0.0) as usize).min(CELLS - 1);
    (k, at - k as f64)
}

impl Table {
    fn new(bright: &dyn Fn(Vec3) -> f32, [x, y, z]: [DVec3; 3]) -> Self {
        let mut sums = vec![0.0; LINES * LINES];
        for i in 0..CELLS {
            let mut row = 0.0;
            for j in 0..CELLS {
                let (s, t) = (slope(i as f64 + 0.5), slope(j as f64 + 0.5));
                let direction = (s * x + t * y + z).normalize();
                let value = f64::from(bright(direction.as_vec3()));
                // A cell without light may have some beside its middle.
                let value = if value.is_finite() { value.max(0.0) } else { 0.0 };
                row += stretch(s, t) * value;
                sums[(i + 1) * LINES + j + 1] = sums[i * LINES + j + 1] + row;
            }
        }
        // A share of the mean everywhere: what lies between the middles of cells is found.
        let even = 0.05 * sums[LINES * LINES - 1] / (CELLS * CELLS) as f64;
        for i in 0..LINES {
            for j in 0..LINES {
                sums[i * LINES + j] += even * (i * j) as f64;
            }
        }
        Table { sums }
    }

    /// The sum up to two lines or between.
    fn sum(&self, i: usize, along: (usize, f64)) -> f64 {
        let (j, part) = along;
        let row = &self.sums[i * LINES + j..i * LINES + j + 2];
        row[0] + part * (row[1] - row[0])
    }

    fn up_to(&self, across: (usize, f64), along: (usize, f64)) -> f64 {
        let (low, high) = (self.sum(across.0, along), self.sum(across.0 + 1, along));
        low + across.1 * (high - low)
    }

    /// What a window brings.
    fn within(&self, window: &Window) -> f64 {
        let [[a, b], [c, d]] = window.0.map(|ends| ends.map(split));
        self.up_to(b, d) - self.up_to(a, d) - self.up_to(b, c) + self.up_to(a, c)
    }

    /// What a cell brings.
    fn density(&self, i: usize, j: usize) -> f64 {
        let at = |i: usize, j: usize| self.sums[i * LINES + j];
        at(i + 1, j + 1) - at(i, j + 1) - at(i + 1, j) + at(i, j)
    }

    /// A place in the window, in cells, in proportion to what it brings.
    fn draw(&self, window: &Window, [u, v]: [f64; 2]) -> [f64; 2] {
        let [[a, b], [c, d]] = window.0;
        let ends = [c, d].map(split);
        let band = |i: usize| self.sum(i, ends[1]) - self.sum(i, ends[0]);
        let first = invert(a, b, u, band);
        let (i, _) = split(first);
        let second = invert(c, d, v, |j| {
            self.sums[(i + 1) * LINES + j] - self.sums[i * LINES + j]
        });
        [first, second]
    }
}

/// Where between `a` and `b` a running sum that is straight between whole numbers reaches the share `u`.
fn invert(a: f64, b: f64, u: f64, sum: impl Fn(usize) -> f64) -> f64 {
    let at = |x: f64| {
        let (k, part) = split(x);
        let low = sum(k);
        low + part * (sum(k + 1) - low)
    };
    let (from, to) = (at(a), at(b));
    let wanted = from + u * (to - from);
    let (mut low, mut high) = (split(a).0, split(b).0 + 1);
    while high - low > 1 {
        let middle = (low + high) / 2;
        if sum(middle) <= wanted {
            low = middle;
        } else {
            high = middle;
        }
    }
    let (below, above) = (sum(low), sum(low + 1));
    let part = if above > below {
        (wanted - below) / (above - below)
    } else {
        0.5
    };
    (low as f64 + part).clamp(a, b)
}

/// The two ranges of coordinates, in cells, in which an opening is seen.
#[derive(Clone, Copy, Default)]
struct Window([[f64; 2]; 2]);

/// An opening seen from inside.
#[derive(Clone, Debug)]
struct Opening {
    corner: DVec3,
    /// Lengths along the first two axes.
    size: [f64; 2],
    /// Along the edges, and outward.
    axes: [DVec3; 3],
    table: usize,
    /// Share of the directions outward that meet nothing.
    clear: f64,
}

impl Opening {
    /// How it is seen from a point; `None` from outside.
    fn window(&self, from: DVec3) -> Option<Window> {
        let way = self.corner - from;
        let height = way.dot(self.axes[2]);
        if height <= 1e-9 * way.length() {
            return None;
        }
        let range = |k: usize| {
            let low = way.dot(self.axes[k]);
            [low, low + self.size[k]].map(|x| cell(x / height))
        };
        let window = Window([range(0), range(1)]);
        // So far aside that nothing is left of it.
        window.0.iter().all(|[a, b]| b - a > 1e-7).then_some(window)
    }
}

/// All openings.
#[derive(Clone, Debug, Default)]
pub(crate) struct Openings {
    all: Vec<Opening>,
    tables: Vec<Table>,
    /// Axes of the tables.
    frames: Vec<[DVec3; 3]>,
}

impl Openings {
    /// Adds a parallelogram by corner and edges, which lets this share of the light towards the side of `outward` pass,
    /// `bright` by direction; one that is no rectangle is left out, and one that lets nothing pass.
    pub(crate) fn add(
        &mut self,
        bright: &dyn Fn(Vec3) -> f32,
        [corner, a, b]: [Vec3; 3],
        outward: Vec3,
        clear: f32,
    ) {
        let (corner, a, b) = (corner.as_dvec3(), a.as_dvec3(), b.as_dvec3());
        let (Some(x), Some(y)) = (a.try_normalize(), b.try_normalize()) else {
            return;
        };
        if x.dot(y).abs() > 1e-3 || clear <= 0.0 {
            return;
        }
        let z = x.cross(y).normalize();
        let z = z * 1.0_f64.copysign(z.dot(outward.as_dvec3()));
        let y = z.cross(x) * 1.0_f64.copysign(z.cross(x).dot(b));
        let axes = [x, y, z];
        let close = |other: &[DVec3; 3]| axes.iter().zip(other).all(|(a, b)| a.distance(*b) < 1e-9);
        let table = self.frames.iter().position(close).unwrap_or_else(|| {
            self.frames.push(axes);
            self.tables.push(Table::new(bright, axes));
            self.tables.len() - 1
        });
        self.all.push(Opening {
            corner,
            size: [a.length(), b.dot(y)],
            axes,
            table,
            clear: f64::from(clear),
        });
    }

    pub(crate) fn is_empty(&self) -> bool {
        self.all.is_empty()
    }

    /// What is seen from a point.
    pub(crate) fn seen(&self, from: Vec3) -> Seen {
        let from = from.as_dvec3();
        let mut seen = Seen {
            from,
            total: 0.0,
            first: None,
        };
        for (k, opening) in self.all.iter().enumerate() {
            if let Some((window, brings)) = self.through(opening, from) {
                seen.total += brings;
                seen.first.get_or_insert((k, window, brings));
            }
        }
        seen
    }

    fn through(&self, opening: &Opening, from: DVec3) -> Option<(Window, f64)> {
        let window = opening.window(from)?;
        let brings = opening.clear * self.tables[opening.table].within(&window);
        (brings > 0.0).then_some((window, brings))
    }

    /// A direction through one of them, `None` where none is seen.
    pub(crate) fn sample(&self, seen: &Seen, [u, v]: [f32; 2]) -> Option<Vec3> {
        let (first, window, brings) = seen.first?;
        let mut chosen = (&self.all[first], window, brings);
        let mut left = f64::from(u) * seen.total;
        for opening in &self.all[first + 1..] {
            if left < chosen.2 {
                break;
            }
            if let Some((window, brings)) = self.through(opening, seen.from) {
                left -= chosen.2;
                chosen = (opening, window, brings);
            }
        }
        let (opening, window, brings) = chosen;
        let share = (left / brings).min(1.0);
        let place = self.tables[opening.table].draw(&window, [share, f64::from(v)]);
        let [s, t] = place.map(slope);
        let [x, y, z] = opening.axes;
        Some((s * x + t * y + z).normalize().as_vec3())
    }

    /// The density per solid angle with which [`Openings::sample`] draws a unit direction.
    pub(crate) fn pdf(&self, seen: &Seen, direction: Vec3) -> f32 {
        let Some((first, window, _)) = seen.first else {
            return 0.0;
        };
        let direction = direction.as_dvec3();
        let mut sum = self.density(&self.all[first], &window, direction);
        for opening in &self.all[first + 1..] {
            if let Some(window) = opening.window(seen.from) {
                sum += self.density(opening, &window, direction);
            }
        }
        (sum / seen.total * (0.5 * CELLS as f64).powi(2)) as f32
    }

    /// What a direction brings if it lies in the window.
    fn density(&self, opening: &Opening, window: &Window, direction: DVec3) -> f64 {
        let [a, b, c] = opening.axes.map(|axis| direction.dot(axis));
        if c <= 0.0 {
            return 0.0;
        }
        let (s, t) = (a / c, b / c);
        let place = [cell(s), cell(t)];
        let inside = |(p, [low, high]): (&f64, &[f64; 2])| p >= low && p <= high;
        if !place.iter().zip(&window.0).all(inside) {
            return 0.0;
        }
        let density = self.tables[opening.table].density(split(place[0]).0, split(place[1]).0);
        opening.clear * density / stretch(s, t)
    }
}

/// The openings seen from a point.
pub(crate) struct Seen {
    from: DVec3,
    /// What all bring; of no unit.
    total: f64,
    /// The first of them, its window and what it brings.
    first: Option<(usize, Window, f64)>,
}

impl Seen {
    /// What all of them bring, roughly: radiance times solid angle, of the brightest channel.
    pub(crate) fn brings(&self) -> f32 {
        (self.total / (0.5 * CELLS as f64).powi(2)) as f32
    }

    /// Whether there is none.
    pub(crate) fn is_empty(&self) -> bool {
        self.first.is_none()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sampler::Sampler;

    #[test]
    fn directions_through_two_openings_have_the_stated_density_and_pass_them() {
        let bright = Vec3::new(0.2, 0.9, 0.4).normalize();
        let sky = move |d: Vec3| {
            if d.z > 0.0 {
                1.0 + 20.0 * d.dot(bright).max(0.0).powi(30)
            } else {
                0.2
            }
        };
        let mut openings = Openings::default();
        let first = [Vec3::new(-1.0, 2.0, 0.5), Vec3::X * 2.0, Vec3::Z];
        openings.add(&sky, first, Vec3::Y, 1.0);
        let second = [Vec3::new(3.0, -0.5, 0.0), Vec3::Z * 2.0, Vec3::Y * 1.5];
        openings.add(&sky, second, Vec3::X, 0.5);
        assert_eq!(openings.tables.len(), 2);
        let from = Vec3::new(0.3, -0.2, 0.7);
        let seen = openings.seen(from);
        let n = 100_000;
        // The solid angles, and the mean of one coordinate, by the area of the openings.
        let mut wanted = [0.0_f64; 2];
        for [corner, a, b] in [first, second] {
            for k in 0..400 * 400 {
                let at = |k: i32| (k as f32 + 0.5) / 400.0;
                let way = corner + at(k % 400) * a + at(k / 400) * b - from;
                let cos = way.normalize().dot(a.cross(b).normalize()).abs();
                let angle = f64::from(cos * a.cross(b).length() / way.length_squared()) / 160_000.0;
                wanted[0] += angle;
                wanted[1] += angle * f64::from(way.normalize().z);
            }
        }
        let mut found = [0.0_f64; 2];
        for k in 0..n {
            let d = openings.sample(&seen, Sampler::new(2, 0, k).two()).unwrap();
            let weight = 1.0 / f64::from(openings.pdf(&seen, d)) / f64::from(n);
            found[0] += weight;
            found[1] += weight * f64::from(d.z);
        }
        for (f, w) in found.iter().zip(wanted) {
            assert!((f - w).abs() < 3e-3 * wanted[0], "{found:?} {wanted:?}");
        }
        // Behind the first, the second alone is left.
        let aside = Vec3::new(0.0, 5.0, 0.0);
        let d = openings.sample(&openings.seen(aside), [0.3, 0.6]).unwrap();
        assert!(d.x > 0.0 && d.y < 0.0);
        assert!(openings.seen(Vec3::new(5.0, 5.0, 0.0)).is_empty());
    }
}
