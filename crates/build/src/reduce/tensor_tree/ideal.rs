//! Light that leaves without spreading, in the cells it goes to.

use std::collections::BTreeMap;

use gonio_bsdf::tensor_tree::Rank;
use gonio_bsdf::tensor_tree::lookup::{coordinates, incident_direction};
use gonio_geom::{Component, Side};

use crate::reduce::OneChannel;

/// Incidences across a finest cell, in each coordinate: rank 3, rank 4.
const POINTS: [usize; 2] = [32, 6];
/// Half the width, in finest cells, over which a direction is shared out, so that one on the border of two cells goes
/// to both alike (the plane of incidence is such a border).
const BLUR: f64 = 1e-3;
/// Of the cells that a tree may have, those that light without spread may take.
const BUDGET: f64 = 0.5;

/// The flux of the ideal part in every cell that has any.
pub(super) struct Ideal {
    /// Cells of this depth hold the light, and all of it.
    pub(super) depth: u8,
    /// By depth: cell to `integral share dI`, the flux into its exit directions over its incident square (or line).
    flux: Vec<BTreeMap<[u16; 4], f64>>,
}

impl Ideal {
    /// Of one component; `None` where the model has no ideal part. The depth is `max_depth`, or as much less as keeps
    /// the cells under half of `max_cells`.
    pub(super) fn new(
        one: OneChannel<'_>,
        rank: Rank,
        side: Side,
        component: Component,
        max_depth: u8,
        max_cells: usize,
    ) -> Option<Self> {
        let most = BUDGET * max_cells as f64;
        let incidences = |depth: u8| 1usize << (usize::from(depth) * rank.incident_dimensions());
        // Every cell of incidence takes one family of children at least; finer ones are not even tried.
        let affordable = |d: &u8| incidences(d - 1) as f64 * rank.children() as f64 <= most || *d == 1;
        let mut depth = (1..=max_depth).rev().find(affordable)?;
        loop {
            let ideal = Ideal::at_depth(one, rank, side, component, depth)?;
            let cells: usize = ideal.flux.iter().take(depth.into()).map(BTreeMap::len).sum();
            if depth == 1 || (cells * (rank.children() - 1)) as f64 <= most {
                return Some(ideal);
            }
            depth -= 1;
        }
    }

    fn at_depth(
        one: OneChannel<'_>,
        rank: Rank,
        side: Side,
        component: Component,
        depth: u8,
    ) -> Option<Self> {
        let d = rank.incident_dimensions();
        let n = 1usize << depth;
        let points = POINTS[d - 1];
        let step = 1.0 / (n * points) as f64;
        let at = |k: usize| (k as f64 + 0.5) * step;
        let mut shares = vec![0.0; one.model.channels().len()];
        let mut finest = BTreeMap::new();
        // At rank 3 the incidences fill half of the line.
        let lines = if d == 1 { n * points / 2 } else { n * points };
        let columns = if d == 1 { 1 } else { lines };
        let weight = step.powi(d as i32);
        for a in 0..lines {
            for b in 0..columns {
                let incident = [at(a), if d == 2 { at(b) } else { 0.0 }];
                let wi = incident_direction(rank, incident, side);
                let Some(ws) = one.model.delta(wi, component, &mut shares) else {
                    continue;
                };
                let share = shares[one.index];
                if !(share > 0.0 && share.is_finite()) {
                    continue;
                }
                let exit = &coordinates(rank, wi, ws)[d..];
                let origin = [(a / points) as u16, (b / points) as u16];
                for (u, part_u) in shared(exit[0], n) {
                    for (v, part_v) in shared(exit[1], n) {
                        let cell = match rank {
                            Rank::Three => [origin[0], u, v, 0],
                            Rank::Four => [origin[0], origin[1], u, v],
                        };
                        *finest.entry(cell).or_insert(0.0) += weight * share * part_u * part_v;
                    }
                }
            }
        }
        if finest.is_empty() {
            return None;
        }
        let mut flux = vec![finest];
        for _ in 0..depth {
            let mut coarser = BTreeMap::new();
            for (cell, part) in &flux[flux.len() - 1] {
                *coarser.entry(cell.map(|k| k / 2)).or_insert(0.0) += part;
            }
            flux.push(coarser);
        }
        flux.reverse();
        Some(Ideal { depth, flux })
    }

    /// `integral share dI` of a cell.
    pub(super) fn flux(&self, origin: [u16; 4], depth: u8) -> f64 {
        let level = self.flux.get(usize::from(depth));
        level.and_then(|cells| cells.get(&origin)).copied().unwrap_or(0.0)
    }
}

/// The cells of `n` to which a coordinate in `[0, 1]` belongs, with the parts of it that they get.
fn shared(x: f64, n: usize) -> impl Iterator<Item = (u16, f64)> {
    let x = x * n as f64;
    let cell = |x: f64| (x.max(0.0) as usize).min(n - 1);
    let (low, high) = (cell(x - BLUR), cell(x + BLUR));
    let part = if low == high {
        1.0
    } else {
        ((high as f64 - (x - BLUR)) / (2.0 * BLUR)).clamp(0.0, 1.0)
    };
    [(low as u16, part), (high as u16, 1.0 - part)]
        .into_iter()
        .filter(|(_, part)| *part > 0.0)
}
