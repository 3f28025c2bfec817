//! Which lobe of a slice is which, and where it goes with the incidence.

use std::sync::Arc;

use gonio_geom::DVec3;

use super::{Lobe, Symmetric};
use crate::images::Image;
use crate::layout::Neighbour;
use crate::linear::solve;
use crate::node::Node;
use crate::plane::Point;
use crate::triangulated::Placed;
use crate::weights::{cubic, monomials, quadratic, to_incidence_plane};

/// Coefficients of a cubic of two variables.
const TERMS: usize = 10;

/// Most lobes that are tracked.
const MOST: usize = 3;

/// Ridge of the fits of the laws.
const RIDGE: f64 = 1e-4;

/// Rounds of labelling and fitting; polar angles of incidence (degrees) up to which the first ones look, and distances
/// (direction cosines) within which a lobe belongs to a law.
const ROUNDS: usize = 12;
const WITHIN: [f64; 5] = [20.0, 35.0, 50.0, 65.0, 90.0];
const BELONGS: [f64; 4] = [0.12, 0.2, 0.3, 0.3];
const LAST: f64 = 0.2;

/// How far what is interpolated may leave the values it is made of, in units of their range; and how round the root of a
/// covariance is at least.
const PAST: f64 = 0.5;
const LEAST_ROUND: f64 = 1e-3;

/// The lobes of a measured incidence or its image.
#[derive(Clone, Debug, Default)]
pub(crate) struct Tracked {
    /// All of them.
    pub(crate) lobes: Vec<Lobe>,
    /// The position of each tracked lobe; `None` where it is not there.
    pub(crate) which: Vec<Option<usize>>,
}

/// What a tracked lobe is at one place: its centre off its law, the root of its covariance, the logarithm of its mass.
type Shape = [f64; 6];

/// A tracked lobe wherever it was found.
#[derive(Clone, Debug, Default)]
struct Track {
    /// In the plane of incidences.
    points: Vec<Point>,
    shapes: Vec<Shape>,
}

/// A lobe as its neighbours in incidence say.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Smooth {
    pub(crate) centre: [f64; 2],
    pub(crate) root: Symmetric,
    pub(crate) ln_mass: f64,
}

/// The tracked lobes of all incidences.
#[derive(Clone, Debug)]
pub(crate) struct Tracks {
    /// How far each lobe lies from the mirror (through) direction: a cubic of that direction's cosines, one for each of its
    /// own.
    laws: Vec<[[f64; TERMS]; 2]>,
    /// By incidence and image.
    places: Vec<[Tracked; 4]>,
    /// By law.
    tracks: Vec<Track>,
}

/// A lobe of a place, on the search for its law.
struct Seen {
    place: usize,
    lobe: usize,
    mirror: [f64; 2],
    shift: [f64; 2],
    theta: f64,
}

impl Tracks {
    /// The tracks of `nodes` that lie as `placed` says; `None` without a lobe at the incidence nearest to the normal.
    pub(crate) fn new(nodes: &[Arc<Node>], placed: &[Placed]) -> Option<Self> {
        let lobes: Vec<Vec<Lobe>> = placed
            .iter()
            .map(|p| nodes[p.node].lobes().iter().map(|l| l.of(p.image)).collect())
            .collect();
        let mirror = |i: DVec3| [-i.x, -i.y];
        let seen: Vec<Seen> = (0..placed.len())
            .flat_map(|place| (0..lobes[place].len()).map(move |lobe| (place, lobe)))
            .map(|(place, lobe)| {
                let (i, centre) = (placed[place].direction, lobes[place][lobe].centre);
                let m = mirror(i);
                Seen {
                    place,
                    lobe,
                    mirror: m,
                    shift: [centre[0] - m[0], centre[1] - m[1]],
                    theta: i.z.clamp(-1.0, 1.0).acos().to_degrees(),
                }
            })
            .collect();
        let middle = (0..placed.len()).min_by(|&a, &b| {
            let r = |k: usize| {
                let p = to_incidence_plane(placed[k].direction);
                p[0].hypot(p[1])
            };
            r(a).total_cmp(&r(b))
        })?;
        let mut laws: Vec<[[f64; TERMS]; 2]> = seen
            .iter()
            .filter(|s| s.place == middle)
            .take(MOST)
            .map(|s| {
                s.shift.map(|v| {
                    let mut law = [0.0; TERMS];
                    law[0] = v;
                    law
                })
            })
            .collect();
        if laws.is_empty() {
            return None;
        }
        let mut labels: Vec<(usize, f64)> = Vec::new();
        for round in 0..ROUNDS {
            labels = seen.iter().map(|s| nearest(&laws, s)).collect();
            let belongs = BELONGS.get(round).copied().unwrap_or(LAST);
            let within = WITHIN[round.min(WITHIN.len() - 1)];
            for (law, fitted) in laws.iter_mut().enumerate() {
                let members: Vec<&Seen> = seen
                    .iter()
                    .zip(&labels)
                    .filter(|(s, l)| l.0 == law && l.1 < belongs && s.theta <= within)
                    .map(|(s, _)| s)
                    .collect();
                if let Some(better) = fit(&members) {
                    *fitted = better;
                }
            }
        }
        let mut places: Vec<[Tracked; 4]> = vec![Default::default(); nodes.len()];
        for (place, p) in placed.iter().enumerate() {
            places[p.node][p.image.index()] = Tracked {
                lobes: lobes[place].clone(),
                which: vec![None; laws.len()],
            };
        }
        for (s, (law, apart)) in seen.iter().zip(labels) {
            let p = &placed[s.place];
            let Tracked { lobes, which } = &mut places[p.node][p.image.index()];
            let heavier = which[law].is_none_or(|other| lobes[s.lobe].mass() > lobes[other].mass());
            if apart < LAST && heavier {
                which[law] = Some(s.lobe);
            }
        }
        let mut tracks = vec![Track::default(); laws.len()];
        for p in placed {
            let tracked = &places[p.node][p.image.index()];
            for ((track, which), law) in tracks.iter_mut().zip(&tracked.which).zip(&laws) {
                if let Some(lobe) = which.and_then(|k| tracked.lobes.get(k)) {
                    track.points.push(to_incidence_plane(p.direction));
                    track.shapes.push(shape(lobe, centre(law, p.direction)));
                }
            }
        }
        Some(Tracks { laws, places, tracks })
    }

    /// Number of lobes that are tracked.
    pub(crate) fn len(&self) -> usize {
        self.laws.len()
    }

    /// The lobes of a slice as a query sees them.
    #[inline]
    pub(crate) fn of(&self, k: &Neighbour) -> &Tracked {
        &self.places[k.node][k.image.index()]
    }

    /// A tracked lobe at incidence `i` by a local cubic, or parabola, through the incidences that have it; `None` where these
    /// do not surround it well enough.
    pub(crate) fn smooth(&self, law: usize, i: DVec3) -> Option<Smooth> {
        let Track { points, shapes } = &self.tracks[law];
        let p = to_incidence_plane(i);
        let of = |weights: &[(usize, f64)]| -> Shape {
            std::array::from_fn(|a| {
                let each = weights.iter().map(|&(k, w)| (w, shapes[k][a]));
                let (sum, low, high) = each.fold(
                    (0.0, f64::INFINITY, f64::NEG_INFINITY),
                    |(sum, low, high), (w, v)| (sum + w * v, low.min(v), high.max(v)),
                );
                let margin = PAST * (high - low);
                sum.clamp(low - margin, high + margin)
            })
        };
        let [x, y, xx, xy, yy, ln_mass] = match cubic(points, p) {
            Some(weights) => of(&weights),
            None => of(quadratic(points, p)?.as_slice()),
        };
        let root = Symmetric { xx, xy, yy };
        let positive = xx > 0.0 && yy > 0.0 && root.determinant() > LEAST_ROUND * xx * yy;
        let law = self.centre(law, i);
        positive.then_some(Smooth {
            centre: [law[0] + x, law[1] + y],
            root,
            ln_mass,
        })
    }

    /// Where the law of a lobe puts its centre at incidence `i`, direction cosines.
    pub(crate) fn centre(&self, law: usize, i: DVec3) -> [f64; 2] {
        centre(&self.laws[law], i)
    }
}

fn centre(law: &[[f64; TERMS]; 2], i: DVec3) -> [f64; 2] {
    let m = [-i.x, -i.y];
    let terms = terms(m);
    let [x, y] = law.map(|c| dot(&c, &terms));
    [m[0] + x, m[1] + y]
}

impl Image {
    /// Its number, 0 to 3.
    fn index(self) -> usize {
        let [x, y] = self.of_point([1.0, 1.0]);
        usize::from(x < 0.0) + 2 * usize::from(y < 0.0)
    }
}

fn shape(lobe: &Lobe, law: [f64; 2]) -> Shape {
    let root = lobe.covariance.root();
    [
        lobe.centre[0] - law[0],
        lobe.centre[1] - law[1],
        root.xx,
        root.xy,
        root.yy,
        lobe.mass().max(f64::MIN_POSITIVE).ln(),
    ]
}

fn terms([x, y]: [f64; 2]) -> [f64; TERMS] {
    monomials(x, y)
}

fn dot(a: &[f64; TERMS], b: &[f64; TERMS]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

/// The law nearest to a lobe, and how far away it puts it.
fn nearest(laws: &[[[f64; TERMS]; 2]], seen: &Seen) -> (usize, f64) {
    let terms = terms(seen.mirror);
    let apart = laws
        .iter()
        .map(|law| (dot(&law[0], &terms) - seen.shift[0]).hypot(dot(&law[1], &terms) - seen.shift[1]));
    apart
        .enumerate()
        .min_by(|a, b| a.1.total_cmp(&b.1))
        .unwrap_or((0, f64::INFINITY))
}

/// A law through lobes, of as many terms as they allow; `None` for fewer than four.
fn fit(members: &[&Seen]) -> Option<[[f64; TERMS]; 2]> {
    let free = match members.len() {
        0..4 => return None,
        4..=12 => 3,
        13..=24 => 6,
        _ => TERMS,
    };
    let mut normal = [[0.0; TERMS]; TERMS];
    let mut right = [[0.0; TERMS]; 2];
    for s in members {
        let row = terms(s.mirror);
        for a in 0..free {
            for b in 0..=a {
                normal[a][b] += row[a] * row[b];
            }
            for (axis, right) in right.iter_mut().enumerate() {
                right[a] += row[a] * s.shift[axis];
            }
        }
    }
    for (a, row) in normal.iter_mut().enumerate() {
        row[a] += if a < free { RIDGE } else { 1.0 };
    }
    let [x, y] = right;
    Some([solve(normal, x)?, solve(normal, y)?])
}
