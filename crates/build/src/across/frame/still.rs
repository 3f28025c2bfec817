//! No movement.

use gonio_geom::DVec3;

use super::Counterpart;

#[inline]
pub(super) fn counterpart(s: DVec3) -> Counterpart {
    Counterpart {
        direction: s,
        factor: 1.0,
    }
}
