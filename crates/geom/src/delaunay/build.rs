//! Incremental Delaunay triangulation of the plane with exact predicates and 32-bit indices.
//!
//! The outside is triangulated too: every hull edge carries a triangle to one [`GHOST`] vertex at infinity (on the
//! sphere: the pole of projection), so that insertion, walking and flipping know no boundary case [Shewchuk1997 for the
//! predicates].

use robust::{Coord, incircle, orient2d};

/// The vertex at infinity.
pub(crate) const GHOST: u32 = u32::MAX;

/// Half-edge `3 t + k` runs from `tri[t][k]` to `tri[t][(k + 1) % 3]`; `twin` is the one that runs back.
#[derive(Debug, Default)]
pub(crate) struct Mesh {
    pub(crate) tri: Vec<[u32; 3]>,
    pub(crate) twin: Vec<u32>,
}

/// Where a point lies.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Place {
    /// Strictly inside a triangle.
    Face(u32),
    /// On the open edge of this half-edge.
    Edge(u32),
    /// On a vertex.
    Vertex(u32),
    /// Strictly outside the hull edge of this ghost triangle.
    Outside(u32),
}

fn coord(p: [f64; 2]) -> Coord<f64> {
    Coord { x: p[0], y: p[1] }
}

/// Positive when `a, b, c` turn left; the sign is exact.
#[inline]
pub(crate) fn orient(a: [f64; 2], b: [f64; 2], c: [f64; 2]) -> f64 {
    // The filter of the exact predicate, inlined: most calls end here.
    let left = (a[0] - c[0]) * (b[1] - c[1]);
    let right = (a[1] - c[1]) * (b[0] - c[0]);
    let det = left - right;
    if det.abs() >= 3.331e-16 * (left.abs() + right.abs()) && det != 0.0 {
        return det;
    }
    orient2d(coord(a), coord(b), coord(c))
}

#[inline]
pub(crate) fn next(h: u32) -> u32 {
    if h % 3 == 2 { h - 2 } else { h + 1 }
}

impl Mesh {
    /// The two triangles of three points that turn left and the three ghosts around them.
    fn start(a: u32, b: u32, c: u32, capacity: usize) -> Mesh {
        let mut mesh = Mesh {
            tri: Vec::with_capacity(2 * capacity + 2),
            twin: Vec::with_capacity(6 * capacity + 6),
        };
        mesh.tri
            .extend([[a, b, c], [b, a, GHOST], [c, b, GHOST], [a, c, GHOST]]);
        // half-edges: 0 ab 1 bc 2 ca | 3 ba 4 aG 5 Gb | 6 cb 7 bG 8 Gc | 9 ac 10 cG 11 Ga
        mesh.twin.extend([3, 6, 9, 0, 11, 7, 1, 5, 10, 2, 8, 4]);
        mesh
    }

    /// Triangulates `xy`. `copies` receives `(index, index of the equal point that is a vertex)`. Empty when all
    /// points lie on one line.
    pub(crate) fn build(xy: &[[f64; 2]], order: &[u32], copies: &mut Vec<(u32, u32)>) -> Mesh {
        let at = |i: u32| xy[i as usize];
        let Some(&first) = order.first() else {
            return Mesh::default();
        };
        let Some(&second) = order.iter().find(|&&i| at(i) != at(first)) else {
            return Mesh::default();
        };
        let Some(&third) = order
            .iter()
            .find(|&&i| orient(at(first), at(second), at(i)) != 0.0)
        else {
            return Mesh::default();
        };
        let mut mesh = if orient(at(first), at(second), at(third)) > 0.0 {
            Mesh::start(first, second, third, xy.len())
        } else {
            Mesh::start(second, first, third, xy.len())
        };
        let mut stack = Vec::with_capacity(64);
        let mut hint = 0;
        for &p in order {
            if p == first || p == second || p == third {
                continue;
            }
            match mesh.locate(xy, hint, at(p)) {
                Place::Vertex(v) => copies.push((p, v)),
                Place::Face(t) | Place::Outside(t) => {
                    let h = 3 * t;
                    mesh.insert(p, &[h, h + 1, h + 2], &mut stack);
                    hint = mesh.legalise(xy, p, &mut stack);
                }
                Place::Edge(h) => {
                    let g = mesh.twin[h as usize];
                    let ring = [next(h), next(next(h)), next(g), next(next(g))];
                    mesh.insert(p, &ring, &mut stack);
                    hint = mesh.legalise(xy, p, &mut stack);
                }
            }
        }
        mesh
    }

    /// Walks from triangle `hint` to the place of `p`. The visibility walk in a Delaunay triangulation ends.
    pub(crate) fn locate(&self, xy: &[[f64; 2]], hint: u32, p: [f64; 2]) -> Place {
        let mut t = hint;
        let mut entered = u32::MAX;
        if let Some(k) = self.tri[t as usize].iter().position(|&v| v == GHOST) {
            let hull_edge = 3 * t + (k as u32 + 1) % 3;
            t = self.twin[hull_edge as usize] / 3;
        }
        loop {
            let v = self.tri[t as usize];
            let mut zero = [false; 3];
            let mut crossed = None;
            for k in 0..3 {
                let h = 3 * t + k as u32;
                if h == entered {
                    continue;
                }
                let o = orient(xy[v[k] as usize], xy[v[(k + 1) % 3] as usize], p);
                if o < 0.0 {
                    crossed = Some(h);
                    break;
                }
                zero[k] = o == 0.0;
            }
            let Some(h) = crossed else {
                return match zero {
                    [false, false, false] => Place::Face(t),
                    [true, false, true] => Place::Vertex(v[0]),
                    [true, true, _] => Place::Vertex(v[1]),
                    [false, true, true] => Place::Vertex(v[2]),
                    [true, false, false] => Place::Edge(3 * t),
                    [false, true, false] => Place::Edge(3 * t + 1),
                    [false, false, true] => Place::Edge(3 * t + 2),
                };
            };
            entered = self.twin[h as usize];
            t = entered / 3;
            if self.tri[t as usize].contains(&GHOST) {
                return Place::Outside(t);
            }
        }
    }

    /// Replaces the triangles of the closed ring of half-edges by a fan around `p`; `p` becomes vertex 2 of each.
    fn insert(&mut self, p: u32, ring: &[u32], stack: &mut Vec<u32>) {
        let mut fan = [(0u32, 0u32, 0u32); 4];
        let n = ring.len();
        let mut free = [0u32; 4];
        let mut owned = 0;
        for (slot, &h) in fan.iter_mut().zip(ring) {
            *slot = (
                self.tri[(h / 3) as usize][(h % 3) as usize],
                self.tri[(h / 3) as usize][(next(h) % 3) as usize],
                self.twin[h as usize],
            );
            if !free[..owned].contains(&(h / 3)) {
                free[owned] = h / 3;
                owned += 1;
            }
        }
        while owned < n {
            free[owned] = self.tri.len() as u32;
            self.tri.push([p; 3]);
            self.twin.extend([0; 3]);
            owned += 1;
        }
        for i in 0..n {
            let (from, to, outer) = fan[i];
            let (t, following) = (free[i], free[(i + 1) % n]);
            self.tri[t as usize] = [from, to, p];
            self.link(3 * t, outer);
            self.link(3 * t + 1, 3 * following + 2);
            stack.push(t);
        }
    }

    #[inline]
    fn link(&mut self, a: u32, b: u32) {
        self.twin[a as usize] = b;
        self.twin[b as usize] = a;
    }

    /// Flips until the edges opposite of `p` (vertex 2 of every triangle on the stack) are Delaunay. Returns a
    /// triangle at `p`.
    fn legalise(&mut self, xy: &[[f64; 2]], p: u32, stack: &mut Vec<u32>) -> u32 {
        let mut last = 0;
        let at = |i: u32| xy[i as usize];
        while let Some(t) = stack.pop() {
            last = t;
            let [a, b, _] = self.tri[t as usize];
            let g = self.twin[3 * t as usize];
            let (u, g_next) = (g / 3, next(g));
            let g_prev = next(g_next);
            let d = self.tri[u as usize][(g_prev % 3) as usize];
            let conflict = if d == GHOST {
                false
            } else if a == GHOST {
                orient(at(d), at(b), at(p)) > 0.0
            } else if b == GHOST {
                orient(at(a), at(d), at(p)) > 0.0
            } else {
                incircle(coord(at(a)), coord(at(b)), coord(at(p)), coord(at(d))) > 0.0
            };
            if !conflict {
                continue;
            }
            let (x, y, w) = (
                self.twin[g_next as usize],
                self.twin[g_prev as usize],
                self.twin[3 * t as usize + 1],
            );
            self.tri[t as usize] = [a, d, p];
            self.tri[u as usize] = [d, b, p];
            self.link(3 * t, x);
            self.link(3 * t + 1, 3 * u + 2);
            self.link(3 * u, y);
            self.link(3 * u + 1, w);
            stack.push(t);
            stack.push(u);
        }
        last
    }

    /// Moves the ghosts behind the real triangles and returns the number of the latter.
    pub(crate) fn ghosts_last(&mut self) -> usize {
        let is_ghost = |t: &[u32; 3]| t.contains(&GHOST);
        let real = self.tri.iter().filter(|t| !is_ghost(t)).count();
        let mut back = real;
        for front in 0..real {
            if !is_ghost(&self.tri[front]) {
                continue;
            }
            while is_ghost(&self.tri[back]) {
                back += 1;
            }
            self.swap(front as u32, back as u32);
        }
        real
    }

    fn swap(&mut self, s: u32, t: u32) {
        self.tri.swap(s as usize, t as usize);
        let moved = |h: u32| match h / 3 {
            x if x == s => 3 * t + h % 3,
            x if x == t => 3 * s + h % 3,
            _ => h,
        };
        let old: Vec<u32> = [3 * s, 3 * s + 1, 3 * s + 2, 3 * t, 3 * t + 1, 3 * t + 2]
            .iter()
            .map(|&h| self.twin[h as usize])
            .collect();
        for (k, &g) in old.iter().enumerate() {
            let h = if k < 3 {
                3 * t + k as u32
            } else {
                3 * s + k as u32 - 3
            };
            self.link(h, moved(g));
        }
    }
}
