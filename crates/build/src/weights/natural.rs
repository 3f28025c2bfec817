//! Natural-neighbour weights \[Sibson1981\]: the share of a query's Voronoi cell that each point would lose to it.

use crate::plane::Point;

use super::Weights;

/// A query is moved by this much, so that it lies on no line through two points; the weights are put right again.
const NUDGE: Point = [1.3e-5, 0.7e-5];

/// Circles larger than this belong to slivers along the hull, in which no query lies.
const LARGEST: f64 = 100.0;

/// The circles through the corners of every triangle of a Delaunay triangulation.
#[derive(Clone, Debug)]
pub(crate) struct Natural {
    triangles: Vec<[u32; 3]>,
    circles: Vec<(Point, f64)>,
}

impl Natural {
    /// Of the triangles over `points`.
    pub(crate) fn new(points: &[Point], triangles: &[[u32; 3]]) -> Self {
        let circles = triangles
            .iter()
            .map(|t| {
                let [a, b, c] = t.map(|k| points[k as usize]);
                let centre = circumcentre(a, b, c);
                let radius2 = (a[0] - centre[0]).powi(2) + (a[1] - centre[1]).powi(2);
                if radius2 < LARGEST * LARGEST {
                    (centre, radius2 * (1.0 + 1e-9))
                } else {
                    ([0.0; 2], 0.0)
                }
            })
            .collect();
        Natural {
            triangles: triangles.to_vec(),
            circles,
        }
    }

    /// The weights at `p` inside the hull; `None` where they cannot be told to working precision.
    ///
    /// Over the triangles whose circle holds the query: the areas between its circumcentre and those of the triangles that the
    /// query makes with two of its corners \[Watson1992\].
    pub(crate) fn weights(&self, points: &[Point], p: Point) -> Option<Weights> {
        let q = [p[0] + NUDGE[0], p[1] + NUDGE[1]];
        let mut weights = Weights::NONE;
        for (triangle, (centre, radius2)) in self.triangles.iter().zip(&self.circles) {
            if (q[0] - centre[0]).powi(2) + (q[1] - centre[1]).powi(2) >= *radius2 {
                continue;
            }
            let corners = triangle.map(|k| points[k as usize]);
            let [a, b, c] = corners;
            // Without each corner in turn, from the centre of the triangle's own circle.
            let without = [(b, c), (c, a), (a, b)].map(|(u, v)| {
                let found = circumcentre(q, u, v);
                [found[0] - centre[0], found[1] - centre[1]]
            });
            for k in 0..3 {
                let (u, v) = (without[(k + 1) % 3], without[(k + 2) % 3]);
                weights.add(triangle[k] as usize, u[0] * v[1] - u[1] * v[0]);
            }
        }
        weights.linear_about(points, p)
    }
}

/// Centre of the circle through three points; far away or not finite when they lie on a line.
#[inline]
fn circumcentre(a: Point, b: Point, c: Point) -> Point {
    let (bx, by) = (b[0] - a[0], b[1] - a[1]);
    let (cx, cy) = (c[0] - a[0], c[1] - a[1]);
    let d = 0.5 / (bx * cy - by * cx);
    let (b2, c2) = (bx * bx + by * by, cx * cx + cy * cy);
    [a[0] + d * (cy * b2 - by * c2), a[1] + d * (bx * c2 - cx * b2)]
}

#[cfg(test)]
mod tests {
    use super::super::tests::{grid, queries};
    use super::*;
    use crate::mesh::Mesh;

    #[test]
    fn the_weights_are_shares_that_reproduce_every_linear_function() {
        let points = grid();
        let mesh = Mesh::new(points.clone()).unwrap();
        let natural = Natural::new(&points, mesh.triangles());
        for p in queries() {
            let w = natural.weights(&points, p).unwrap();
            let sum = |f: &dyn Fn(Point) -> f64| -> f64 {
                w.as_slice().iter().map(|(k, w)| w * f(points[*k])).sum()
            };
            assert!((sum(&|_| 1.0) - 1.0).abs() < 1e-12);
            assert!((sum(&|q| 2.0 * q[0] - q[1]) - (2.0 * p[0] - p[1])).abs() < 1e-12);
            assert!(w.as_slice().iter().all(|w| w.1 > -1e-4), "{p:?} {w:?}");
        }
    }

    #[test]
    fn on_a_square_grid_the_weights_are_those_of_the_areas_lost() {
        // A unit grid (scaled into the disk); a query in the middle of a cell takes a quarter from each corner.
        let points: Vec<Point> = (0..25)
            .map(|k| [0.2 * f64::from(k % 5) - 0.4, 0.2 * f64::from(k / 5) - 0.4])
            .collect();
        let mesh = Mesh::new(points.clone()).unwrap();
        let natural = Natural::new(&points, mesh.triangles());
        let w = natural.weights(&points, [0.1, 0.1]).unwrap();
        let near: Vec<f64> = w
            .as_slice()
            .iter()
            .map(|w| w.1)
            .filter(|w| w.abs() > 1e-4)
            .collect();
        assert_eq!(near.len(), 4);
        assert!(near.iter().all(|w| (w - 0.25).abs() < 1e-4), "{near:?}");
    }
}
