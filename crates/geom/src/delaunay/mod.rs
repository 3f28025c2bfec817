//! Delaunay triangulation of scattered directions of one hemisphere.
//!
//! The directions are projected stereographically from the opposite pole, `(x, y) / (1 + |z|)`. That projection maps
//! circles to circles, so the plane triangulation is the spherical one of the points, triangle by triangle, as long
//! as a triangle's empty cap does not contain the opposite pole [Snyder1987, ch. 21]. Predicates are exact, indices are 32 bits.

mod build;
mod order;

use glam::DVec3;
use thiserror::Error;

use crate::Side;
use build::Place;
pub(crate) use build::{GHOST, Mesh, next, orient};
pub(crate) use order::insertion_order;

/// Points that cannot be triangulated.
#[derive(Debug, Clone, PartialEq, Error)]
pub enum DelaunayError {
    /// A vector that is not a unit vector.
    #[error("direction {index}: found ({x}, {y}, {z}), allowed a unit vector (length within 1e-6 of 1)")]
    NotUnit {
        /// Index of the point.
        index: usize,
        /// Found components.
        x: f64,
        /// Found components.
        y: f64,
        /// Found components.
        z: f64,
    },
    /// A direction of the other side.
    #[error("direction {index}: found z = {z}, allowed directions of the {side} hemisphere only")]
    WrongSide {
        /// Index of the point.
        index: usize,
        /// Its z component.
        z: f64,
        /// The side asked for.
        side: Side,
    },
    /// More points than 32-bit half-edge indices can hold.
    #[error("{found} directions found, at most {MAX_POINTS} allowed")]
    TooMany {
        /// Number of points.
        found: usize,
    },
}

/// Largest number of points: six half-edges a point must fit 32 bits.
pub const MAX_POINTS: usize = 700_000_000;

/// How far below the horizon a direction may lie and still count as on it (rounding of `theta = 90 deg`).
pub const HORIZON_TOLERANCE: f64 = 1e-12;

/// A Delaunay triangulation of directions of one hemisphere.
///
/// Triangles are counter-clockwise in the projected plane, that is seen from outside the sphere for the front and
/// from inside for the back. Exact copies of a direction are one vertex; see [`Delaunay::copies`].
#[derive(Debug)]
pub struct Delaunay {
    side: Side,
    xy: Vec<[f64; 2]>,
    mesh: Mesh,
    real: usize,
    copies: Vec<(u32, u32)>,
}

/// A place inside the triangulation: three vertices and their barycentric weights (non-negative, sum 1) in the
/// projected plane.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Location {
    /// Index into [`Delaunay::triangles`]: a good hint for the next query nearby.
    pub triangle: u32,
    /// The vertices, indices of the points.
    pub vertices: [u32; 3],
    /// Their weights.
    pub weights: [f64; 3],
}

/// Neighbours of every vertex in compressed rows: those of point `i` are `targets[offsets[i]..offsets[i + 1]]`.
#[derive(Clone, Debug)]
pub struct Adjacency {
    /// `n + 1` row starts.
    pub offsets: Vec<u32>,
    /// Point indices.
    pub targets: Vec<u32>,
}

impl Adjacency {
    /// Neighbours of point `i`; empty for a copy of another point.
    pub fn of(&self, i: usize) -> &[u32] {
        &self.targets[self.offsets[i] as usize..self.offsets[i + 1] as usize]
    }
}

impl Delaunay {
    /// Triangulates `points` (unit vectors, all on `side`; the horizon belongs to both sides).
    ///
    /// Any number of points: with fewer than three distinct ones, or all on one circle through the opposite pole (an
    /// in-plane scan), there are no triangles. Deterministic. Time `O(n log n)`, memory about 70 bytes a point while it
    /// runs and 64 afterwards.
    ///
    /// # Errors
    /// [`DelaunayError`] when a point is not a unit vector, lies on the other side, or there are too many.
    pub fn new(points: &[DVec3], side: Side) -> Result<Delaunay, DelaunayError> {
        Ok(Delaunay::from_projected(project(points, side)?, side))
    }

    fn from_projected(xy: Vec<[f64; 2]>, side: Side) -> Delaunay {
        let mut copies = Vec::new();
        let mut mesh = {
            let order = insertion_order(&xy);
            Mesh::build(&xy, &order, &mut copies)
        };
        copies.sort_unstable();
        let real = mesh.ghosts_last();
        Delaunay {
            side,
            xy,
            mesh,
            real,
            copies,
        }
    }

    /// The hemisphere.
    pub fn side(&self) -> Side {
        self.side
    }

    /// Number of points, copies included.
    pub fn len(&self) -> usize {
        self.xy.len()
    }

    /// Whether there are no points.
    pub fn is_empty(&self) -> bool {
        self.xy.is_empty()
    }

    /// Vertices of every triangle, indices of the points.
    pub fn triangles(&self) -> &[[u32; 3]] {
        &self.mesh.tri[..self.real]
    }

    /// Triangle across the edge from vertex `k` to vertex `k + 1` of `triangle`; `None` on the hull.
    pub fn neighbour(&self, triangle: u32, k: usize) -> Option<u32> {
        let t = self.mesh.twin[3 * triangle as usize + k % 3] / 3;
        ((t as usize) < self.real).then_some(t)
    }

    /// `(copy, vertex)` of every point that equals another one exactly, sorted; the copy is no vertex of a triangle.
    /// Empty when there are no triangles.
    pub fn copies(&self) -> &[(u32, u32)] {
        &self.copies
    }

    /// Vertices of the outer boundary of the triangulation (convex in the projected plane), counter-clockwise.
    /// Empty when there are no triangles.
    pub fn hull(&self) -> Vec<u32> {
        let mut hull = Vec::new();
        if self.real == self.mesh.tri.len() {
            return hull;
        }
        // In ghost (a, b, G) the hull runs from b to a; the ghost at a follows across the edge (G, a).
        let start = self.real as u32;
        let mut t = start;
        loop {
            let v = self.mesh.tri[t as usize];
            let g = v.iter().position(|&x| x == GHOST).unwrap_or(0);
            hull.push(v[(g + 2) % 3]);
            t = self.mesh.twin[3 * t as usize + g] / 3;
            if t == start || hull.len() > self.mesh.tri.len() {
                return hull;
            }
        }
    }

    /// Neighbours of every vertex. Without triangles every row is empty.
    pub fn adjacency(&self) -> Adjacency {
        let n = self.len();
        let mut offsets = vec![0u32; n + 1];
        // Every edge between real vertices is two half-edges over real and ghost triangles together.
        let edges = || {
            self.mesh.tri.iter().flat_map(|t| {
                [(t[0], t[1]), (t[1], t[2]), (t[2], t[0])]
                    .into_iter()
                    .filter(|e| e.0 != GHOST && e.1 != GHOST)
            })
        };
        for (a, _) in edges() {
            offsets[a as usize + 1] += 1;
        }
        for i in 0..n {
            offsets[i + 1] += offsets[i];
        }
        let mut fill = offsets.clone();
        let mut targets = vec![0u32; offsets[n] as usize];
        for (a, b) in edges() {
            targets[fill[a as usize] as usize] = b;
            fill[a as usize] += 1;
        }
        Adjacency { offsets, targets }
    }

    /// Finds the triangle that holds `direction`, walking from triangle `hint` (0 will do; the triangle of a nearby
    /// query is faster). `None` outside the hull, on the other side, or when there are no triangles.
    pub fn locate(&self, direction: DVec3, hint: u32) -> Option<Location> {
        if self.real == 0 || Side::of_z(direction.z * self.side.sign()) == Side::Back {
            return None;
        }
        let p = project_one(direction);
        let hint = if (hint as usize) < self.real { hint } else { 0 };
        let triangle = match self.mesh.locate(&self.xy, hint, p) {
            Place::Face(t) => t,
            Place::Edge(h) => h / 3,
            Place::Vertex(v) => {
                return Some(Location {
                    triangle: hint,
                    vertices: [v; 3],
                    weights: [1.0, 0.0, 0.0],
                });
            }
            Place::Outside(_) => return None,
        };
        let vertices = self.mesh.tri[triangle as usize];
        let [a, b, c] = vertices.map(|v| self.xy[v as usize]);
        let w = [orient(b, c, p), orient(c, a, p), orient(a, b, p)].map(|w| w.max(0.0));
        let sum = w[0] + w[1] + w[2];
        Some(Location {
            triangle,
            vertices,
            weights: w.map(|w| w / sum),
        })
    }

    /// Triangle to start a walk to `direction` from when nothing is known of it; see [`Locator`].
    pub fn locator(&self) -> Locator<'_> {
        Locator::new(self)
    }

    /// Linear interpolation (barycentric in the projected plane) of one value a point. `None` as for
    /// [`Delaunay::locate`].
    pub fn interpolate(&self, values: &[f64], direction: DVec3, hint: u32) -> Option<f64> {
        let at = self.locate(direction, hint)?;
        Some(
            (0..3)
                .map(|k| at.weights[k] * values[at.vertices[k] as usize])
                .sum(),
        )
    }

    pub(crate) fn mesh(&self) -> &Mesh {
        &self.mesh
    }

    pub(crate) fn xy(&self) -> &[[f64; 2]] {
        &self.xy
    }
}

/// Point location for queries in any order: a grid over the projected disk holds a triangle to start from.
#[derive(Debug)]
pub struct Locator<'a> {
    delaunay: &'a Delaunay,
    grid: Vec<u32>,
    side: usize,
}

impl<'a> Locator<'a> {
    fn new(delaunay: &'a Delaunay) -> Self {
        let side = ((delaunay.len() as f64 / 2.0).sqrt().ceil() as usize).clamp(1, 1024);
        let mut grid = vec![u32::MAX; side * side];
        for (t, v) in delaunay.triangles().iter().enumerate() {
            grid[cell(delaunay.xy[v[0] as usize], side)] = t as u32;
        }
        let mut last = 0;
        for g in &mut grid {
            if *g == u32::MAX {
                *g = last;
            } else {
                last = *g;
            }
        }
        Locator { delaunay, grid, side }
    }

    /// [`Delaunay::locate`] with a hint from the grid.
    pub fn locate(&self, direction: DVec3) -> Option<Location> {
        let hint = self.grid[cell(project_one(direction), self.side)];
        self.delaunay.locate(direction, hint)
    }
}

fn cell(p: [f64; 2], side: usize) -> usize {
    let k = |x: f64| (((x + 1.0) * 0.5 * side as f64).max(0.0) as usize).min(side - 1);
    k(p[1]) * side + k(p[0])
}

/// Stereographic projection of a direction from the pole of the other side: the hemisphere becomes the unit disk.
fn project_one(d: DVec3) -> [f64; 2] {
    let s = 1.0 / (1.0 + d.z.abs());
    [d.x * s, d.y * s]
}

fn project(points: &[DVec3], side: Side) -> Result<Vec<[f64; 2]>, DelaunayError> {
    if points.len() > MAX_POINTS {
        return Err(DelaunayError::TooMany { found: points.len() });
    }
    points
        .iter()
        .enumerate()
        .map(|(index, &d)| {
            let unit = (d.length_squared() - 1.0).abs() < 2e-6;
            if !unit {
                return Err(DelaunayError::NotUnit {
                    index,
                    x: d.x,
                    y: d.y,
                    z: d.z,
                });
            }
            if d.z * side.sign() < -HORIZON_TOLERANCE {
                return Err(DelaunayError::WrongSide { index, z: d.z, side });
            }
            // Tiny coordinates only cost exponent range in the exact predicates; they are the pole itself.
            Ok(project_one(d).map(|x| if x.abs() < 1e-60 { 0.0 } else { x }))
        })
        .collect()
}

#[cfg(test)]
mod tests;
