//! Linear rule of one cell: weights of a reading and its neighbours for the integral of `f |cos θ|` over the cell.

use glam::DVec3;

use crate::weights::{Cell, Diagram, area_and_moment};

/// Triangles with a side longer than this (radians) are bisected before a node is put into them.
const FINEST: f64 = 0.03;
/// Weight of the prior `slope = 0`, `second derivative = 0` against the neighbours, in units of the farthest neighbour:
/// decides only the directions in which the neighbours say nothing.
const RIDGE: f64 = 1e-3;
/// Squared distance, in units of that of the farthest neighbour or corner of the cell, below which a neighbour says ever less about the slope:
/// the difference of two readings of nearly the same direction is their noise.
const CLOSE: f64 = 4e-4;

/// The rules of one cell; buffers are kept between calls.
///
/// `f` around the reading is a polynomial through the reading's own value, fitted to the neighbours by least squares
/// with weights `1 / distance²`, less for very close ones ([`CLOSE`]). Its integral over the cell is linear in the neighbours' values:
/// `∫ f |cos θ| dω = measured f_i + Σ_j w_j (f_j - f_i)` with `w = linear` (gradient) or `quadratic` (gradient and
/// second derivatives).
#[derive(Default)]
pub(crate) struct Stencil {
    /// Projected solid angle of the part of the cell within the limit, sr.
    pub(crate) measured: f64,
    /// Solid angle of that part, sr.
    pub(crate) measured_omega: f64,
    /// Weights of the neighbours in the linear rule, sr.
    pub(crate) linear: Vec<f64>,
    /// Weights of the neighbours in the quadratic rule, sr.
    pub(crate) quadratic: Vec<f64>,
    /// Nodes of the part beyond the limit: direction (front frame) and projected solid angle.
    pub(crate) far: Vec<(DVec3, f64)>,
    rows: Vec<[f64; 6]>,
}

impl Stencil {
    /// Rules of the cell of point `i`; what lies farther than `limit` radians from the point becomes `far`. With
    /// `linear_only` the quadratic rule is the linear one.
    pub(crate) fn build(
        &mut self,
        diagram: &Diagram<'_>,
        i: usize,
        cell: &Cell,
        limit: f64,
        linear_only: bool,
    ) {
        let p = diagram.point(i);
        let (t1, t2) = p.any_orthonormal_pair();
        let limit2 = (2.0 * (0.5 * limit).sin()).powi(2);
        self.far.clear();
        let (mut total, mut total_omega, mut far_omega) = (0.0, 0.0, 0.0);
        let mut m = [0.0; 5];
        for piece in cell.pieces() {
            let (omega, moment) = area_and_moment(piece);
            total += moment.z;
            total_omega += omega;
            let Some(centre) = moment.try_normalize() else {
                continue;
            };
            let near = piece.iter().all(|v| v.distance_squared(p) <= limit2);
            let far = &mut self.far;
            let mut add = |a: DVec3, b: DVec3, c: DVec3| {
                let area = 0.5 * (b - a).cross(c - a).length();
                let middle = (a + b + c) / 3.0;
                if !near && middle.distance_squared(p) > limit2 {
                    far_omega += area;
                    far.extend(middle.try_normalize().map(|d| (d, area * d.z)));
                    return;
                }
                for x in [a + b, b + c, c + a] {
                    // midpoints of the sides: exact for quadratics on a plane triangle
                    let w = area * x.z / 6.0;
                    let (u, v) = (0.5 * x.dot(t1), 0.5 * x.dot(t2));
                    m[0] += w * u;
                    m[1] += w * v;
                    m[2] += 0.5 * w * u * u;
                    m[3] += w * u * v;
                    m[4] += 0.5 * w * v * v;
                }
            };
            let mut from = piece[piece.len() - 1];
            for &to in piece {
                bisect(centre, from, to, &mut add);
                from = to;
            }
        }
        let far_projected = self.far.iter().map(|n| n.1).sum::<f64>();
        self.measured = (total - far_projected).max(0.0);
        self.measured_omega = (total_omega - far_omega).max(0.0);
        self.fit(diagram, p, (t1, t2), cell, m);
        if linear_only {
            self.quadratic.copy_from_slice(&self.linear);
        }
    }

    /// Solves the normal equations for the moments `m` and spreads them over the neighbours.
    fn fit(&mut self, diagram: &Diagram<'_>, p: DVec3, (t1, t2): (DVec3, DVec3), cell: &Cell, m: [f64; 5]) {
        self.rows.clear();
        self.linear.clear();
        self.quadratic.clear();
        let mut farthest: f64 = 0.0;
        for &j in &cell.neighbours {
            let d = diagram.point(j as usize) - p;
            let (u, v) = (d.dot(t1), d.dot(t2));
            let d2 = u * u + v * v;
            farthest = farthest.max(d2);
            self.rows.push([u, v, 0.5 * u * u, u * v, 0.5 * v * v, d2]);
        }
        if farthest == 0.0 {
            self.linear.resize(self.rows.len(), 0.0);
            self.quadratic.resize(self.rows.len(), 0.0);
            return;
        }
        let extent2 = farthest.max(cell.reach(p).powi(2));
        let scale = 1.0 / extent2.sqrt();
        let mut normal = [[0.0; 5]; 5];
        for row in &mut self.rows {
            row[5] = 1.0 / (row[5] + CLOSE * extent2);
            for x in &mut row[2..5] {
                *x *= scale;
            }
            for a in 0..5 {
                for b in 0..=a {
                    normal[a][b] += row[5] * row[a] * row[b];
                }
            }
        }
        let m = [m[0], m[1], m[2] * scale, m[3] * scale, m[4] * scale];
        for (a, row) in normal.iter_mut().enumerate() {
            row[a] += RIDGE;
        }
        let y = solve::<2>(&normal, &m);
        self.linear
            .extend(self.rows.iter().map(|r| r[5] * (r[0] * y[0] + r[1] * y[1])));
        let y = solve::<5>(&normal, &m);
        self.quadratic.extend(
            self.rows
                .iter()
                .map(|r| r[5] * (0..5).map(|a| r[a] * y[a]).sum::<f64>()),
        );
    }
}

/// Bisects the triangle at its longest side until no side is longer than `FINEST`.
fn bisect(a: DVec3, b: DVec3, c: DVec3, visit: &mut impl FnMut(DVec3, DVec3, DVec3)) {
    let (ab, bc, ca) = (
        a.distance_squared(b),
        b.distance_squared(c),
        c.distance_squared(a),
    );
    let longest = ab.max(bc).max(ca);
    if longest <= FINEST * FINEST {
        visit(a, b, c);
    } else if longest == ab {
        let m = (a + b).normalize();
        bisect(a, m, c, visit);
        bisect(m, b, c, visit);
    } else if longest == bc {
        let m = (b + c).normalize();
        bisect(a, b, m, visit);
        bisect(a, m, c, visit);
    } else {
        let m = (c + a).normalize();
        bisect(a, b, m, visit);
        bisect(m, b, c, visit);
    }
}

/// Solves the leading `N` equations of a positive definite system by Cholesky's factorisation (lower triangle given).
fn solve<const N: usize>(normal: &[[f64; 5]; 5], right: &[f64; 5]) -> [f64; N] {
    let mut l = [[0.0; N]; N];
    let mut y = [0.0; N];
    for a in 0..N {
        for b in 0..=a {
            let dot: f64 = (0..b).map(|c| l[a][c] * l[b][c]).sum();
            let x = normal[a][b] - dot;
            l[a][b] = if a == b {
                x.max(f64::MIN_POSITIVE).sqrt()
            } else {
                x / l[b][b]
            };
        }
        let dot: f64 = (0..a).map(|c| l[a][c] * y[c]).sum();
        y[a] = (right[a] - dot) / l[a][a];
    }
    for a in (0..N).rev() {
        let dot: f64 = (a + 1..N).map(|c| l[c][a] * y[c]).sum();
        y[a] = (y[a] - dot) / l[a][a];
    }
    y
}
