//! The Voronoi diagram of a hemisphere, cell by cell, from the Delaunay triangulation.
//!
//! Points of one hemisphere, mirrored in the horizon, keep the horizon as an edge of the diagram of points and
//! images; so the cell of the mirrored set equals the cell of the points alone clipped to the hemisphere, and no image is
//! needed. An inner cell is the polygon of the circumcentres around its point. Cells that touch the hull of the triangulation
//! or the horizon, or that have an ill-conditioned corner, are cut out of the hemisphere half space by half space.

use glam::DVec3;

use super::polygon::{QUARTERS, area_and_moment, clip};
use crate::delaunay::{Delaunay, GHOST, Mesh, insertion_order, next};

/// Corners worse than this (radians) are not taken from the circumcentre.
const CORNER_ERROR: f64 = 1e-10;
/// Caps wider than this (cosine of the radius) are not walked around.
const WIDEST_CAP: f64 = 0.1;

/// Cells of the points of `delaunay`, all in the frame of the front (`z` positive).
pub(crate) struct Diagram<'a> {
    points: &'a [DVec3],
    flip: DVec3,
    delaunay: &'a Delaunay,
    /// A half-edge that starts at each point; `GHOST` for a copy or without triangles.
    first: Vec<u32>,
    /// More neighbours of some points (sorted pairs): across the far side of the sphere, or along a circle.
    extra: Vec<(u32, u32)>,
    /// `(copy, point)`, sorted.
    copies: Vec<(u32, u32)>,
}

/// One cell: convex pieces (corners counter-clockwise) and the neighbouring points, kept between calls.
#[derive(Default)]
pub(crate) struct Cell {
    corners: Vec<DVec3>,
    ends: Vec<usize>,
    /// Points that share a Delaunay edge with the cell's point.
    pub(crate) neighbours: Vec<u32>,
    work: Vec<DVec3>,
    piece: Vec<DVec3>,
}

impl Cell {
    /// The convex pieces of the cell.
    pub(crate) fn pieces(&self) -> impl Iterator<Item = &[DVec3]> {
        let starts = std::iter::once(0).chain(self.ends.iter().copied());
        starts.zip(&self.ends).map(|(a, &b)| &self.corners[a..b])
    }

    /// Angle from `point` to the farthest corner, radians.
    pub(crate) fn reach(&self, point: DVec3) -> f64 {
        let chord2 = self.corners.iter().map(|c| c.distance_squared(point));
        2.0 * (0.5 * chord2.fold(0.0, f64::max).sqrt()).min(1.0).asin()
    }

    /// Whether the cell ends at the horizon.
    pub(crate) fn at_horizon(&self) -> bool {
        self.corners.iter().any(|c| c.z < 1e-9)
    }

    /// Solid angle, sr.
    pub(crate) fn omega(&self) -> f64 {
        self.pieces().map(|p| area_and_moment(p).0).sum()
    }
}

impl<'a> Diagram<'a> {
    /// `delaunay` is the triangulation of `points`.
    pub(crate) fn new(points: &'a [DVec3], delaunay: &'a Delaunay) -> Self {
        let mesh = delaunay.mesh();
        let mut first = vec![GHOST; points.len()];
        for (t, v) in mesh.tri.iter().enumerate() {
            for (k, &i) in v.iter().enumerate() {
                if i != GHOST {
                    first[i as usize] = (3 * t + k) as u32;
                }
            }
        }
        // A hull point starts at its ghost, so that one look tells hull from inside.
        for (t, v) in mesh.tri.iter().enumerate().skip(delaunay.triangles().len()) {
            for k in 0..3 {
                if v[k] != GHOST {
                    first[v[k] as usize] = (3 * t + k) as u32;
                }
            }
        }
        let mut diagram = Diagram {
            points,
            flip: DVec3::new(1.0, 1.0, delaunay.side().sign()),
            delaunay,
            first,
            extra: Vec::new(),
            copies: delaunay.copies().to_vec(),
        };
        if mesh.tri.is_empty() {
            diagram.link_line();
        } else if diagram.far_side_matters() {
            diagram.link_far_side();
        }
        diagram.extra.sort_unstable();
        diagram.extra.dedup();
        diagram
    }

    /// Point `i` in the frame of the front.
    pub(crate) fn point(&self, i: usize) -> DVec3 {
        self.points[i] * self.flip
    }

    /// `(copy, point)` of every point that has the direction of another, sorted by copy.
    pub(crate) fn copies(&self) -> &[(u32, u32)] {
        &self.copies
    }

    /// Points of one line of the projected plane lie on one circle of the sphere: each has the one before and
    /// the one after as neighbours, around the circle.
    fn link_line(&mut self) {
        let xy = self.delaunay.xy();
        let at = |i: u32| xy[i as usize];
        let mut line: Vec<u32> = (0..xy.len() as u32).collect();
        line.sort_by(|&a, &b| {
            let (p, q) = (at(a), at(b));
            p[0].total_cmp(&q[0]).then(p[1].total_cmp(&q[1])).then(a.cmp(&b))
        });
        let mut distinct: Vec<u32> = Vec::with_capacity(line.len());
        for i in line {
            match distinct.last() {
                Some(&p) if at(p) == at(i) => self.copies.push((i, p)),
                _ => distinct.push(i),
            }
        }
        self.copies.sort_unstable();
        self.link_cycle(&distinct);
    }

    fn link_cycle(&mut self, cycle: &[u32]) {
        for (k, &a) in cycle.iter().enumerate() {
            let b = cycle[(k + 1) % cycle.len()];
            if a != b {
                self.extra.extend([(a, b), (b, a)]);
            }
        }
    }

    /// Whether the pole of projection, taken as a point of its own, would own a part of the hemisphere.
    fn far_side_matters(&self) -> bool {
        let mesh = self.delaunay.mesh();
        mesh.tri[self.delaunay.triangles().len()..].iter().any(|t| {
            let [a, b, c] = t.map(|i| {
                if i == GHOST {
                    DVec3::NEG_Z
                } else {
                    self.point(i as usize)
                }
            });
            let n = (b - a).cross(c - a);
            n.z > -1e-6 * n.length()
        })
    }

    /// Links hull points across the far side of the sphere. The triangles there have their corners on the hull and
    /// are triangles of the hull points alone, which are triangulated from one of themselves as pole of projection.
    fn link_far_side(&mut self) {
        let hull = self.delaunay.hull();
        let Some((&pole, rest)) = hull.split_first() else {
            return;
        };
        let z = self.point(pole as usize);
        let x = z.any_orthonormal_vector();
        let y = z.cross(x);
        let xy: Vec<[f64; 2]> = rest
            .iter()
            .map(|&i| {
                let p = self.point(i as usize);
                // 1 - p·z without cancellation
                let s = 2.0 / (p - z).length_squared();
                [p.dot(x) * s, p.dot(y) * s]
            })
            .collect();
        let mut copies = Vec::new();
        let mesh = Mesh::build(&xy, &insertion_order(&xy), &mut copies);
        if mesh.tri.is_empty() {
            let mut cycle: Vec<u32> = (0..rest.len() as u32).collect();
            cycle.sort_by(|&a, &b| {
                let (p, q) = (xy[a as usize], xy[b as usize]);
                p[0].total_cmp(&q[0]).then(p[1].total_cmp(&q[1]))
            });
            let mut cycle: Vec<u32> = cycle.iter().map(|&k| rest[k as usize]).collect();
            cycle.push(pole);
            self.link_cycle(&cycle);
            return;
        }
        let name = |k: u32| if k == GHOST { pole } else { rest[k as usize] };
        for t in &mesh.tri {
            for k in 0..3 {
                self.extra.push((name(t[k]), name(t[(k + 1) % 3])));
            }
        }
    }

    /// Fills `cell` with the cell of point `i`; `false` for a copy of another point (whose cell it shares).
    pub(crate) fn cell(&self, i: usize, cell: &mut Cell) -> bool {
        cell.corners.clear();
        cell.ends.clear();
        cell.neighbours.clear();
        let walked = self.walk(i, cell);
        if walked {
            cell.ends.push(cell.corners.len());
            return true;
        }
        let i32 = i as u32;
        if self.first[i] == GHOST && self.copies.binary_search_by_key(&i32, |c| c.0).is_ok() {
            return false;
        }
        let from = self.extra.partition_point(|e| e.0 < i32);
        let extra = self.extra[from..].iter().take_while(|e| e.0 == i32);
        cell.neighbours.extend(extra.map(|e| e.1));
        self.cut(i, cell);
        true
    }

    /// Collects the neighbours and, if every corner is a sound circumcentre above the horizon, the corners.
    fn walk(&self, i: usize, cell: &mut Cell) -> bool {
        let start = self.first[i];
        if start == GHOST {
            return false;
        }
        let mesh = self.delaunay.mesh();
        let p = self.point(i);
        let mut sound = true;
        let mut h = start;
        let mut ahead = mesh.tri[(h / 3) as usize][(next(h) % 3) as usize];
        let mut to_ahead = if ahead == GHOST {
            DVec3::ZERO
        } else {
            self.point(ahead as usize) - p
        };
        loop {
            let back = next(next(h));
            let behind = mesh.tri[(h / 3) as usize][(back % 3) as usize];
            let to_behind = if behind == GHOST {
                DVec3::ZERO
            } else {
                self.point(behind as usize) - p
            };
            if ahead == GHOST || behind == GHOST {
                sound = false;
            } else if sound {
                let n = to_ahead.cross(to_behind);
                let length2 = n.length_squared();
                let edge2 = to_ahead.length_squared().max(to_behind.length_squared());
                let corner = n / length2.sqrt();
                sound = length2 * (CORNER_ERROR * CORNER_ERROR) > edge2 * 1e-31
                    && corner.z > 0.0
                    && corner.dot(p) > WIDEST_CAP;
                cell.corners.push(corner);
            }
            if ahead != GHOST {
                cell.neighbours.push(ahead);
            }
            (ahead, to_ahead) = (behind, to_behind);
            h = mesh.twin[back as usize];
            if h == start {
                break;
            }
        }
        if !sound {
            cell.corners.clear();
        }
        sound
    }

    /// Cuts the cell of point `i` out of the hemisphere by the half spaces towards its neighbours.
    fn cut(&self, i: usize, cell: &mut Cell) {
        let p = self.point(i);
        for quarter in &QUARTERS {
            cell.piece.clear();
            cell.piece.extend(quarter);
            for &j in &cell.neighbours {
                clip(&mut cell.piece, p - self.point(j as usize), &mut cell.work);
            }
            if cell.piece.len() >= 3 {
                cell.corners.extend(&cell.piece);
                cell.ends.push(cell.corners.len());
            }
        }
    }
}
