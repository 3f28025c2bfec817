//! Nearest reading to a direction.

use gonio_geom::DVec3;

/// A k-d tree over unit vectors: answers which of `n` directions lie nearest to another, in `O(log n)`.
///
/// The tree is implicit (median of each range splits it along its widest axis), so it holds one index a direction
/// and nothing else; distances are chords, which order like angles.
#[derive(Clone, Debug)]
pub struct DirectionIndex {
    points: Vec<DVec3>,
    order: Vec<u32>,
    axis: Vec<u8>,
}

const LEAF: usize = 8;

impl DirectionIndex {
    /// Builds the index over `points` (unit vectors). Non-finite points are never found.
    pub fn new(points: Vec<DVec3>) -> Self {
        let mut order: Vec<u32> = (0..points.len() as u32)
            .filter(|&i| points[i as usize].is_finite())
            .collect();
        let mut axis = vec![0_u8; order.len()];
        split(&points, &mut order, &mut axis);
        DirectionIndex { points, order, axis }
    }

    /// Index of the direction nearest to `to` and its angle to it in radians, when one lies within `within` radians.
    pub fn nearest(&self, to: DVec3, within: f64) -> Option<(usize, f64)> {
        self.nearest_k(to, 1, within).into_iter().next()
    }

    /// Up to `k` directions nearest to `to` within `within` radians: index and angle, nearest first.
    pub fn nearest_k(&self, to: DVec3, k: usize, within: f64) -> Vec<(usize, f64)> {
        let mut found: Vec<(usize, f64)> = Vec::with_capacity(k + 1);
        let reach = 2.0 * (0.5 * within.clamp(0.0, std::f64::consts::PI)).sin();
        let mut search = Search {
            index: self,
            to,
            k,
            limit: reach * reach * (1.0 + 1e-12) + 1e-30,
            found: &mut found,
        };
        if k > 0 {
            search.descend(0, self.order.len());
        }
        for (_, d2) in &mut found {
            *d2 = 2.0 * (0.5 * d2.sqrt()).min(1.0).asin();
        }
        found
    }
}

/// Orders `order` as an implicit tree and notes the split axis of each range at its middle.
fn split(points: &[DVec3], order: &mut [u32], axis: &mut [u8]) {
    if order.len() <= LEAF {
        return;
    }
    let (mut lo, mut hi) = (DVec3::INFINITY, DVec3::NEG_INFINITY);
    for &i in order.iter() {
        lo = lo.min(points[i as usize]);
        hi = hi.max(points[i as usize]);
    }
    let extent = hi - lo;
    let widest = if extent.x >= extent.y && extent.x >= extent.z {
        0
    } else if extent.y >= extent.z {
        1
    } else {
        2
    };
    let middle = order.len() / 2;
    order.select_nth_unstable_by(middle, |&a, &b| {
        points[a as usize][widest].total_cmp(&points[b as usize][widest])
    });
    axis[middle] = widest as u8;
    let (left, right) = order.split_at_mut(middle);
    let (axis_left, axis_right) = axis.split_at_mut(middle);
    split(points, left, axis_left);
    split(points, &mut right[1..], &mut axis_right[1..]);
}

struct Search<'a> {
    index: &'a DirectionIndex,
    to: DVec3,
    k: usize,
    limit: f64,
    found: &'a mut Vec<(usize, f64)>,
}

impl Search<'_> {
    fn offer(&mut self, i: u32) {
        let d2 = self.index.points[i as usize].distance_squared(self.to);
        if d2 > self.limit {
            return;
        }
        let at = self.found.partition_point(|&(_, other)| other <= d2);
        self.found.insert(at, (i as usize, d2));
        if self.found.len() > self.k {
            self.found.pop();
        }
        if self.found.len() == self.k {
            self.limit = self.limit.min(self.found[self.k - 1].1);
        }
    }

    fn descend(&mut self, start: usize, end: usize) {
        if end - start <= LEAF {
            for at in start..end {
                self.offer(self.index.order[at]);
            }
            return;
        }
        let middle = start + (end - start) / 2;
        let i = self.index.order[middle];
        let axis = self.index.axis[middle] as usize;
        let across = self.to[axis] - self.index.points[i as usize][axis];
        let (near, far) = if across < 0.0 {
            ((start, middle), (middle + 1, end))
        } else {
            ((middle + 1, end), (start, middle))
        };
        self.descend(near.0, near.1);
        self.offer(i);
        if across * across <= self.limit {
            self.descend(far.0, far.1);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use gonio_geom::Direction;

    fn spiral(n: usize) -> Vec<DVec3> {
        let golden = std::f64::consts::PI * (3.0 - 5.0_f64.sqrt());
        (0..n)
            .map(|i| {
                let z = 1.0 - 2.0 * (i as f64 + 0.5) / n as f64;
                Direction::from_spherical(z.acos(), golden * i as f64).vec()
            })
            .collect()
    }

    #[test]
    fn the_nearest_directions_are_those_of_an_exhaustive_search() {
        let points = spiral(3000);
        let index = DirectionIndex::new(points.clone());
        for (t, p) in [
            (3.0_f64, 10.0_f64),
            (47.0, 200.0),
            (89.9, 359.0),
            (133.0, 77.0),
            (180.0, 0.0),
        ] {
            let to = Direction::from_degrees(t, p).vec();
            let mut all: Vec<usize> = (0..points.len()).collect();
            all.sort_by(|&a, &b| points[a].distance(to).total_cmp(&points[b].distance(to)));
            let found: Vec<usize> = index.nearest_k(to, 7, 1.0).iter().map(|f| f.0).collect();
            assert_eq!(found, all[..7]);
        }
    }

    #[test]
    fn nothing_is_found_further_away_than_asked() {
        let index = DirectionIndex::new(vec![Direction::NORMAL.vec()]);
        let to = Direction::from_degrees(2.0, 0.0).vec();
        assert!(index.nearest(to, 1.9_f64.to_radians()).is_none());
        let (i, angle) = index.nearest(to, 2.1_f64.to_radians()).unwrap();
        assert_eq!(i, 0);
        assert!((angle.to_degrees() - 2.0).abs() < 1e-9);
    }
}
