//! An interpolant as a scattering model.

use std::collections::HashMap;
use std::f64::consts::PI;
use std::sync::{Arc, PoisonError, RwLock};

use gonio_bsdf::{Bsdf, Channel, Lobe as Part, Properties, Sample};
use gonio_geom::{Component, DVec3, Direction, Side};

use super::advect::{along, inside};
use super::grid::{Grid, coded, moderated};
use super::mesh::{Edge, Node, Place, Triangle, place, triangles};
use super::slice::{Lobe, Slice};

/// Lobes of slices that are kept for the incidences looked at last, some 100 MB.
const KEPT_LOBES: usize = 2_000_000;
/// Cosine of the angle up to which an incidence is a measured one.
const SAME: f64 = 1.0 - 5e-13;
/// Cosine of the width of a cell of exit directions, 0.56 degrees: what a file resolves.
const CELL: f64 = 0.999_952;
/// Triangles of a mesh without crossings are fewer than this, times the incidences.
const MOST_TRIANGLES: usize = 64;

/// Which incidences stand for which others.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Symmetry {
    /// All azimuths alike.
    Isotropic,
    /// One bit a quadrant that was measured; the others are its mirror images.
    Quadrants(u8),
}

impl Symmetry {
    /// Of the number in the header.
    pub(super) fn of_quadrants(bits: u8) -> Option<Self> {
        match bits {
            0 => Some(Symmetry::Isotropic),
            1 | 2 | 3 | 4 | 6 | 8 | 9 | 12 | 15 => Some(Symmetry::Quadrants(bits)),
            _ => None,
        }
    }

    /// Signs of x and y that bring an incidence into the measured quadrants.
    fn fold(self, at: DVec3) -> [f64; 2] {
        let Symmetry::Quadrants(bits) = self else {
            return [1.0, 1.0];
        };
        let measured = |x: f64, y: f64| {
            let bit = match (x >= 0.0, y >= 0.0) {
                (true, true) => 1,
                (false, true) => 2,
                (false, false) => 4,
                (true, false) => 8,
            };
            bits & bit != 0
        };
        let signs = [[1.0, 1.0], [-1.0, 1.0], [1.0, -1.0], [-1.0, -1.0]];
        let brings = |s: &&[f64; 2]| measured(s[0] * at.x, s[1] * at.y);
        signs.iter().find(brings).copied().unwrap_or([1.0, 1.0])
    }
}

/// What the header says.
#[derive(Clone, Debug)]
pub(super) struct Frame {
    pub(super) name: String,
    pub(super) manufacturer: String,
    pub(super) symmetry: Symmetry,
    pub(super) from: Side,
    pub(super) to: Side,
    pub(super) grid: Grid,
    /// Least BSDF, 1/sr.
    pub(super) floor: f64,
    /// BSDF and width of the one lobe that answers past the measured incidences.
    pub(super) peak: Option<[f64; 2]>,
}

/// A scattering interpolant: one side of incidence and one component, one channel (luminance).
///
/// At a measured incidence the DSF is a sum of Gaussian lobes; between incidences the lobes move as the transports of the
/// file say. The BSDF is the DSF over `0.98 |cos theta_s| + 0.02`, and nowhere less than the least BSDF of the file. Past
/// the measured incidences the least BSDF answers, with one lobe in the mirror or through direction where the file has
/// one. Everything is as RADIANCE evaluates it, but for isotropic files: their lobes turn with the incidence exactly, not
/// from cell to cell, at normal incidence too.
pub struct Interpolant {
    frame: Frame,
    nodes: Vec<Node>,
    edges: Vec<Edge>,
    triangles: Vec<Triangle>,
    measured: Vec<Arc<Slice>>,
    kept: RwLock<Kept>,
}

/// Slices by incidence.
#[derive(Default)]
struct Kept {
    slices: HashMap<[u64; 2], Arc<Slice>>,
    lobes: usize,
}

/// Field, what was found, what is allowed.
type Wrong = (&'static str, String, String);

/// An incidence in the frame of the measured ones.
struct Local {
    at: DVec3,
    /// The exit direction seen from there.
    turn: Turn,
}

#[derive(Clone, Copy)]
enum Turn {
    /// Cosine and sine of the angle about the normal.
    About([f64; 2]),
    Mirror([f64; 2]),
}

impl Turn {
    fn there(self, d: DVec3) -> DVec3 {
        match self {
            Turn::About([c, s]) => DVec3::new(c * d.x - s * d.y, s * d.x + c * d.y, d.z),
            Turn::Mirror([x, y]) => DVec3::new(x * d.x, y * d.y, d.z),
        }
    }

    fn back(self) -> Self {
        match self {
            Turn::About([c, s]) => Turn::About([c, -s]),
            mirror => mirror,
        }
    }
}

impl Interpolant {
    pub(super) fn new(frame: Frame, nodes: Vec<Node>, edges: Vec<Edge>) -> Result<Self, Wrong> {
        let isotropic = frame.symmetry == Symmetry::Isotropic;
        let steeper = |pair: &[Node]| pair[0].incidence.z.abs() < pair[1].incidence.z.abs();
        if isotropic && nodes.windows(2).any(steeper) {
            let found = "incidences out of order".to_owned();
            return Err(("incidences", found, "from the normal outwards".into()));
        }
        let triangles = if isotropic {
            Vec::new()
        } else {
            triangles(&nodes, &edges)
        };
        if triangles.len() > MOST_TRIANGLES * nodes.len() {
            let found = format!("{} triangles", triangles.len());
            return Err(("transports", found, "a mesh without crossings".into()));
        }
        let slice = |n: &Node| Arc::new(Slice::new(&n.lobes, frame.floor));
        Ok(Interpolant {
            measured: nodes.iter().map(slice).collect(),
            frame,
            nodes,
            edges,
            triangles,
            kept: RwLock::default(),
        })
    }

    /// Name of the material; empty where the file has none.
    pub fn name(&self) -> &str {
        &self.frame.name
    }

    /// Its manufacturer; empty where the file has none.
    pub fn manufacturer(&self) -> &str {
        &self.frame.manufacturer
    }

    /// Side of incidence and component.
    pub fn component(&self) -> (Side, Component) {
        (
            self.frame.from,
            Component::between(self.frame.from, self.frame.to),
        )
    }

    /// The measured incidences.
    pub fn incidences(&self) -> impl Iterator<Item = Direction> {
        self.nodes.iter().map(|n| Direction::from_unit(n.incidence))
    }

    /// Gaussian lobes of all measured incidences.
    pub fn lobes(&self) -> usize {
        self.nodes.iter().map(|n| n.lobes.len()).sum()
    }

    /// Transports between incidences.
    pub fn transports(&self) -> usize {
        self.edges.len()
    }

    /// Least BSDF, 1/sr.
    pub fn floor(&self) -> f64 {
        self.frame.floor
    }

    /// Largest directional albedo of the measured incidences by their lobes, and the least; past the horizon lobes count
    /// nothing.
    pub fn albedos(&self) -> [f64; 2] {
        let each = self.incidences().map(|wi| {
            let n = 96;
            let mut sum = 0.0;
            for k in 0..n * n {
                let [u, v] = [k / n, k % n].map(|j| (f64::from(j) + 0.5) / f64::from(n));
                let (x, y) = gonio_geom::disk::square_to_disk(u, v);
                let z = self.frame.grid.sign * (1.0 - x * x - y * y).max(0.0).sqrt();
                if let Some(ws) = Direction::new(DVec3::new(x, y, z)) {
                    sum += self.eval_first(wi, ws);
                }
            }
            PI * sum / f64::from(n * n)
        });
        each.fold([f64::INFINITY, 0.0], |[a, b], x| [a.min(x), b.max(x)])
    }

    /// The incidence among the measured ones.
    fn local(&self, wi: DVec3) -> Local {
        if self.frame.symmetry == Symmetry::Isotropic {
            let sin = wi.x.hypot(wi.y);
            let axis = self.azimuth(wi.z.abs());
            let from = if sin > 0.0 { [wi.x / sin, wi.y / sin] } else { axis };
            // turns the azimuth of the incidence to that of the measured ones
            let turn = [
                axis[0] * from[0] + axis[1] * from[1],
                axis[1] * from[0] - axis[0] * from[1],
            ];
            Local {
                at: DVec3::new(sin * axis[0], sin * axis[1], wi.z),
                turn: Turn::About(turn),
            }
        } else {
            let signs = self.frame.symmetry.fold(wi);
            Local {
                at: DVec3::new(signs[0] * wi.x, signs[1] * wi.y, wi.z),
                turn: Turn::Mirror(signs),
            }
        }
    }

    /// Cosine and sine of the azimuth of the measured incidence that is next farther from the normal.
    fn azimuth(&self, cos: f64) -> [f64; 2] {
        let next = self.nodes.partition_point(|n| n.incidence.z.abs() >= cos);
        let oblique = |n: &&Node| n.incidence.x.hypot(n.incidence.y) > 1e-3;
        let after = self.nodes[next..].iter().find(oblique);
        after
            .or_else(|| self.nodes.iter().rev().find(oblique))
            .map_or([1.0, 0.0], |n| {
                let sin = n.incidence.x.hypot(n.incidence.y);
                [n.incidence.x / sin, n.incidence.y / sin]
            })
    }

    fn place(&self, at: DVec3) -> Place {
        if self.frame.symmetry != Symmetry::Isotropic {
            return place(&self.nodes, &self.edges, &self.triangles, at);
        }
        let next = self.nodes.partition_point(|n| n.incidence.z.abs() >= at.z.abs());
        let joins = |e: &Edge| {
            let (a, b) = (e.from.min(e.to), e.from.max(e.to));
            a + 1 == next && b == next
        };
        self.edges
            .iter()
            .position(joins)
            .map_or(Place::Outside, Place::On)
    }

    fn slice(&self, at: DVec3) -> Arc<Slice> {
        if let Some(k) = self.nodes.iter().position(|n| n.incidence.dot(at) >= SAME) {
            return self.measured[k].clone();
        }
        let place = self.place(at);
        if matches!(place, Place::Outside) {
            // Beside the outermost incidence by less than a cell: a first incidence of 0.001 degrees is the normal.
            let beside = |k: &usize| self.nodes[*k].incidence.dot(at) >= CELL;
            if let Some(k) = (0..self.nodes.len()).find(beside) {
                return self.measured[k].clone();
            }
        }
        let key = [at.x.to_bits(), at.y.to_bits()];
        let kept = self.kept.read().unwrap_or_else(PoisonError::into_inner);
        if let Some(slice) = kept.slices.get(&key) {
            return slice.clone();
        }
        drop(kept);
        let grid = self.frame.grid;
        let lobes = match place {
            Place::Inside(t) => inside(&self.nodes, &self.edges, &t, at, grid),
            Place::On(k) => along(&self.nodes, &self.edges[k], at, grid),
            Place::Outside => self.outside(at),
        };
        let slice = Arc::new(Slice::new(&lobes, self.frame.floor));
        let mut kept = self.kept.write().unwrap_or_else(PoisonError::into_inner);
        if kept.lobes + slice.len() > KEPT_LOBES || kept.slices.len() > KEPT_LOBES / 10 {
            *kept = Kept::default();
        }
        kept.lobes += slice.len();
        kept.slices.insert(key, slice.clone());
        slice
    }

    /// What answers past the measured incidences.
    fn outside(&self, at: DVec3) -> Vec<Lobe> {
        let lobe = |[value, radius]: [f64; 2]| {
            let straight = DVec3::new(-at.x, -at.y, self.frame.grid.sign * at.z.abs());
            Lobe {
                peak: value * moderated(at.z),
                radius: coded(radius),
                axis: self.frame.grid.centred(straight),
            }
        };
        let above = self.frame.peak.filter(|[value, _]| *value > self.frame.floor);
        above.into_iter().map(lobe).collect()
    }

    fn answers(&self, wi: Direction) -> bool {
        wi.side() == self.frame.from && wi.cos_theta() != 0.0
    }
}

impl Bsdf for Interpolant {
    fn channels(&self) -> &[Channel] {
        &[Channel::Photopic]
    }

    fn properties(&self) -> Properties {
        Properties {
            reciprocal: false,
            energy_conserving: false,
            isotropic: self.frame.symmetry == Symmetry::Isotropic,
        }
    }

    fn eval(&self, wi: Direction, ws: Direction, f: &mut [f64]) {
        f[0] = self.eval_first(wi, ws);
    }

    fn eval_first(&self, wi: Direction, ws: Direction) -> f64 {
        if !self.answers(wi) || ws.side() != self.frame.to || ws.cos_theta() == 0.0 {
            return 0.0;
        }
        let local = self.local(wi.vec());
        self.slice(local.at).value(local.turn.there(ws.vec()))
    }

    fn has_data(&self, wi: Direction, ws: Direction) -> bool {
        if !self.answers(wi) || ws.side() != self.frame.to {
            return false;
        }
        let at = self.local(wi.vec()).at;
        self.nodes.iter().any(|n| n.incidence.dot(at) >= SAME) || !matches!(self.place(at), Place::Outside)
    }

    fn pdf(&self, w: Direction, sampled: Direction) -> f64 {
        if !self.answers(w) || sampled.side() != self.frame.to {
            return 0.0;
        }
        let local = self.local(w.vec());
        self.slice(local.at).pdf(local.turn.there(sampled.vec()))
    }

    /// A lobe by its light, then a direction of it: exact, but for the moderated cosine, which the weight makes up for.
    fn sample(&self, w: Direction, u: [f64; 3]) -> Option<Sample> {
        if !self.answers(w) {
            return None;
        }
        let local = self.local(w.vec());
        let slice = self.slice(local.at);
        let there = slice.sample(u, self.frame.grid.sign)?;
        let pdf = slice.pdf(there);
        let weight = slice.value(there) * there.z.abs() / pdf;
        (pdf > 0.0 && weight > 0.0).then_some(Sample {
            direction: Direction::from_unit(local.turn.back().there(there)),
            weight,
            pdf,
            lobe: Part::Glossy,
        })
    }
}
