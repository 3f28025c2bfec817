//! Interpolation over incidence for one side and component.
//!
//! Between measured incidences one [`Rule`] holds, beyond them another; at a measured incidence both are its slice.

use std::f64::consts::LN_2;
use std::sync::Arc;

use gonio_geom::DVec3;

use crate::across::{Across, Candidate, Frame, MOST_TERMS, Method, Order, Query, View};
use crate::base::Base;
use crate::cubic::Stencil;
use crate::images::Symmetry;
use crate::layout::{Layout, Near, Neighbour};
use crate::lobes::{Moved, Tracks};
use crate::node::Node;
use crate::reciprocity;
use crate::slice_surface::Coverage;

/// A counterpart this low (cosine) or lower begins to lose weight: it leaves through the horizon of its slice.
const FADE: f64 = 0.05;

/// Total weight of visible counterparts below which the unmoved slices are blended in.
const LEAST_VISIBLE: f64 = 0.1;

/// A query within this angle of a measured incidence counts as measured (radians): half a degree.
pub(crate) const SAME_INCIDENCE: f64 = 0.5 * std::f64::consts::PI / 180.0;

/// A candidate with the base it uses.
#[derive(Clone, Debug)]
pub(crate) struct Rule {
    pub(crate) candidate: Candidate,
    /// Used by those that need one.
    pub(crate) base: Option<Arc<Base>>,
    /// Past the measured incidences, whether source and receiver are exchanged where that was read.
    pub(crate) exchange: bool,
}

impl Rule {
    /// The frame in which lobes move.
    fn moving_frame(&self) -> Frame {
        let frames = self.candidate.way().frames();
        let moving = frames.iter().copied().find(|f| *f != Frame::Still);
        moving.unwrap_or(Frame::Still)
    }
}

/// The incidences of one side and component, interpolated.
#[derive(Clone, Debug)]
pub(crate) struct Part {
    nodes: Vec<Arc<Node>>,
    symmetry: Symmetry,
    layout: Layout,
    within: Rule,
    beyond: Rule,
    tracks: Option<Arc<Tracks>>,
    /// A narrow peak that is interpolated apart and added.
    peak: Option<Box<Part>>,
}

impl Part {
    /// Interpolates between `nodes` (at least one; in isotropic layout sorted by polar angle) by `within`, and past
    /// the last of them (outside their hull) by `beyond`.
    pub(crate) fn new(nodes: Vec<Arc<Node>>, symmetry: Symmetry, within: Rule, beyond: Rule) -> Self {
        let directions: Vec<DVec3> = nodes.iter().map(|n| n.direction).collect();
        let layout = Layout::new(&directions, symmetry);
        let tracks = (within.candidate.method == Method::Tracked)
            .then(|| Tracks::new(&nodes, layout.placed()))
            .flatten();
        Part {
            tracks: tracks.map(Arc::new),
            peak: None,
            layout,
            symmetry,
            nodes,
            within,
            beyond,
        }
    }

    /// Adds a narrow peak to this.
    pub(crate) fn add_peak(&mut self, peak: Part) {
        self.peak = Some(Box::new(peak));
    }

    pub(crate) fn symmetry(&self) -> Symmetry {
        self.symmetry
    }

    pub(crate) fn nodes(&self) -> &[Arc<Node>] {
        &self.nodes
    }

    /// The angle to the nearest measured incidence, radians.
    pub(crate) fn distance(&self, i: DVec3) -> f64 {
        self.layout.distance(i)
    }

    /// BSDF for local directions on the upper hemisphere, 1/sr, not negative.
    #[inline]
    pub(crate) fn eval(&self, i: DVec3, s: DVec3) -> f64 {
        let (i, s) = self.layout.frame(i, s);
        let rest = self.eval_about(&self.about(i), s);
        match &self.peak {
            None => rest,
            Some(peak) => rest + peak.eval(i, s),
        }
    }

    /// [`Part::eval`] of one incidence and many directions, faster.
    pub(crate) fn eval_each(&self, i: DVec3, directions: impl Iterator<Item = DVec3>) -> Vec<f64> {
        let about = self.about(self.layout.frame(i, DVec3::Z).0);
        let peak = self.peak.as_ref().map(|p| (p, p.about(i)));
        directions
            .map(|s| {
                let s = self.layout.frame(i, s).1;
                let narrow = peak.as_ref().map_or(0.0, |(p, about)| p.eval_about(about, s));
                self.eval_about(&about, s) + narrow
            })
            .collect()
    }

    /// What a query needs to know of an incidence in the frame of the slices.
    #[inline]
    fn about(&self, i: DVec3) -> About {
        let near = self.layout.near(i);
        let rule = if near.beyond { &self.beyond } else { &self.within };
        self.about_by(rule, near, i)
    }

    #[inline]
    fn about_by(&self, rule: &Rule, near: Near, i: DVec3) -> About {
        let several = near.len() > 1;
        About {
            i,
            stencil: (rule.candidate.order == Order::Cubic && several)
                .then(|| self.layout.stencil(i))
                .flatten(),
            quadratic: (rule.candidate.order == Order::Quadratic && several && near.inside)
                .then(|| self.layout.near_quadratic(i))
                .flatten(),
            moved: match (&self.tracks, rule.candidate.method) {
                (Some(tracks), Method::Tracked) => {
                    Some(Moved::new(tracks, &near, i, |k| self.nodes[k].direction))
                }
                _ => None,
            },
            near,
        }
    }

    #[inline]
    fn eval_about(&self, about: &About, s: DVec3) -> f64 {
        if !about.near.beyond {
            return self.by(&self.within, about, s);
        }
        let direct = self.by(&self.beyond, about, s);
        if !self.beyond.exchange {
            return direct;
        }
        let weight = reciprocity::weight(self.layout.past(about.i), self.layout.past(s));
        match self.exchanged(s, about.i) {
            Some(value) => weight * value + (1.0 - weight) * direct,
            None => direct,
        }
    }

    /// The value at the pair `(i, s)`, where `i` lies between measured incidences and readings surround what it is made of.
    fn exchanged(&self, i: DVec3, s: DVec3) -> Option<f64> {
        let (i, s) = self.layout.frame(i, s);
        let near = self.layout.near(i);
        if !near.inside || !self.seen(&self.within, &near, i, s) {
            return None;
        }
        Some(self.by(&self.within, &self.about_by(&self.within, near, i), s))
    }

    /// The value by `rule`, direction and incidence in the frame of the slices.
    #[inline]
    fn by(&self, rule: &Rule, about: &About, s: DVec3) -> f64 {
        let i = about.i;
        if let (Some(moved), Some(tracks)) = (&about.moved, &self.tracks) {
            return moved.eval(tracks, &about.near, &self.nodes, s).max(0.0);
        }
        let query = Query {
            i,
            s,
            base: rule.base.as_ref(),
        };
        let way = rule.candidate.way();
        let mut views = about.near.iter().map(|k| View {
            node: &self.nodes[k.node],
            neighbour: k,
        });
        if let Some(value) = way.together(&query, &mut views) {
            return value.max(0.0);
        }
        let mut terms = [0.0; MOST_TERMS];
        for (term, &frame) in way.frames().iter().enumerate() {
            let read = |k: &Neighbour, frame: Frame| {
                let view = View {
                    node: &self.nodes[k.node],
                    neighbour: k,
                };
                let at = frame.counterpart(i, s, view.direction());
                let visible = if frame == Frame::Still {
                    1.0
                } else {
                    fade(at.direction.z)
                };
                let value = if visible > 0.0 {
                    way.read(term, &query, &view, at)
                } else {
                    0.0
                };
                (value, visible)
            };
            terms[term] = match self.higher(way, about, |k| read(k, frame)) {
                Some((value, 1.0)) => value,
                Some((value, v)) if v > 0.0 => v * value + (1.0 - v) * linear(&about.near, frame, read),
                _ => linear(&about.near, frame, read),
            };
        }
        way.join(&query, &terms).max(0.0)
    }

    /// One number interpolated by a higher order where there is one, and how visible its counterparts are.
    #[inline]
    fn higher(
        &self,
        way: &dyn Across,
        about: &About,
        read: impl Fn(&Neighbour) -> (f64, f64),
    ) -> Option<(f64, f64)> {
        if let Some((theta, stencil)) = &about.stencil {
            let mut visible = 1.0f64;
            let mut value = |k: Neighbour| {
                let (v, seen) = read(&k);
                visible = visible.min(seen);
                v
            };
            let between = stencil.between.map(|k| value(k.node));
            let before = stencil.before.map(|k| value(k.node));
            let after = stencil.after.map(|k| value(k.node));
            return Some((stencil.interpolate(*theta, before, between, after), visible));
        }
        let near = about.quadratic.as_ref()?;
        let (mut sum, mut visible) = (0.0, 1.0f64);
        let (mut low, mut high) = (f64::INFINITY, f64::NEG_INFINITY);
        for k in near.iter() {
            let (value, seen) = read(k);
            sum += k.weight * value;
            visible = visible.min(seen);
            low = low.min(value);
            high = high.max(value);
        }
        let (low, high) = if way.logarithmic() {
            (low - LN_2, high + LN_2)
        } else {
            (low - 0.5 * low.abs(), high + high.abs())
        };
        Some((sum.clamp(low, high), visible))
    }

    /// How the value at `(i, s)` is known.
    pub(crate) fn coverage(&self, i: DVec3, s: DVec3) -> Coverage {
        let (i, s) = self.layout.frame(i, s);
        let near = self.layout.near(i);
        let rule = if near.beyond { &self.beyond } else { &self.within };
        let at_node = self.layout.distance(i) <= SAME_INCIDENCE;
        match (self.seen(rule, &near, i, s), at_node, near.inside) {
            (true, true, _) => Coverage::Measured,
            (true, false, true) => Coverage::Interpolated,
            _ => Coverage::Extrapolated,
        }
    }

    /// Whether readings surround the counterparts of a query in all slices `near`.
    fn seen(&self, rule: &Rule, near: &Near, i: DVec3, s: DVec3) -> bool {
        let frame = rule.moving_frame();
        near.iter().filter(|k| k.weight > 1e-9).all(|k| {
            let node = &*self.nodes[k.node];
            let at = frame.counterpart(i, s, k.turn(node.direction));
            at.direction.z > 0.0 && node.measured(k.turn(at.direction))
        })
    }

    /// The slices that a value is made of: number, weight, and the direction in which each is read, at the lowest the
    /// horizon.
    pub(crate) fn counterparts(&self, i: DVec3, s: DVec3) -> impl Iterator<Item = (usize, f64, DVec3)> + '_ {
        let (i, s) = self.layout.frame(i, s);
        let near = self.layout.near(i);
        let rule = if near.beyond { &self.beyond } else { &self.within };
        let frame = rule.moving_frame();
        let list: Vec<Neighbour> = near.iter().copied().collect();
        list.into_iter().map(move |k| {
            let at = frame.counterpart(i, s, k.turn(self.nodes[k.node].direction));
            let seen = if at.direction.z > 0.0 { at.direction } else { s };
            (k.node, k.weight, k.turn(seen))
        })
    }

    /// What slice `k` alone predicts; `None` where it was not read there.
    pub(crate) fn alone(&self, k: Neighbour, i: DVec3, s: DVec3) -> Option<f64> {
        let (i, s) = self.layout.frame(i, s);
        let near = Near::alone(k);
        self.seen(&self.within, &near, i, s)
            .then(|| self.by(&self.within, &self.about_by(&self.within, near, i), s))
    }

    /// How the measured incidences lie.
    pub(crate) fn layout(&self) -> &Layout {
        &self.layout
    }
}

/// An incidence as queries see it.
#[derive(Clone, Debug)]
struct About {
    i: DVec3,
    near: Near,
    /// Polar angle and the incidences around it, where a cubic is wanted and there is one.
    stencil: Option<(f64, Stencil)>,
    /// Weights of the local quadratic, where one is wanted and tame.
    quadratic: Option<Near>,
    /// Lobes that are followed.
    moved: Option<Moved>,
}

/// Linear over incidence; the slices as they are where no counterpart is visible.
#[inline]
fn linear(near: &Near, frame: Frame, read: impl Fn(&Neighbour, Frame) -> (f64, f64)) -> f64 {
    let (mut sum, mut visible) = (0.0, 0.0);
    for k in near.iter() {
        let (value, seen) = read(k, frame);
        sum += k.weight * seen * value;
        visible += k.weight * seen;
    }
    if visible >= LEAST_VISIBLE {
        return sum / visible;
    }
    let unmoved: f64 = near.iter().map(|k| k.weight * read(k, Frame::Still).0).sum();
    let moved = if visible > 0.0 { sum / visible } else { 0.0 };
    let share = visible / LEAST_VISIBLE;
    share * moved + (1.0 - share) * unmoved
}

/// Smooth step from 0 at the horizon to 1 at [`FADE`].
#[inline]
fn fade(z: f64) -> f64 {
    let x = (z / FADE).clamp(0.0, 1.0);
    x * x * (3.0 - 2.0 * x)
}
