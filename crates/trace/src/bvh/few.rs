//! Scenes of few triangles: several rays against all of them, instead of a way through a tree.

use super::Triangles;

/// Up to so many triangles, trying all is quicker than a tree: twice as many where sixteen rays are tried at once.
fn most() -> usize {
    #[cfg(target_arch = "x86_64")]
    if is_x86_feature_detected!("avx512f") {
        return 128;
    }
    64
}

/// Two triangles: `a b c`, and `a c d`, which holds nothing where `c` and `d` are one.
#[derive(Clone, Copy, Debug)]
pub(super) struct Pair {
    pub(super) corners: [[f32; 3]; 4],
    /// Their indices.
    pub(super) triangles: [u32; 2],
}

/// All triangles in pairs with a common edge, as far as there are; `None` where they are many.
pub(super) fn pairs(triangles: &Triangles<'_>) -> Option<Vec<Pair>> {
    if triangles.is_empty() || triangles.len() > most() {
        return None;
    }
    let mut open: Vec<usize> = (0..triangles.len()).rev().collect();
    let mut out = Vec::new();
    while let Some(first) = open.pop() {
        let with = open
            .iter()
            .rposition(|second| common(triangles, first, *second).is_some());
        let pair = with.and_then(|at| common(triangles, first, open.remove(at)));
        let [a, b, c] = triangles.corners(first);
        out.push(pair.unwrap_or(Pair {
            corners: [a, b, c, c],
            triangles: [first as u32; 2],
        }));
    }
    Some(out)
}

/// The pair of two triangles with a common edge.
fn common(triangles: &Triangles<'_>, first: usize, second: usize) -> Option<Pair> {
    let (own, other) = (triangles.corners(first), triangles.corners(second));
    (0..3).find_map(|k| {
        let [a, b, c] = [own[k], own[(k + 1) % 3], own[(k + 2) % 3]];
        let far = other.iter().position(|p| *p != a && *p != c)?;
        let shared = other.contains(&a) && other.contains(&c);
        shared.then_some(Pair {
            corners: [a, b, c, other[far]],
            triangles: [first as u32, second as u32],
        })
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_triangles_of_a_box_become_six_pairs_that_hold_their_corners() {
        let vertices: Vec<[f32; 3]> = (0..8)
            .map(|k| [(k & 1) as f32, (k >> 1 & 1) as f32, (k >> 2) as f32])
            .collect();
        let faces = [
            [0, 2, 3, 1],
            [4, 5, 7, 6],
            [0, 1, 5, 4],
            [2, 6, 7, 3],
            [0, 4, 6, 2],
            [1, 3, 7, 5],
        ];
        let indices: Vec<[u32; 3]> = faces
            .iter()
            .flat_map(|[a, b, c, d]| [[*a, *b, *c], [*d, *a, *c]])
            .collect();
        let triangles = Triangles {
            vertices: &vertices,
            indices: &indices,
        };
        let pairs = pairs(&triangles).unwrap();
        assert_eq!(pairs.len(), 6);
        let mut seen = Vec::new();
        for pair in &pairs {
            let [a, b, c, d] = pair.corners;
            for (triangle, held) in pair.triangles.iter().zip([[a, b, c], [a, c, d]]) {
                seen.push(*triangle);
                let own = triangles.corners(*triangle as usize);
                assert!(own.iter().all(|p| held.contains(p)));
            }
        }
        seen.sort_unstable();
        assert_eq!(seen, (0..12).collect::<Vec<u32>>());
    }
}
