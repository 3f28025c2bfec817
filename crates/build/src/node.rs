//! A measured incidence, made ready for evaluation.

use gonio_geom::{Angles, DVec3};

use crate::plane::{Point, from_plane, to_plane};
use crate::readings::Readings;
use crate::slice_surface::SliceSurface;
use crate::table::{Accuracy, Table};

/// Cells along one side of the coverage mask: about a degree.
const MASK_CELLS: usize = 180;

/// Share of the hemisphere up to 75 degrees whose BSDF lies below the diffuse base.
const BASE_QUANTILE: f64 = 0.05;

/// Largest error of the resampled slice relative to the value, when the readings have no noise.
const TABLE_ERROR: f64 = 1e-3;

/// The same as a fraction of the relative noise of a reading: detail below it is not worth a finer grid.
const TABLE_NOISE: f64 = 0.4;

/// Error of the resampled slice that does not matter, as a fraction of its mean BSDF.
const TABLE_FLOOR: f64 = 1e-3;

/// Most readings a held-out comparison uses; more are thinned evenly.
const HELD_OUT_MOST: usize = 20_000;

/// One slice over the upper hemisphere of the local frame.
#[derive(Debug)]
pub(crate) struct Node {
    /// Incidence as measured.
    pub(crate) incidence: Angles,
    /// Incidence in the local frame.
    pub(crate) direction: DVec3,
    /// Level of the diffuse part, 1/sr.
    pub(crate) base: f64,
    table: Table,
    mask: Vec<bool>,
}

/// The readings of a node as read, to compare predictions with.
#[derive(Debug, Default)]
pub(crate) struct HeldOut {
    pub(crate) direction: Vec<DVec3>,
    /// BSDF, 1/sr.
    pub(crate) bsdf: Vec<f64>,
    /// Solid angle times cosine.
    pub(crate) weight: Vec<f64>,
    /// Median of the stated noise over the value.
    relative_noise: f64,
}

impl Node {
    /// Resamples `surfaces` (one incidence up to azimuth; their mean counts) and, when `bilateral`, their mirror
    /// images at the plane of incidence.
    pub(crate) fn new(
        incidence: Angles,
        direction: DVec3,
        surfaces: &[SliceSurface],
        held_out: &HeldOut,
        bilateral: bool,
    ) -> Self {
        let views = |p: Point| {
            let image = bilateral.then_some([p[0], -p[1]]);
            std::iter::once(p).chain(image)
        };
        // The mean of what is measured; of everything where nothing is.
        let at = |p: Point| {
            let (mut known, mut all) = ((0.0, 0.0), (0.0, 0.0));
            for surface in surfaces {
                for q in views(p) {
                    let (value, measured) = surface.at(q);
                    all = (all.0 + value, all.1 + 1.0);
                    if measured {
                        known = (known.0 + value, known.1 + 1.0);
                    }
                }
            }
            let (sum, count) = if known.1 > 0.0 { known } else { all };
            (sum / count, known.1 > 0.0)
        };
        let mut density: Vec<Point> = surfaces.iter().flat_map(|s| s.points()).copied().collect();
        if bilateral {
            let images: Vec<Point> = density.iter().map(|p| [p[0], -p[1]]).collect();
            density.extend(images);
        }
        let accuracy = Accuracy {
            relative: TABLE_ERROR.max(TABLE_NOISE * held_out.relative_noise),
            floor: TABLE_FLOOR * held_out.mean_bsdf(),
        };
        let table = Table::new(|p| at(p).0, &density, accuracy);
        let mask = (0..MASK_CELLS * MASK_CELLS)
            .map(|k| {
                let centre = |i: usize| 2.0 * (i as f64 + 0.5) / MASK_CELLS as f64 - 1.0;
                at([centre(k % MASK_CELLS), centre(k / MASK_CELLS)]).1
            })
            .collect();
        Node {
            incidence,
            direction,
            base: base(&table),
            table,
            mask,
        }
    }

    /// BSDF in the local direction `s` (`z >= 0`); may be negative where the readings are.
    #[inline]
    pub(crate) fn value(&self, s: DVec3) -> f64 {
        self.table.value(to_plane(s))
    }

    /// Whether readings surround the local direction `s`.
    pub(crate) fn measured(&self, s: DVec3) -> bool {
        let p = to_plane(s);
        let cell = |x: f64| (((x + 1.0) * 0.5 * MASK_CELLS as f64).max(0.0) as usize).min(MASK_CELLS - 1);
        self.mask[cell(p[1]) * MASK_CELLS + cell(p[0])]
    }

    /// Number of values the slice was resampled to.
    pub(crate) fn table_len(&self) -> usize {
        self.table.len()
    }
}

impl HeldOut {
    /// The readings behind `surfaces`, each weighted by its projected solid angle.
    pub(crate) fn new(readings: &[Readings], surfaces: &[SliceSurface]) -> Self {
        let mut out = HeldOut::default();
        for (r, surface) in readings.iter().zip(surfaces) {
            let omega = surface.solid_angles();
            let stride = r.len().div_ceil(HELD_OUT_MOST).max(1);
            for k in (0..r.len()).step_by(stride) {
                let direction = from_plane(r.points[k]);
                out.direction.push(direction);
                out.bsdf.push(r.value[k]);
                out.weight.push(omega[k] * direction.z * stride as f64);
            }
        }
        out.relative_noise = relative_noise(readings);
        out
    }

    /// Mean BSDF over the measured directions, 1/sr.
    pub(crate) fn mean_bsdf(&self) -> f64 {
        let weight: f64 = self.weight.iter().sum();
        let sum: f64 = self.weight.iter().zip(&self.bsdf).map(|(w, f)| w * f).sum();
        if weight > 0.0 { (sum / weight).abs() } else { 0.0 }
    }
}

fn relative_noise(readings: &[Readings]) -> f64 {
    let mut ratios: Vec<f64> = readings
        .iter()
        .flat_map(|r| r.sigma.iter().zip(&r.value))
        .map(|(u, f)| u / f.abs().max(1e-300))
        .collect();
    ratios.sort_unstable_by(f64::total_cmp);
    ratios.get(ratios.len() / 2).copied().unwrap_or(0.0)
}

/// Low quantile of the BSDF up to 75 degrees, not below 0.
fn base(table: &Table) -> f64 {
    let (n, lowest) = (4000, f64::to_radians(75.0).cos());
    let golden = std::f64::consts::PI * (1.0 + 5f64.sqrt());
    let mut values: Vec<f64> = (0..n)
        .map(|k| {
            let z = 1.0 - (1.0 - lowest) * (k as f64 + 0.5) / n as f64;
            let (s, c) = (golden * k as f64).sin_cos();
            let r = (1.0 - z * z).sqrt();
            table.value(to_plane(DVec3::new(r * c, r * s, z)))
        })
        .collect();
    values.sort_unstable_by(f64::total_cmp);
    values[(BASE_QUANTILE * n as f64) as usize].max(0.0)
}
