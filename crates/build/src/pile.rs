//! The readings of one incidence on the way to a node.

use std::sync::Arc;

use gonio_geom::{Angles, Component, DVec3, Side};
use gonio_scan::Slice;

use crate::base::{Divisor, Picked};
use crate::error::BuildError;
use crate::hold_out::SliceError;
use crate::lobes::{Lobes, find};
use crate::plane::{from_plane, to_plane};
use crate::readings::Readings;
use crate::slice_surface::SliceSurface;
use crate::spacing::spacing;
use crate::symmetry::{Incidence, SAME_THETA, half_measured, polar};
use crate::watch::{Stage, Watch};

/// Fewest readings of a slice.
const LEAST_READINGS: usize = 12;

/// Readings spread less than this (root mean square, in the stereographic plane) in some direction lie in one
/// scattering plane: about a degree.
const LEAST_EXTENT: f64 = 0.01;

/// Error between readings (relative L1) from which a slice is divided by lobes of its own, kept where its error falls below
/// this share of what it was; and the floor of those lobes in units of the highest reading.
pub(crate) const OWN_LOBES: f64 = 0.01;
const CLEARLY: f64 = 0.8;
const LEAST_FLOOR: f64 = 1e-5;

/// The slices that make one node: one incidence, or several of one polar angle when isotropic.
pub(crate) struct Pile<'a> {
    pub(crate) incidence: Angles,
    pub(crate) slices: Vec<&'a Slice>,
    pub(crate) readings: Vec<Readings>,
    pub(crate) surfaces: Vec<SliceSurface>,
    /// What the surfaces were divided by, where that is lobes of its own.
    pub(crate) own: Option<Arc<Lobes>>,
}

impl<'a> Pile<'a> {
    /// The same incidence with other readings; `None` when these span no triangle.
    pub(crate) fn with(&self, readings: Readings) -> Option<Self> {
        let surface = SliceSurface::flat(&readings)?;
        Some(Pile {
            incidence: self.incidence,
            slices: self.slices.clone(),
            readings: vec![readings],
            surfaces: vec![surface],
            own: None,
        })
    }
}

impl Pile<'_> {
    /// Whether it holds `slice`.
    pub(crate) fn holds(&self, slice: &Slice) -> bool {
        self.slices.iter().any(|s| std::ptr::eq(*s, slice))
    }

    /// The relative uncertainty that its readings share.
    pub(crate) fn common(&self) -> f64 {
        self.slices.iter().map(|s| s.u_common).fold(0.0, f64::max)
    }

    /// Some of its readings, by `importance` of BSDF and cosine.
    pub(crate) fn picked(&self, most: usize, importance: impl Fn(f64, f64) -> f64) -> Picked {
        let omega: Vec<f64> = self
            .surfaces
            .iter()
            .flat_map(SliceSurface::solid_angles)
            .collect();
        let each: Vec<(usize, usize)> = (0..self.readings.len())
            .flat_map(|r| (0..self.readings[r].len()).map(move |j| (r, j)))
            .collect();
        let reading = |n: usize| {
            let (r, j) = each[n];
            let readings = &self.readings[r];
            (
                from_plane(readings.points[j]),
                readings.value[j],
                readings.sigma[j],
                omega[n],
            )
        };
        Picked::new(each.len(), most, reading, importance)
    }
}

impl Pile<'_> {
    /// Distance of the readings about the peak, radians.
    pub(crate) fn peak_spacing(&self) -> Option<f64> {
        let each = self.surfaces.iter().zip(&self.readings);
        each.filter_map(|(s, r)| Picked::peak_spacing(&r.value, &s.solid_angles()))
            .reduce(f64::min)
    }

    /// Divides by lobes of its own where that lessens the `error` between readings clearly; else by `joint` as before. The
    /// error after that.
    pub(crate) fn by_own_lobes(
        &mut self,
        smooth: bool,
        joint: Option<Divisor>,
        error: SliceError,
    ) -> SliceError {
        let ([surface], [readings]) = (&mut self.surfaces[..], &self.readings[..]) else {
            return error;
        };
        let mut levels: Vec<f64> = readings.value.clone();
        levels.sort_unstable_by(f64::total_cmp);
        let (level, highest) = (levels[levels.len() / 20].max(0.0), levels[levels.len() - 1]);
        let own = Arc::new(Lobes {
            floor: level.max(LEAST_FLOOR * highest),
            lobes: find(|s| surface.value(to_plane(s)), level),
        });
        surface.fill(readings, smooth, Some(Divisor::Own(Arc::clone(&own))));
        let found = self.slice_error(false);
        if found.total() < CLEARLY * error.total() {
            self.own = Some(own);
            return found;
        }
        for (surface, readings) in self.surfaces.iter_mut().zip(&self.readings) {
            surface.fill(readings, smooth, joint.clone());
        }
        error
    }

    /// Distance of its readings over the narrow half width of the slice, the largest of its surfaces.
    pub(crate) fn spacing(&self) -> f64 {
        self.surfaces.iter().map(spacing).fold(0.0, f64::max)
    }

    /// Error of its mean slice between readings.
    pub(crate) fn slice_error(&self, bilateral: bool) -> SliceError {
        let each: Vec<SliceError> = self
            .surfaces
            .iter()
            .zip(&self.readings)
            .map(|(surface, r)| {
                let omega = surface.solid_angles();
                let weight: Vec<f64> = omega
                    .iter()
                    .zip(&r.points)
                    .map(|(o, &p)| o * from_plane(p).z)
                    .collect();
                SliceError::new(surface, &r.value, &weight)
            })
            .collect();
        let n = each.len() as f64;
        let views = if bilateral { 2.0 * n } else { n };
        SliceError {
            noise: each.iter().map(|e| e.noise).sum::<f64>() / n / views.sqrt(),
            gap: each.iter().map(|e| e.gap).sum::<f64>() / n,
            repeats: 0.0,
        }
    }
}

/// The slices of `side` and `component`, by incidence.
pub(crate) fn piles<'a>(
    slices: &[&'a Slice],
    side: Side,
    component: Component,
    isotropic: bool,
    notes: &mut Vec<String>,
    watch: &Watch,
) -> Result<Vec<Pile<'a>>, BuildError> {
    let mut piles: Vec<Pile<'a>> = Vec::new();
    let groups = Incidence::group(slices, side);
    watch.stage(Stage::Reading, groups.len())?;
    for group in groups {
        watch.check()?;
        watch.step();
        let mut readings = group.readings(component, isotropic);
        if readings.len() == 0 {
            continue;
        }
        let mut surface = surface(&readings, &group, side, component)?;
        if isotropic && half_measured(&surface) {
            readings = readings.with_mirror_images();
            surface = self::surface(&readings, &group, side, component)?;
            notes.push(format!(
                "{side} {component}, theta_i {:.1} deg: one half was measured, the other is its mirror image",
                group.angles.theta.to_degrees()
            ));
        }
        match piles.last_mut() {
            Some(last) if isotropic && polar(group.angles) - polar(last.incidence) < SAME_THETA => {
                last.slices.extend(&group.slices);
                last.readings.push(readings);
                last.surfaces.push(surface);
            }
            _ => piles.push(Pile {
                incidence: group.angles,
                slices: group.slices,
                readings: vec![readings],
                surfaces: vec![surface],
                own: None,
            }),
        }
    }
    Ok(piles)
}

fn surface(
    readings: &Readings,
    group: &Incidence<'_>,
    side: Side,
    component: Component,
) -> Result<SliceSurface, BuildError> {
    let (theta_i, phi_i) = group.angles.to_degrees();
    let refused = |found: String, needed: &str| BuildError::Readings {
        theta_i,
        phi_i,
        side,
        component,
        found,
        needed: needed.into(),
    };
    if readings.len() < LEAST_READINGS {
        return Err(refused(
            format!("{} usable readings", readings.len()),
            "at least 12 outside the horizon",
        ));
    }
    if readings.least_extent() < LEAST_EXTENT {
        return Err(refused(
            "readings in one scattering plane".into(),
            "readings over the hemisphere",
        ));
    }
    SliceSurface::flat(readings).ok_or_else(|| refused("no triangle".into(), "readings over the hemisphere"))
}

/// Incidence in the local frame; at azimuth pi when isotropic.
pub(crate) fn local_incidence(incidence: Angles, isotropic: bool) -> DVec3 {
    let theta = polar(incidence);
    let (s, c) = theta.sin_cos();
    if isotropic {
        DVec3::new(-s, 0.0, c)
    } else {
        DVec3::new(s * incidence.phi.cos(), s * incidence.phi.sin(), c)
    }
}
