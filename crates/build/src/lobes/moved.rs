//! The lobes of the incidences around a query, moved to where they stand at the query.
//!
//! Every tracked lobe keeps its shape up to an affine map: how far its centre lies off its law, the root of its covariance and the
//! logarithm of its mass follow a local cubic or parabola through the incidences that have it, or the weights of the neighbours
//! where these incidences do not surround the query. What belongs to no lobe stays where it is.

use std::sync::Arc;

use gonio_geom::DVec3;

use super::tracks::Smooth;
use super::{Lobe, Symmetric, Tracks};
use crate::layout::Near;
use crate::node::Node;

/// A lobe is there when incidences of this total weight have it.
const THERE: f64 = 0.5;

/// Share of the diffuse level that speaks for no lobe.
const FLOOR: f64 = 0.5;
const LEAST_FLOOR: f64 = 5e-4;

/// A lobe at a query.
#[derive(Clone, Debug)]
struct At {
    law: usize,
    centre: [f64; 2],
    sources: Vec<Source>,
}

/// Where an incidence has it.
#[derive(Clone, Debug)]
struct Source {
    /// Position among the neighbours.
    neighbour: usize,
    /// Its weight, times the masses' and areas' ratio.
    weight: f64,
    centre: [f64; 2],
    /// From offsets at the query to offsets in the slice.
    map: [[f64; 2]; 2],
}

/// All lobes at a query's incidence.
#[derive(Clone, Debug)]
pub(crate) struct Moved {
    lobes: Vec<At>,
}

impl Moved {
    /// The lobes at incidence `i`, whose neighbours are `near`.
    pub(crate) fn new(tracks: &Tracks, near: &Near, i: DVec3, directions: impl Fn(usize) -> DVec3) -> Self {
        let lobes = (0..tracks.len()).filter_map(|law| {
            let sources: Vec<(usize, f64, &Lobe, DVec3)> = near
                .iter()
                .enumerate()
                .filter_map(|(n, k)| {
                    let tracked = tracks.of(k);
                    let lobe = tracked.lobes.get((*tracked.which.get(law)?)?)?;
                    Some((n, k.weight, lobe, k.turn(directions(k.node))))
                })
                .collect();
            let there: f64 = sources.iter().map(|s| s.1).sum();
            if there < THERE {
                return None;
            }
            let mean = |f: &dyn Fn(&Lobe, DVec3) -> f64| -> f64 {
                sources.iter().map(|s| s.1 * f(s.2, s.3)).sum::<f64>() / there
            };
            let Smooth {
                centre,
                root,
                ln_mass,
            } = tracks.smooth(law, i).unwrap_or_else(|| {
                let law_here = tracks.centre(law, i);
                let residual = |axis: usize| mean(&|l, at| l.centre[axis] - tracks.centre(law, at)[axis]);
                Smooth {
                    centre: [law_here[0] + residual(0), law_here[1] + residual(1)],
                    root: Symmetric {
                        xx: mean(&|l, _| l.covariance.root().xx),
                        xy: mean(&|l, _| l.covariance.root().xy),
                        yy: mean(&|l, _| l.covariance.root().yy),
                    },
                    ln_mass: mean(&|l, _| l.mass().max(f64::MIN_POSITIVE).ln()),
                }
            });
            let mass = ln_mass.exp();
            let inverse = root.determinant().recip();
            let back = Symmetric {
                xx: inverse * root.yy,
                xy: -inverse * root.xy,
                yy: inverse * root.xx,
            };
            let sources = sources
                .iter()
                .map(|&(neighbour, weight, lobe, _)| {
                    let own = lobe.covariance.root();
                    let map = [
                        [
                            own.xx * back.xx + own.xy * back.xy,
                            own.xx * back.xy + own.xy * back.yy,
                        ],
                        [
                            own.xy * back.xx + own.yy * back.xy,
                            own.xy * back.xy + own.yy * back.yy,
                        ],
                    ];
                    let area = own.determinant() * inverse;
                    Source {
                        neighbour,
                        weight: weight / there * mass * area / lobe.mass().max(f64::MIN_POSITIVE),
                        centre: lobe.centre,
                        map,
                    }
                })
                .collect();
            Some(At { law, centre, sources })
        });
        Moved {
            lobes: lobes.collect(),
        }
    }

    /// The BSDF in direction `s`, 1/sr.
    pub(crate) fn eval(&self, tracks: &Tracks, near: &Near, nodes: &[Arc<Node>], s: DVec3) -> f64 {
        let mut sum = 0.0;
        for k in near.iter() {
            let node = &*nodes[k.node];
            let above = node.value(k.turn(s)) - node.level;
            sum += k.weight * (node.level + above * share(tracks.of(k), None, node.level, [s.x, s.y]));
        }
        let list: Vec<_> = near.iter().collect();
        for lobe in &self.lobes {
            let d = [s.x - lobe.centre[0], s.y - lobe.centre[1]];
            for source in &lobe.sources {
                let p: [f64; 2] = std::array::from_fn(|a| {
                    source.centre[a] + source.map[a][0] * d[0] + source.map[a][1] * d[1]
                });
                let z2 = 1.0 - p[0] * p[0] - p[1] * p[1];
                if z2 <= 0.0 {
                    continue;
                }
                let k = list[source.neighbour];
                let node = &*nodes[k.node];
                let at = DVec3::new(p[0], p[1], z2.sqrt());
                let tracked = tracks.of(k);
                let own = tracked.which.get(lobe.law).copied().flatten();
                let above = node.value(k.turn(at)) - node.level;
                sum += source.weight * above * share(tracked, own, node.level, p);
            }
        }
        sum
    }
}

/// How much of what lies above the diffuse level at `p` belongs to lobe `own`, or to no tracked lobe.
fn share(tracked: &super::tracks::Tracked, own: Option<usize>, level: f64, p: [f64; 2]) -> f64 {
    let floor = (FLOOR * level).max(LEAST_FLOOR);
    let (mut mine, mut other, mut all) = (0.0, floor, floor);
    for (n, lobe) in tracked.lobes.iter().enumerate() {
        let value = lobe.value(p);
        all += value;
        if Some(n) == own {
            mine = value;
        }
        if !tracked.which.contains(&Some(n)) {
            other += value;
        }
    }
    if own.is_some() { mine / all } else { other / all }
}
