//! A lobe about the direction of incidence: the half-vector rule with the receiver's azimuth turned by 180 degrees.

use gonio_geom::DVec3;

use super::{Counterpart, half_vector};

#[inline]
pub(super) fn counterpart(i: DVec3, s: DVec3, node: DVec3) -> Counterpart {
    let turned = |v: DVec3| DVec3::new(-v.x, -v.y, v.z);
    let found = half_vector::counterpart(i, turned(s), node);
    Counterpart {
        direction: turned(found.direction),
        factor: found.factor,
    }
}
