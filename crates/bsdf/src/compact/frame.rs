//! The coordinates of a compact table: incidence, and the half vector in units of a lobe's width.

use gonio_geom::{DVec3, Direction};

use crate::BsdfError;
use crate::analytic::Real;

use super::domain;
use super::symmetry::{Axis, Symmetry};

/// Growth of the incidence axis towards grazing: `x = s (1 + GRAZING s^2) / (1 + GRAZING)`, `s^2 = 1 - cos(theta_i)`.
const GRAZING: f64 = 0.5;
/// Keeps quotients finite where a vector has no direction.
const TINY: f64 = 1e-30;

/// The coordinates `(x, p_i, u, p_h)` of pairs of directions on the side of incidence, and the nodes along them. For
/// transmission the scattered direction is mirrored in the sample plane first.
///
/// `x` grows with the polar angle of incidence ([`Frame::theta_i`] inverts it), `u` with the distance `R` of the half
/// vector from the normal in units of the widths, `u = asinh(R) / asinh(1 / least width)`: even within a lobe,
/// logarithmic beyond it. `p_i` and `p_h` are the azimuths of incidence and of the scaled half vector as diamond angles,
/// `p = 1 - x / (|x| + |y|)` over the upper half turn: 0 at 0, 1 at 90, 2 at 180 degrees. Isotropic tables count the
/// latter from the plane of incidence, others from `phi_x`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Frame {
    /// What is taken for granted about azimuth.
    pub symmetry: Symmetry,
    /// Widths of the half vector along `phi_x` and across it; equal for isotropic tables.
    pub width: [f64; 2],
    /// Azimuth that the others count from, radians; 0 for isotropic tables.
    pub phi_x: f64,
    /// Nodes along `x`, `p_i`, `u` and `p_h`.
    pub shape: [usize; 4],
}

impl Frame {
    /// Most nodes along an axis.
    pub const MOST: usize = 4096;

    /// The frame, when everything is in its range: widths of 1e-4 to 1, 2 to [`Frame::MOST`] nodes along an axis (4 of a
    /// whole turn, one of the incidence's azimuth for isotropic tables).
    ///
    /// # Errors
    /// [`BsdfError::Domain`] for anything else.
    pub fn check(&self) -> Result<(), BsdfError> {
        if let Some(width) = self.width.iter().find(|w| !(1e-4..=1.0).contains(*w)) {
            return Err(domain("width", width.to_string(), "0.0001 to 1"));
        }
        if !(self.phi_x.is_finite() && self.phi_x.abs() <= 7.0) {
            return Err(domain("phi_x", self.phi_x.to_string(), "-7 to 7 radians"));
        }
        if self.symmetry.is_isotropic() && (self.width[0] != self.width[1] || self.phi_x != 0.0) {
            let found = format!("widths {:?}, phi_x {}", self.width, self.phi_x);
            return Err(domain(
                "width",
                found,
                "one width and phi_x 0 for an isotropic table",
            ));
        }
        for (k, n) in self.shape.into_iter().enumerate() {
            let (least, most) = match self.axis(k) {
                Axis::Single => (1, 1),
                axis => (axis.least(), Self::MOST),
            };
            if !(least..=most).contains(&n) {
                let found = format!("{n} nodes along axis {k} of {}", self.symmetry.name());
                return Err(domain("shape", found, format!("{least} to {most}")));
            }
        }
        if self.shape.iter().product::<usize>() > 1 << 28 {
            return Err(domain("shape", format!("{:?}", self.shape), "at most 2^28 nodes"));
        }
        Ok(())
    }

    /// Number of nodes.
    pub fn len(&self) -> usize {
        self.shape.iter().product()
    }

    /// Whether there are none; never of a frame that [`Frame::check`] accepts.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    pub(super) fn axis(&self, k: usize) -> Axis {
        match k {
            1 => self.symmetry.phi_i(),
            3 => self.symmetry.phi_h(),
            _ => Axis::Ends(1.0),
        }
    }

    /// Whether the first node along axis `k` follows the last.
    pub fn is_round(&self, k: usize) -> bool {
        self.axis(k) == Axis::Round
    }

    /// Nodes per unit of each coordinate; 0 along an axis of one node.
    pub fn density(&self) -> [f64; 4] {
        [0, 1, 2, 3].map(|k| self.axis(k).density(self.shape[k]))
    }

    /// Largest `asinh(R)`.
    pub(super) fn reach(&self) -> f64 {
        (1.0 / self.width[0].min(self.width[1])).asinh()
    }

    /// What finds coordinates fast.
    pub(super) fn chart(&self) -> Chart {
        let (sin, cos) = self.phi_x.sin_cos();
        Chart {
            cos,
            sin,
            per_width: self.width.map(|w| 1.0 / w),
            per_reach: 1.0 / self.reach(),
        }
    }

    /// Coordinates `(x, p_i, u, p_h)` of a pair, both directions as vectors with `z >= 0`.
    pub fn coordinates(&self, wi: [f64; 3], ws: [f64; 3]) -> [f64; 4] {
        let chart = self.chart();
        match self.symmetry {
            Symmetry::Isotropic => chart.coordinates::<f64, ISOTROPIC>(wi, ws),
            Symmetry::IsotropicChiral => chart.coordinates::<f64, CHIRAL>(wi, ws),
            Symmetry::Quadrilateral => chart.coordinates::<f64, QUADRILATERAL>(wi, ws),
            Symmetry::Bilateral => chart.coordinates::<f64, BILATERAL>(wi, ws),
            Symmetry::HalfTurn => chart.coordinates::<f64, HALF_TURN>(wi, ws),
            Symmetry::Anisotropic => chart.coordinates::<f64, ANISOTROPIC>(wi, ws),
        }
    }

    /// Cosine of the polar angle of incidence at `x` in `[0, 1]`, by Newton's method.
    pub fn cos_theta_i(x: f64) -> f64 {
        let wanted = x * (1.0 + GRAZING);
        let mut s = x;
        for _ in 0..20 {
            s -= (s * (1.0 + GRAZING * s * s) - wanted) / (1.0 + 3.0 * GRAZING * s * s);
        }
        1.0 - s * s
    }

    /// The pair at coordinates `(x, p_i, u, p_h)`, both directions on the front, and the solid angle of scattered directions
    /// per unit of `(u, p_h)`; `None` where there is no pair: the half vector or the scattered direction lies below the
    /// horizon, or the incidence on it.
    pub fn pair(&self, [x, p_i, u, p_h]: [f64; 4]) -> Option<(Direction, Direction, f64)> {
        let cos = Self::cos_theta_i(x);
        let sin = (1.0 - cos * cos).max(0.0).sqrt();
        let (sin_x, cos_x) = self.phi_x.sin_cos();
        let turned = |[a, b]: [f64; 2]| (a * cos_x - b * sin_x, a * sin_x + b * cos_x);
        let (ax, ay) = turned(if self.symmetry.is_isotropic() {
            [1.0, 0.0]
        } else {
            of_diamond(p_i)
        });
        let wi = DVec3::new(sin * ax, sin * ay, cos);
        let reach = self.reach();
        let [cos_h, sin_h] = of_diamond(p_h);
        let r = (u * reach).sinh();
        let (hx, hy) = turned([r * cos_h * self.width[0], r * sin_h * self.width[1]]);
        let hz = (1.0 - hx * hx - hy * hy).max(0.0).sqrt();
        let h = DVec3::new(hx, hy, hz);
        let along = wi.dot(h);
        let ws = 2.0 * along * h - wi;
        if !(hz > 1e-9 && ws.z > 1e-9 && wi.z > 1e-9) {
            return None;
        }
        let area = self.width[0] * self.width[1] * r * r.hypot(1.0) * reach;
        let turn = (cos_h.abs() + sin_h.abs()).powi(2);
        let solid_angle = 4.0 * along.abs() * area * turn / hz;
        Some((Direction::new(wi)?, Direction::new(ws)?, solid_angle))
    }
}

/// Symmetries as numbers that loops know when they are compiled.
pub(super) const ISOTROPIC: u8 = 0;
pub(super) const CHIRAL: u8 = 1;
pub(super) const QUADRILATERAL: u8 = 2;
pub(super) const BILATERAL: u8 = 3;
pub(super) const ANISOTROPIC: u8 = 4;
pub(super) const HALF_TURN: u8 = 5;

/// The numbers of a [`Frame`] that its coordinates take.
#[derive(Clone, Copy, Debug)]
pub(super) struct Chart {
    cos: f64,
    sin: f64,
    per_width: [f64; 2],
    per_reach: f64,
}

impl Chart {
    /// [`Frame::coordinates`] of a frame whose symmetry is number `KIND`.
    #[inline(always)]
    pub(super) fn coordinates<R: Real<Plain = R>, const KIND: u8>(&self, wi: [R; 3], ws: [R; 3]) -> [R; 4] {
        let one = R::constant(1.0);
        let [mut ix, mut iy, iz] = wi;
        let tilt2 = ix * ix + iy * iy;
        let s2 = tilt2 / (iz + 1.0);
        let x = s2.sqrt() * (s2 * GRAZING + 1.0) * (1.0 / (1.0 + GRAZING));
        let (sx, sy, sz) = (ix + ws[0], iy + ws[1], iz + ws[2]);
        let inverse = (sx * sx + sy * sy + sz * sz + TINY).sqrt().recip();
        let (mut hx, mut hy) = (sx * inverse, sy * inverse);
        let p_i;
        if KIND == ISOTROPIC || KIND == CHIRAL {
            let tilt = tilt2.sqrt();
            let away = tilt + (-1e-9);
            let inverse = (tilt + TINY).recip();
            let (cos, sin) = (
                R::select(away, ix * inverse, one),
                R::select(away, iy * inverse, R::constant(0.0)),
            );
            (hx, hy) = (hx * cos + hy * sin, hy * cos - hx * sin);
            if KIND == ISOTROPIC {
                hy = hy.abs();
            }
            p_i = R::constant(0.0);
        } else {
            (ix, iy) = (ix * self.cos + iy * self.sin, iy * self.cos - ix * self.sin);
            (hx, hy) = (hx * self.cos + hy * self.sin, hy * self.cos - hx * self.sin);
            if KIND == QUADRILATERAL {
                hx = R::select(-ix, -hx, hx);
                ix = ix.abs();
            }
            if KIND == HALF_TURN {
                hx = R::select(-iy, -hx, hx);
                ix = R::select(-iy, -ix, ix);
            }
            if KIND != ANISOTROPIC {
                hy = R::select(-iy, -hy, hy);
                iy = iy.abs();
            }
            p_i = diamond(ix, iy);
        }
        (hx, hy) = (hx * self.per_width[0], hy * self.per_width[1]);
        let r2 = hx * hx + hy * hy;
        let u = (r2.sqrt() + (r2 + 1.0).sqrt()).ln() * self.per_reach;
        [x, p_i, u, diamond(hx, hy)]
    }
}

/// Azimuth of `(x, y)` as a diamond angle in `[0, 4)`; 1 for no direction.
#[inline(always)]
fn diamond<R: Real<Plain = R>>(x: R, y: R) -> R {
    let share = x / (x.abs() + y.abs() + TINY);
    R::select(-y, share + 3.0, -share + 1.0)
}

/// Unit vector of a diamond angle.
fn of_diamond(p: f64) -> [f64; 2] {
    let p = p.rem_euclid(4.0);
    let x = if p <= 2.0 { 1.0 - p } else { p - 3.0 };
    let y = (1.0 - x.abs()) * if p <= 2.0 { 1.0 } else { -1.0 };
    let length = x.hypot(y);
    [x / length, y / length]
}

#[cfg(test)]
#[path = "frame_tests.rs"]
mod tests;
