//! A measured incidence, made ready for evaluation.

use std::f64::consts::PI;
use std::sync::{Arc, OnceLock};

use gonio_geom::{Angles, DVec3};

use crate::across::Quantiles;
use crate::base::{Base, Divisor, Picked};
use crate::lobes::{Lobe, find};
use crate::plane::{Point, from_plane, to_plane};
use crate::readings::Readings;
use crate::slice_surface::SliceSurface;
use crate::table::{Accuracy, Table};

/// Cells along one side of the coverage mask: about a degree.
const MASK_CELLS: usize = 180;

/// Share of the hemisphere up to 75 degrees whose BSDF lies below the diffuse level.
const LEVEL_QUANTILE: f64 = 0.05;

/// Directions, even over projected solid angle, over which light outside the readings is summed up.
const OUTSIDE: usize = 4000;

/// Largest error of the resampled slice relative to the value, when the readings have no noise.
const TABLE_ERROR: f64 = 1e-3;

/// The same as a fraction of the relative noise of a reading: detail below it is not worth a finer grid.
const TABLE_NOISE: f64 = 0.8;

/// Error of the resampled slice that does not matter, as a fraction of its mean BSDF.
const TABLE_FLOOR: f64 = 1e-3;

/// Smallest ratio to the base whose logarithm is taken.
const LEAST_RATIO: f64 = 1e-4;

/// One slice over the upper hemisphere of the local frame: its ratio to a parametric base, and the BSDF itself where
/// that is asked for often.
#[derive(Debug)]
pub(crate) struct Node {
    /// Incidence as measured.
    pub(crate) incidence: Angles,
    /// Incidence in the local frame.
    pub(crate) direction: DVec3,
    /// Level of the diffuse part, 1/sr.
    pub(crate) level: f64,
    divisor: Option<Divisor>,
    ratio: Table,
    bsdf: Option<Table>,
    mask: Vec<bool>,
    density: Vec<Point>,
    relative: f64,
    mean: f64,
    lobes: OnceLock<Vec<Lobe>>,
    quantiles: OnceLock<Arc<Quantiles>>,
}

/// What is known of the readings of a node.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Statistics {
    /// Median of the stated noise over the value.
    pub(crate) relative_noise: f64,
    /// Mean BSDF over the measured directions, 1/sr.
    pub(crate) mean: f64,
}

impl Statistics {
    /// Of all readings, some of which are `picked`.
    pub(crate) fn new(readings: &[Readings], picked: &Picked) -> Self {
        let mut ratios: Vec<f64> = readings
            .iter()
            .flat_map(|r| r.sigma.iter().zip(&r.value))
            .map(|(u, f)| u / f.abs().max(1e-300))
            .collect();
        ratios.sort_unstable_by(f64::total_cmp);
        let weight: f64 = (0..picked.len())
            .map(|j| picked.omega[j] * picked.direction[j].z)
            .sum();
        Statistics {
            relative_noise: ratios.get(ratios.len() / 2).copied().unwrap_or(0.0),
            mean: if weight > 0.0 {
                (picked.albedo() / weight).abs()
            } else {
                0.0
            },
        }
    }
}

impl Node {
    /// Resamples `surfaces` (one incidence up to azimuth; their mean counts) and, when `bilateral`, their mirror
    /// images at the plane of incidence. `divisor` is the one they were filled with.
    pub(crate) fn new(
        incidence: Angles,
        direction: DVec3,
        surfaces: &[SliceSurface],
        divisor: Option<Divisor>,
        statistics: Statistics,
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
                    let (value, measured) = surface.ratio_at(q);
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
        let relative = TABLE_ERROR.max(TABLE_NOISE * statistics.relative_noise);
        let floor = TABLE_FLOOR * statistics.mean;
        let accuracy = match &divisor {
            Some(divisor) => Accuracy::of_points(relative, |points| {
                let level = divisor.eval_all(points.iter().map(|&p| from_plane(p)));
                level.into_iter().map(|m| floor / m).collect()
            }),
            None => Accuracy::even(relative, floor),
        };
        let ratio = Table::new(|p| at(p).0, &density, &accuracy);
        let mask = (0..MASK_CELLS * MASK_CELLS)
            .map(|k| {
                let centre = |i: usize| 2.0 * (i as f64 + 0.5) / MASK_CELLS as f64 - 1.0;
                at([centre(k % MASK_CELLS), centre(k / MASK_CELLS)]).1
            })
            .collect();
        let mut node = Node {
            incidence,
            direction,
            level: 0.0,
            divisor,
            ratio,
            bsdf: None,
            mask,
            density,
            relative,
            mean: statistics.mean,
            lobes: OnceLock::new(),
            quantiles: OnceLock::new(),
        };
        node.level = level(&node);
        node
    }

    /// The same with the BSDF resampled too, so that it is one look-up away.
    pub(crate) fn with_bsdf(&self) -> Self {
        let accuracy = Accuracy::even(self.relative, TABLE_FLOOR * self.mean);
        let bsdf = self
            .divisor
            .as_ref()
            .map(|_| Table::new(|p| self.value(from_plane(p)), &self.density, &accuracy));
        Node {
            incidence: self.incidence,
            direction: self.direction,
            level: self.level,
            divisor: self.divisor.clone(),
            ratio: self.ratio.clone(),
            bsdf,
            mask: self.mask.clone(),
            density: Vec::new(),
            relative: self.relative,
            mean: self.mean,
            lobes: self.lobes.clone(),
            quantiles: self.quantiles.clone(),
        }
    }

    /// BSDF in the local direction `s` (`z >= 0`); may be negative where the readings are.
    #[inline]
    pub(crate) fn value(&self, s: DVec3) -> f64 {
        let p = to_plane(s);
        match (&self.bsdf, &self.divisor) {
            (Some(bsdf), _) => bsdf.value(p),
            (None, Some(divisor)) => self.ratio.value(p) * divisor.eval(s),
            (None, None) => self.ratio.value(p),
        }
    }

    /// Logarithm of the ratio of the BSDF to `base` in the local direction `s`, taken no lower than that of
    /// [`LEAST_RATIO`].
    #[inline]
    pub(crate) fn ln_ratio(&self, base: &Arc<Base>, s: DVec3) -> f64 {
        let ratio = self.ratio.value(to_plane(s));
        match &self.divisor {
            Some(own) if own.is(base) => ratio.max(LEAST_RATIO).ln(),
            Some(own) => {
                let bases = own.eval(s) / base.eval(self.direction, s);
                (ratio * bases).max(LEAST_RATIO).ln()
            }
            None => (ratio / base.eval(self.direction, s)).max(LEAST_RATIO).ln(),
        }
    }

    /// The lobes over the diffuse level, highest first.
    pub(crate) fn lobes(&self) -> &[Lobe] {
        self.lobes.get_or_init(|| find(|s| self.value(s), self.level))
    }

    /// The quantiles of the light above the diffuse level.
    pub(crate) fn quantiles(&self) -> &Quantiles {
        self.quantiles.get_or_init(|| {
            Arc::new(Quantiles::new(|p| {
                let z = (1.0 - p[0] * p[0] - p[1] * p[1]).max(0.0).sqrt();
                self.value(DVec3::new(p[0], p[1], z)) - self.level
            }))
        })
    }

    /// Whether readings surround the local direction `s`.
    pub(crate) fn measured(&self, s: DVec3) -> bool {
        let p = to_plane(s);
        let cell = |x: f64| (((x + 1.0) * 0.5 * MASK_CELLS as f64).max(0.0) as usize).min(MASK_CELLS - 1);
        self.mask[cell(p[1]) * MASK_CELLS + cell(p[0])]
    }

    /// Share of the incident light that goes where no readings stand.
    pub(crate) fn extrapolated_light(&self) -> f64 {
        let golden = PI * (1.0 + 5f64.sqrt());
        let sum: f64 = (0..OUTSIDE)
            .map(|k| {
                let r = ((k as f64 + 0.5) / OUTSIDE as f64).sqrt();
                let (s, c) = (golden * k as f64).sin_cos();
                DVec3::new(r * c, r * s, (1.0 - r * r).sqrt())
            })
            .filter(|&s| !self.measured(s))
            .map(|s| self.value(s).max(0.0))
            .sum();
        PI * sum / OUTSIDE as f64
    }

    /// Number of values the slice was resampled to.
    pub(crate) fn table_len(&self) -> usize {
        self.ratio.len() + self.bsdf.as_ref().map_or(0, Table::len)
    }
}

/// Low quantile of the BSDF up to 75 degrees, not below 0.
fn level(node: &Node) -> f64 {
    let (n, lowest) = (4000, f64::to_radians(75.0).cos());
    let golden = std::f64::consts::PI * (1.0 + 5f64.sqrt());
    let mut values: Vec<f64> = (0..n)
        .map(|k| {
            let z = 1.0 - (1.0 - lowest) * (k as f64 + 0.5) / n as f64;
            let (s, c) = (golden * k as f64).sin_cos();
            let r = (1.0 - z * z).sqrt();
            node.value(DVec3::new(r * c, r * s, z))
        })
        .collect();
    values.sort_unstable_by(f64::total_cmp);
    values[(LEVEL_QUANTILE * n as f64) as usize].max(0.0)
}
