//! The square of direction cosines for many directions at once: branch-free, so that loops over columns vectorise.
//!
//! The same map as `gonio_geom::disk`, right to 3e-13.

use std::f64::consts::FRAC_PI_4;

use super::lookup::BELOW_HALF;

/// `atan(t) / t * 4 / pi` in powers of `t^2`, `t` in `[-1, 1]`: Chebyshev fit, relative error 2.5e-13.
const ARCTANGENT: [f64; 15] = [
    1.273_239_544_734_844_8,
    -0.424_413_181_431_427_26,
    0.254_647_897_629_799_17,
    -0.181_891_017_605_436_36,
    0.141_465_483_054_906_33,
    -0.115_694_377_312_856_1,
    0.097_587_184_916_322,
    -0.083_279_506_681_939_81,
    0.069_636_316_043_916_08,
    -0.054_128_526_914_925_07,
    0.036_460_663_293_336_81,
    -0.019_631_517_292_795_924,
    0.007_686_314_119_717_206,
    -0.001_908_090_372_008_265_6,
    0.000_222_813_818_917_924_88,
];

/// Bits of a fixed-point coordinate.
pub(crate) const BITS: u32 = 31;

/// A coordinate in `[0, 1]` as a whole number of `2^-31`; anything outside counts as the edge, NaN as 0.
#[inline(always)]
pub(crate) fn fixed(x: f64) -> u32 {
    const SCALE: f64 = (1_u64 << BITS) as f64;
    // 2^52 in the sum leaves whole numbers in the low bits; the half makes rounding a floor. Ties are whole
    // coordinates and go to the even neighbour, which is the cell they begin.
    const WHOLE: f64 = 4_503_599_627_370_496.0;
    // A clamp would keep NaN.
    #[expect(clippy::manual_clamp)]
    let inside = (x * SCALE - 0.5).max(0.0).min(SCALE - 1.0);
    (inside + WHOLE).to_bits() as u32
}

/// [`gonio_geom::disk::disk_to_square`].
#[inline(always)]
pub(crate) fn square(x: f64, y: f64) -> (f64, f64) {
    let (ax, ay) = (x.abs(), y.abs());
    let (large, small) = if ax > ay { (ax, ay) } else { (ay, ax) };
    let t = if large > 0.0 { small / large } else { 0.0 };
    let t2 = t * t;
    let mut sum = 0.0;
    for c in ARCTANGENT.iter().rev() {
        sum = sum * t2 + c;
    }
    let r = (x * x + y * y).sqrt();
    let m = r * t * sum;
    let (a, b) = if ax > ay { (r, m) } else { (m, r) };
    (0.5 + 0.5 * a.copysign(x), 0.5 + 0.5 * b.copysign(y))
}

/// [`gonio_geom::disk::square_to_disk`].
#[inline(always)]
pub(crate) fn disk(u: f64, v: f64) -> (f64, f64) {
    let (a, b) = (2.0 * u - 1.0, 2.0 * v - 1.0);
    let swap = a.abs() > b.abs();
    let (large, small) = if swap { (a, b) } else { (b, a) };
    let t = if large == 0.0 {
        0.0
    } else {
        FRAC_PI_4 * small / large
    };
    // Taylor series to t^15 and t^16, both below 5e-17 at pi/4.
    let t2 = t * t;
    let (mut sin, mut cos) = (0.0, 0.0);
    for k in (1..=15).rev().step_by(2) {
        let k = f64::from(k);
        sin = (1.0 - sin * t2) / (k * (k - 1.0).max(1.0));
    }
    for k in (2..=16).rev().step_by(2) {
        let k = f64::from(k);
        cos = (1.0 - cos * t2) / (k * (k - 1.0));
    }
    let (s, c) = (sin * t, 1.0 - cos * t2);
    if swap {
        (large * c, large * s)
    } else {
        (large * s, large * c)
    }
}

/// Cosine and sine of the azimuth of the mirror direction of `(x, y, z)`.
#[inline(always)]
pub(crate) fn mirror_azimuth(x: f64, y: f64) -> (f64, f64) {
    let r = (x * x + y * y).sqrt();
    if r > 0.0 { (-x / r, -y / r) } else { (-1.0, 0.0) }
}

/// The incident coordinate of a tree of rank 3.
#[inline(always)]
pub(crate) fn isotropic_incidence(x: f64, y: f64) -> f64 {
    (0.5 - BELOW_HALF - 0.5 * (x * x + y * y).sqrt()).max(0.0)
}
