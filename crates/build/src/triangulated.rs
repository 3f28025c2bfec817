//! Directions of incidence of a sample with axes, triangulated with their images.

use std::sync::Arc;

use gonio_geom::DVec3;

use crate::images::{Image, Images};
use crate::layout::{Near, Neighbour};
use crate::mesh::Mesh;
use crate::plane::Point;
use crate::weights::{Natural, quadratic, to_incidence_plane};

/// A measured incidence or an image of one.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Placed {
    pub(crate) node: usize,
    pub(crate) image: Image,
    /// Where the image lies.
    pub(crate) direction: DVec3,
}

/// Directions of incidence and their images with their triangulation (`None` for fewer than three, or in one plane).
#[derive(Clone, Debug)]
pub(crate) struct Triangulated {
    nodes: usize,
    placed: Vec<Placed>,
    points: Vec<Point>,
    mesh: Option<Arc<(Mesh, Natural)>>,
    hull: Vec<usize>,
}

/// Images this close to a measured incidence (plane of incidences) are that incidence: half a degree.
const SAME_PLACE: f64 = 0.5 / 90.0;

impl Triangulated {
    /// The first entries are the incidences as measured.
    pub(crate) fn new(directions: &[DVec3], images: Images) -> Self {
        let mut placed: Vec<Placed> = Vec::new();
        let mut points: Vec<Point> = Vec::new();
        for image in images.iter() {
            for (node, &direction) in directions.iter().enumerate() {
                let direction = image.of(direction);
                let p = to_incidence_plane(direction);
                let there = |q: &Point| (q[0] - p[0]).hypot(q[1] - p[1]) < SAME_PLACE;
                if image != Image::SAME && points.iter().any(there) {
                    continue;
                }
                placed.push(Placed {
                    node,
                    image,
                    direction,
                });
                points.push(p);
            }
        }
        let mesh = Mesh::new(points.clone());
        let hull = mesh
            .as_ref()
            .map_or_else(Vec::new, |m| m.hull().iter().map(|&k| k as usize).collect());
        Triangulated {
            nodes: directions.len(),
            mesh: mesh.map(|m| {
                let natural = Natural::new(&points, m.triangles());
                Arc::new((m, natural))
            }),
            placed,
            points,
            hull,
        }
    }

    /// The measured incidences and their images.
    pub(crate) fn placed(&self) -> &[Placed] {
        &self.placed
    }

    /// Incidences with others on all sides, themselves and their images.
    pub(crate) fn interior(&self) -> Vec<usize> {
        if self.mesh.is_none() {
            return Vec::new();
        }
        let edge = self.on_hull();
        (0..self.nodes).filter(|k| !edge.contains(k)).collect()
    }

    /// A local quadratic; `None` where it would amplify errors.
    pub(crate) fn near_quadratic(&self, i: DVec3) -> Option<Near> {
        let weights = quadratic(&self.points, to_incidence_plane(i))?;
        Some(self.near_by(weights.as_slice(), true))
    }

    fn near_by(&self, weights: &[(usize, f64)], inside: bool) -> Near {
        Near::placed(weights, inside, |k| (self.placed[k].node, self.placed[k].image))
    }

    /// Natural neighbours; outside the hull linear along its nearest edge; without a triangulation the nearest incidence
    /// alone.
    pub(crate) fn near(&self, i: DVec3) -> Near {
        let p = to_incidence_plane(i);
        let Some(mesh) = &self.mesh else {
            return self.near_by(&[(self.nearest(i), 1.0)], false);
        };
        let (mesh, natural) = &**mesh;
        if let Some(at) = mesh.locate(p) {
            let corners = at.vertices.map(|k| k as usize);
            if let Some(k) = (0..3).find(|&k| at.weights[k] > 1.0 - 1e-9) {
                return self.near_by(&[(corners[k], 1.0)], true);
            }
            return match natural.weights(&self.points, p) {
                Some(weights) => self.near_by(weights.as_slice(), true),
                None => {
                    let entries: [(usize, f64); 3] = std::array::from_fn(|k| (corners[k], at.weights[k]));
                    self.near_by(&entries, true)
                }
            };
        }
        let mut best = (f64::INFINITY, 0, 0, 0.0);
        for (k, &a) in self.hull.iter().enumerate() {
            let b = self.hull[(k + 1) % self.hull.len()];
            let (t, d2) = project_on(self.points[a], self.points[b], p);
            if d2 < best.0 {
                best = (d2, a, b, t);
            }
        }
        let (_, a, b, t) = best;
        self.near_by(&[(a, 1.0 - t), (b, t)], false)
    }

    /// Position of the nearest incidence or image.
    fn nearest(&self, i: DVec3) -> usize {
        let mut best = 0;
        for k in 1..self.placed.len() {
            if self.placed[k].direction.dot(i) > self.placed[best].direction.dot(i) {
                best = k;
            }
        }
        best
    }

    /// Incidences that stand on the hull, themselves or their images.
    pub(crate) fn on_hull(&self) -> Vec<usize> {
        let mut nodes = Vec::new();
        for &k in &self.hull {
            if !nodes.contains(&self.placed[k].node) {
                nodes.push(self.placed[k].node);
            }
        }
        nodes
    }

    pub(crate) fn pairs(&self) -> Vec<(Neighbour, usize)> {
        let Some(mesh) = &self.mesh else { return Vec::new() };
        let triangles = mesh.0.triangles().iter();
        let mut edges: Vec<(u32, u32)> = triangles
            .flat_map(|t| [(t[0], t[1]), (t[1], t[2]), (t[2], t[0])])
            .flat_map(|(a, b)| [(a, b), (b, a)])
            .collect();
        edges.sort_unstable();
        edges.dedup();
        edges
            .into_iter()
            .map(|(a, b)| (self.placed[a as usize], self.placed[b as usize]))
            .filter(|(a, b)| b.image == Image::SAME && a.node != b.node)
            .map(|(a, b)| (Neighbour::whole(a.node, a.image), b.node))
            .collect()
    }
}

/// Position along the segment `a b` (0 to 1) of the point nearest to `p`, and its squared distance.
fn project_on(a: Point, b: Point, p: Point) -> (f64, f64) {
    let (dx, dy) = (b[0] - a[0], b[1] - a[1]);
    let (x, y) = (p[0] - a[0], p[1] - a[1]);
    let t = ((x * dx + y * dy) / (dx * dx + dy * dy).max(1e-300)).clamp(0.0, 1.0);
    (t, (x - t * dx).powi(2) + (y - t * dy).powi(2))
}
