//! What is reduced: some channels of one component of a model, averaged over the symmetry that is taken for granted.

use gonio_bsdf::compact::{Frame, Symmetry};
use gonio_bsdf::{Bsdf, Channel, Properties};
use gonio_geom::{Component, DVec3, Direction, Side};
use rayon::prelude::*;

/// Some channels of a model, with values that are finite and not negative, and data everywhere.
pub(super) struct View<'a> {
    model: &'a dyn Bsdf,
    indices: Vec<usize>,
    channels: Vec<Channel>,
}

impl<'a> View<'a> {
    /// Channels `indices` of the model, all of them in its list.
    pub(super) fn new(model: &'a dyn Bsdf, indices: Vec<usize>) -> Self {
        let channels = indices.iter().map(|k| model.channels()[*k]).collect();
        View {
            model,
            indices,
            channels,
        }
    }

    /// The ideal part ([`Bsdf::delta`]): shares of the channels that are kept, and the direction.
    pub(super) fn shares(&self, w: Direction, component: Component, shares: &mut [f64]) -> Option<Direction> {
        let mut all = vec![0.0; self.model.channels().len()];
        let to = self.model.delta(w, component, &mut all);
        for (share, k) in shares.iter_mut().zip(&self.indices) {
            *share = if all[*k].is_finite() {
                all[*k].clamp(0.0, 1.0)
            } else {
                0.0
            };
        }
        to.filter(|_| shares.iter().any(|s| *s > 0.0))
    }
}

impl Bsdf for View<'_> {
    fn channels(&self) -> &[Channel] {
        &self.channels
    }

    fn properties(&self) -> Properties {
        self.model.properties()
    }

    /// The scattered light alone: ideal parts are kept apart ([`View::shares`]).
    fn eval(&self, wi: Direction, ws: Direction, f: &mut [f64]) {
        let sound = |v: f64| if v.is_finite() { v.max(0.0) } else { 0.0 };
        if let ([0], [f]) = (&self.indices[..], &mut *f) {
            *f = sound(self.model.eval_first(wi, ws));
            return;
        }
        let mut all = vec![0.0; self.model.channels().len()];
        self.model.eval(wi, ws, &mut all);
        for (f, k) in f.iter_mut().zip(&self.indices) {
            *f = sound(all[*k]);
        }
    }
}

/// A pair on the side of incidence: both directions on the front.
pub(super) type Pair = (Direction, Direction);

/// One component.
pub(super) struct Source<'a> {
    pub(super) view: &'a View<'a>,
    pub(super) side: Side,
    pub(super) component: Component,
    images: Vec<Image>,
}

impl<'a> Source<'a> {
    pub(super) fn new(view: &'a View<'a>, side: Side, component: Component) -> Self {
        Source {
            view,
            side,
            component,
            images: vec![SAME],
        }
    }

    /// The same averaged over the mirror images of `symmetry`.
    pub(super) fn averaged(&self, symmetry: Symmetry, phi_x: f64) -> Self {
        Source {
            images: images(symmetry, phi_x),
            ..*self
        }
    }

    pub(super) fn channels(&self) -> usize {
        self.view.channels.len()
    }

    /// The pair where the model has it.
    pub(super) fn placed(&self, (wi, ws): Pair) -> Pair {
        let to = |d: Direction, side: Side| if side == Side::Back { d.flipped() } else { d };
        (
            to(wi, self.side),
            to(ws, self.component.scattered_side(self.side)),
        )
    }

    /// Values of every channel, averaged over the images.
    pub(super) fn eval(&self, pair: Pair, f: &mut [f64]) {
        f.fill(0.0);
        let mut one = vec![0.0; f.len()];
        for image in &self.images {
            let (wi, ws) = self.placed((turned(image, pair.0), turned(image, pair.1)));
            self.view.eval(wi, ws, &mut one);
            f.iter_mut()
                .zip(&one)
                .for_each(|(f, v)| *f += v / self.images.len() as f64);
        }
    }

    /// Values of many pairs, `[pair][channel]`.
    pub(super) fn many(&self, pairs: &[Pair]) -> Vec<f64> {
        let n = self.channels();
        let mut values = vec![0.0; n * pairs.len()];
        values
            .par_chunks_mut(n)
            .with_min_len(256)
            .zip(pairs)
            .for_each(|(f, pair)| self.eval(*pair, f));
        values
    }

    /// The symmetry to take for granted: the highest whose mirror images are within `tolerance`, as relative L1 difference
    /// from their mean. `axes` are azimuths to try as mirror planes.
    pub(super) fn find_symmetry(&self, axes: &[f64], tolerance: f64) -> (Symmetry, f64) {
        let isotropic = self.view.properties().isotropic;
        let probes = probes();
        let plain = self.many(&probes);
        let total: f64 = plain.iter().sum();
        let holds = |symmetry: Symmetry, phi_x: f64| {
            let mean = self.averaged(symmetry, phi_x).many(&probes);
            let difference: f64 = mean.iter().zip(&plain).map(|(a, b)| (a - b).abs()).sum();
            difference <= tolerance * total
        };
        if isotropic {
            return if holds(Symmetry::Isotropic, 0.0) {
                (Symmetry::Isotropic, 0.0)
            } else {
                (Symmetry::IsotropicChiral, 0.0)
            };
        }
        let quarter = std::f64::consts::FRAC_PI_2;
        for &axis in axes {
            if holds(Symmetry::Quadrilateral, axis) {
                return (Symmetry::Quadrilateral, axis);
            }
        }
        let first = axes.first().copied().unwrap_or(0.0);
        if holds(Symmetry::HalfTurn, first) {
            return (Symmetry::HalfTurn, first);
        }
        for &axis in axes {
            for axis in [axis, axis + quarter] {
                if holds(Symmetry::Bilateral, axis) {
                    return (Symmetry::Bilateral, axis);
                }
            }
        }
        (Symmetry::Anisotropic, first)
    }
}

/// A linear map of the sample plane, row after row.
pub(super) type Image = [f64; 4];

const SAME: Image = [1.0, 0.0, 0.0, 1.0];

/// Maps of the sample plane that leave `f` as it is.
pub(super) fn images(symmetry: Symmetry, phi_x: f64) -> Vec<Image> {
    let (sin, cos) = (2.0 * phi_x).sin_cos();
    let across = [cos, sin, sin, -cos];
    match symmetry {
        Symmetry::Isotropic | Symmetry::Bilateral => vec![SAME, across],
        Symmetry::Quadrilateral => vec![SAME, across, across.map(|v| -v), SAME.map(|v| -v)],
        Symmetry::HalfTurn => vec![SAME, SAME.map(|v| -v)],
        Symmetry::IsotropicChiral | Symmetry::Anisotropic => vec![SAME],
    }
}

pub(super) fn turned(image: &Image, d: Direction) -> Direction {
    let v = d.vec();
    Direction::from_unit(DVec3::new(
        image[0] * v.x + image[1] * v.y,
        image[2] * v.x + image[3] * v.y,
        v.z,
    ))
}

/// Pairs spread over incidences and half vectors, most of them near the normal.
fn probes() -> Vec<Pair> {
    let frame = Frame {
        symmetry: Symmetry::Anisotropic,
        width: [0.05; 2],
        phi_x: 0.3,
        shape: [2, 4, 2, 4],
    };
    let pair = |k: u32| {
        let [a, b, c, d] = spread(k);
        let (wi, ws, _) = frame.pair([0.9 * a, 4.0 * b, c, 4.0 * d])?;
        Some((wi, ws))
    };
    (0..6000).filter_map(pair).collect()
}

/// Point `k` of an even sequence in the unit hypercube: multiples of the powers of the root of `x^5 = x + 1`.
pub(super) fn spread(k: u32) -> [f64; 4] {
    const ROOT: f64 = 1.167_303_978_261_418_7;
    [1, 2, 3, 4].map(|power| (0.5 + f64::from(k + 1) / ROOT.powi(power)).fract())
}
