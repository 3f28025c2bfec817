//! The lobe turns rigidly with the mirror (through) direction, by the shortest rotation.
//!
//! The factor is that of a lobe whose flux stays and whose BSDF goes with `2 / (c_i + c_s)`: near the mirror
//! direction the DSF of such a lobe does not depend on the incidence.

use gonio_geom::DVec3;

use super::Counterpart;

#[inline]
pub(super) fn counterpart(i: DVec3, s: DVec3, node: DVec3) -> Counterpart {
    let (from, to) = (DVec3::new(-i.x, -i.y, i.z), DVec3::new(-node.x, -node.y, node.z));
    let cosine = from.dot(to);
    let axis = from.cross(to);
    // Rodrigues' rotation without angles; both directions are on the upper hemisphere, so 1 + cosine > 0 unless
    // both lie on the horizon, opposite.
    let direction = s * cosine + axis.cross(s) + axis * (axis.dot(s) / (1.0 + cosine).max(1e-9));
    Counterpart {
        direction,
        factor: (node.z + direction.z.max(0.0)) / (i.z + s.z).max(1e-3),
    }
}
