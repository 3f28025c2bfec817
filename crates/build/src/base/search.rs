//! Which bases are tried across incidences.

use std::sync::Arc;

use gonio_geom::Component;
use rayon::prelude::*;

use super::recipes::{recipes, with_retro};
use super::{Base, Fitting, Recipe};
use crate::error::BuildError;
use crate::watch::{Stage, Watch};

/// Where a base of one lobe comes no closer to the readings of a sample with axes (relative L1), two lobes are tried.
const ONE_LOBE: f64 = 0.02;

/// How many bases are tried across incidences, and how far behind the best one they may be (ratio of their errors).
const BASES: usize = 2;
const BEHIND: f64 = 2.0;

/// A lobe about the incidence is kept when it brings the base closer to the readings by this factor.
const RETRO_GAIN: f64 = 0.95;

/// The bases to try, best first.
pub(crate) fn bases(
    fitting: &Fitting,
    component: Component,
    isotropic: bool,
    without: &[String],
    watch: &Watch,
) -> Result<Vec<(Recipe, Arc<Base>)>, BuildError> {
    let judged = |base: Base| {
        let error = fitting.error(&base, |_| true);
        error.is_finite().then(|| (Arc::new(base), error))
    };
    let fitted = |recipe: Recipe| -> Option<Tried> {
        if watch.stopped() {
            return None;
        }
        let (base, error) = judged(fitting.fit(&recipe, None, |_| true)?)?;
        Some(Tried { recipe, base, error })
    };
    let allowed = |r: &Recipe| {
        let mut names = r.model.parts.iter().map(|p| p.info().name);
        names.all(|name| !without.iter().any(|w| w == name))
    };
    // From a base that lacks the last lobe only, where there is one.
    let grown = |recipe: Recipe, found: &[Tried]| -> Option<Tried> {
        let lacks = |t: &&Tried| {
            let names = |r: &Recipe| -> Vec<&str> { r.model.parts.iter().map(|p| p.info().name).collect() };
            let (own, other) = (names(&recipe), names(&t.recipe));
            other.len() + 1 == own.len() && own.starts_with(&other)
        };
        let Some(less) = found.iter().find(lacks) else {
            return fitted(recipe);
        };
        let starts = recipe.starts(&less.base.values());
        let fits = starts
            .par_iter()
            .filter(|_| !watch.stopped())
            .filter_map(|s| judged(fitting.fit(&recipe, Some(s), |_| true)?));
        let (base, error) = fits.min_by(|a, b| a.1.total_cmp(&b.1))?;
        Some(Tried { recipe, base, error })
    };
    let first: Vec<Recipe> = recipes(component, isotropic, false)?;
    watch.stage(Stage::Bases, first.len())?;
    let mut found: Vec<Tried> = first
        .into_par_iter()
        .filter(allowed)
        .filter_map(|recipe| {
            let tried = fitted(recipe);
            watch.step();
            tried
        })
        .collect();
    watch.check()?;
    found.sort_by(|a, b| a.error.total_cmp(&b.error));
    if !isotropic && found.first().is_none_or(|f| f.error > ONE_LOBE) {
        let more: Vec<Recipe> = recipes(component, isotropic, true)?;
        let more: Vec<Tried> = more
            .into_par_iter()
            .filter(allowed)
            .filter_map(|r| grown(r, &found))
            .collect();
        found.extend(more);
        found.sort_by(|a, b| a.error.total_cmp(&b.error));
    }
    if component == Component::Reflection
        && let Some(first) = found.first()
    {
        // Without axes the lobe of facets: a round one was seen to run away past the last incidence of matte samples.
        let [facets, round] = with_retro(&first.recipe);
        let kinds = if isotropic {
            vec![facets]
        } else {
            vec![facets, round]
        };
        let retro = kinds
            .into_par_iter()
            .filter_map(|r| if isotropic { fitted(r) } else { grown(r, &found) })
            .min_by(|a, b| a.error.total_cmp(&b.error));
        if let Some(retro) = retro.filter(|r| r.error < RETRO_GAIN * first.error) {
            found.insert(0, retro);
        }
    }
    let most = found.first().map_or(0.0, |f| BEHIND * f.error);
    found.retain(|f| f.error <= most);
    found.truncate(BASES);
    Ok(found.into_iter().map(|t| (t.recipe, t.base)).collect())
}

/// A base that was fitted.
struct Tried {
    recipe: Recipe,
    base: Arc<Base>,
    error: f64,
}

/// Orders of expansions that are tried for matte samples.
const ORDERS: [usize; 3] = [4, 6, 8];

/// Orders of the expansions to try: those closer to the readings than the best of `bases`, which has no lobe to describe then.
pub(crate) fn orders(fitting: &Fitting, bases: &[(Recipe, Arc<Base>)]) -> Vec<usize> {
    let Some((_, base)) = bases.first() else {
        return Vec::new();
    };
    let least = fitting.error(base, |_| true);
    let close = |order: &usize| {
        let found = fitting.expansion(*order, |_| true);
        found.is_some_and(|e| fitting.error(&e, |_| true) < least)
    };
    ORDERS.into_iter().filter(close).collect()
}
