//! Which readings a ray meets.

use std::collections::HashMap;
use std::f64::consts::PI;

use gonio_geom::{DVec3, Direction};

use crate::Detector;

/// The apertures of all readings, by where they are.
pub(crate) struct Apertures {
    /// In units of the distance of the detector: middles, and ways travelled during a reading.
    middle: Vec<DVec3>,
    travel: Vec<DVec3>,
    distance: f64,
    radius: f64,
    /// Edge of a cell.
    edge: f64,
    cells: HashMap<[i32; 3], Vec<u32>>,
}

impl Apertures {
    /// Of readings at directions `ws` that travel by `travel` (of unit distance).
    pub(crate) fn new(detector: &Detector, ws: &[Direction], travel: &[DVec3]) -> Self {
        let radius = detector.aperture.tan();
        let half = |t: &DVec3| radius + 0.5 * t.length();
        let longest = travel.iter().map(half).fold(radius, f64::max);
        let mut out = Apertures {
            middle: ws.iter().map(|d| d.vec()).collect(),
            travel: travel.to_vec(),
            distance: detector.distance,
            radius,
            edge: 2.0 * longest,
            cells: HashMap::new(),
        };
        for (j, (d, t)) in ws.iter().zip(travel).enumerate() {
            // A little more: the aperture is flat, the sphere is not.
            let reach = DVec3::splat(1.01 * half(t));
            let (low, high) = (out.cell(d.vec() - reach), out.cell(d.vec() + reach));
            for x in low[0]..=high[0] {
                for y in low[1]..=high[1] {
                    for z in low[2]..=high[2] {
                        out.cells.entry([x, y, z]).or_default().push(j as u32);
                    }
                }
            }
        }
        out
    }

    /// One over the solid angle of an aperture from the middle, flat as it is, 1/sr.
    pub(crate) fn per_solid_angle(&self) -> f32 {
        (1.0 / (PI * self.radius * self.radius)) as f32
    }

    fn cell(&self, at: DVec3) -> [i32; 3] {
        (at / self.edge).floor().to_array().map(|x| x as i32)
    }

    /// Calls `each` with the readings, and where it meets their apertures (metres), that a ray from `from` (metres) in the unit `direction` meets at a time within the
    /// reading, `[-0.5, 0.5]`.
    pub(crate) fn hit(&self, from: DVec3, direction: DVec3, time: f64, mut each: impl FnMut(usize, DVec3)) {
        let from = from / self.distance;
        // To the unit sphere.
        let along = from.dot(direction);
        let inside = along * along - from.length_squared() + 1.0;
        if inside <= 0.0 {
            return;
        }
        let at = from + (inside.sqrt() - along) * direction;
        for &j in self.cells.get(&self.cell(at)).into_iter().flatten() {
            let j = j as usize;
            let normal = self.middle[j];
            let facing = direction.dot(normal);
            if facing <= 0.0 {
                continue;
            }
            let middle = normal + time * self.travel[j];
            let met = from + (middle - from).dot(normal) / facing * direction;
            if met.distance_squared(middle) <= self.radius * self.radius {
                each(j, self.distance * met);
            }
        }
    }
}
