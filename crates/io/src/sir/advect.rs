//! Lobes on their way from one incidence to another.

use gonio_geom::DVec3;

use super::grid::{Grid, between, coded};
use super::mesh::{Edge, Node, Transport, Triangle};
use super::slice::Lobe;

/// Shares below this are none.
const NOTHING: f32 = 1e-6;
/// Most lobes of a slice between incidences; the smallest shares go where there are more.
const MOST_LOBES: usize = 15_000;
/// Nearer than this to a measured incidence its own lobes answer, radians.
const NEAR: f64 = 1e-3;

/// The lobes at `at` on the great circle from the first to the second incidence of an edge. The widths blend by their
/// squares, the axes move on great circles and are centred in their cells.
pub(super) fn along(nodes: &[Node], edge: &Edge, at: DVec3, grid: Grid) -> Vec<Lobe> {
    let (from, to) = (&nodes[edge.from], &nodes[edge.to]);
    let angle = |a: DVec3, b: DVec3| a.dot(b).clamp(-1.0, 1.0).acos();
    let (gone, whole) = (angle(at, from.incidence), angle(from.incidence, to.incidence));
    if gone <= NEAR {
        return from.lobes.clone();
    }
    if gone >= whole - NEAR {
        return to.lobes.clone();
    }
    let t = gone / whole;
    let light = 1.0 - t + t * ratio(to.light, from.light);
    let least = limited(|least| edge.transport.shares().iter().filter(|s| s.2 > least).count());
    let moved = edge.transport.shares().iter().filter(|s| s.2 > least);
    moved
        .map(|&(i, j, share)| {
            let (a, b) = (&from.lobes[i as usize], &to.lobes[j as usize]);
            let r2 = (1.0 - t) * a.radius * a.radius + t * b.radius * b.radius;
            Lobe {
                peak: a.peak * f64::from(share) * light * a.radius * a.radius / r2,
                radius: coded(r2.sqrt()),
                axis: grid.centred(between(a.axis, b.axis, t)),
            }
        })
        .collect()
}

/// The lobes at `at` inside a triangle of incidences: along its first edge to the great circle through `at` and the third
/// incidence, then along that circle.
pub(super) fn inside(
    nodes: &[Node],
    edges: &[Edge],
    triangle: &Triangle,
    at: DVec3,
    grid: Grid,
) -> Vec<Lobe> {
    let [a, b, c] = triangle.nodes.map(|k| &nodes[k]);
    let [ab, bc, ac] = triangle.edges.map(|k| &edges[k].transport);
    let angle = |a: DVec3, b: DVec3| a.dot(b).clamp(-1.0, 1.0).acos();
    let plane = |p: DVec3| p.cross(c.incidence).normalize_or_zero();
    let first = plane(a.incidence);
    let s = (angle(first, plane(at)) / angle(first, plane(b.incidence))).clamp(0.0, 1.0);
    let foot = between(a.incidence, b.incidence, s);
    let t = (angle(foot, at) / angle(foot, c.incidence)).clamp(0.0, 1.0);
    let through_b = s * ratio(b.light, a.light) * (1.0 - t + t * ratio(c.light, b.light));
    let through_a = (1.0 - s) * (1.0 - t + t * ratio(c.light, a.light));
    let each = |least: f32, visit: &mut dyn FnMut(usize, usize, usize, f64)| {
        for &(i, j, first) in ab.shares().iter().filter(|x| x.2 > least) {
            let (i, j) = (i as usize, j as usize);
            for (k, from_a, from_b) in joined(ac, i, bc, j) {
                if from_a > least || from_b > least {
                    let share = f64::from(from_b) * through_b + f64::from(from_a) * through_a;
                    visit(i, j, k, f64::from(first) * share);
                }
            }
        }
    };
    let least = limited(|least| {
        let mut n = 0;
        each(least, &mut |_, _, _, _| n += 1);
        n
    });
    let mut lobes = Vec::new();
    each(least, &mut |i, j, k, share| {
        let (i, j, k) = (&a.lobes[i], &b.lobes[j], &c.lobes[k]);
        let square = |lobe: &Lobe| lobe.radius * lobe.radius;
        let r2 = (1.0 - t) * ((1.0 - s) * square(i) + s * square(j)) + t * square(k);
        lobes.push(Lobe {
            peak: i.peak * share * square(i) / r2,
            radius: coded(r2.sqrt()),
            axis: grid.centred(between(between(i.axis, j.axis, s), k.axis, t)),
        });
    });
    lobes
}

fn ratio(a: f64, b: f64) -> f64 {
    if b > 0.0 { a / b } else { 0.0 }
}

/// The share below which lobes are left out so that not too many stay.
fn limited(count: impl Fn(f32) -> usize) -> f32 {
    let mut least = NOTHING;
    while count(least) > MOST_LOBES && least < 1.0 {
        least = 2.0 * least + 10.0 * NOTHING;
    }
    least
}

/// Row `i` of `a` and row `j` of `b`, side by side: the column and the shares there.
fn joined(a: &Transport, i: usize, b: &Transport, j: usize) -> impl Iterator<Item = (usize, f32, f32)> {
    let (a, b) = (a.row(i), b.row(j));
    let (mut m, mut n) = (0, 0);
    std::iter::from_fn(move || {
        let next = |row: &[(u32, u32, f32)], k: usize| row.get(k).map_or(u32::MAX, |s| s.1);
        let column = next(a, m).min(next(b, n));
        if column == u32::MAX {
            return None;
        }
        let take = |row: &[(u32, u32, f32)], k: &mut usize| match row.get(*k) {
            Some(s) if s.1 == column => {
                *k += 1;
                s.2
            }
            _ => 0.0,
        };
        let shares = (take(a, &mut m), take(b, &mut n));
        Some((column as usize, shares.0, shares.1))
    })
}
