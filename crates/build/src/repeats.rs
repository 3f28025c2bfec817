//! Several slices of one incidence: how far they differ, and whether their noise explains it.

use std::f64::consts::PI;

use gonio_geom::{Component, Side};
use gonio_scan::Slice;
use rayon::prelude::*;

use crate::base::Divisor;
use crate::pile::Pile;
use crate::plane::from_plane;
use crate::readings::{Readings, turn_to_pi};
use crate::slice_surface::SliceSurface;
use crate::symmetry::Incidence;

/// Share of a slice's solid angle that another one must have read too for the two to repeat one another; two that share less
/// complete one another.
const OVERLAP: f64 = 0.2;

/// Every so manyth reading is compared.
const COMPARED: usize = 3;

/// Factor between the spread and what noise explains, and least spread (relative L1), from which repeats differ.
const MORE: f64 = 2.0;
const LEAST: f64 = 0.005;

/// The repeats of one incidence.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Repeats {
    pub(crate) count: usize,
    /// Mean difference of two of them, relative L1 of the DSF; and what their stated noise makes of it.
    pub(crate) spread: f64,
    pub(crate) noise: f64,
}

impl Repeats {
    /// What the repeats say of `pile`, whose slices were divided by `divisor`; `None` where nothing was read twice.
    pub(crate) fn of(
        pile: &Pile<'_>,
        (side, component): (Side, Component),
        isotropic: bool,
        smooth: bool,
        divisor: Option<&Divisor>,
    ) -> Option<Self> {
        let mut found: Option<Repeats> = None;
        for group in Incidence::group(&pile.slices, side) {
            let turn = if isotropic { turn_to_pi(group.angles) } else { 0.0 };
            let to = component.scattered_side(side);
            let surface = |slice: &&Slice| {
                let readings = Readings::collect(&[*slice], to, turn);
                let mut surface = SliceSurface::flat(&readings)?;
                surface.fill(&readings, smooth, divisor.cloned());
                Some(surface)
            };
            if group.slices.len() < 2 {
                continue;
            }
            let surfaces: Vec<SliceSurface> = group.slices.par_iter().filter_map(surface).collect();
            let pairs = (0..surfaces.len()).flat_map(|a| (0..a).map(move |b| (a, b)));
            let apart: Vec<(f64, f64)> = pairs
                .filter_map(|(a, b)| difference(&surfaces[a], &surfaces[b]))
                .collect();
            if apart.is_empty() {
                continue;
            }
            let mean = |of: fn(&(f64, f64)) -> f64| apart.iter().map(of).sum::<f64>() / apart.len() as f64;
            let own = Repeats {
                count: surfaces.len(),
                spread: mean(|d| d.0),
                noise: mean(|d| d.1),
            };
            if found.is_none_or(|f| own.spread > f.spread) {
                found = Some(own);
            }
        }
        found
    }

    /// Whether they differ by more than their noise.
    pub(crate) fn differ(&self) -> bool {
        self.spread > LEAST && self.spread > MORE * self.noise
    }

    /// How far their mean is from what they repeat, relative L1, beyond their noise.
    pub(crate) fn of_mean(&self) -> f64 {
        let beyond = (self.spread * self.spread - self.noise * self.noise)
            .max(0.0)
            .sqrt();
        beyond / (2.0 * self.count as f64).sqrt()
    }
}

/// Relative L1 difference of two slices where both were read, and what their noise makes of it.
fn difference(a: &SliceSurface, b: &SliceSurface) -> Option<(f64, f64)> {
    let omega = a.solid_angles();
    let (mut apart, mut noise, mut size) = (0.0, 0.0, 0.0);
    let (mut both, mut all) = (0.0, 0.0);
    for (&p, w) in a.points().iter().zip(omega).step_by(COMPARED) {
        all += w;
        if !b.measured(p) {
            continue;
        }
        both += w;
        let (x, y) = (a.value(p), b.value(p));
        let weight = w * from_plane(p).z;
        let sigma = (a.relative_noise(p) * x).hypot(b.relative_noise(p) * y);
        apart += weight * (x - y).abs();
        // Mean of the absolute value of a normal deviate.
        noise += weight * (2.0 / PI).sqrt() * sigma;
        size += weight * 0.5 * (x.abs() + y.abs());
    }
    (both > OVERLAP * all && size > 0.0).then(|| (apart / size, noise / size))
}

/// What to say of the repeats of all incidences.
pub(crate) fn note(label: &str, all: &[Option<Repeats>]) -> Option<String> {
    let found: Vec<&Repeats> = all.iter().flatten().collect();
    let worst = found.iter().max_by(|a, b| a.spread.total_cmp(&b.spread))?;
    let (incidences, most) = (found.len(), found.iter().map(|r| r.count).max()?);
    let mean = found.iter().map(|r| r.spread).sum::<f64>() / incidences as f64;
    let differing = found.iter().filter(|r| r.differ()).count();
    let said = format!(
        "{label}: up to {most} slices of one incidence are averaged at {incidences} of {} incidences; they differ by {:.1} % (mean \
         relative L1, largest {:.1} %)",
        all.len(),
        100.0 * mean,
        100.0 * worst.spread
    );
    Some(if differing == 0 {
        format!("{said}, within their noise")
    } else {
        format!(
            "{said}, at {differing} of them by more than their noise explains ({:.1} % where they differ most): if they are other \
             samples or other places, the model is their mean and none of them; the spread is in the stated error",
            100.0 * worst.noise
        )
    })
}
