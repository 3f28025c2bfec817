//! From the slices of one side and component to an interpolated part.

use std::sync::Arc;

use gonio_geom::{Component, DVec3, Side};
use gonio_scan::Slice;
use rayon::prelude::*;

use crate::across::{Candidate, Order};
use crate::base::{Divisor, Fitting, Picked, bases, orders};
use crate::built::Built;
use crate::choice::{Contest, PEAK_TIE, TIE, best};
use crate::data_driven::{BuildOptions, PartSummary};
use crate::error::BuildError;
use crate::hold_out::SliceError;
use crate::images::{Images, Symmetry};
use crate::incidence::Part;
use crate::leave_one_out::Held;
use crate::local_error::LocalError;
use crate::node::{Node, Statistics};
use crate::peak;
use crate::pile::{OWN_LOBES, Pile, local_incidence, piles};
use crate::readings::Readings;
use crate::repeats::{self, Repeats};
use crate::slice_surface::SliceSurface;
use crate::stated::PartErrors;
use crate::symmetry::{self, mirror_symmetric, polar};
use crate::unknowable;
use crate::watch::Stage;

/// Readings of an incidence that predictions of it are compared with; with axes, where there are more incidences, and those
/// of all incidences.
const HELD_READINGS: usize = 3000;
const HELD_WITH_AXES: usize = 1200;

/// Readings of an incidence that a base is fitted to, and about those of all incidences together.
const FIT_READINGS: usize = 700;
const FIT_ALL: usize = 8000;
const LEAST_FIT: usize = 150;

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
    let piles = piles(slices, side, component, isotropic, &mut notes, &options.watch)?;
    if piles.is_empty() {
        return Ok(None);
    }
    let directions: Vec<DVec3> = piles
        .iter()
        .map(|p| local_incidence(p.incidence, isotropic))
        .collect();
    let job = Job {
        side,
        component,
        isotropic,
        options,
        groups: groups(&piles, copied),
        directions: &directions,
    };
    let radius = if isotropic {
        None
    } else {
        peak::radius(&piles, &directions)
    };
    let mut built = match radius.and_then(|r| Some((r, peak::split(&piles, &directions, r)?))) {
        None => job.build(piles, Share::All)?,
        Some((radius, (rest, within))) => {
            let mut rest = job.build(rest, Share::All)?;
            let nodes = rest.part.nodes().iter();
            let above = peak::above(within, nodes.map(|n| |s: DVec3| n.value(s)));
            let narrow = job.build(above, Share::Peak(rest.part.symmetry()))?;
            rest.add_peak(narrow, radius, &format!("{side} {component}"));
            rest
        }
    };
    notes.append(&mut built.notes);
    built.notes = notes;
    Ok(Some(built))
}

/// Copies share the number of the first of them.
fn groups(piles: &[Pile<'_>], copied: &[(&Slice, &Slice)]) -> Vec<usize> {
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
    groups
}

/// What of the light the piles hold.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Share {
    /// All of it, or what a peak leaves.
    All,
    /// The peak, of a sample of known symmetry.
    Peak(Symmetry),
}

/// What is the same for all shares of a part.
struct Job<'a> {
    side: Side,
    component: Component,
    isotropic: bool,
    options: &'a BuildOptions,
    groups: Vec<usize>,
    directions: &'a [DVec3],
}

impl Job<'_> {
    fn build(&self, mut piles: Vec<Pile<'_>>, share: Share) -> Result<Built, BuildError> {
        let Job {
            side,
            component,
            isotropic,
            options,
            directions,
            ..
        } = *self;
        let mut notes = Vec::new();
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
            // Without axes bases stay as they were judged: bounds on widths change what is taken past the last incidence.
            let spacing = if spacing.is_finite() && !isotropic {
                spacing
            } else {
                0.0
            };
            Fitting::new(component, directions.to_vec(), readings.collect(), spacing)
        };
        let watch = &options.watch;
        let bases = bases(&fitting, component, isotropic, &options.without, watch)?;
        let orders = if share == Share::All && isotropic && component == Component::Reflection {
            orders(&fitting, &bases)
        } else {
            Vec::new()
        };
        let first = bases.first().map(|(_, base)| Arc::clone(base));
        let base = first.as_ref();

        watch.stage(Stage::Slices, 2 * piles.len())?;
        piles.par_iter_mut().zip(directions).for_each(|(pile, &i)| {
            if watch.stopped() {
                return;
            }
            for (surface, readings) in pile.surfaces.iter_mut().zip(&pile.readings) {
                surface.fill(
                    readings,
                    options.smooth,
                    base.map(|b| Divisor::Joint(Arc::clone(b), i)),
                );
            }
            watch.step();
        });
        watch.check()?;
        let agree: Vec<bool> = piles
            .par_iter()
            .flat_map(|p| p.surfaces.par_iter().filter_map(mirror_symmetric))
            .collect();
        let bilateral =
            isotropic && !agree.is_empty() && 2 * agree.iter().filter(|a| **a).count() > agree.len();

        let mut slice_errors: Vec<SliceError> = piles
            .par_iter_mut()
            .zip(directions)
            .map(|(pile, &i)| {
                if watch.stopped() {
                    return SliceError::default();
                }
                let joint = base.map(|b| Divisor::Joint(Arc::clone(b), i));
                let error = pile.slice_error(bilateral);
                watch.step();
                if isotropic || error.gap < OWN_LOBES {
                    return error;
                }
                pile.by_own_lobes(options.smooth, joint, error)
            })
            .collect();
        watch.stage(Stage::Symmetry, 1)?;
        if share == Share::All {
            let repeats: Vec<Option<Repeats>> = piles
                .iter()
                .zip(directions)
                .map(|(pile, &i)| {
                    let joint = base.map(|b| Divisor::Joint(Arc::clone(b), i));
                    Repeats::of(pile, (side, component), isotropic, options.smooth, joint.as_ref())
                })
                .collect();
            notes.extend(repeats::note(&format!("{side} {component}"), &repeats));
            for (error, repeats) in slice_errors.iter_mut().zip(&repeats) {
                error.repeats = repeats.map_or(0.0, |r| r.of_mean());
            }
        }
        let symmetry = if let Share::Peak(known) = share {
            known
        } else if isotropic {
            Symmetry::Isotropic
        } else {
            let slices: Vec<(DVec3, &SliceSurface)> = piles
                .iter()
                .zip(directions)
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

        let readings = piles.iter().flat_map(|p| &p.readings).map(Readings::len).sum();
        watch.stage(Stage::Resampling, piles.len())?;
        let all: Vec<Held> = piles
            .iter()
            .zip(directions)
            .zip(held)
            .zip(&self.groups)
            .map(|(((pile, &direction), readings), &group)| {
                watch.check()?;
                let statistics = Statistics::new(&pile.readings, &readings);
                let node = Node::new(
                    pile.incidence,
                    direction,
                    &pile.surfaces,
                    match &pile.own {
                        Some(own) => Some(Divisor::Own(Arc::clone(own))),
                        None => base.map(|b| Divisor::Joint(Arc::clone(b), direction)),
                    },
                    statistics,
                    bilateral,
                );
                watch.step();
                Ok(Held {
                    node: Arc::new(node),
                    readings,
                    group,
                })
            })
            .collect::<Result<_, BuildError>>()?;
        let local: Vec<LocalError> = piles
            .par_iter()
            .map(|p| LocalError::new(&p.surfaces, bilateral, p.common()))
            .collect();
        let spacings: Vec<f64> = piles.par_iter().map(Pile::spacing).collect();
        drop(piles);
        if all.len() == 1 {
            notes.push(format!(
                "{side} {component}: one incidence only, every other is extrapolated from it"
            ));
        }

        // The peak is nowhere judged by more than the light it is.
        let light: Vec<f64> = all.iter().map(|h| h.readings.albedo().max(0.0)).collect();
        let units = match share {
            Share::All => vec![1.0; all.len()],
            Share::Peak(_) => light.clone(),
        };
        let contest = Contest::new(
            &all,
            symmetry,
            component,
            Some(&fitting),
            (bases, &orders),
            &units,
            watch,
        )?;
        let list: Vec<Candidate> = options
            .candidate
            .map_or(Candidate::ALL.to_vec(), |c| vec![c])
            .into_iter()
            .filter(|c| !c.method.needs_base() || !contest.bases.is_empty())
            .filter(|c| !c.method.is_last_resort() || share == Share::All)
            .collect();
        let higher = if isotropic { Order::Cubic } else { Order::Quadratic };
        let within = contest.run(&list, options.candidate.is_none().then_some(higher), false)?;
        let tie = if share == Share::All { TIE } else { PEAK_TIE };
        let beyond = contest.beyond(&list, within.get(best(&within, tie)))?;
        watch.stage(Stage::Choice, 1)?;
        let Some(chosen) = within.get(best(&within, tie)) else {
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
            (&units, light, share != Share::All),
            (
                &chosen.errors,
                &contest.wider(chosen),
                beyond.as_ref().map_or(&[], |t| &t.errors),
            ),
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
            spacings: spacings.clone(),
            reciprocity: contest.reciprocity(),
            exchange: beyond_rule.exchange,
            bilateral,
            symmetry: symmetry.name(),
            candidate: rule.candidate,
            base: rule.base.as_ref().map(|b| b.name.clone()),
            beyond: beyond_rule.candidate,
            beyond_base: beyond_rule.base.as_ref().map(|b| b.name.clone()),
            scores,
            peak: None,
        };
        let part = Part::new(nodes, symmetry, rule, beyond_rule);
        if share == Share::All {
            let label = format!("{side} {component}");
            notes.extend(unknowable::notes(&label, &all, (&slice_errors, &spacings), &part));
            if let Some(last) = all.last()
                && isotropic
            {
                notes.extend(unknowable::last_gap(&label, &loo, polar(last.node.incidence)));
            }
        }
        Ok(Built {
            part,
            base: first,
            errors,
            local,
            summary,
            loo,
            notes,
        })
    }
}
