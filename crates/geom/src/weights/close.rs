//! Directions that no goniometer tells apart.

use std::borrow::Cow;

use glam::DVec3;

/// Distance up to which two directions are one, radians (.0001 degrees): a fraction of any pointing error, and far enough
/// apart for the corners of a Voronoi cell to be computed.
const SAME: f64 = 2e-6;
/// An axis in no special position to the usual rings and planes of readings.
const AXIS: DVec3 = DVec3::new(0.577_113, 0.211_947, 0.788_672);

/// `points` with every one that lies within [`SAME`] of an earlier one (along [`AXIS`]) put onto it; the same slice when
/// there is none.
pub(crate) fn unified(points: &[DVec3]) -> Cow<'_, [DVec3]> {
    let mut order: Vec<(f64, u32)> = points
        .iter()
        .enumerate()
        .map(|(k, p)| (p.dot(AXIS), k as u32))
        .collect();
    order.sort_unstable_by(|a, b| a.0.total_cmp(&b.0));
    let mut out = Cow::Borrowed(points);
    let mut taken = vec![false; points.len()];
    for (k, &(height, first)) in order.iter().enumerate() {
        // One that was put onto another, or equals it, has met every neighbour there.
        if taken[first as usize] {
            continue;
        }
        let p = points[first as usize];
        for &(other_height, other) in &order[k + 1..] {
            if other_height - height > SAME {
                break;
            }
            let q = points[other as usize];
            if !taken[other as usize] && p.distance_squared(q) <= SAME * SAME {
                taken[other as usize] = true;
                if p != q {
                    out.to_mut()[other as usize] = p;
                }
            }
        }
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Direction;

    #[test]
    fn neighbours_closer_than_any_pointing_become_one() {
        let p = Direction::from_degrees(40.0, 20.0).vec();
        let near = Direction::from_degrees(40.0 + 1e-5, 20.0).vec();
        let apart = Direction::from_degrees(40.001, 20.0).vec();
        let points = [p, apart, near, p];
        let found = unified(&points);
        assert_eq!(found[2], found[0]);
        assert_eq!(found[3], found[0]);
        assert_eq!(found[1], apart);
    }

    #[test]
    fn many_repeats_of_one_direction_take_one_pass() {
        // Quadratic in the repeats this would not end.
        let p = Direction::from_degrees(40.0, 20.0).vec();
        assert!(matches!(unified(&vec![p; 3_000_000]), Cow::Borrowed(_)));
    }

    #[test]
    fn distinct_directions_are_left_alone() {
        let points: Vec<DVec3> = (0..90)
            .map(|k| Direction::from_degrees(f64::from(k), 7.0).vec())
            .collect();
        assert!(matches!(unified(&points), Cow::Borrowed(_)));
    }
}
