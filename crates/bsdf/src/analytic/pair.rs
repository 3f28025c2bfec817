//! Pairs of directions as formulas and loops take them.

use gonio_geom::{DVec3, Direction};
use multiversion::multiversion;

use super::{Fast, Real};

/// Two directions in the frame of a formula: `wi.z > 0`, whichever side the light arrives on.
#[derive(Clone, Copy, Debug)]
pub struct Pair<R> {
    /// Direction to the source.
    pub wi: [R; 3],
    /// Direction to the receiver; `z > 0` for reflection, `z < 0` for transmission.
    pub ws: [R; 3],
}

impl<R: Real> Pair<R> {
    /// `wi + ws`, not normalised.
    #[inline(always)]
    pub fn sum(&self) -> [R; 3] {
        [
            self.wi[0] + self.ws[0],
            self.wi[1] + self.ws[1],
            self.wi[2] + self.ws[2],
        ]
    }

    /// `wi . ws`.
    #[inline(always)]
    pub fn dot(&self) -> R {
        self.wi[0] * self.ws[0] + self.wi[1] * self.ws[1] + self.wi[2] * self.ws[2]
    }

    /// `|cos theta_i|` and `|cos theta_s|`.
    #[inline(always)]
    pub fn cosines(&self) -> (R, R) {
        (self.wi[2], self.ws[2].abs())
    }

    /// The two directions swapped (the sides of a transmission with them).
    #[inline(always)]
    pub fn swapped(&self) -> Self {
        let side = R::select(self.ws[2].plain(), R::constant(1.0), R::constant(-1.0));
        let turn = |v: [R; 3]| [v[0], v[1], v[2] * side];
        Pair {
            wi: turn(self.ws),
            ws: turn(self.wi),
        }
    }
}

impl Pair<f64> {
    /// The pair of `wi` and `ws`, both mirrored in the sample plane when `wi` is on the back.
    #[inline(always)]
    pub fn new(wi: Direction, ws: Direction) -> Self {
        let side = if wi.cos_theta() < 0.0 { -1.0 } else { 1.0 };
        let (i, s) = (wi.vec(), ws.vec());
        Pair {
            wi: [i.x, i.y, i.z * side],
            ws: [s.x, s.y, s.z * side],
        }
    }
}

/// Many pairs with one direction of incidence: columns of scattered directions.
#[derive(Clone, Debug, PartialEq)]
pub struct Pairs {
    /// In the frame of a formula: `z` is not negative.
    wi: [f64; 3],
    back: bool,
    ws: [Vec<f64>; 3],
}

impl Pairs {
    /// No pair, with room for `n`.
    pub fn with_capacity(wi: Direction, n: usize) -> Self {
        let v = wi.vec();
        Pairs {
            wi: [v.x, v.y, v.z.abs()],
            back: v.z < 0.0,
            ws: std::array::from_fn(|_| Vec::with_capacity(n)),
        }
    }

    /// The pairs of `wi` with the directions of polar angles `theta_s` and azimuths `phi_s` (radians; as many of one as
    /// of the other, or it panics). Angles that are no numbers, or beyond 1e5, give NaN.
    pub fn from_spherical(wi: Direction, theta_s: &[f64], phi_s: &[f64]) -> Self {
        assert_eq!(theta_s.len(), phi_s.len(), "one azimuth a polar angle");
        let n = theta_s.len();
        let mut pairs = Pairs::with_capacity(wi, 0);
        pairs.ws = std::array::from_fn(|_| vec![0.0; n]);
        let [x, y, z] = &mut pairs.ws;
        to_vectors(theta_s, phi_s, if pairs.back { -1.0 } else { 1.0 }, [x, y, z]);
        pairs
    }

    /// Adds the pair with `ws`.
    pub fn push(&mut self, ws: Direction) {
        let v = ws.vec();
        let z = if self.back { -v.z } else { v.z };
        for (column, v) in self.ws.iter_mut().zip([v.x, v.y, z]) {
            column.push(v);
        }
    }

    /// The pairs at `positions` (panics past the end, as slices do).
    pub fn subset(&self, positions: &[u32]) -> Self {
        Pairs {
            wi: self.wi,
            back: self.back,
            ws: self
                .ws
                .each_ref()
                .map(|column| positions.iter().map(|&j| column[j as usize]).collect()),
        }
    }

    /// Number of pairs.
    pub fn len(&self) -> usize {
        self.ws[0].len()
    }

    /// Whether there is none.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// The direction of incidence.
    pub fn wi(&self) -> Direction {
        self.turned(self.wi)
    }

    /// The scattered direction of pair `j`.
    #[inline]
    pub fn ws(&self, j: usize) -> Direction {
        self.turned([self.ws[0][j], self.ws[1][j], self.ws[2][j]])
    }

    #[inline]
    fn turned(&self, [x, y, z]: [f64; 3]) -> Direction {
        Direction::from_unit(DVec3::new(x, y, if self.back { -z } else { z }))
    }

    /// The pairs in `range` (panics past the end, as slices do).
    pub fn view(&self, range: std::ops::Range<usize>) -> PairsView<'_> {
        PairsView {
            wi: self.wi,
            back: self.back,
            ws: self.ws.each_ref().map(|column| &column[range.clone()]),
        }
    }
}

/// Unit vectors of spherical coordinates, `z` times `side`.
#[multiversion(targets("x86_64+avx512f+avx512dq+avx512vl+avx512bw+fma", "x86_64+avx2+fma+bmi2"))]
fn to_vectors(theta: &[f64], phi: &[f64], side: f64, [x, y, z]: [&mut [f64]; 3]) {
    // Beyond, the reduction by multiples of pi/2 is no longer exact.
    const MOST: f64 = 1e5;
    let n = theta.len();
    let (phi, x, y, z) = (&phi[..n], &mut x[..n], &mut y[..n], &mut z[..n]);
    for j in 0..n {
        let (sin, cos) = Fast(theta[j]).sin_cos();
        let (sin_phi, cos_phi) = Fast(phi[j]).sin_cos();
        let known = (theta[j].abs() <= MOST) & (phi[j].abs() <= MOST);
        x[j] = if known { (sin * cos_phi).0 } else { f64::NAN };
        y[j] = if known { (sin * sin_phi).0 } else { f64::NAN };
        z[j] = if known { cos.0 * side } else { f64::NAN };
    }
}

/// Some of the pairs.
#[derive(Clone, Copy, Debug)]
pub struct PairsView<'a> {
    pub(super) wi: [f64; 3],
    /// Whether light came from the back.
    pub(super) back: bool,
    pub(super) ws: [&'a [f64]; 3],
}

impl PairsView<'_> {
    /// The direction of incidence in the frame of a formula: light comes from `z >= 0`.
    pub fn incidence(&self) -> [f64; 3] {
        self.wi
    }

    /// Components of the scattered directions in the frame of a formula: `z > 0` reflection, `z < 0` transmission.
    pub fn scattered(&self) -> [&[f64]; 3] {
        self.ws
    }

    /// Number of pairs.
    pub fn len(&self) -> usize {
        self.ws[0].len()
    }

    /// Whether there is none.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn columns_hold_the_directions_of_the_angles() {
        let theta: Vec<f64> = (0..300).map(|k| 0.0105 * f64::from(k)).collect();
        let phi: Vec<f64> = (0..300).map(|k| -40.0 + 0.37 * f64::from(k)).collect();
        for wi in [
            Direction::from_degrees(20.0, 30.0),
            Direction::from_degrees(160.0, 30.0),
        ] {
            let pairs = Pairs::from_spherical(wi, &theta, &phi);
            let mut pushed = Pairs::with_capacity(wi, 300);
            for (j, (t, p)) in theta.iter().zip(&phi).enumerate() {
                let want = Direction::from_spherical(*t, *p);
                pushed.push(want);
                assert!((pairs.ws(j).vec() - want.vec()).length() < 4e-16, "{j}");
                assert_eq!(pushed.ws(j), want);
            }
            assert_eq!(pairs.wi(), wi);
            assert_eq!(pairs.subset(&[7, 3]).ws(1), pairs.ws(3));
        }
    }

    #[test]
    fn angles_that_are_none_give_nan() {
        let wi = Direction::NORMAL;
        let pairs = Pairs::from_spherical(wi, &[f64::NAN, 0.1, 0.1], &[0.0, f64::INFINITY, 1e300]);
        let view = pairs.view(0..3);
        assert!(view.ws.iter().all(|c| c.iter().all(|v| v.is_nan())));
    }
}
