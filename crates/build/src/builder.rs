//! From the slices of one side and component to an interpolated part.

use std::sync::Arc;

use gonio_geom::{Angles, Component, DVec3, Side};
use gonio_scan::Slice;
use rayon::prelude::*;

use crate::across::{Candidate, Order};
use crate::base::{Base, Fitting, Picked, Recipe, recipes, with_retro};
use crate::choice::{Contest, best};
use crate::data_driven::{BuildOptions, PartSummary};
use crate::error::BuildError;
use crate::hold_out::SliceError;
use crate::images::{Images, Symmetry};
use crate::incidence::Part;
use crate::leave_one_out::{Held, LooError};
use crate::local_error::LocalError;
use crate::node::{Node, Statistics};
use crate::plane::from_plane;
use crate::readings::Readings;
use crate::slice_surface::SliceSurface;
use crate::stated::PartErrors;
use crate::symmetry::{self, Incidence, SAME_THETA, half_measured, mirror_symmetric, polar};
use crate::unknowable;

/// Fewest readings of a slice.
const LEAST_READINGS: usize = 12;

/// Readings spread less than this (root mean square, in the stereographic plane) in some direction lie in one
/// scattering plane: about a degree.
const LEAST_EXTENT: f64 = 0.01;

/// Readings of an incidence that predictions of it are compared with; with axes, where there are more incidences, and those
/// of all incidences.
const HELD_READINGS: usize = 3000;
const HELD_WITH_AXES: usize = 1200;

/// Readings of an incidence that a base is fitted to, and about those of all incidences together.
const FIT_READINGS: usize = 700;
const FIT_ALL: usize = 8000;
const LEAST_FIT: usize = 150;

/// Where a base of one lobe comes no closer to the readings of a sample with axes (relative L1), two lobes are tried.
const ONE_LOBE: f64 = 0.02;

/// How many bases are tried across incidences, and how far behind the best one they may be (ratio of their errors).
const BASES: usize = 2;
const BEHIND: f64 = 2.0;

/// A lobe about the incidence is kept when it brings the base closer to the readings by this factor.
const RETRO_GAIN: f64 = 0.95;

/// A part and what is to be said of it.
pub(crate) struct Built {
    pub(crate) part: Part,
    /// The base that describes the slices best, if any.
    pub(crate) base: Option<Arc<Base>>,
    pub(crate) errors: PartErrors,
    pub(crate) local: Vec<LocalError>,
    pub(crate) summary: PartSummary,
    pub(crate) loo: Vec<LooError>,
    pub(crate) notes: Vec<String>,
}

/// The slices that make one node: one incidence, or several of one polar angle when isotropic.
struct Pile<'a> {
    incidence: Angles,
    slices: Vec<&'a Slice>,
    readings: Vec<Readings>,
    surfaces: Vec<SliceSurface>,
}

impl Pile<'_> {
    /// Whether it holds `slice`.
    fn holds(&self, slice: &Slice) -> bool {
        self.slices.iter().any(|s| std::ptr::eq(*s, slice))
    }

    /// The relative uncertainty that its readings share.
    fn common(&self) -> f64 {
        self.slices.iter().map(|s| s.u_common).fold(0.0, f64::max)
    }

    /// Some of its readings, by `importance` of BSDF and cosine.
    fn picked(&self, most: usize, importance: impl Fn(f64, f64) -> f64) -> Picked {
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
    fn peak_spacing(&self) -> Option<f64> {
        let each = self.surfaces.iter().zip(&self.readings);
        each.filter_map(|(s, r)| Picked::peak_spacing(&r.value, &s.solid_angles()))
            .reduce(f64::min)
    }

    /// Error of its mean slice between readings.
    fn slice_error(&self, bilateral: bool) -> SliceError {
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
        }
    }
}

/// The part of light from `side` in `component`; `None` when there is no reading of it. Slices of `copied` hold the same
/// readings.
pub(crate) fn part(
    slices: &[&Slice],
    copied: &[(&Slice, &Slice)],
    side: Side,
    component: Component,
    isotropic: bool,
    options: &BuildOptions,
) -> Result<Option<Built>, BuildError> {
    let mut notes = Vec::new();
    let mut piles = piles(slices, side, component, isotropic, &mut notes)?;
    if piles.is_empty() {
        return Ok(None);
    }
    let directions: Vec<DVec3> = piles
        .iter()
        .map(|p| local_incidence(p.incidence, isotropic))
        .collect();
    let compared = if isotropic { HELD_READINGS } else { HELD_WITH_AXES };
    let held: Vec<Picked> = piles
        .par_iter()
        .map(|p| p.picked(compared, |f, z| f * z))
        .collect();
    let fitting = {
        let most = if isotropic {
            FIT_READINGS
        } else {
            (FIT_ALL / piles.len()).clamp(LEAST_FIT, FIT_READINGS)
        };
        let readings = piles
            .par_iter()
            .map(|p| p.picked(most, |f, z| (f * z).cbrt().powi(2)));
        let spacing = piles
            .iter()
            .filter_map(Pile::peak_spacing)
            .fold(f64::INFINITY, f64::min);
        let spacing = if spacing.is_finite() { spacing } else { 0.0 };
        Fitting::new(component, directions.clone(), readings.collect(), spacing)
    };
    let bases = bases(&fitting, component, isotropic, &options.without)?;
    let first = bases.first().map(|(_, base)| Arc::clone(base));
    let base = first.as_ref();

    piles.par_iter_mut().zip(&directions).for_each(|(pile, &i)| {
        for (surface, readings) in pile.surfaces.iter_mut().zip(&pile.readings) {
            surface.fill(readings, options.smooth, base.map(|b| (Arc::clone(b), i)));
        }
    });
    let agree: Vec<bool> = piles
        .par_iter()
        .flat_map(|p| p.surfaces.par_iter().filter_map(mirror_symmetric))
        .collect();
    let bilateral = isotropic && !agree.is_empty() && 2 * agree.iter().filter(|a| **a).count() > agree.len();

    let slice_errors: Vec<SliceError> = piles.par_iter().map(|p| p.slice_error(bilateral)).collect();
    let symmetry = if isotropic {
        Symmetry::Isotropic
    } else {
        let slices: Vec<(DVec3, &SliceSurface)> = piles
            .iter()
            .zip(&directions)
            .flat_map(|(p, &i)| p.surfaces.iter().map(move |s| (i, s)))
            .collect();
        let known = slice_errors.iter().map(SliceError::total).sum::<f64>() / slice_errors.len() as f64;
        let (images, difference) = symmetry::images(&slices, 2.0 * known);
        if images != Images::None {
            notes.push(format!(
                "{side} {component}: slices agree with their images within {:.1} % (mean relative L1): taken as {}",
                100.0 * difference,
                images.name()
            ));
        }
        Symmetry::Axes(images)
    };

    // Copies share the number of the first of them.
    let mut groups: Vec<usize> = (0..piles.len()).collect();
    for b in 0..piles.len() {
        let copy = |a: &usize| {
            let both = |(x, y): &(&Slice, &Slice)| {
                (piles[*a].holds(x) && piles[b].holds(y)) || (piles[*a].holds(y) && piles[b].holds(x))
            };
            copied.iter().any(both)
        };
        if let Some(a) = (0..b).find(copy) {
            groups[b] = groups[a];
        }
    }
    let readings = piles.iter().flat_map(|p| &p.readings).map(Readings::len).sum();
    let all: Vec<Held> = piles
        .iter()
        .zip(&directions)
        .zip(held)
        .zip(groups)
        .map(|(((pile, &direction), readings), group)| {
            let statistics = Statistics::new(&pile.readings, &readings);
            let node = Node::new(
                pile.incidence,
                direction,
                &pile.surfaces,
                base,
                statistics,
                bilateral,
            );
            Held {
                node: Arc::new(node),
                readings,
                group,
            }
        })
        .collect();
    let local: Vec<LocalError> = piles
        .par_iter()
        .map(|p| LocalError::new(&p.surfaces, bilateral, p.common()))
        .collect();
    drop(piles);
    if all.len() == 1 {
        notes.push(format!(
            "{side} {component}: one incidence only, every other is extrapolated from it"
        ));
    }

    let contest = Contest::new(&all, symmetry, component, Some(&fitting), bases);
    let list: Vec<Candidate> = options
        .candidate
        .map_or(Candidate::ALL.to_vec(), |c| vec![c])
        .into_iter()
        .filter(|c| !c.method.needs_base() || !contest.bases.is_empty())
        .collect();
    let higher = if isotropic { Order::Cubic } else { Order::Quadratic };
    let within = contest.run(&list, options.candidate.is_none().then_some(higher), false);
    let beyond = contest.beyond(&list, within.get(best(&within)));
    let Some(chosen) = within.get(best(&within)) else {
        return Err(BuildError::NoBase {
            side,
            component,
            candidate: options.candidate.map_or("", |c| c.name()),
        });
    };
    if chosen.errors.is_empty() && options.candidate.is_none() {
        notes.push(format!(
            "{side} {component}: no incidence lies between others, so the interpolation was not chosen by its error \
             but taken as {}",
            chosen.candidate
        ));
    }
    let edge = beyond.as_ref().unwrap_or(chosen);
    let (rule, beyond_rule) = (contest.rule(chosen), contest.rule(edge));
    let loo = chosen.errors.clone();
    let mut scores: Vec<(Candidate, f64)> = Vec::new();
    for tried in within.iter().filter(|t| !t.errors.is_empty()) {
        let score = tried.errors.iter().map(|e| e.rel_l1).sum::<f64>() / tried.errors.len() as f64;
        match scores.iter_mut().find(|s| s.0 == tried.candidate) {
            Some(known) => known.1 = known.1.min(score),
            None => scores.push((tried.candidate, score)),
        }
    }
    let plain = !rule.candidate.method.needs_base() || !beyond_rule.candidate.method.needs_base();
    let errors = PartErrors::new(
        &all,
        slice_errors.clone(),
        symmetry,
        rule.candidate,
        &contest.folds,
        &chosen.errors,
        beyond.as_ref().map_or(&[], |t| &t.errors),
    );
    let nodes: Vec<Arc<Node>> = if plain && base.is_some() {
        all.iter().map(|h| Arc::new(h.node.with_bsdf())).collect()
    } else {
        all.iter().map(|h| Arc::clone(&h.node)).collect()
    };
    let summary = PartSummary {
        side,
        component,
        incidences: nodes.len(),
        readings,
        table_values: nodes.iter().map(|n| n.table_len()).sum(),
        slice_errors: all
            .iter()
            .zip(&slice_errors)
            .map(|(h, e)| (h.node.incidence, e.total()))
            .collect(),
        reciprocity: contest.reciprocity(),
        exchange: beyond_rule.exchange,
        bilateral,
        symmetry: symmetry.name(),
        candidate: rule.candidate,
        base: rule.base.as_ref().map(|b| b.name.clone()),
        beyond: beyond_rule.candidate,
        beyond_base: beyond_rule.base.as_ref().map(|b| b.name.clone()),
        scores,
    };
    let part = Part::new(nodes, symmetry, rule, beyond_rule);
    notes.extend(unknowable::notes(
        &format!("{side} {component}"),
        &all,
        &slice_errors,
        &part,
    ));
    Ok(Some(Built {
        part,
        base: first,
        errors,
        local,
        summary,
        loo,
        notes,
    }))
}

/// The bases to try, best first.
fn bases(
    fitting: &Fitting,
    component: Component,
    isotropic: bool,
    without: &[String],
) -> Result<Vec<(Recipe, Arc<Base>)>, BuildError> {
    let fitted = |recipe: Recipe| -> Option<(Recipe, Arc<Base>, f64)> {
        let base = fitting.fit(&recipe, None, |_| true)?;
        let error = fitting.error(&base, |_| true);
        error.is_finite().then(|| (recipe, Arc::new(base), error))
    };
    let all_fitted = |recipes: Vec<Recipe>| -> Vec<(Recipe, Arc<Base>, f64)> {
        let allowed = |r: &Recipe| {
            let mut names = r.model.parts.iter().map(|p| p.info().name);
            names.all(|name| !without.iter().any(|w| w == name))
        };
        recipes
            .into_par_iter()
            .filter(allowed)
            .filter_map(fitted)
            .collect()
    };
    let mut found = all_fitted(recipes(component, isotropic, false)?);
    found.sort_by(|a, b| a.2.total_cmp(&b.2));
    if !isotropic && found.first().is_none_or(|f| f.2 > ONE_LOBE) {
        found.extend(all_fitted(recipes(component, isotropic, true)?));
        found.sort_by(|a, b| a.2.total_cmp(&b.2));
    }
    if component == Component::Reflection
        && let Some((first, _, error)) = found.first()
        && let Some(retro) = fitted(with_retro(first))
        && retro.2 < RETRO_GAIN * error
    {
        found.insert(0, retro);
    }
    let most = found.first().map_or(0.0, |f| BEHIND * f.2);
    found.retain(|f| f.2 <= most);
    found.truncate(BASES);
    Ok(found
        .into_iter()
        .map(|(recipe, base, _)| (recipe, base))
        .collect())
}

fn piles<'a>(
    slices: &[&'a Slice],
    side: Side,
    component: Component,
    isotropic: bool,
    notes: &mut Vec<String>,
) -> Result<Vec<Pile<'a>>, BuildError> {
    let mut piles: Vec<Pile<'a>> = Vec::new();
    for group in Incidence::group(slices, side) {
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
