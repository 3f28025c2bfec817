//! Openings of windows.

use glam::Vec3;

/// A corner and two edges of four points that are a parallelogram within a thousandth of its size.
pub(super) fn parallelogram(points: &[Vec3]) -> Option<[Vec3; 3]> {
    let [a, b, c, d] = *points else {
        return None;
    };
    let off = (b - a) - (c - d);
    (off.length() <= 1e-3 * (c - a).length()).then_some([a, b - a, d - a])
}
