//! A fitted parameter.

use gonio_bsdf::Channel;
use gonio_bsdf::analytic::Role;

/// How a value is to be read.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    /// A value with its uncertainty.
    Value,
    /// The lobe is not resolved by the beam: the parameter is below `high`, more cannot be said.
    UpperLimit,
    /// Held at the value given.
    Fixed,
    /// The data do not depend on it.
    Undetermined,
}

impl Kind {
    /// Name used in files and Python.
    pub fn name(self) -> &'static str {
        match self {
            Kind::Value => "value",
            Kind::UpperLimit => "upper_limit",
            Kind::Fixed => "fixed",
            Kind::Undetermined => "undetermined",
        }
    }
}

/// Where the ends of the interval come from.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Interval {
    /// The curvature of the cost at its minimum.
    Quadratic,
    /// The profile of the cost: the other parameters follow while this one is moved.
    Profile,
}

impl Interval {
    /// Name used in files and Python.
    pub fn name(self) -> &'static str {
        match self {
            Interval::Quadratic => "quadratic",
            Interval::Profile => "profile",
        }
    }
}

/// A fitted parameter of one channel, or of all.
#[derive(Clone, Debug, PartialEq)]
pub struct Estimate {
    /// Name as in [`crate::Parameter::name`].
    pub name: String,
    /// Unit; angles are in radians.
    pub unit: String,
    /// What the parameter does.
    pub role: Role,
    /// The channel it belongs to; `None`: all of them.
    pub channel: Option<Channel>,
    /// The value at the minimum.
    pub value: f64,
    /// Standard uncertainty from noise, from correlated residuals and from what all readings share (beam power).
    pub u: f64,
    /// The part of `u` that all readings share.
    pub u_common: f64,
    /// Largest difference to the value that another metric prefers: how much the model, not the noise, leaves open.
    pub u_model: f64,
    /// Lower end of the 95 % interval of `u`.
    pub low: f64,
    /// Upper end.
    pub high: f64,
    /// How the value is to be read.
    pub kind: Kind,
    /// Where `low` and `high` come from.
    pub interval: Interval,
}
