//! Triangles over scattered points of the stereographic disk, with fast location in any order.

use gonio_geom::delaunay::{Adjacency, Delaunay, Location};
use gonio_geom::{DVec3, Side};

use crate::plane::{Point, from_plane};

/// The Delaunay triangulation of points of the disk, with a grid of seeds from which a walk finds any triangle in a
/// few steps.
#[derive(Debug)]
pub(crate) struct Mesh {
    points: Vec<Point>,
    delaunay: Delaunay,
    /// A triangle in or near each cell of the seed grid.
    seeds: Vec<u32>,
    side: usize,
}

impl Mesh {
    /// The mesh of `points` of the unit disk; `None` when they span no triangle or lie outside.
    pub(crate) fn new(points: Vec<Point>) -> Option<Self> {
        let directions: Vec<DVec3> = points.iter().map(|&p| from_plane(p)).collect();
        let delaunay = Delaunay::new(&directions, Side::Front).ok()?;
        if delaunay.triangles().is_empty() {
            return None;
        }
        let side = ((points.len() as f64 / 4.0).sqrt() as usize).clamp(4, 512);
        let mut mesh = Mesh {
            points,
            delaunay,
            seeds: Vec::new(),
            side,
        };
        mesh.seeds = mesh.seed();
        Some(mesh)
    }

    /// A triangle of every grid cell: one with its centroid there, else that of the cell before it in the row.
    fn seed(&self) -> Vec<u32> {
        let n = self.side;
        let mut seeds = vec![u32::MAX; n * n];
        for t in 0..self.triangles().len() {
            seeds[self.cell(self.centroid(t))] = t as u32;
        }
        for row in seeds.chunks_mut(n) {
            let mut last = row.iter().copied().find(|&t| t != u32::MAX).unwrap_or(0);
            for seed in row {
                if *seed == u32::MAX {
                    *seed = last;
                }
                last = *seed;
            }
        }
        seeds
    }

    fn cell(&self, p: Point) -> usize {
        let n = self.side;
        let index = |x: f64| (((x + 1.0) * 0.5 * n as f64).max(0.0) as usize).min(n - 1);
        index(p[1]) * n + index(p[0])
    }

    /// Every vertex.
    pub(crate) fn points(&self) -> &[Point] {
        &self.points
    }

    /// Vertices of the convex hull in order.
    pub(crate) fn hull(&self) -> Vec<u32> {
        self.delaunay.hull()
    }

    /// Vertices of every triangle.
    pub(crate) fn triangles(&self) -> &[[u32; 3]] {
        self.delaunay.triangles()
    }

    /// Vertices joined to each vertex by an edge.
    pub(crate) fn adjacency(&self) -> Adjacency {
        self.delaunay.adjacency()
    }

    /// The corners of a triangle.
    pub(crate) fn corners(&self, triangle: usize) -> [Point; 3] {
        self.triangles()[triangle].map(|k| self.points[k as usize])
    }

    pub(crate) fn centroid(&self, triangle: usize) -> Point {
        let [a, b, c] = self.corners(triangle);
        [(a[0] + b[0] + c[0]) / 3.0, (a[1] + b[1] + c[1]) / 3.0]
    }

    /// Area in the plane.
    pub(crate) fn area(&self, triangle: usize) -> f64 {
        let [a, b, c] = self.corners(triangle);
        0.5 * ((b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])).abs()
    }

    /// Where `p` lies; `None` outside the hull or when `p` is not finite. On a vertex all three vertices are that
    /// one, and the triangle is any.
    pub(crate) fn locate(&self, p: Point) -> Option<Location> {
        if !(p[0].is_finite() && p[1].is_finite()) {
            return None;
        }
        self.delaunay.locate(from_plane(p), self.seeds[self.cell(p)])
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn scattered(n: usize) -> Vec<Point> {
        let golden = std::f64::consts::PI * (1.0 + 5f64.sqrt());
        (0..n)
            .map(|k| {
                let (r, a) = (((k as f64 + 0.5) / n as f64).sqrt(), golden * k as f64);
                [r * a.cos(), r * a.sin()]
            })
            .collect()
    }

    #[test]
    fn a_linear_function_is_reproduced_inside_the_hull() {
        let mesh = Mesh::new(scattered(500)).unwrap();
        let f = |p: Point| 1.0 + 2.0 * p[0] - 3.0 * p[1];
        for q in scattered(3000) {
            let p = [q[0] * 0.9, q[1] * 0.9];
            let found = mesh.locate(p).unwrap();
            let value: f64 = (0..3)
                .map(|k| found.weights[k] * f(mesh.points()[found.vertices[k] as usize]))
                .sum();
            assert!((value - f(p)).abs() < 1e-9);
        }
    }

    #[test]
    fn a_point_outside_the_hull_is_not_found() {
        let inner: Vec<Point> = scattered(50).iter().map(|p| [0.5 * p[0], 0.5 * p[1]]).collect();
        let mesh = Mesh::new(inner).unwrap();
        assert!(mesh.locate([0.6, 0.6]).is_none());
        assert!(mesh.locate([f64::NAN, 0.0]).is_none());
    }

    #[test]
    fn points_on_a_line_span_no_mesh() {
        assert!(Mesh::new((0..10).map(|k| [0.1 * k as f64 - 0.5, 0.0]).collect()).is_none());
    }

    #[test]
    fn adjacency_is_symmetric() {
        let mesh = Mesh::new(scattered(200)).unwrap();
        let neighbours = mesh.adjacency();
        for a in 0..200 {
            for &b in neighbours.of(a) {
                assert!(neighbours.of(b as usize).contains(&(a as u32)));
            }
        }
    }
}
