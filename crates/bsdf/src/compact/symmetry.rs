//! What a compact table takes for granted about azimuth.

use crate::BsdfError;

use super::domain;

/// What a table takes for granted about azimuth.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Symmetry {
    /// `f` depends on `phi_s - phi_i` only, and not on its sign. Rank 3.
    Isotropic,
    /// `f` depends on `phi_s - phi_i`. Rank 3.
    IsotropicChiral,
    /// Mirrored in the planes of `phi_x` and `phi_x + 90` degrees. Rank 4.
    Quadrilateral,
    /// Mirrored in the plane of `phi_x`. Rank 4.
    Bilateral,
    /// The same after half a turn about the normal. Rank 4.
    HalfTurn,
    /// Nothing. Rank 4.
    Anisotropic,
}

impl Symmetry {
    /// Every symmetry, with its name in files.
    pub const NAMES: [(Symmetry, &'static str); 6] = [
        (Symmetry::Isotropic, "isotropic"),
        (Symmetry::IsotropicChiral, "isotropic-chiral"),
        (Symmetry::Quadrilateral, "quadrilateral"),
        (Symmetry::Bilateral, "bilateral"),
        (Symmetry::HalfTurn, "half-turn"),
        (Symmetry::Anisotropic, "anisotropic"),
    ];

    /// Whether `f` depends on `phi_s - phi_i` only.
    pub fn is_isotropic(self) -> bool {
        matches!(self, Symmetry::Isotropic | Symmetry::IsotropicChiral)
    }

    /// Name in files.
    pub fn name(self) -> &'static str {
        Self::NAMES.iter().find(|(s, _)| *s == self).map_or("", |n| n.1)
    }

    /// The axis of the incidence's azimuth.
    pub(super) fn phi_i(self) -> Axis {
        match self {
            Symmetry::Isotropic | Symmetry::IsotropicChiral => Axis::Single,
            Symmetry::Quadrilateral => Axis::Ends(1.0),
            Symmetry::Bilateral | Symmetry::HalfTurn => Axis::Ends(2.0),
            Symmetry::Anisotropic => Axis::Round,
        }
    }

    /// The axis of the half vector's azimuth.
    pub(super) fn phi_h(self) -> Axis {
        match self {
            Symmetry::Isotropic => Axis::Ends(2.0),
            _ => Axis::Round,
        }
    }
}

impl std::str::FromStr for Symmetry {
    type Err = BsdfError;

    fn from_str(name: &str) -> Result<Self, BsdfError> {
        let found = Self::NAMES.iter().find(|(_, n)| *n == name);
        found.map(|(s, _)| *s).ok_or_else(|| {
            let names = Self::NAMES.map(|(_, n)| n);
            domain("symmetry", format!("{name:?}"), names.join(", "))
        })
    }
}

/// How nodes lie along an axis of azimuth, in diamond angles.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Axis {
    /// One node: the coordinate does not count.
    Single,
    /// From 0 to this, nodes at both ends.
    Ends(f64),
    /// Once round, from 0 to 4; the first node follows the last.
    Round,
}

impl Axis {
    /// Nodes per unit of the coordinate.
    pub(super) fn density(self, nodes: usize) -> f64 {
        match self {
            Axis::Single => 0.0,
            Axis::Ends(end) => (nodes - 1) as f64 / end,
            Axis::Round => nodes as f64 / 4.0,
        }
    }

    /// Fewest nodes.
    pub(super) fn least(self) -> usize {
        match self {
            Axis::Single => 1,
            Axis::Ends(_) => 2,
            Axis::Round => 4,
        }
    }
}
