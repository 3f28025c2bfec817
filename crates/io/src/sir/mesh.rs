//! Measured incidences and what connects them.

use std::collections::BTreeMap;

use gonio_geom::DVec3;

use super::slice::Lobe;

/// A measured incidence.
#[derive(Clone, Debug)]
pub(super) struct Node {
    pub(super) incidence: DVec3,
    /// Light of all lobes.
    pub(super) light: f64,
    pub(super) lobes: Vec<Lobe>,
}

/// Which share of each lobe goes to which: (from, to, share), by rows.
#[derive(Clone, Debug)]
pub(super) struct Transport {
    shares: Vec<(u32, u32, f32)>,
    rows: Vec<u32>,
}

impl Transport {
    /// Of shares in the order of rows and columns, for `rows` lobes.
    pub(super) fn new(shares: Vec<(u32, u32, f32)>, rows: usize) -> Self {
        let starts = (0..=rows).map(|r| shares.partition_point(|s| (s.0 as usize) < r) as u32);
        let rows = starts.collect();
        Transport { shares, rows }
    }

    pub(super) fn shares(&self) -> &[(u32, u32, f32)] {
        &self.shares
    }

    pub(super) fn row(&self, i: usize) -> &[(u32, u32, f32)] {
        &self.shares[self.rows[i] as usize..self.rows[i + 1] as usize]
    }
}

/// A pair of neighbouring incidences.
#[derive(Clone, Debug)]
pub(super) struct Edge {
    pub(super) from: usize,
    pub(super) to: usize,
    pub(super) transport: Transport,
}

/// Three incidences that are neighbours of each other, in ascending order, and the edges first-second, second-third and
/// first-third.
#[derive(Clone, Copy, Debug)]
pub(super) struct Triangle {
    pub(super) nodes: [usize; 3],
    pub(super) edges: [usize; 3],
}

/// Where an incidence lies among those measured.
#[derive(Clone, Copy, Debug)]
pub(super) enum Place {
    Inside(Triangle),
    On(usize),
    Outside,
}

/// How far off an edge an incidence may lie and still be on it: excess of the way round over the straight one, in the
/// cosine.
const ON_EDGE: f64 = 1e-3;

/// All triangles of edges that lead from a lower to a higher node, the smallest first.
pub(super) fn triangles(nodes: &[Node], edges: &[Edge]) -> Vec<Triangle> {
    let upward: BTreeMap<(usize, usize), usize> = edges
        .iter()
        .enumerate()
        .filter(|(_, e)| e.from < e.to)
        .map(|(k, e)| ((e.from, e.to), k))
        .collect();
    let mut found = Vec::new();
    for (&(a, b), &ab) in &upward {
        for (&(_, c), &bc) in upward.range((b, 0)..(b + 1, 0)) {
            if let Some(&ac) = upward.get(&(a, c)) {
                found.push(Triangle {
                    nodes: [a, b, c],
                    edges: [ab, bc, ac],
                });
            }
        }
    }
    let area = |t: &Triangle| {
        let [a, b, c] = t.nodes.map(|k| nodes[k].incidence);
        (b - a).cross(c - a).length()
    };
    found.sort_by(|a, b| area(a).total_cmp(&area(b)));
    found
}

/// The smallest triangle that holds `at`, else the nearest edge if that is near enough.
pub(super) fn place(nodes: &[Node], edges: &[Edge], triangles: &[Triangle], at: DVec3) -> Place {
    let inside = |t: &&Triangle| {
        let [a, b, c] = t.nodes.map(|k| nodes[k].incidence);
        let signs = [(a, b), (b, c), (c, a)].map(|(p, q)| at.dot(p.cross(q)));
        signs.iter().all(|s| *s >= 0.0) || signs.iter().all(|s| *s <= 0.0)
    };
    if let Some(t) = triangles.iter().find(inside) {
        return Place::Inside(*t);
    }
    let excess = |e: &Edge| {
        let (a, b) = (nodes[e.from].incidence, nodes[e.to].incidence);
        let (p, q) = (a.dot(at), b.dot(at));
        let round = p * q - ((1.0 - p * p).max(0.0) * (1.0 - q * q).max(0.0)).sqrt();
        if p > 0.0 && q > 0.0 && round > 0.0 {
            a.dot(b) - round
        } else {
            f64::INFINITY
        }
    };
    let nearest = edges
        .iter()
        .enumerate()
        .map(|(k, e)| (k, excess(e)))
        .min_by(|a, b| a.1.total_cmp(&b.1));
    match nearest {
        Some((k, excess)) if excess < ON_EDGE => Place::On(k),
        _ => Place::Outside,
    }
}
