//! The same shift in direction cosines: what a thin diffracting layer does [Harvey1976].

use gonio_geom::DVec3;

use super::Counterpart;

#[inline]
pub(super) fn counterpart(i: DVec3, s: DVec3, node: DVec3) -> Counterpart {
    // Mirror directions are (-i.x, -i.y): s - mirror(i) = s_node - mirror(node).
    let (x, y) = (s.x + i.x - node.x, s.y + i.y - node.y);
    let z2 = 1.0 - x * x - y * y;
    let direction = if z2 > 0.0 {
        DVec3::new(x, y, z2.sqrt())
    } else {
        // Evanescent there: below the horizon.
        DVec3::new(x, y, -1e-3).normalize()
    };
    Counterpart {
        direction,
        factor: 1.0,
    }
}
