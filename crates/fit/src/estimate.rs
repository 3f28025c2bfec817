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

/// Why the readings leave a parameter open.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Open {
    /// They do not depend on it, or only together with another parameter.
    Undetermined,
    /// They say hardly more than its bounds do: `u` is at least that of an even distribution between the bounds, their
    /// distance over `sqrt(12)` \[JCGM100, 4.3.7\]; or the 95 % interval reaches both bounds; or, of an amplitude or a
    /// width, `u` exceeds both the value and 0.05.
    Vague,
    /// A width or an exponent at the end of its range: the range chose it, not the readings.
    Range,
}

impl Open {
    /// Name used in files and Python.
    pub fn name(self) -> &'static str {
        match self {
            Open::Undetermined => "undetermined",
            Open::Vague => "vague",
            Open::Range => "range",
        }
    }
}

/// An amplitude or width whose `u` exceeds both this and its value is not known.
const UNKNOWN: f64 = 0.05;
/// Indices of absorption below this are none: reflectance depends on `k` squared, so that at `k = 0` its derivative says
/// nothing although the readings do.
const NO_ABSORPTION: f64 = 1e-3;

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
    /// Why the readings leave it open; `None` where they determine it.
    pub open: Option<Open>,
}

impl Estimate {
    /// Why the readings leave the value open, for a parameter of the range `low` to `high`; `at_end` tells whether the search
    /// ended at one of them.
    pub(crate) fn openness(&self, low: f64, high: f64, at_end: bool) -> Option<Open> {
        let index_of_none = self.role == Role::Index && self.value.abs() < NO_ABSORPTION;
        match self.kind {
            Kind::Fixed | Kind::UpperLimit => None,
            Kind::Undetermined | Kind::Value if index_of_none => None,
            Kind::Undetermined => Some(Open::Undetermined),
            Kind::Value => {
                let sized = matches!(self.role, Role::Amplitude | Role::Width);
                let whole = self.low <= low && self.high >= high;
                let even = (high - low) / 12.0_f64.sqrt();
                if self.u >= even || whole || (sized && self.u > self.value.abs().max(UNKNOWN)) {
                    Some(Open::Vague)
                } else {
                    let shape = matches!(self.role, Role::Width | Role::Exponent);
                    (shape && at_end).then_some(Open::Range)
                }
            }
        }
    }

    /// Name with its channel, such as `color (red)`.
    pub fn label(&self) -> String {
        match self.channel {
            Some(channel) => format!("{} ({channel})", self.name),
            None => self.name.clone(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::limits::Z95;

    fn estimate(role: Role, value: f64, u: f64) -> Estimate {
        Estimate {
            name: "x".into(),
            unit: "1".into(),
            role,
            channel: None,
            value,
            u,
            u_common: 0.0,
            u_model: 0.0,
            low: (value - Z95 * u).max(0.0),
            high: (value + Z95 * u).min(1.0),
            kind: Kind::Value,
            interval: Interval::Quadratic,
            open: None,
        }
    }

    #[test]
    fn a_parameter_known_no_better_than_from_its_bounds_is_vague() {
        // An even distribution over 0 to 1 has a standard deviation of 0.2887.
        let open = |u| estimate(Role::Exponent, 0.6, u).openness(0.0, 1.0, false);
        assert_eq!(open(0.289), Some(Open::Vague));
        assert_eq!(open(0.288), None);
    }

    #[test]
    fn an_interval_from_bound_to_bound_is_vague() {
        let mut e = estimate(Role::Exponent, 0.5, 0.2);
        (e.low, e.high) = (0.0, 1.0);
        assert_eq!(e.openness(0.0, 1.0, false), Some(Open::Vague));
    }

    #[test]
    fn an_amplitude_or_width_below_its_uncertainty_is_vague_unless_both_are_small() {
        let open = |role, value, u| estimate(role, value, u).openness(0.0, 1.0, false);
        assert_eq!(open(Role::Amplitude, 0.1, 0.11), Some(Open::Vague));
        assert_eq!(open(Role::Width, 0.1, 0.11), Some(Open::Vague));
        assert_eq!(open(Role::Exponent, 0.1, 0.11), None);
        assert_eq!(open(Role::Amplitude, 0.01, 0.04), None);
    }

    #[test]
    fn a_shape_at_the_end_of_its_range_is_open_and_an_amplitude_there_is_not() {
        let at_end = |role| estimate(role, 1.0, 0.01).openness(0.0, 1.0, true);
        assert_eq!(at_end(Role::Width), Some(Open::Range));
        assert_eq!(at_end(Role::Exponent), Some(Open::Range));
        assert_eq!(at_end(Role::Amplitude), None);
    }

    #[test]
    fn no_absorption_is_known_although_its_derivative_vanishes() {
        let mut k = estimate(Role::Index, 0.0, 0.0);
        k.kind = Kind::Undetermined;
        assert_eq!(k.openness(0.0, 20.0, true), None);
        k.value = 3.0;
        assert_eq!(k.openness(0.0, 20.0, false), Some(Open::Undetermined));
    }

    #[test]
    fn limits_and_fixed_parameters_are_not_open() {
        for kind in [Kind::UpperLimit, Kind::Fixed] {
            let mut e = estimate(Role::Width, 0.01, 5.0);
            e.kind = kind;
            assert_eq!(e.openness(0.001, 1.0, true), None);
        }
    }
}
