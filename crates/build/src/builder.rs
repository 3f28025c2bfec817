//! From the slices of one side and component to an interpolated part.

use std::sync::Arc;

use gonio_geom::{Angles, Component, DVec3, Side};
use gonio_scan::Slice;

use crate::data_driven::{BuildOptions, PartSummary};
use crate::error::BuildError;
use crate::incidence::Part;
use crate::leave_one_out::{LooError, leave_one_out};
use crate::node::{HeldOut, Node};
use crate::readings::Readings;
use crate::slice_surface::SliceSurface;
use crate::symmetry::{Incidence, SAME_THETA, half_measured, mirror_symmetric, polar};
use crate::warp::Candidate;

/// Fewest readings of a slice.
const LEAST_READINGS: usize = 12;

/// Readings spread less than this (root mean square, in the stereographic plane) in some direction lie in one
/// scattering plane: about a degree.
const LEAST_EXTENT: f64 = 0.01;

/// A part and what is to be said of it.
pub(crate) struct Built {
    pub(crate) part: Part,
    pub(crate) summary: PartSummary,
    pub(crate) loo: Vec<LooError>,
    pub(crate) notes: Vec<String>,
}

/// The slices that make one node: one incidence, or several of one polar angle when isotropic.
struct Pile {
    incidence: Angles,
    readings: Vec<Readings>,
    surfaces: Vec<SliceSurface>,
}

/// The part of light from `side` in `component`; `None` when there is no reading of it.
pub(crate) fn part(
    slices: &[&Slice],
    side: Side,
    component: Component,
    isotropic: bool,
    options: &BuildOptions,
) -> Result<Option<Built>, BuildError> {
    let mut notes = Vec::new();
    let piles = piles(slices, side, component, isotropic, options, &mut notes)?;
    if piles.is_empty() {
        return Ok(None);
    }
    let agree: Vec<bool> = piles
        .iter()
        .flat_map(|p| p.surfaces.iter().filter_map(mirror_symmetric))
        .collect();
    let bilateral = isotropic && !agree.is_empty() && 2 * agree.iter().filter(|a| **a).count() > agree.len();

    let readings = piles.iter().flat_map(|p| &p.readings).map(Readings::len).sum();
    let mut nodes = Vec::with_capacity(piles.len());
    let mut held_out = Vec::with_capacity(piles.len());
    for pile in piles {
        let held = HeldOut::new(&pile.readings, &pile.surfaces);
        let direction = local_incidence(pile.incidence, isotropic);
        nodes.push(Arc::new(Node::new(
            pile.incidence,
            direction,
            &pile.surfaces,
            &held,
            bilateral,
        )));
        held_out.push(held);
    }
    if nodes.len() == 1 {
        notes.push(format!(
            "{side} {component}: one incidence only, every other is extrapolated from it"
        ));
    }

    let folds = |candidate| leave_one_out(&nodes, &held_out, isotropic, component, candidate);
    let all: Vec<Candidate> = options.candidate.map_or(Candidate::ALL.to_vec(), |c| vec![c]);
    let mut tried: Vec<(Candidate, Vec<LooError>)> = all.into_iter().map(|c| (c, folds(c))).collect();
    let score = |loo: &[LooError]| loo.iter().map(|e| e.rel_l1).sum::<f64>() / loo.len() as f64;
    if isotropic && options.candidate.is_none() {
        // the way over incidence matters less than the way the lobe moves: it is chosen last
        let best = tried
            .iter()
            .filter(|(_, loo)| !loo.is_empty())
            .min_by(|a, b| score(&a.1).total_cmp(&score(&b.1)));
        if let Some((best, _)) = best {
            let cubic = best.with_cubic();
            tried.push((cubic, folds(cubic)));
        }
    }
    let scores: Vec<(Candidate, f64)> = tried
        .iter()
        .filter(|(_, loo)| !loo.is_empty())
        .map(|(c, loo)| (*c, score(loo)))
        .collect();
    let best = (0..scores.len())
        .min_by(|&a, &b| scores[a].1.total_cmp(&scores[b].1))
        .unwrap_or(0);
    if scores.is_empty() && options.candidate.is_none() {
        notes.push(format!(
            "{side} {component}: no incidence lies between others, so the interpolation was not chosen by its error \
             but taken as {}",
            tried[0].0
        ));
    }
    let (candidate, loo) = tried.swap_remove(best);
    let summary = PartSummary {
        side,
        component,
        incidences: nodes.len(),
        readings,
        table_values: nodes.iter().map(|n| n.table_len()).sum(),
        bilateral,
        candidate,
        scores,
    };
    Ok(Some(Built {
        part: Part::new(nodes, isotropic, candidate),
        summary,
        loo,
        notes,
    }))
}

fn piles(
    slices: &[&Slice],
    side: Side,
    component: Component,
    isotropic: bool,
    options: &BuildOptions,
    notes: &mut Vec<String>,
) -> Result<Vec<Pile>, BuildError> {
    let mut piles: Vec<Pile> = Vec::new();
    for group in Incidence::group(slices, side) {
        let mut readings = group.readings(component, isotropic);
        if readings.len() == 0 {
            continue;
        }
        let mut surface = surface(&readings, &group, side, component, options)?;
        if isotropic && half_measured(&surface) {
            readings = readings.with_mirror_images();
            surface = self::surface(&readings, &group, side, component, options)?;
            notes.push(format!(
                "{side} {component}, theta_i {:.1} deg: one half was measured, the other is its mirror image",
                group.angles.theta.to_degrees()
            ));
        }
        match piles.last_mut() {
            Some(last) if isotropic && polar(group.angles) - polar(last.incidence) < SAME_THETA => {
                last.readings.push(readings);
                last.surfaces.push(surface);
            }
            _ => piles.push(Pile {
                incidence: group.angles,
                readings: vec![readings],
                surfaces: vec![surface],
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
    options: &BuildOptions,
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
    SliceSurface::new(readings, options.smooth)
        .ok_or_else(|| refused("no triangle".into(), "readings over the hemisphere"))
}

/// Incidence in the local frame; at azimuth pi when isotropic.
fn local_incidence(incidence: Angles, isotropic: bool) -> DVec3 {
    let theta = polar(incidence);
    let (s, c) = theta.sin_cos();
    if isotropic {
        DVec3::new(-s, 0.0, c)
    } else {
        DVec3::new(s * incidence.phi.cos(), s * incidence.phi.sin(), c)
    }
}
