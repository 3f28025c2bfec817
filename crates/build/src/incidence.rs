//! Interpolation over incidence for one side and component.
//!
//! `f(i, s) = sum_k w_k b_k + sum_k w_k g_k (f_k(s_k) - b_k)`: the diffuse bases `b_k` are interpolated as they are,
//! the rest is read from each neighbouring slice in the direction `s_k` where a [`Warp`](crate::Warp) finds the same
//! part of the lobe, with its factor `g_k`. At a measured incidence this is the slice itself.

use std::sync::Arc;

use gonio_geom::DVec3;

use crate::layout::{Layout, Near, Neighbour};
use crate::node::Node;
use crate::slice_surface::Coverage;
use crate::warp::{Candidate, Warp};

/// A counterpart this low (cosine) or lower begins to lose weight: it leaves through the horizon of its slice.
const FADE: f64 = 0.05;

/// Total weight of visible counterparts below which the unmoved slices are blended in.
const LEAST_VISIBLE: f64 = 0.1;

/// A query within this angle of a measured incidence counts as measured (radians): half a degree.
pub(crate) const SAME_INCIDENCE: f64 = 0.5 * std::f64::consts::PI / 180.0;

/// The incidences of one side and component, interpolated by one candidate.
#[derive(Clone, Debug)]
pub(crate) struct Part {
    nodes: Vec<Arc<Node>>,
    layout: Layout,
    candidate: Candidate,
}

impl Part {
    /// Interpolates between `nodes` (at least one; in isotropic layout sorted by polar angle).
    pub(crate) fn new(nodes: Vec<Arc<Node>>, isotropic: bool, candidate: Candidate) -> Self {
        let directions: Vec<DVec3> = nodes.iter().map(|n| n.direction).collect();
        Part {
            layout: Layout::new(&directions, isotropic),
            nodes,
            candidate,
        }
    }

    pub(crate) fn nodes(&self) -> &[Arc<Node>] {
        &self.nodes
    }

    /// Positions of the incidences that lie between others, so that they can be predicted from these.
    pub(crate) fn interior(&self) -> Vec<usize> {
        self.layout.interior()
    }

    /// The angle to the nearest measured incidence, radians.
    pub(crate) fn distance(&self, i: DVec3) -> f64 {
        self.layout.distance(i)
    }

    /// BSDF for local directions on the upper hemisphere, 1/sr, not negative.
    #[inline]
    pub(crate) fn eval(&self, i: DVec3, s: DVec3) -> f64 {
        let (i, s) = self.layout.frame(i, s);
        if self.candidate.cubic
            && let Some((value, fade)) = self.cubic(i, s)
        {
            return if fade < 1.0 {
                fade * value.max(0.0) + (1.0 - fade) * self.linear(i, s)
            } else {
                value.max(0.0)
            };
        }
        self.linear(i, s)
    }

    /// The limited cubic over incidence, and how far it holds: 0 where a counterpart is not visible, `None` where
    /// there is no incidence beyond the two around `i`.
    #[inline]
    fn cubic(&self, i: DVec3, s: DVec3) -> Option<(f64, f64)> {
        let (theta, stencil) = self.layout.stencil(i)?;
        let moved = self.candidate.warp != Warp::Identity;
        let mut visible = 1.0f64;
        let mut value = |k: Neighbour| {
            let node = &*self.nodes[k.node];
            let level = if self.candidate.base_split { node.base } else { 0.0 };
            let at = self.candidate.warp.counterpart(i, s, k.turn(node.direction));
            if moved {
                visible = visible.min(fade(at.direction.z));
                if visible == 0.0 {
                    return 0.0;
                }
            }
            level + at.factor * (node.value(k.turn(at.direction)) - level)
        };
        let between = stencil.between.map(|k| value(k.node));
        let before = stencil.before.map(|k| value(k.node));
        let after = stencil.after.map(|k| value(k.node));
        Some((stencil.interpolate(theta, before, between, after), visible))
    }

    /// Linear over incidence.
    #[inline]
    fn linear(&self, i: DVec3, s: DVec3) -> f64 {
        let near = self.layout.near(i);
        let moved = self.candidate.warp != Warp::Identity;
        let (mut base, mut lobe, mut visible) = (0.0, 0.0, 0.0);
        for k in near.iter() {
            let node = &*self.nodes[k.node];
            let level = if self.candidate.base_split { node.base } else { 0.0 };
            base += k.weight * level;
            let at = self.candidate.warp.counterpart(i, s, k.turn(node.direction));
            let fade = if moved { fade(at.direction.z) } else { 1.0 };
            if fade > 0.0 {
                let value = node.value(k.turn(at.direction)) - level;
                lobe += k.weight * fade * at.factor * value;
                visible += k.weight * fade;
            }
        }
        let mut f = base;
        if visible > 0.0 {
            f += lobe / visible * (visible / LEAST_VISIBLE).min(1.0);
        }
        if visible < LEAST_VISIBLE {
            f += (1.0 - visible / LEAST_VISIBLE) * self.unmoved(&near, s);
        }
        f.max(0.0)
    }

    /// The lobes where they are: what is left when no counterpart is visible.
    fn unmoved(&self, near: &Near, s: DVec3) -> f64 {
        near.iter()
            .map(|k| {
                let node = &*self.nodes[k.node];
                let level = if self.candidate.base_split { node.base } else { 0.0 };
                k.weight * (node.value(k.turn(s)) - level)
            })
            .sum()
    }

    /// How the value at `(i, s)` is known.
    pub(crate) fn coverage(&self, i: DVec3, s: DVec3) -> Coverage {
        let (i, s) = self.layout.frame(i, s);
        let near = self.layout.near(i);
        let seen = near.iter().filter(|k| k.weight > 1e-9).all(|k| {
            let node = &*self.nodes[k.node];
            let at = self.candidate.warp.counterpart(i, s, k.turn(node.direction));
            at.direction.z > 0.0 && node.measured(k.turn(at.direction))
        });
        let at_node = self.layout.distance(i) <= SAME_INCIDENCE;
        match (seen, at_node, near.inside) {
            (true, true, _) => Coverage::Measured,
            (true, false, true) => Coverage::Interpolated,
            _ => Coverage::Extrapolated,
        }
    }
}

/// Smooth step from 0 at the horizon to 1 at [`FADE`].
#[inline]
fn fade(z: f64) -> f64 {
    let x = (z / FADE).clamp(0.0, 1.0);
    x * x * (3.0 - 2.0 * x)
}
