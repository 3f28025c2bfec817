//! Noise on the integer lattice: Perlin's, by Hermite interpolation of a value and a gradient a lattice point, and the
//! fractal one. The lattice values are those of RADIANCE's program before its release 6 [Radiance]; that one has others, so a
//! noisy pattern has the same character there and not the same grain.

/// A number in (-1, 1] from an integer.
fn hashed(seed: i64) -> f64 {
    let s = (seed << 13) ^ seed;
    let mixed = s
        .wrapping_mul(s.wrapping_mul(s).wrapping_mul(15731).wrapping_add(789_221))
        .wrapping_add(1_376_312_589);
    1.0 - (mixed & 0x7fff_ffff) as f64 / 1_073_741_824.0
}

/// A number from a lattice point, each of the three weights its own.
fn lattice(point: [i64; 3], weights: [i64; 3]) -> f64 {
    let seed = (0..3).fold(0i64, |sum, k| sum.wrapping_add(weights[k].wrapping_mul(point[k])));
    hashed(seed)
}

/// Weights of the gradient's three components and of the value.
const WEIGHTS: [[i64; 3]; 4] = [[67, 59, 71], [73, 79, 83], [89, 97, 101], [103, 107, 109]];

/// Hermite interpolation between values `p0`, `p1` with slopes `r0`, `r1`.
pub(super) fn hermite(p0: f64, p1: f64, r0: f64, r1: f64, t: f64) -> f64 {
    p0 * ((2.0 * t - 3.0) * t * t + 1.0)
        + p1 * (3.0 - 2.0 * t) * t * t
        + r0 * ((t - 2.0) * t + 1.0) * t
        + r1 * (t - 1.0) * t * t
}

/// Perlin's noise: the interpolated gradient's x, y, z and the value.
pub(super) fn noise3(p: [f64; 3]) -> [f64; 4] {
    let base = p.map(|x| x.floor() as i64);
    let mut corners: [[f64; 4]; 8] = std::array::from_fn(|j| {
        let corner = std::array::from_fn(|k| base[k].wrapping_add((j >> k & 1) as i64));
        WEIGHTS.map(|weights| lattice(corner, weights))
    });
    for axis in 0..3 {
        let t = p[axis] - p[axis].floor();
        for pair in 0..4 >> axis {
            let (low, high) = (corners[2 * pair], corners[2 * pair + 1]);
            let mut joined: [f64; 4] = std::array::from_fn(|k| hermite(low[k], high[k], 0.0, 0.0, t));
            joined[3] = hermite(low[3], high[3], low[axis], high[axis], t);
            corners[pair] = joined;
        }
    }
    corners[0]
}

/// Steps of the fractal within one lattice cell: what it resolves.
const FINEST: i64 = 1000;

/// Fractal noise: cells are halved about the point, and each new corner gets the mean of its neighbours and a random part
/// in proportion to the cell's size.
pub(super) fn fnoise3(p: [f64; 3]) -> f64 {
    let mut size = FINEST;
    let target = p.map(|x| (size as f64 * x) as i64);
    let mut base = p.map(|x| size.wrapping_mul(x.floor() as i64));
    let random = |v: [i64; 3]| lattice(v, [17, 23, 29]);
    let mut corners: [f64; 8] = std::array::from_fn(|j| {
        random(std::array::from_fn(|k| {
            base[k].wrapping_add(size * (j >> k & 1) as i64)
        }))
    });
    loop {
        let mean = corners.iter().sum::<f64>() * 0.125;
        size /= 2;
        if size == 0 {
            return mean;
        }
        let part = size as f64 / FINEST as f64;
        let middle = base.map(|b| b.wrapping_add(size));
        let branch = (0..3)
            .filter(|&k| target[k] > middle[k])
            .fold(0usize, |bits, k| bits | 1 << k);
        let toward = |k: usize| if branch >> k & 1 == 1 { size } else { -size };
        // The octant that holds the point keeps its own corner; the middle of the cell is the corner across from it.
        corners[!branch & 7] = mean + part * random(middle);
        for k in 0..3 {
            let mut v = middle;
            v[k] = v[k].wrapping_add(toward(k));
            let near = (0..8)
                .filter(|j| (j ^ branch) >> k & 1 == 0)
                .map(|j| corners[j])
                .sum::<f64>();
            corners[!(branch ^ (1 << k)) & 7] = 0.25 * near + part * random(v);
        }
        for k in 0..3 {
            let mut v = middle;
            for other in [(k + 1) % 3, (k + 2) % 3] {
                v[other] = v[other].wrapping_add(toward(other));
            }
            let near = corners[branch & !(1 << k)] + corners[branch | 1 << k];
            corners[branch ^ (1 << k)] = 0.5 * near + part * random(v);
        }
        for (k, b) in base.iter_mut().enumerate() {
            if branch >> k & 1 == 1 {
                *b = b.wrapping_add(size);
            }
        }
    }
}
