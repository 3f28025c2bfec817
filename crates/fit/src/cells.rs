//! Cells of the outgoing sphere: readings within one share their residuals' correlation.

use gonio_geom::{Component, DVec3, Direction};

/// Rings about the ideal direction; they double in width, so that a narrow peak is divided too. Degrees.
const RINGS: [f64; 7] = [1.0, 2.0, 4.0, 8.0, 16.0, 32.0, 64.0];
/// Sectors of a ring.
const SECTORS: usize = 6;
/// Cells of a hemisphere.
pub(crate) const CELLS: usize = (RINGS.len() + 1) * SECTORS;

/// The ideal direction of `component`: mirror or through.
pub(crate) fn ideal(component: Component, wi: Direction) -> Direction {
    match component {
        Component::Reflection => wi.mirror(),
        Component::Transmission => wi.through(),
    }
}

/// Assigns directions to cells about an ideal direction.
pub(crate) struct Cells {
    ideal: Direction,
    across: DVec3,
    along: DVec3,
}

impl Cells {
    pub(crate) fn new(component: Component, wi: Direction) -> Self {
        let ideal = ideal(component, wi);
        let v = ideal.vec();
        let across = v.cross(DVec3::Z).try_normalize().unwrap_or(DVec3::X);
        Cells {
            ideal,
            across,
            along: v.cross(across),
        }
    }

    /// The cell of `ws`, below [`CELLS`].
    pub(crate) fn cell(&self, ws: Direction) -> u8 {
        let gamma = self.ideal.angle_to(ws).to_degrees();
        let ring = RINGS.iter().take_while(|edge| gamma >= **edge).count();
        let v = ws.vec();
        let turn = v.dot(self.across).atan2(v.dot(self.along)) / std::f64::consts::TAU + 0.5;
        let sector = ((turn * SECTORS as f64) as usize).min(SECTORS - 1);
        (ring * SECTORS + sector) as u8
    }
}
