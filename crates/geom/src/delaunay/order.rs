//! Insertion order of the triangulation: a biased randomised insertion order [Amenta2003] along a Hilbert curve.
//!
//! Rounds of growing size keep the expected number of flips linear for any arrangement of the points (concentric
//! rings in path order make a pure sweep quadratic); the curve inside a round keeps the walk to the next point short.

/// Bits of one Hilbert coordinate.
const BITS: u32 = 14;
/// Each round holds about seven eighths of the points that the later rounds do not hold.
const ROUND_BITS: u32 = 3;
const LAST_ROUND: u32 = 7;

/// Indices of `xy` in the order of insertion. Deterministic.
pub(crate) fn insertion_order(xy: &[[f64; 2]]) -> Vec<u32> {
    let mut low = [f64::INFINITY; 2];
    let mut high = [f64::NEG_INFINITY; 2];
    for p in xy {
        for k in 0..2 {
            low[k] = low[k].min(p[k]);
            high[k] = high[k].max(p[k]);
        }
    }
    let width = (high[0] - low[0]).max(high[1] - low[1]);
    let cells = f64::from(1u32 << BITS);
    let scale = if width > 0.0 {
        cells * (1.0 - f64::EPSILON) / width
    } else {
        0.0
    };
    let mut keys: Vec<u64> = xy
        .iter()
        .enumerate()
        .map(|(i, p)| {
            let max = (1u32 << BITS) - 1;
            let x = (((p[0] - low[0]) * scale) as u32).min(max);
            let y = (((p[1] - low[1]) * scale) as u32).min(max);
            let key = (round(i as u64) << (2 * BITS)) | hilbert(x, y);
            (u64::from(key) << 32) | i as u64
        })
        .collect();
    keys.sort_unstable();
    keys.iter().map(|&k| k as u32).collect()
}

/// Round of insertion of point `i`, `0..=LAST_ROUND`, from a mixed hash of the index (SplitMix64 finaliser).
fn round(i: u64) -> u32 {
    let mut z = i.wrapping_add(0x9e37_79b9_7f4a_7c15);
    z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    z ^= z >> 31;
    LAST_ROUND - (z.leading_zeros() / ROUND_BITS).min(LAST_ROUND)
}

/// Position of cell `(x, y)` along the Hilbert curve of `2^BITS` cells a side.
fn hilbert(mut x: u32, mut y: u32) -> u32 {
    let mut d = 0;
    let mut s = 1u32 << (BITS - 1);
    while s > 0 {
        let rx = u32::from(x & s > 0);
        let ry = u32::from(y & s > 0);
        d += s * s * ((3 * rx) ^ ry);
        if ry == 0 {
            if rx == 1 {
                x = (s.wrapping_mul(2) - 1) & !x;
                y = (s.wrapping_mul(2) - 1) & !y;
            }
            std::mem::swap(&mut x, &mut y);
        }
        x &= s.wrapping_sub(1);
        y &= s.wrapping_sub(1);
        s >>= 1;
    }
    d
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn successive_cells_of_the_hilbert_curve_are_neighbours() {
        let mut at = vec![(0u32, 0u32); 4096];
        for x in 0..64 {
            for y in 0..64 {
                let d = hilbert(x, y) as usize;
                assert!(d < 4096, "the first 64 x 64 cells come first");
                at[d] = (x, y);
            }
        }
        for w in at.windows(2) {
            assert_eq!(w[0].0.abs_diff(w[1].0) + w[0].1.abs_diff(w[1].1), 1);
        }
    }

    #[test]
    fn every_point_is_inserted_once() {
        let xy: Vec<[f64; 2]> = (0..1000)
            .map(|i| [f64::from(i).sin(), f64::from(i).cos()])
            .collect();
        let mut order = insertion_order(&xy);
        order.sort_unstable();
        assert!(order.iter().enumerate().all(|(i, &o)| i as u32 == o));
    }
}
