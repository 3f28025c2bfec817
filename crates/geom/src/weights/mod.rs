//! Solid-angle weights of scattered directions: exact spherical Voronoi cells of a hemisphere.

mod close;
mod patch;
mod polygon;
mod voronoi;

use glam::DVec3;

use crate::Side;
use crate::delaunay::{Delaunay, DelaunayError};
pub(crate) use close::unified;
pub use patch::{PatchWeights, patch_weights};
pub(crate) use polygon::area_and_moment;
pub(crate) use voronoi::{Cell, Diagram};

/// Weights cannot be computed.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum WeightsError {
    /// A point that cannot be triangulated.
    #[error(transparent)]
    Delaunay(#[from] DelaunayError),
    /// No points at all.
    #[error("no directions found, at least 1 needed")]
    Empty,
    /// A raster that is no bounded patch.
    #[error("a direction {angle:.1} deg from the mean direction found, at most 80 deg allowed for a raster")]
    Spread {
        /// Angle of a direction to the mean of all, degrees; NaN when there is no mean.
        angle: f64,
    },
}

/// Voronoi cells of a hemisphere, one a point and in the order of the points.
///
/// The cells tile the hemisphere: `Σ omega = 2 pi` and `Σ |moment.z| = pi`, whatever the points. Points of equal
/// direction share their cell in equal parts.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Cells {
    /// Solid angle Ω, sr.
    pub omega: Vec<f64>,
    /// First moment `∫ω dω`, sr; its `z` component is the projected solid angle (negative on the back), its
    /// direction the centroid.
    pub moment: Vec<DVec3>,
    /// Angle from the point to the farthest corner of its cell, radians.
    pub reach: Vec<f64>,
}

impl Cells {
    /// Number of cells.
    pub fn len(&self) -> usize {
        self.omega.len()
    }

    /// Whether there are no cells.
    pub fn is_empty(&self) -> bool {
        self.omega.is_empty()
    }

    /// Projected solid angle Ω⊥ = ∫|cos θ| dω of cell `i`, sr.
    pub fn omega_projected(&self, i: usize) -> f64 {
        self.moment[i].z.abs()
    }

    /// Centroid of cell `i`, a unit vector; `None` for a cell without area.
    pub fn centroid(&self, i: usize) -> Option<DVec3> {
        self.moment[i].try_normalize()
    }
}

/// The exact Voronoi cell of every point, clipped to the hemisphere `side`.
///
/// `points` are unit vectors on `side` (the horizon belongs to both sides), any number from one, anywhere: the
/// same direction several times (or within 2e-6 rad, which counts as the same), all on a circle, all in a small patch. Ω and Ω⊥ of a cell are exact to rounding
/// (`1e-12` relative for cells of 0.1°); the sums to 2π and π hold to `1e-9`.
///
/// # Errors
/// [`WeightsError`] for no points, a vector that is not a unit vector, or a point on the other side.
pub fn hemisphere_cells(points: &[DVec3], side: Side) -> Result<Cells, WeightsError> {
    if points.is_empty() {
        return Err(WeightsError::Empty);
    }
    let points = &*unified(points);
    let delaunay = Delaunay::new(points, side)?;
    let diagram = Diagram::new(points, &delaunay);
    let n = points.len();
    let mut cells = Cells {
        omega: vec![0.0; n],
        moment: vec![DVec3::ZERO; n],
        reach: vec![0.0; n],
    };
    let mut cell = Cell::default();
    for i in 0..n {
        if !diagram.cell(i, &mut cell) {
            continue;
        }
        for piece in cell.pieces() {
            let (omega, moment) = area_and_moment(piece);
            cells.omega[i] += omega;
            cells.moment[i] += moment;
        }
        cells.moment[i].z *= side.sign();
        cells.reach[i] = cell.reach(diagram.point(i));
    }
    share(&mut cells, diagram.copies());
    Ok(cells)
}

/// Splits the cell of every point with copies into equal parts.
fn share(cells: &mut Cells, copies: &[(u32, u32)]) {
    for_each_group(copies, |point, group| {
        let part = 1.0 / (group.len() + 1) as f64;
        cells.omega[point] *= part;
        cells.moment[point] *= part;
        for &(_, copy) in group {
            let copy = copy as usize;
            cells.omega[copy] = cells.omega[point];
            cells.moment[copy] = cells.moment[point];
            cells.reach[copy] = cells.reach[point];
        }
    });
}

/// Calls `visit(point, [(point, copy), ...])` for every point that has copies; `copies` holds `(copy, point)`.
pub(crate) fn for_each_group(copies: &[(u32, u32)], mut visit: impl FnMut(usize, &[(u32, u32)])) {
    let mut by_point: Vec<(u32, u32)> = copies.iter().map(|&(copy, point)| (point, copy)).collect();
    by_point.sort_unstable();
    for group in by_point.chunk_by(|a, b| a.0 == b.0) {
        visit(group[0].0 as usize, group);
    }
}

#[cfg(test)]
mod tests;
