//! Directions and widths of lobes, as a file codes them.

use std::f64::consts::PI;

use gonio_geom::DVec3;
use gonio_geom::disk::{disk_to_square, square_to_disk};

/// Codes of a half turn.
const CODES: f64 = 65_536.0;

/// Cells of equal solid angle over a hemisphere: the square of Shirley and Chiu on the disk of equal areas
/// \[ShirleyChiu1997\].
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Grid {
    /// Cells along a side.
    pub(super) cells: u16,
    /// Sign of `z` of the hemisphere.
    pub(super) sign: f64,
}

impl Grid {
    /// The middle of a cell.
    pub(super) fn direction(self, x: u16, y: u16) -> DVec3 {
        let n = f64::from(self.cells);
        let (u, v) = square_to_disk((f64::from(x) + 0.5) / n, (f64::from(y) + 0.5) / n);
        let r2 = (u * u + v * v).min(1.0);
        let scale = (2.0 - r2).sqrt();
        DVec3::new(u * scale, v * scale, self.sign * (1.0 - r2))
    }

    /// The middle of the cell of a direction on the hemisphere: the lobes of RADIANCE lie there alone, moved ones too.
    pub(super) fn centred(self, d: DVec3) -> DVec3 {
        let norm = 1.0 / (1.0 + d.z.abs()).sqrt();
        let (u, v) = disk_to_square(d.x * norm, d.y * norm);
        let n = f64::from(self.cells);
        let cell = |x: f64| ((x * n).max(0.0) as u32).min(u32::from(self.cells) - 1) as u16;
        self.direction(cell(u), cell(v))
    }
}

/// Radians of a coded width.
pub(super) fn radius(code: u16) -> f64 {
    (f64::from(code) + 0.5) * PI / CODES
}

/// Radians as a file would keep them.
pub(super) fn coded(radius_: f64) -> f64 {
    radius((radius_ * CODES / PI).clamp(0.0, CODES - 1.0) as u16)
}

/// The direction a share `t` of the way from `a` to `b` on their great circle; `a` where they coincide or are opposite.
pub(super) fn between(a: DVec3, b: DVec3, t: f64) -> DVec3 {
    let angle = a.dot(b).clamp(-1.0, 1.0).acos();
    let sin = angle.sin();
    if sin < 1e-9 {
        return a;
    }
    (((1.0 - t) * angle).sin() / sin * a + (t * angle).sin() / sin * b).normalize()
}

/// The moderated cosine that a DSF is divided by to make it a BSDF.
pub(super) fn moderated(cos: f64) -> f64 {
    0.98 * cos.abs() + 0.02
}
