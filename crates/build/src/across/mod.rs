//! Ways of interpolating across incidences: one interface, one way a file.
//!
//! A way carries one to three numbers over from every measured incidence near a query, each read where its
//! [`Frame`] finds the same part of the scattering, and makes a BSDF of them once they are interpolated.

mod components;
mod displaced;
mod frame;
mod plain;
mod ratio;
mod split;

use std::fmt;
use std::sync::Arc;

use gonio_geom::DVec3;

use crate::base::Base;
use crate::layout::Neighbour;
use crate::node::Node;

pub(crate) use displaced::Quantiles;
pub(crate) use frame::Counterpart;
pub use frame::Frame;

/// Most numbers a way carries over.
pub(crate) const MOST_TERMS: usize = 3;

/// A direction of incidence and one of scattering (in the frame of the slices), and the base where one is used.
#[derive(Clone, Copy)]
pub(crate) struct Query<'a> {
    pub(crate) i: DVec3,
    pub(crate) s: DVec3,
    pub(crate) base: Option<&'a Arc<Base>>,
}

/// A slice as a query sees it.
#[derive(Clone, Copy)]
pub(crate) struct View<'a> {
    pub(crate) node: &'a Node,
    pub(crate) neighbour: &'a Neighbour,
}

impl View<'_> {
    /// Its incidence in the query's frame.
    #[inline]
    pub(crate) fn direction(&self) -> DVec3 {
        self.neighbour.turn(self.node.direction)
    }

    #[inline]
    fn bsdf(&self, s: DVec3) -> f64 {
        self.node.value(self.neighbour.turn(s))
    }

    #[inline]
    fn ln_ratio(&self, base: &Arc<Base>, s: DVec3) -> f64 {
        self.node.ln_ratio(base, self.neighbour.turn(s))
    }
}

/// A way of interpolating across incidences.
///
/// At a measured incidence every way gives its slice back: `join` of what `read` finds there at factor 1 is the slice.
pub(crate) trait Across: Sync {
    /// The frame of each number that is carried over.
    fn frames(&self) -> &[Frame];

    /// Whether the numbers are logarithms.
    fn logarithmic(&self) -> bool {
        false
    }

    /// Number `term` as slice `view` has it at the counterpart `at` of the query.
    fn read(&self, term: usize, query: &Query<'_>, view: &View<'_>, at: Counterpart) -> f64;

    /// The BSDF that the numbers mean at the query.
    fn join(&self, query: &Query<'_>, terms: &[f64; MOST_TERMS]) -> f64;

    /// The BSDF at the query from all slices together, for a way that has no numbers to read from one slice at a time.
    fn together(&self, _query: &Query<'_>, _views: &mut dyn Iterator<Item = View<'_>>) -> Option<f64> {
        None
    }
}

/// What is carried over, and how it moves.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Method {
    /// The BSDF.
    Plain(Frame),
    /// The diffuse level as it is, and what lies above it.
    Split(Frame),
    /// The logarithm of the ratio to a parametric base.
    Ratio(Frame),
    /// The same for each part of the base in its own frame: diffuse parts still, lobes at the same half-vector, a
    /// lobe about the incidence with it.
    Components,
    /// The same with lobes turned with the mirror (through) direction.
    TurnedComponents,
    /// Lobes that are found in every slice and followed (samples with axes).
    Tracked,
    /// The diffuse level as it is, and the light above it displaced quantile by quantile.
    Displaced,
}

impl Method {
    fn way(self) -> &'static dyn Across {
        match self {
            Method::Plain(frame) => plain::of(frame),
            Method::Split(frame) => split::of(frame),
            Method::Ratio(frame) => ratio::of(frame),
            Method::Components => &components::FACETS,
            Method::TurnedComponents => &components::TURNED,
            // The lobes are moved apart from this; without one, slices stay as they are.
            Method::Tracked => plain::of(Frame::Still),
            Method::Displaced => &displaced::Displaced,
        }
    }

    /// Whether it is tried only where no other one predicts well, and only between incidences: lobes that move on their own.
    pub(crate) fn is_last_resort(self) -> bool {
        matches!(self, Method::Tracked | Method::Displaced)
    }

    /// Whether it needs a parametric base.
    pub fn needs_base(self) -> bool {
        matches!(
            self,
            Method::Ratio(_) | Method::Components | Method::TurnedComponents
        )
    }
}

/// How what is carried over is interpolated.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum Order {
    /// Linear in the polar angle of incidence (isotropic samples), by natural neighbours (others).
    #[default]
    Linear,
    /// A limited cubic of the polar angle of incidence (isotropic samples).
    Cubic,
    /// A guarded local quadratic of the direction of incidence (samples with axes).
    Quadratic,
}

/// A way of interpolating across incidences.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct Candidate {
    /// What is carried over.
    pub method: Method,
    /// How it is interpolated.
    pub order: Order,
}

impl Candidate {
    /// Every candidate, the preferred one of a tie first.
    pub const ALL: [Candidate; 13] = [
        Candidate::linear(Method::Ratio(Frame::HalfVector)),
        Candidate::linear(Method::Components),
        Candidate::linear(Method::TurnedComponents),
        Candidate::linear(Method::Ratio(Frame::Mirror)),
        Candidate::linear(Method::Ratio(Frame::CosineShift)),
        Candidate::linear(Method::Ratio(Frame::Still)),
        Candidate::linear(Method::Split(Frame::HalfVector)),
        Candidate::linear(Method::Split(Frame::Mirror)),
        Candidate::linear(Method::Split(Frame::CosineShift)),
        Candidate::linear(Method::Tracked),
        Candidate::linear(Method::Plain(Frame::Mirror)),
        Candidate::linear(Method::Plain(Frame::Still)),
        Candidate::linear(Method::Displaced),
    ];

    /// `method`, linear over incidence.
    pub const fn linear(method: Method) -> Self {
        Candidate {
            method,
            order: Order::Linear,
        }
    }

    /// The same of another order over incidence.
    pub const fn with_order(self, order: Order) -> Self {
        Candidate { order, ..self }
    }

    pub(crate) fn way(self) -> &'static dyn Across {
        self.method.way()
    }

    /// Name used in reports and options.
    pub fn name(self) -> &'static str {
        macro_rules! name {
            ($($method:pat => $name:literal),* $(,)?) => {
                match self.method {
                    $($method => match self.order {
                        Order::Linear => $name,
                        Order::Cubic => concat!($name, ", cubic"),
                        Order::Quadratic => concat!($name, ", quadratic"),
                    },)*
                }
            };
        }
        name! {
            Method::Plain(Frame::Still) => "naive",
            Method::Plain(Frame::Mirror) => "mirror-frame",
            Method::Plain(Frame::HalfVector) => "half-vector",
            Method::Plain(Frame::CosineShift) => "cosine-shift",
            Method::Plain(Frame::Retro) => "retro",
            Method::Split(Frame::Still) => "base + naive",
            Method::Split(Frame::Mirror) => "base + mirror-frame",
            Method::Split(Frame::HalfVector) => "base + half-vector",
            Method::Split(Frame::CosineShift) => "base + cosine-shift",
            Method::Split(Frame::Retro) => "base + retro",
            Method::Ratio(Frame::Still) => "model x ratio",
            Method::Ratio(Frame::Mirror) => "model x mirror-frame",
            Method::Ratio(Frame::HalfVector) => "model x half-vector",
            Method::Ratio(Frame::CosineShift) => "model x cosine-shift",
            Method::Ratio(Frame::Retro) => "model x retro",
            Method::Components => "model x components",
            Method::TurnedComponents => "model x turned components",
            Method::Tracked => "tracked lobes",
            Method::Displaced => "displaced light",
        }
    }
}

impl fmt::Display for Candidate {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}
