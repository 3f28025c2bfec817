//! Sides of a sample and components of its scattering.

use std::fmt;

/// One side of the sample. The front is the half space `z > 0`.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum Side {
    /// Half space `z > 0` (theta < 90 degrees).
    Front,
    /// Half space `z < 0` (theta > 90 degrees).
    Back,
}

impl Side {
    /// Both sides, front first.
    pub const BOTH: [Side; 2] = [Side::Front, Side::Back];

    /// The side a direction with this `z` component leaves to; the horizon (`z == 0`) counts as front.
    pub fn of_z(z: f64) -> Self {
        if z < 0.0 { Side::Back } else { Side::Front }
    }

    /// The other side.
    pub fn opposite(self) -> Self {
        match self {
            Side::Front => Side::Back,
            Side::Back => Side::Front,
        }
    }

    /// `+1.0` for the front, `-1.0` for the back: the sign of `z`.
    pub fn sign(self) -> f64 {
        match self {
            Side::Front => 1.0,
            Side::Back => -1.0,
        }
    }
}

impl fmt::Display for Side {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Side::Front => "front",
            Side::Back => "back",
        })
    }
}

/// Whether light leaves on the side it came from.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum Component {
    /// Source and receiver on the same side.
    Reflection,
    /// Source and receiver on opposite sides.
    Transmission,
}

impl Component {
    /// The component that connects the side of incidence with the side of scattering.
    pub fn between(incident: Side, scattered: Side) -> Self {
        if incident == scattered {
            Component::Reflection
        } else {
            Component::Transmission
        }
    }

    /// The side scattered light leaves to when it arrives on `incident`.
    pub fn scattered_side(self, incident: Side) -> Side {
        match self {
            Component::Reflection => incident,
            Component::Transmission => incident.opposite(),
        }
    }
}

impl fmt::Display for Component {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Component::Reflection => "reflection",
            Component::Transmission => "transmission",
        })
    }
}
