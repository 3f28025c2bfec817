//! Noise on the integer lattice: Perlin's improved one, which is 0 at lattice points and has slopes there, and the fractal one of
//! RADIANCE, as its release 6 has it [Radiance, rt/noise3.c].

/// A number in (-1, 1] from an integer.
fn hashed(seed: i64) -> f64 {
    let s = (seed << 13) ^ seed;
    let mixed = s
        .wrapping_mul(s.wrapping_mul(s).wrapping_mul(15731).wrapping_add(789_221))
        .wrapping_add(1_376_312_589);
    1.0 - (mixed & 0x7fff_ffff) as f64 / 1_073_741_824.0
}

/// A number from a lattice point.
fn lattice(point: [i64; 3]) -> f64 {
    let seed = (0..3).fold(0i64, |sum, k| {
        sum.wrapping_add([17_i64, 23, 29][k].wrapping_mul(point[k]))
    });
    hashed(seed)
}

/// Hermite interpolation between values `p0`, `p1` with slopes `r0`, `r1`.
pub(super) fn hermite(p0: f64, p1: f64, r0: f64, r1: f64, t: f64) -> f64 {
    p0 * ((2.0 * t - 3.0) * t * t + 1.0)
        + p1 * (3.0 - 2.0 * t) * t * t
        + r0 * ((t - 2.0) * t + 1.0) * t
        + r1 * (t - 1.0) * t * t
}

/// Perlin's noise [Perlin2002] at a point and its slopes along x, y and z, each over the last [`STEP`] as RADIANCE takes them:
/// `[x, y, z, value]`.
pub(super) fn noise3(p: [f64; 3]) -> [f64; 4] {
    let value = perlin(p);
    let slope = |axis: usize| {
        let mut before = p;
        before[axis] -= STEP;
        (value - perlin(before)) / STEP
    };
    [slope(0), slope(1), slope(2), value]
}

/// The value alone.
pub(super) fn perlin(p: [f64; 3]) -> f64 {
    let base = p.map(f64::floor);
    let within: [f64; 3] = std::array::from_fn(|k| p[k] - base[k]);
    let cell = base.map(|x| x.rem_euclid(256.0) as usize);
    // The corner of three bits: bit 0 is x, bit 1 y, bit 2 z.
    let mut corners: [f64; 8] = std::array::from_fn(|j| {
        let step = |k: usize| j >> k & 1;
        let hash = (0..3).fold(0, |hash, k| shuffled(hash + cell[k] + step(k)));
        slanted(hash, std::array::from_fn(|k| within[k] - step(k) as f64))
    });
    for (axis, t) in within.into_iter().enumerate() {
        let eased = t * t * t * (t * (t * 6.0 - 15.0) + 10.0);
        for pair in 0..4 >> axis {
            let (low, high) = (corners[2 * pair], corners[2 * pair + 1]);
            corners[pair] = low + eased * (high - low);
        }
    }
    corners[0]
}

/// A slope in one of the twelve directions from the middle of a cube to its edges, at a place.
fn slanted(hash: usize, [x, y, z]: [f64; 3]) -> f64 {
    let h = hash & 15;
    let u = if h < 8 { x } else { y };
    let v = match h {
        0..=3 => y,
        12 | 14 => x,
        _ => z,
    };
    (if h & 1 == 0 { u } else { -u }) + (if h & 2 == 0 { v } else { -v })
}

fn shuffled(k: usize) -> usize {
    usize::from(SHUFFLED[k & 255])
}

/// The numbers from 0 to 255 in the order of [Perlin2002].
#[rustfmt::skip]
const SHUFFLED: [u8; 256] = [
    151, 160, 137, 91, 90, 15, 131, 13, 201, 95, 96, 53, 194, 233, 7, 225, 140, 36, 103, 30, 69, 142, 8, 99,
    37, 240, 21, 10, 23, 190, 6, 148, 247, 120, 234, 75, 0, 26, 197, 62, 94, 252, 219, 203, 117, 35, 11, 32,
    57, 177, 33, 88, 237, 149, 56, 87, 174, 20, 125, 136, 171, 168, 68, 175, 74, 165, 71, 134, 139, 48, 27, 166,
    77, 146, 158, 231, 83, 111, 229, 122, 60, 211, 133, 230, 220, 105, 92, 41, 55, 46, 245, 40, 244, 102, 143, 54,
    65, 25, 63, 161, 1, 216, 80, 73, 209, 76, 132, 187, 208, 89, 18, 169, 200, 196, 135, 130, 116, 188, 159, 86,
    164, 100, 109, 198, 173, 186, 3, 64, 52, 217, 226, 250, 124, 123, 5, 202, 38, 147, 118, 126, 255, 82, 85, 212,
    207, 206, 59, 227, 47, 16, 58, 17, 182, 189, 28, 42, 223, 183, 170, 213, 119, 248, 152, 2, 44, 154, 163, 70,
    221, 153, 101, 155, 167, 43, 172, 9, 129, 22, 39, 253, 19, 98, 108, 110, 79, 113, 224, 232, 178, 185, 112, 104,
    218, 246, 97, 228, 251, 34, 242, 193, 238, 210, 144, 12, 191, 179, 162, 241, 81, 51, 145, 235, 249, 14, 239, 107,
    49, 192, 214, 31, 181, 199, 106, 157, 184, 84, 204, 176, 115, 121, 50, 45, 127, 4, 150, 254, 138, 236, 205, 93,
    222, 114, 67, 29, 24, 72, 243, 141, 128, 195, 78, 66, 215, 61, 156, 180,
];

/// How finely the fractal resolves, and over which length slopes are taken.
const STEP: f64 = 0.0005;

/// Steps of the fractal within one lattice cell: what it resolves.
const FINEST: i64 = 2000;

/// Fractal noise: cells are halved about the point, and each new corner gets the mean of its neighbours and a random part
/// in proportion to the cell's size.
pub(super) fn fnoise3(p: [f64; 3]) -> f64 {
    let mut size = FINEST;
    let target = p.map(|x| (size as f64 * x) as i64);
    let mut base = p.map(|x| size.wrapping_mul(x.floor() as i64));
    let mut corners: [f64; 8] = std::array::from_fn(|j| {
        lattice(std::array::from_fn(|k| {
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
        corners[!branch & 7] = mean + part * lattice(middle);
        for k in 0..3 {
            let mut v = middle;
            v[k] = v[k].wrapping_add(toward(k));
            let near = (0..8)
                .filter(|j| (j ^ branch) >> k & 1 == 0)
                .map(|j| corners[j])
                .sum::<f64>();
            corners[!(branch ^ (1 << k)) & 7] = 0.25 * near + part * lattice(v);
        }
        for k in 0..3 {
            let mut v = middle;
            for other in [(k + 1) % 3, (k + 2) % 3] {
                v[other] = v[other].wrapping_add(toward(other));
            }
            let near = corners[branch & !(1 << k)] + corners[branch | 1 << k];
            corners[branch ^ (1 << k)] = 0.5 * near + part * lattice(v);
        }
        for (k, b) in base.iter_mut().enumerate() {
            if branch >> k & 1 == 1 {
                *b = b.wrapping_add(size);
            }
        }
    }
}
