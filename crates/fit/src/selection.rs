//! Which readings take part, and how many do not.

use std::fmt;

use gonio_bsdf::Channel;
use gonio_geom::Component;
use gonio_scan::Flags;

/// What a fit may use.
#[derive(Clone, Debug, PartialEq)]
pub struct Selection {
    /// Channels; empty: all.
    pub channels: Vec<Channel>,
    /// One component only; `None`: whatever the model scatters into.
    pub component: Option<Component>,
    /// Largest angle between receiver and the normal of its side, radians. Closer to the sample plane holders and edges
    /// disturb.
    pub max_theta_s: f64,
    /// Readings closer than this to the direction of incidence are left out, radians: the receiver's shadow where it was
    /// not flagged.
    pub retro_radius: f64,
}

impl Default for Selection {
    fn default() -> Self {
        Selection {
            channels: Vec::new(),
            component: None,
            max_theta_s: 85.0_f64.to_radians(),
            retro_radius: 0.0,
        }
    }
}

/// Why a reading was left out.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Reason {
    /// Not a number, or flagged as no data.
    NoData,
    /// Flagged as a sentinel zero.
    Sentinel,
    /// Flagged as the receiver's shadow.
    Shadow,
    /// Flagged as saturated.
    Saturated,
    /// Closer to the sample plane than `max_theta_s`, or flagged as horizon.
    Grazing,
    /// Within `retro_radius` of the direction of incidence.
    Retro,
    /// In a component that the model does not scatter into, or that was not selected.
    Component,
    /// In a channel that was not selected.
    Channel,
    /// Incidence in the sample plane.
    Incidence,
}

impl Reason {
    /// Name used in files and Python.
    pub fn name(self) -> &'static str {
        match self {
            Reason::NoData => "no_data",
            Reason::Sentinel => "sentinel",
            Reason::Shadow => "shadow",
            Reason::Saturated => "saturated",
            Reason::Grazing => "grazing",
            Reason::Retro => "retro",
            Reason::Component => "component",
            Reason::Channel => "channel",
            Reason::Incidence => "incidence",
        }
    }

    /// What unusable flags say.
    pub(crate) fn of_flags(flags: Flags) -> Option<Self> {
        [
            (Flags::NO_DATA, Reason::NoData),
            (Flags::SENTINEL, Reason::Sentinel),
            (Flags::SHADOW, Reason::Shadow),
            (Flags::SATURATED, Reason::Saturated),
            (Flags::HORIZON, Reason::Grazing),
        ]
        .into_iter()
        .find(|(f, _)| flags.intersects(*f))
        .map(|(_, r)| r)
    }
}

/// Readings left out for one reason.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Exclusion {
    /// The reason.
    pub reason: Reason,
    /// How many.
    pub count: usize,
}

impl fmt::Display for Exclusion {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{} {}", self.count, self.reason.name())
    }
}

/// The exclusions in one phrase.
pub(crate) fn phrase(exclusions: &[Exclusion]) -> String {
    if exclusions.is_empty() {
        "none".into()
    } else {
        exclusions
            .iter()
            .map(Exclusion::to_string)
            .collect::<Vec<_>>()
            .join(", ")
    }
}
