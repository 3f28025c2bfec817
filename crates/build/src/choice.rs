//! Which way of interpolating across incidences predicts left-out incidences best, and with which base.

use std::sync::Arc;

use gonio_geom::Component;
use rayon::prelude::*;

use crate::across::{Candidate, Frame, Method, Order};
use crate::base::{Base, Fitting, Recipe};
use crate::error::BuildError;
use crate::images::Symmetry;
use crate::incidence::Rule;
use crate::leave_one_out::{Fold, Held, LooError, error, folds};
use crate::node::Node;
use crate::reciprocity::{self, RECIPROCAL};
use crate::watch::{Stage, Watch};

/// A candidate whose worst fold is worse than this factor times the least worst fold is not chosen.
const WORST: f64 = 1.5;

/// Candidates whose mean errors lie closer than this ratio are tied; the first in order is taken.
pub(crate) const TIE: f64 = 1.01;

/// The same where one incidence only could be left out: the order of candidates there says little of another incidence.
const TIE_OF_ONE: f64 = 1.2;

/// The same for a narrow peak: its amplitude falls over decades, which ratios to a base follow better than incidences left out
/// can tell.
pub(crate) const PEAK_TIE: f64 = 1.1;

/// Share of the error of a choice without a base that one with a base must stay below to take over past the data.
const CLEARLY: f64 = 1.0 / 3.0;
/// Exchange of source and receiver is used where it lowers the error by this factor.
const GAIN: f64 = 0.95;

/// Lobes are followed, and light is displaced, where no other candidate has a smaller mean error.
const WELL: f64 = 0.03;

/// How many of the linear candidates are tried with a higher order too.
const HIGHER: usize = 2;
const HIGHER_WITH_AXES: usize = 8;

/// A base to try: fitted to everything, and to what each fold keeps.
#[derive(Debug)]
pub(crate) struct Fitted {
    pub(crate) whole: Arc<Base>,
    folds: Vec<Option<Arc<Base>>>,
}

/// What the choice is made of.
pub(crate) struct Contest<'a> {
    pub(crate) all: &'a [Held],
    pub(crate) symmetry: Symmetry,
    pub(crate) component: Component,
    pub(crate) bases: Vec<Fitted>,
    pub(crate) folds: Vec<Fold>,
    /// What the relative error of each incidence counts.
    units: &'a [f64],
    watch: &'a Watch,
}

/// A candidate, its base (a position in [`Contest::bases`]), and its errors.
#[derive(Clone, Debug)]
pub(crate) struct Tried {
    pub(crate) candidate: Candidate,
    base: Option<usize>,
    /// Whether source and receiver are exchanged past the measured incidences.
    pub(crate) exchange: bool,
    pub(crate) errors: Vec<LooError>,
    /// What each of them counts.
    units: Vec<f64>,
}

impl Tried {
    /// Mean error against the smoothed slices.
    pub(crate) fn mean(&self) -> f64 {
        self.each().sum::<f64>() / self.units.iter().sum::<f64>().max(f64::MIN_POSITIVE)
    }

    fn worst(&self) -> f64 {
        self.each().fold(0.0, f64::max)
    }

    fn each(&self) -> impl Iterator<Item = f64> {
        self.errors
            .iter()
            .zip(&self.units)
            .map(|(e, u)| e.rel_l1_smooth * u)
    }
}

impl<'a> Contest<'a> {
    /// Fits the bases in every fold, and expansions of the given orders.
    pub(crate) fn new(
        all: &'a [Held],
        symmetry: Symmetry,
        component: Component,
        fitting: Option<&Fitting>,
        (bases, orders): (Vec<(Recipe, Arc<Base>)>, &[usize]),
        units: &'a [f64],
        watch: &'a Watch,
    ) -> Result<Self, BuildError> {
        let folds = folds(all, symmetry);
        watch.stage(Stage::Refits, bases.len() * folds.len())?;
        let expansions = orders.iter().filter_map(|&order| {
            let fitting = fitting?;
            let kept = |fold: &Fold| fitting.expansion(order, |k| fold.kept.contains(&k)).map(Arc::new);
            Some(Fitted {
                whole: Arc::new(fitting.expansion(order, |_| true)?),
                folds: folds.iter().map(kept).collect(),
            })
        });
        let expansions: Vec<Fitted> = expansions.collect();
        let mut bases: Vec<Fitted> = bases
            .into_iter()
            .map(|(recipe, whole)| Fitted {
                whole: Arc::clone(&whole),
                folds: folds
                    .par_iter()
                    .map(|fold| {
                        if watch.stopped() {
                            return None;
                        }
                        watch.step();
                        // With axes there are many incidences and few of them are left out: the minimum hardly moves.
                        let known = (!symmetry.is_isotropic()).then(|| whole.values());
                        let base = fitting?.fit(&recipe, known.as_deref(), |k| fold.kept.contains(&k))?;
                        Some(Arc::new(base))
                    })
                    .collect(),
            })
            .collect();
        bases.extend(expansions);
        watch.check()?;
        Ok(Contest {
            all,
            symmetry,
            component,
            bases,
            folds,
            units,
            watch,
        })
    }

    /// Errors of one candidate in the folds between incidences, or in those beyond them; none where a base could not
    /// be fitted to one of them.
    fn tried(
        &self,
        candidate: Candidate,
        base: Option<usize>,
        beyond: bool,
        exchange: bool,
    ) -> Option<Tried> {
        let folds: Vec<usize> = (0..self.folds.len())
            .filter(|&f| self.folds[f].beyond == beyond)
            .collect();
        let units = folds
            .iter()
            .map(|&f| self.units[self.folds[f].left_out])
            .collect();
        let errors = folds.into_iter().map(|f| {
            if self.watch.stopped() {
                return None;
            }
            let base = match base {
                Some(b) => Some(self.bases[b].folds[f].as_ref()?),
                None => None,
            };
            let fold = &self.folds[f];
            Some(error(
                self.all,
                fold,
                self.symmetry,
                self.component,
                candidate,
                base,
                exchange,
            ))
        });
        Some(Tried {
            candidate,
            base,
            exchange,
            errors: errors.collect::<Option<Vec<_>>>()?,
            units,
        })
    }

    /// Every candidate of `list` with every base it can use, and the best ones of a `higher` order.
    pub(crate) fn run(
        &self,
        list: &[Candidate],
        higher: Option<Order>,
        beyond: bool,
    ) -> Result<Vec<Tried>, BuildError> {
        let mut tried: Vec<Tried> = Vec::new();
        self.watch
            .stage(Stage::LeaveOneOut, list.len() + usize::from(higher.is_some()))?;
        for &candidate in list {
            self.watch.check()?;
            self.watch.step();
            if candidate.method.is_last_resort() {
                // Where nothing else predicts well; never past the data. Lobes are followed over axes only.
                let least = tried.iter().filter(|t| !t.errors.is_empty()).map(Tried::mean);
                let well = least.fold(f64::INFINITY, f64::min) < WELL && list.len() > 1;
                let tracked = candidate.method == Method::Tracked;
                if well || beyond || (tracked && self.symmetry.is_isotropic()) {
                    continue;
                }
            }
            let bases: Vec<Option<usize>> = if candidate.method.needs_base() {
                let still = candidate.method == Method::Ratio(Frame::Still) && !beyond;
                let able = |b: &usize| still || !self.bases[*b].whole.is_expansion();
                (0..self.bases.len()).filter(able).map(Some).collect()
            } else {
                vec![None]
            };
            tried.extend(
                bases
                    .into_iter()
                    .filter_map(|b| self.tried(candidate, b, beyond, false)),
            );
        }
        if let Some(order) = higher {
            let mut places: Vec<usize> = (0..tried.len())
                .filter(|&k| !tried[k].errors.is_empty() && !tried[k].candidate.method.is_last_resort())
                .collect();
            places.sort_by(|&a, &b| tried[a].mean().total_cmp(&tried[b].mean()));
            let more: Vec<Tried> = places
                .iter()
                .take(if self.symmetry.is_isotropic() {
                    HIGHER
                } else {
                    HIGHER_WITH_AXES
                })
                .filter_map(|&k| {
                    self.tried(tried[k].candidate.with_order(order), tried[k].base, beyond, false)
                })
                .collect();
            tried.extend(more);
            self.watch.step();
        }
        self.watch.check()?;
        Ok(tried)
    }

    /// Errors of what was tried in gaps twice as wide: the neighbours of each incidence left out are left out too. For
    /// isotropic samples; empty where there are too few incidences.
    pub(crate) fn wider(&self, tried: &Tried) -> Vec<(Fold, LooError)> {
        let last = self.all.len().saturating_sub(1);
        let inner = |f: &Fold| !f.beyond && f.left_out >= 2 && f.left_out + 2 <= last;
        let folds = self.folds.iter().enumerate().filter(|(_, f)| inner(f));
        folds
            .filter(|_| self.symmetry.is_isotropic())
            .filter_map(|(n, fold)| {
                let base = match tried.base {
                    Some(b) => Some(self.bases[b].folds[n].as_ref()?),
                    None => None,
                };
                let mut wide = fold.clone();
                wide.kept.retain(|k| k.abs_diff(fold.left_out) > 1);
                let found = error(
                    self.all,
                    &wide,
                    self.symmetry,
                    self.component,
                    tried.candidate,
                    base,
                    false,
                );
                Some((wide, found))
            })
            .collect()
    }

    /// The rule of what was tried.
    pub(crate) fn rule(&self, tried: &Tried) -> Rule {
        Rule {
            candidate: tried.candidate,
            base: tried.base.map(|b| Arc::clone(&self.bases[b].whole)),
            exchange: tried.exchange,
        }
    }

    /// Relative L1 difference of exchanged readings of reflection.
    pub(crate) fn reciprocity(&self) -> Option<f64> {
        let nodes: Vec<&Node> = self.all.iter().map(|h| &*h.node).collect();
        match self.component {
            Component::Reflection => reciprocity::score(&nodes, self.symmetry.is_isotropic()),
            Component::Transmission => None,
        }
    }

    /// The rule past the measured incidences: the best of `list`, with source and receiver exchanged where the slices
    /// agree under exchange and the error at the edge is less so. `None` when no incidence can be left out there.
    ///
    /// Where `within`, the choice between incidences, needs no base or an expansion, the sample has no lobes to speak of, and the two
    /// incidences at the edge say little of what comes after them: a base has to leave a third of the error there to take over.
    pub(crate) fn beyond(
        &self,
        list: &[Candidate],
        within: Option<&Tried>,
    ) -> Result<Option<Tried>, BuildError> {
        let tried = self.run(list, None, true)?;
        Ok(self.best_beyond(tried, within))
    }

    fn best_beyond(&self, mut tried: Vec<Tried>, within: Option<&Tried>) -> Option<Tried> {
        let mut first = best(&tried, TIE);
        let same = within.and_then(|w| {
            let method = match w.base {
                None => w.candidate.method,
                Some(b) if self.bases[b].whole.is_expansion() => Method::Plain(Frame::Still),
                Some(_) => return None,
            };
            tried
                .iter()
                .position(|t| t.candidate.method == method && t.base.is_none() && !t.errors.is_empty())
        });
        if let Some(same) = same
            && tried[first].mean() > CLEARLY * tried[same].mean()
        {
            first = same;
        }
        if tried.get(first)?.errors.is_empty() {
            return None;
        }
        let direct = tried.swap_remove(first);
        let agree = self.reciprocity().is_some_and(|s| s <= RECIPROCAL);
        let exchanged = agree
            .then(|| self.tried(direct.candidate, direct.base, true, true))
            .flatten();
        Some(match exchanged {
            Some(e) if e.mean() < GAIN * direct.mean() => e,
            _ => direct,
        })
    }
}

/// The position of the best: the least mean error of those whose worst fold is not much worse than need be, the first of a
/// tie (ratio of mean errors). The first of all when there are no errors.
pub(crate) fn best(tried: &[Tried], tie: f64) -> usize {
    let scored: Vec<usize> = (0..tried.len())
        .filter(|&k| !tried[k].errors.is_empty())
        .collect();
    let worst = scored
        .iter()
        .map(|&k| tried[k].worst())
        .fold(f64::INFINITY, f64::min);
    let allowed: Vec<usize> = scored
        .into_iter()
        .filter(|&k| tried[k].worst() <= WORST * worst)
        .collect();
    let least = allowed
        .iter()
        .map(|&k| tried[k].mean())
        .fold(f64::INFINITY, f64::min);
    let tie = match allowed.first() {
        Some(&k) if tried[k].errors.len() == 1 => TIE_OF_ONE.max(tie),
        _ => tie,
    };
    // Linear ones first, then in the order of the list.
    let rank = |k: &usize| {
        let Candidate { method, order } = tried[*k].candidate;
        let place = Candidate::ALL.iter().position(|c| c.method == method);
        (order != Order::Linear, place)
    };
    allowed
        .into_iter()
        .filter(|&k| tried[k].mean() <= tie * least)
        .min_by_key(rank)
        .unwrap_or(0)
}
