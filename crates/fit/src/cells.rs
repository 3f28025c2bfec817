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
    ideal: DVec3,
    across: DVec3,
    along: DVec3,
    /// Cosines of the rings' edges.
    edges: [f64; RINGS.len()],
}

impl Cells {
    pub(crate) fn new(component: Component, wi: Direction) -> Self {
        let v = ideal(component, wi).vec();
        let across = v.cross(DVec3::Z).try_normalize().unwrap_or(DVec3::X);
        Cells {
            ideal: v,
            across,
            along: v.cross(across),
            edges: RINGS.map(|degrees| degrees.to_radians().cos()),
        }
    }

    /// The cell of `ws`, below [`CELLS`].
    pub(crate) fn cell(&self, ws: Direction) -> u8 {
        let v = ws.vec();
        let near = v.dot(self.ideal);
        let ring = self
            .edges
            .iter()
            .map(|edge| usize::from(near <= *edge))
            .sum::<usize>();
        (ring * SECTORS + sector(v.dot(self.along), v.dot(self.across))) as u8
    }
}

/// The sextant of a point, counted from the negative x axis with the azimuth; no call of `atan2` a reading.
fn sector(x: f64, y: f64) -> usize {
    let steep = y.abs() >= 3.0_f64.sqrt() * x.abs();
    match (y >= 0.0, steep, x >= 0.0) {
        (false, true, _) => 1,
        (false, false, false) => 0,
        (false, false, true) => 2,
        (true, false, true) => 3,
        (true, true, _) => 4,
        (true, false, false) => 5,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sextants_follow_the_azimuth() {
        for k in 0..360 {
            let azimuth = (f64::from(k) + 0.5 - 180.0).to_radians();
            assert_eq!(sector(azimuth.cos(), azimuth.sin()), k as usize / 60, "{k}");
        }
        assert_eq!(SECTORS, 6);
    }

    #[test]
    fn rings_double_from_one_degree_about_the_mirror_direction() {
        let wi = Direction::from_degrees(30.0, 50.0);
        let cells = Cells::new(Component::Reflection, wi);
        for (degrees, ring) in [(0.5, 0), (1.5, 1), (3.0, 2), (5.0, 3), (50.0, 6)] {
            let ws = Direction::from_degrees(30.0 + degrees, 230.0);
            assert_eq!(cells.cell(ws) as usize / SECTORS, ring, "{degrees}");
        }
    }
}
