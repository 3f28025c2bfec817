//! Pairs of triangles in groups: what a whole group of rays passes beside needs not be tried.

use std::ops::Range;

use super::few::Pair;

/// Cost of trying a box, in units of that of a pair.
const BOX: f32 = 0.15;
/// How much likelier one of many rays meets a box than a single one.
const ANY: f32 = 4.0;
/// From this chance on that one of many rays meets it, a pair is not worth a box.
const ALWAYS: f32 = 0.5;
/// What boxes are larger than their triangles, in units of the scene: more than rays and boxes are rounded.
const SLACK: f32 = 1e-5;
/// Rays from farther away, in the same units, are rounded too much for boxes.
const REACH: f32 = 8.0;

/// Some pairs and the box about them.
#[derive(Clone, Debug)]
pub(super) struct Group {
    pub(super) pairs: Range<usize>,
    /// Low and high corner; `None` where rays rarely pass beside.
    pub(super) around: Option<[[f32; 3]; 2]>,
}

/// All triangles of a small scene.
#[derive(Clone, Debug)]
pub(super) struct Few {
    pub(super) pairs: Vec<Pair>,
    pub(super) groups: Vec<Group>,
    /// Largest coordinate from where rays may be tried against boxes.
    pub(super) reach: f32,
}

#[derive(Clone, Copy)]
struct Around([[f32; 3]; 2]);

impl Around {
    const NOTHING: Around = Around([[f32::INFINITY; 3], [f32::NEG_INFINITY; 3]]);

    fn with(mut self, pair: &Pair) -> Self {
        for corner in &pair.corners {
            for (axis, x) in corner.iter().enumerate() {
                self.0[0][axis] = self.0[0][axis].min(*x);
                self.0[1][axis] = self.0[1][axis].max(*x);
            }
        }
        self
    }

    fn of(pairs: &[Pair]) -> Self {
        pairs.iter().fold(Around::NOTHING, Around::with)
    }

    fn area(&self) -> f32 {
        let [x, y, z] = std::array::from_fn(|k| (self.0[1][k] - self.0[0][k]).max(0.0));
        x * y + y * z + z * x
    }
}

impl Few {
    pub(super) fn new(mut pairs: Vec<Pair>) -> Self {
        let whole = Around::of(&pairs);
        let chance = |around: Around| (ANY * around.area() / whole.area().max(f32::MIN_POSITIVE)).min(1.0);
        pairs.sort_by_key(|pair| chance(Around::of(&[*pair])) >= ALWAYS);
        let small = pairs.partition_point(|pair| chance(Around::of(&[*pair])) < ALWAYS);
        let mut groups = Vec::new();
        split(&mut pairs[..small], 0, &chance, &mut groups);
        let extent = whole.0.iter().flatten().fold(0.0_f32, |a, x| a.max(x.abs()));
        let slack = SLACK * extent;
        for group in &mut groups {
            if let Some([low, high]) = &mut group.around {
                for axis in 0..3 {
                    low[axis] -= slack;
                    high[axis] += slack;
                }
            }
        }
        if small < pairs.len() {
            groups.push(Group {
                pairs: small..pairs.len(),
                around: None,
            });
        }
        Few {
            pairs,
            groups,
            reach: REACH * extent,
        }
    }
}

/// Parts pairs where that saves tests, by the places of their boxes along an axis.
fn split(pairs: &mut [Pair], first: usize, chance: &dyn Fn(Around) -> f32, out: &mut Vec<Group>) {
    if pairs.is_empty() {
        return;
    }
    let cost = |pairs: &[Pair]| BOX + chance(Around::of(pairs)) * pairs.len() as f32;
    let middle = |pair: &Pair, axis: usize| {
        let [low, high] = Around::of(&[*pair]).0;
        low[axis] + high[axis]
    };
    let mut best = (cost(pairs), None);
    for axis in 0..3 {
        pairs.sort_by(|a, b| middle(a, axis).total_cmp(&middle(b, axis)));
        for at in 1..pairs.len() {
            let parts = cost(&pairs[..at]) + cost(&pairs[at..]);
            if parts < best.0 {
                best = (parts, Some((axis, at)));
            }
        }
    }
    let Some((axis, at)) = best.1 else {
        out.push(Group {
            pairs: first..first + pairs.len(),
            around: Some(Around::of(pairs).0),
        });
        return;
    };
    pairs.sort_by(|a, b| middle(a, axis).total_cmp(&middle(b, axis)));
    let (low, high) = pairs.split_at_mut(at);
    split(low, first, chance, out);
    split(high, first + at, chance, out);
}

#[cfg(test)]
mod tests {
    use super::*;

    fn square(x: f32, z: f32, size: f32) -> Pair {
        Pair {
            corners: [[x, 0.0, z], [x + size, 0.0, z], [x + size, size, z], [x, size, z]],
            triangles: [0, 1],
        }
    }

    #[test]
    fn what_lies_apart_is_grouped_apart_and_walls_are_always_tried() {
        let mut pairs = vec![square(0.0, 0.0, 10.0), square(0.0, 10.0, 10.0)];
        for k in 0..6 {
            pairs.push(square(1.0, 3.0 + 0.01 * k as f32, 0.2));
            pairs.push(square(8.0, 3.0 + 0.01 * k as f32, 0.2));
        }
        let few = Few::new(pairs);
        let sizes: Vec<usize> = few.groups.iter().map(|g| g.pairs.len()).collect();
        assert_eq!(sizes, [6, 6, 2]);
        assert!(few.groups[2].around.is_none());
        for group in &few.groups[..2] {
            let [low, high] = group.around.unwrap();
            for corner in few.pairs[group.pairs.clone()].iter().flat_map(|p| p.corners) {
                assert!((0..3).all(|k| low[k] < corner[k] && corner[k] < high[k]));
            }
        }
    }
}
