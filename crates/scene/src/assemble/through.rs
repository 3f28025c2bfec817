//! Light that goes straight through a measured material: the peak of its table about the unbent direction
//! [Radiance, rt/m_bsdf.c].

use std::cell::RefCell;
use std::f64::consts::{FRAC_1_PI, PI};
use std::sync::Arc;

use gonio_bsdf::Bsdf;
use gonio_bsdf::klems::{Klems, Role};
use gonio_bsdf::tensor_tree::{Rank, TensorTree, Tree, lookup};
use gonio_geom::{Component, DVec3, Direction, Side};

/// A measured material made of cells.
#[derive(Clone)]
pub(super) enum Table {
    Klems(Arc<Klems>),
    Tree(Arc<TensorTree>),
}

/// What tells cells apart.
type Key = [u32; 4];

/// Cells are looked for at these steps about the unbent direction, in units of the side of the finest cell.
const STEP: f64 = 0.6;
/// Steps along each axis and on the diagonals; those on the axes go one farther.
const RINGS: i32 = 3;
/// Directions that are looked at.
const PROBES: usize = 29;
/// A cell of the peak is not larger than this many of the finest.
const LARGEST: f64 = 1.5;
/// Nor darker than this fraction of the mean of the brighter ones.
const DARKEST: f64 = 1.0 / 8.0;
/// Cells about the peak that must have been seen, over its size.
const SURROUND: f64 = 0.2;
/// A share below this is no peak.
const LEAST: f64 = 0.0005;

/// A cell: its name, projected solid angle about the light, value.
#[derive(Clone, Copy)]
struct Place {
    key: Key,
    size: f64,
    value: f64,
}

/// The peak towards one direction.
#[derive(Clone, Debug, Default)]
pub(super) struct Peak {
    cells: Vec<Key>,
    /// The share of the light that goes straight through.
    pub(super) share: f64,
}

impl Table {
    pub(super) fn model(&self) -> Arc<dyn Bsdf> {
        match self {
            Table::Klems(k) => k.clone(),
            Table::Tree(t) => t.clone(),
        }
    }

    /// The cell that light from `from` towards `to` behind the surface falls into. A tree of rank 3 has cells about its
    /// exit alone: there both are exchanged.
    fn cell(&self, from: Direction, to: Direction) -> Option<Place> {
        const THROUGH: Component = Component::Transmission;
        match self {
            Table::Klems(k) => {
                let forward = k.matrix(from.side(), THROUGH);
                let m = forward.or_else(|| k.matrix(to.side(), THROUGH))?;
                let (i, o) = if forward.is_some() { (from, to) } else { (to, from) };
                let (i, o) = (
                    m.incident().patch(i, Role::Incident),
                    m.exit().patch(o, Role::Exit),
                );
                let size = match forward.is_some() {
                    true => m.incident().lambda().get(i),
                    false => m.exit().lambda().get(o),
                };
                Some(Place {
                    key: [i as u32, o as u32, 0, 0],
                    size: *size?,
                    value: m.value(o, i),
                })
            }
            Table::Tree(t) => {
                let forward = t.tree(from.side(), THROUGH);
                let tree = forward.or_else(|| t.tree(to.side(), THROUGH))?;
                let exchanged = forward.is_none() || tree.rank() == Rank::Three;
                let (i, o) = if exchanged { (to, from) } else { (from, to) };
                let at = lookup::coordinates(tree.rank(), i, o);
                let side = tree.cell_side(&at);
                Some(Place {
                    key: at.map(|x| (x / side).min(1.0 / side - 1.0) as u32),
                    size: PI * side * side,
                    value: match tree.rank() {
                        // Asked as it has its cells: a peak of other cells would stay here and there.
                        Rank::Three => t.eval_first(to, from),
                        Rank::Four => tree.lookup(&at),
                    },
                })
            }
        }
    }

    /// Projected solid angle of the finest cell behind the surface from `to`.
    fn finest(&self, to: Direction) -> Option<f64> {
        const THROUGH: Component = Component::Transmission;
        let sides = [to.side().opposite(), to.side()];
        match self {
            Table::Klems(k) => {
                let m = sides.iter().find_map(|s| k.matrix(*s, THROUGH))?;
                m.incident().lambda().iter().copied().reduce(f64::min)
            }
            Table::Tree(t) => {
                let tree = sides.iter().find_map(|s| t.tree(*s, THROUGH))?;
                Some(PI * (-2.0 * f64::from(tree.depth())).exp2())
            }
        }
    }

    /// The Lambertian part of a component: its least value, unless that is next to nothing or more than all light.
    pub(super) fn least(&self, from: Side, component: Component) -> f64 {
        let mut sides = vec![from];
        if component == Component::Transmission {
            sides.push(from.opposite());
        }
        let least = match self {
            Table::Klems(k) => sides
                .iter()
                .find_map(|s| k.matrix(*s, component))
                .and_then(|m| m.values().iter().copied().reduce(f32::min)),
            Table::Tree(t) => sides
                .iter()
                .find_map(|s| t.tree(*s, component))
                .and_then(least_of_tree),
        };
        least
            .map(f64::from)
            .filter(|v| (0.01 * FRAC_1_PI..1.5 * FRAC_1_PI).contains(v))
            .unwrap_or(0.0)
    }

    /// The peak of the light that leaves towards `to`. `diffuse` of it stays.
    fn peak(&self, to: Direction, diffuse: f64) -> Peak {
        let none = Peak::default();
        let Some(finest) = self.finest(to) else {
            return none;
        };
        let step = STEP * finest.sqrt();
        let ahead = to.through().vec();
        let mut seen: Vec<Place> = Vec::with_capacity(PROBES);
        for (i, j) in steps() {
            let aside = DVec3::new(f64::from(i), f64::from(j), 0.0) * step;
            let Some(from) = Direction::new(ahead + aside) else {
                continue;
            };
            let Some(place) = self.cell(from, to) else {
                return none;
            };
            if !seen.iter().any(|s| s.key == place.key) {
                seen.push(place);
            }
        }
        seen.sort_by(|a, b| b.value.total_cmp(&a.value));
        let mut peak = Peak::default();
        let (mut sum, mut size, mut around) = (0.0, 0.0, 0.0);
        for place in seen {
            let mean = sum / peak.cells.len().max(1) as f64;
            if place.size > LARGEST * finest || place.value < DARKEST * mean || place.value <= 0.0 {
                if peak.cells.is_empty() {
                    return none;
                }
                around += place.size;
                continue;
            }
            peak.cells.push(place.key);
            sum += place.value;
            size += place.size;
            peak.share += (place.value - diffuse).max(0.0) * place.size;
        }
        match around >= SURROUND * size && peak.share >= LEAST {
            true => peak,
            false => none,
        }
    }

    /// The share of the light that goes straight through towards `to`.
    pub(super) fn straight(&self, to: Direction, diffuse: f64) -> f64 {
        self.at_peak(to, diffuse, |peak| peak.share)
    }

    /// What is scattered of the light from `from` towards `to` behind the surface, 1/sr.
    pub(super) fn scattered(&self, from: Direction, to: Direction, diffuse: f64) -> f64 {
        let Some(place) = self.cell(from, to) else {
            return 0.0;
        };
        match self.at_peak(to, diffuse, |peak| peak.cells.contains(&place.key)) {
            true => place.value.min(diffuse),
            false => place.value,
        }
    }

    /// What is known from the peak towards `to`.
    fn at_peak<T>(&self, to: Direction, diffuse: f64, of: impl FnOnce(&Peak) -> T) -> T {
        thread_local! {
            /// The last peak, and of what: at a surface it is asked for several times.
            static LAST: RefCell<(usize, DVec3, Peak)> = RefCell::default();
        }
        let this = match self {
            Table::Klems(k) => Arc::as_ptr(k) as usize,
            Table::Tree(t) => Arc::as_ptr(t) as usize,
        };
        LAST.with_borrow_mut(|last| {
            if last.0 != this || last.1 != to.vec() {
                *last = (this, to.vec(), self.peak(to, diffuse));
            }
            of(&last.2)
        })
    }
}

/// Steps about the unbent direction, nearest first.
fn steps() -> impl Iterator<Item = (i32, i32)> {
    let all = (-RINGS - 1..=RINGS + 1).flat_map(|i| (-RINGS - 1..=RINGS + 1).map(move |j| (i, j)));
    all.filter(|(i, j)| {
        let (i, j) = (i.abs(), j.abs());
        i == 0 || j == 0 || (i == j && i <= RINGS)
    })
}

fn least_of_tree(tree: &Tree) -> Option<f32> {
    // Of a rank 3 tree half of the incident coordinate means nothing.
    if tree.rank() == Rank::Four {
        return tree.values().iter().copied().reduce(f32::min);
    }
    let mut least: Option<f32> = None;
    let finest = f64::from(tree.depth());
    let n = 2.0_f64.powf(finest - 1.0).max(1.0) as usize;
    for k in 0..n {
        let x = (k as f64 + 0.5) * 0.5 / n as f64;
        tree.cross_section([x, 0.0], |cell| {
            least = Some(least.map_or(cell.value, |v| v.min(cell.value)));
        });
    }
    least
}
