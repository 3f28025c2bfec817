//! The same half-vector: what the same facets reflected at the measured incidence.

use gonio_geom::DVec3;

use super::{Counterpart, facet_factor};

#[inline]
pub(super) fn counterpart(i: DVec3, s: DVec3, node: DVec3) -> Counterpart {
    let h = i + s;
    let length2 = h.length_squared();
    if length2 < 1e-12 {
        // Opposite directions, both on the horizon: no half-vector.
        return Counterpart {
            direction: s,
            factor: 1.0,
        };
    }
    let direction = h * (2.0 * h.dot(node) / length2) - node;
    Counterpart {
        direction,
        factor: facet_factor(i, s, node, direction),
    }
}
