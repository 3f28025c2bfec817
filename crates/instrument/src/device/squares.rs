//! Averages over the cells of tensor trees.

use std::sync::atomic::{AtomicBool, AtomicU32, Ordering};

use glam::Vec3;
use gonio_bsdf::tensor_tree::lookup::{coordinates, incident_direction};
use gonio_bsdf::tensor_tree::{Rank, lookup};
use gonio_bsdf::{BsdfError, FourComponents};
use gonio_geom::{Component, DVec3, Direction, Side};
use rayon::prelude::*;

use super::Device;
use super::prune::{Averages, PruneOptions, Pruned, prune};
use super::rows::{Effort, Patches, Progress, grey, key, rows};

/// Levels of a tree: cells of side `2^-levels`. At six of rank 4 the averages take half a gigabyte.
pub const LEVELS: std::ops::RangeInclusive<u8> = 2..=6;

/// BSDF of a device as tensor trees of the luminance, with the standard errors of their cells.
///
/// Rays are followed as by [`super::patch_tables`] from and to cells of side `2^-levels` in the square of direction cosines,
/// which all have the same projected solid angle. Cells are merged as [`prune`] says. Trees of rank 3 are averages over all azimuths
/// of incidence; light is followed one way then.
///
/// `None` when `stop` was set before the end.
///
/// # Errors
/// [`BsdfError::Domain`] for levels outside [`LEVELS`].
pub fn tensor_trees(
    device: &Device,
    (rank, levels): (Rank, u8),
    effort: &Effort,
    options: &PruneOptions,
    stop: &AtomicBool,
    report: Progress<'_>,
) -> Result<Option<FourComponents<Pruned>>, BsdfError> {
    if !LEVELS.contains(&levels) {
        return Err(BsdfError::Domain {
            field: "levels",
            found: levels.to_string(),
            allowed: "2 to 6".into(),
        });
    }
    let found = match rank {
        Rank::Three => averages(device, &Rings(levels), effort, stop, report),
        Rank::Four => averages(device, &Squares(levels), effort, stop, report),
    };
    let Some(found) = found else {
        return Ok(None);
    };
    let pruned: Vec<_> = found
        .into_par_iter()
        .map(|((side, component), averages)| Ok((side, component, prune(&averages, options)?)))
        .collect::<Result<_, BsdfError>>()?;
    let mut four = FourComponents::default();
    for (side, component, tree) in pruned {
        four.set(side, component, Some(tree));
    }
    Ok(Some(four))
}

/// Cells as those of a tree.
trait Cells: Patches {
    const RANK: Rank;

    fn levels(&self) -> u8;

    /// The incident cell of light from a patch that it is sent from.
    fn incident(&self, start: usize) -> usize;
}

/// Cells of the square of direction cosines, rank 4; the second coordinate is the faster.
struct Squares(u8);

impl Patches for Squares {
    const RECIPROCAL: bool = true;

    fn starts(&self) -> usize {
        self.exits()
    }

    fn exits(&self) -> usize {
        1 << (2 * self.0)
    }

    fn lambda(&self, _: usize) -> f64 {
        std::f64::consts::PI / self.exits() as f64
    }

    fn exit(&self, _: Vec3, ws: Direction) -> usize {
        let [_, _, u, v] = coordinates(Rank::Four, Direction::NORMAL, ws);
        cell(self.0, u) << self.0 | cell(self.0, v)
    }

    fn point(&self, start: usize, side: Side, [s, t, _]: [f64; 3]) -> Direction {
        let n = f64::from(1u32 << self.0);
        let (u, v) = (start >> self.0, start & ((1 << self.0) - 1));
        let (u, v) = ((u as f64 + s) / n, (v as f64 + t) / n);
        lookup::exit_direction(Rank::Four, Direction::NORMAL, u, v, side)
    }
}

impl Cells for Squares {
    const RANK: Rank = Rank::Four;

    fn levels(&self) -> u8 {
        self.0
    }

    fn incident(&self, start: usize) -> usize {
        // Incident coordinates are those of the direction turned by 180 degrees.
        self.exits() - 1 - start
    }
}

/// Cells of rank 3: polar angles of incidence, and squares of exit turned with the incidence.
struct Rings(u8);

impl Patches for Rings {
    const RECIPROCAL: bool = false;

    fn starts(&self) -> usize {
        1 << (self.0 - 1)
    }

    fn exits(&self) -> usize {
        1 << (2 * self.0)
    }

    fn lambda(&self, _: usize) -> f64 {
        std::f64::consts::PI / self.exits() as f64
    }

    fn exit(&self, wi: Vec3, ws: Direction) -> usize {
        let wi = Direction::new(DVec3::from(wi.to_array().map(f64::from))).unwrap_or(Direction::NORMAL);
        let [_, u, v, _] = coordinates(Rank::Three, wi, ws);
        cell(self.0, u) << self.0 | cell(self.0, v)
    }

    fn point(&self, start: usize, side: Side, [s, t, _]: [f64; 3]) -> Direction {
        let sine = (start as f64 + s) / f64::from(1u32 << self.0);
        let at = incident_direction(Rank::Three, [sine, 0.0], side).vec();
        let (sin, cos) = (std::f64::consts::TAU * t).sin_cos();
        Direction::from_unit(DVec3::new(cos * at.x - sin * at.y, sin * at.x + cos * at.y, at.z))
    }
}

impl Cells for Rings {
    const RANK: Rank = Rank::Three;

    fn levels(&self) -> u8 {
        self.0
    }

    fn incident(&self, start: usize) -> usize {
        start
    }
}

/// The cell of a coordinate in `[0, 1]`.
fn cell(levels: u8, x: f64) -> usize {
    let n = 1usize << levels;
    ((x * n as f64) as usize).min(n - 1)
}

/// Sums that threads add to: two numbers each at most, so that their order does not count.
struct Sums(Vec<AtomicU32>);

impl Sums {
    fn new(n: usize) -> Self {
        Sums((0..n).map(|_| AtomicU32::new(0)).collect())
    }

    fn add(&self, k: usize, x: f64) {
        if x != 0.0 {
            let more = |bits| Some((f32::from_bits(bits) + x as f32).to_bits());
            // Never refused.
            let _ = self.0[k].fetch_update(Ordering::Relaxed, Ordering::Relaxed, more);
        }
    }

    fn into_values(self) -> Vec<f32> {
        self.0
            .into_iter()
            .map(|x| f32::from_bits(x.into_inner()))
            .collect()
    }
}

type Found = Vec<((Side, Component), Averages)>;

fn averages<C: Cells>(
    device: &Device,
    cells: &C,
    effort: &Effort,
    stop: &AtomicBool,
    report: Progress<'_>,
) -> Option<Found> {
    let n = cells.exits();
    let size = 1usize << (usize::from(cells.levels()) * C::RANK.dimensions());
    let known = |(side, component): (Side, Component)| {
        let lit = |side: Side| effort.sides[usize::from(side == Side::Back)];
        lit(side) || (C::RECIPROCAL && component == Component::Transmission && lit(side.opposite()))
    };
    let keys = FourComponents::<()>::KEYS;
    let tables = keys.map(|k| known(k).then(|| (Sums::new(size), Sums::new(size))));
    let put = |key: usize, incident: usize, exit: usize, (mean, square): &([f64; 3], f64)| {
        if let Some((values, squares)) = &tables[key] {
            values.add(incident * n + exit, grey(*mean));
            squares.add(incident * n + exit, *square);
        }
    };
    rows(device, cells, effort, stop, report, |row| {
        for (k, end) in Side::BOTH.into_iter().enumerate() {
            let component = Component::between(row.side, end);
            for (patch, (onward, back)) in row.onward[k].iter().zip(&row.back[k]).enumerate() {
                put(key(row.side, component), cells.incident(row.start), patch, onward);
                if C::RECIPROCAL {
                    put(key(end, component), cells.incident(patch), row.start, back);
                }
            }
        }
    })?;
    let found = keys.into_iter().zip(tables);
    Some(
        found
            .filter_map(|(key, sums)| {
                let (values, squares) = sums?;
                let averages = Averages {
                    rank: C::RANK,
                    log2: cells.levels(),
                    values: values.into_values(),
                    variances: squares.into_values(),
                    reciprocal: C::RECIPROCAL && key.1 == Component::Reflection,
                };
                Some((key, averages))
            })
            .collect(),
    )
}
