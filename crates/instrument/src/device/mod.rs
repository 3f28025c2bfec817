//! The BSDF of a part that exists as geometry: rays from all directions through a blind, a film, a fabric.

mod apertures;
mod beamlet;
mod contributions;
mod part;
mod patches;
mod prune;
mod readings;
mod rows;
mod scatterings;
mod squares;
mod sums;

pub use patches::{PatchTable, patch_tables};
pub use prune::{PruneOptions, Pruned};
pub use readings::{CHANNELS, Measured, MonteCarlo, ReadingEffort, simulate_device};
pub use rows::{Effort, Progress};
pub use squares::{LEVELS, tensor_trees};

use glam::Vec3;
use gonio_trace::passage::Cell;
use gonio_trace::scene::{Parts, Scene};

use crate::InstrumentError;

/// A part in the frame of its sample: the plane is `z = 0`, the front is `+z`.
pub struct Device {
    pub(crate) scene: Scene,
    pub(crate) cell: Cell,
    /// Where rays are sent through: `[[x, y]; 2]`, the lowest and the highest corner.
    pub(crate) window: [[f32; 2]; 2],
}

/// What of a part is measured.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Extent {
    /// The rectangle that rays are sent through, `[x_low, y_low, x_high, y_high]`; all of the part without it. Of a periodic
    /// part it is one period.
    pub window: Option<[f32; 4]>,
    /// Whether the part repeats beyond the window: otherwise rays may leave it at its rim.
    pub periodic: bool,
}

/// Share of a period that what bounds the part covers at least: with less, the window is in another unit or aside of it.
const LEAST_COVERED: f32 = 0.01;
/// Rays begin before the part by this share of its size.
const BEFORE: f32 = 1e-4;

impl Device {
    /// A part made of these surfaces; lights and skies among them are left out.
    ///
    /// # Errors
    /// [`InstrumentError::Domain`] for a part without extent in x or y, a window that is not inside it, holds next to nothing of
    /// it as a period, or has no area, and
    /// for indices beyond their lists.
    pub fn new(mut parts: Parts, extent: Extent) -> Result<Self, InstrumentError> {
        parts.lights.clear();
        parts.light_patterns.clear();
        parts.sky = None;
        for surface in &mut parts.surfaces {
            surface.light = None;
            surface.glow = Vec3::ZERO;
            surface.concealed = false;
        }
        let (low, high) = bounds(&parts);
        let domain = |field, found: String, allowed: &str| InstrumentError::Domain {
            field,
            found,
            allowed: allowed.into(),
        };
        let size = high - low;
        if !(size.x > 0.0 && size.y > 0.0) {
            let found = format!("{} x {}", size.x.max(0.0), size.y.max(0.0));
            return Err(domain("geometry", found, "a part with an extent in x and y"));
        }
        let [x0, y0, x1, y1] = extent.window.unwrap_or([low.x, low.y, high.x, high.y]);
        let slack = 1e-4 * size.max_element();
        let inside =
            x0 >= low.x - slack && y0 >= low.y - slack && x1 <= high.x + slack && y1 <= high.y + slack;
        let covered = (x1.min(high.x) - x0.max(low.x)).max(0.0) * (y1.min(high.y) - y0.max(low.y)).max(0.0);
        let filled = covered >= LEAST_COVERED * (x1 - x0) * (y1 - y0);
        if !(x1 > x0 && y1 > y0 && (inside || (extent.periodic && filled))) {
            let found = format!("{x0} {y0} {x1} {y1}");
            let part = format!("{} {} {} {}", low.x, low.y, high.x, high.y);
            let allowed = match extent.periodic {
                true => format!(
                    "x_low y_low x_high y_high of one period, in the unit of the part, which lies within {part}"
                ),
                false => format!("x_low y_low x_high y_high within {part}"),
            };
            return Err(domain("window", found, &allowed));
        }
        let before = BEFORE * size.max_element();
        let cell = Cell {
            low: Vec3::new(x0, y0, low.z - before),
            high: Vec3::new(x1, y1, high.z + before),
            periodic: extent.periodic,
        };
        let scene = Scene::new(parts).map_err(|e| domain(e.field, e.found, &e.allowed))?;
        Ok(Device {
            scene,
            cell,
            window: [[x0, y0], [x1, y1]],
        })
    }
}

impl Device {
    /// The rectangle that rays are sent through: its lowest and its highest corner, `[x, y]`.
    pub fn window(&self) -> [[f32; 2]; 2] {
        self.window
    }
}

/// The box about all surfaces.
fn bounds(parts: &Parts) -> (Vec3, Vec3) {
    let used = parts
        .triangles
        .iter()
        .flatten()
        .filter_map(|k| parts.vertices.get(*k as usize))
        .map(|v| Vec3::from(*v));
    let curved = parts.shapes.iter().flat_map(|(shape, _)| shape.bounds());
    used.chain(curved)
        .fold((Vec3::INFINITY, Vec3::NEG_INFINITY), |(low, high), p| {
            (low.min(p), high.max(p))
        })
}
