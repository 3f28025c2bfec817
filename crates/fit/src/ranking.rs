//! The order of models by what the readings say of them, and that order in words.

use std::cmp::Ordering;

use crate::estimate::Open;
use crate::result::Fit;
use crate::select::HeldOut;

/// Held-out errors closer than this ratio count as equal; then the criterion of Akaike decides.
const TIE: f64 = 1.01;
/// A held-out error below this is none: no goniophotometer reads so well, and what is left is the arithmetic's.
const RESOLVED: f64 = 1e-4;
/// Criteria of Akaike closer than this, and held-out errors closer than this ratio, are those of models that say the same
/// of the readings.
const SAME: f64 = 0.01;
const SAME_RATIO: f64 = 1.0001;
/// A model with flaws is passed over for one without whose error is at most this many times its own: errors differ from
/// one incidence to the next by far more.
const MARGIN: f64 = 1.1;
/// The same of criteria of Akaike, where there are no errors: up to 2 both models have substantial support
/// \[BurnhamAnderson2002\].
const MARGIN_AICC: f64 = 2.0;
/// Models that are named one by one in a sentence.
const NAMED: usize = 3;

/// A model in a comparison.
#[derive(Clone, Debug)]
pub struct Ranked {
    /// Its fit to all readings.
    pub fit: Fit,
    /// Errors at the incidences, each left out in turn; empty with a single incidence.
    pub held_out: Vec<HeldOut>,
    /// Mean of the errors; NaN without any.
    pub held_out_error: f64,
}

impl Ranked {
    /// The incidence that the others predict worst.
    pub fn worst(&self) -> Option<&HeldOut> {
        self.held_out
            .iter()
            .max_by(|a, b| a.relative_l1.total_cmp(&b.relative_l1))
    }

    /// What speaks against the model whatever its error: parameters that the readings leave open, and an albedo that
    /// exceeds 1 by more than its expanded uncertainty. Empty for a sound model.
    pub fn flaws(&self) -> Vec<String> {
        let names = |wanted: &[Open]| -> Vec<String> {
            let open = |o: Option<Open>| o.is_some_and(|o| wanted.contains(&o));
            let found = self.fit.estimates.iter().filter(|e| open(e.open));
            let one = self.fit.channels.len() == 1;
            found
                .map(|e| if one { e.name.clone() } else { e.label() })
                .collect()
        };
        let mut flaws = Vec::new();
        let left_open = names(&[Open::Undetermined, Open::Vague]);
        if !left_open.is_empty() {
            flaws.push(format!("the readings leave {} open", listed(&left_open)));
        }
        let at_end = names(&[Open::Range]);
        if !at_end.is_empty() {
            let verb = if at_end.len() == 1 { "ends" } else { "end" };
            flaws.push(format!("{} {verb} at a bound", listed(&at_end)));
        }
        if let Some(top) = self.fit.albedo.filter(|a| a.exceeds_one()) {
            flaws.push(format!("it scatters {top}"));
        }
        flaws
    }

    /// The error that counts.
    fn error(&self) -> f64 {
        if self.held_out_error < RESOLVED {
            RESOLVED
        } else {
            self.held_out_error
        }
    }

    /// Order by Akaike's criterion.
    fn by_criterion(&self, other: &Self) -> Ordering {
        self.fit.aicc.total_cmp(&other.fit.aicc)
    }

    /// Whether both say the same of these readings.
    fn is_same(&self, other: &Self) -> bool {
        let (a, b) = (self.error(), other.error());
        (self.fit.aicc - other.fit.aicc).abs() < SAME
            && (self.held_out.is_empty() || a.max(b) <= SAME_RATIO * a.min(b))
    }

    /// Whether both are sums of the same functions of direction.
    fn has_parts_of(&self, other: &Self) -> bool {
        let parts = |r: &Self| -> Vec<&str> { r.fit.model.parts.iter().map(|p| p.info().name).collect() };
        parts(self) == parts(other)
    }

    /// Whether the model is not much worse than `leader`.
    fn is_near(&self, leader: &Self) -> bool {
        if leader.held_out.is_empty() {
            self.fit.aicc <= leader.fit.aicc + MARGIN_AICC
        } else {
            self.error() <= MARGIN * leader.error()
        }
    }
}

/// Puts the best model first; `names` are those of the fit models in their own order. Returns the models with smaller
/// errors that it was preferred to, and why.
pub(crate) fn order(ranking: &mut [Ranked], names: &[String]) -> Vec<(String, String)> {
    ranking.sort_by(|a, b| a.error().total_cmp(&b.error()).then(a.by_criterion(b)));
    let first = ranking[0].error();
    let ties = ranking.iter().take_while(|r| r.error() <= TIE * first).count();
    ranking[..ties].sort_by(Ranked::by_criterion);
    gather_same(ranking, names);
    let sound = |r: &Ranked| r.flaws().is_empty() && r.is_near(&ranking[0]);
    let Some(next) = ranking.iter().position(sound) else {
        return Vec::new();
    };
    let limit = TIE * ranking[next].error();
    let best = (next..ranking.len())
        // Without errors the limit is no number, and nothing exceeds it.
        .filter(|&k| sound(&ranking[k]) && ranking[k].error().partial_cmp(&limit) != Some(Ordering::Greater))
        .min_by(|&a, &b| {
            let (a, b) = (&ranking[a], &ranking[b]);
            if a.is_same(b) {
                Ordering::Equal
            } else {
                a.by_criterion(b)
            }
        })
        .unwrap_or(next);
    let passed_over = ranking[..best]
        .iter()
        .map(|r| (r.fit.model.name.clone(), r.flaws().join("; ")))
        .filter(|(_, flaws)| !flaws.is_empty())
        .collect();
    ranking[..=best].rotate_right(1);
    passed_over
}

/// Moves models that say the same of the readings behind the first of them, those that a user would look for first in front: no
/// flaws, few parameters, early among `names`. Rounding alone would order them otherwise.
fn gather_same(ranking: &mut [Ranked], names: &[String]) {
    let place = |r: &Ranked| names.iter().position(|n| *n == r.fit.model.name);
    let key = |r: &Ranked| {
        (
            r.flaws().len(),
            r.fit.estimates.len(),
            place(r).unwrap_or(names.len()),
            r.fit.model.name.clone(),
        )
    };
    let mut begin = 0;
    while begin < ranking.len() {
        let mut end = begin + 1;
        for k in begin + 1..ranking.len() {
            if ranking[begin].is_same(&ranking[k]) {
                ranking[end..=k].rotate_right(1);
                end += 1;
            }
        }
        ranking[begin..end].sort_by_cached_key(key);
        begin = end;
    }
}

/// `a, b and c`.
fn listed(names: &[String]) -> String {
    match names {
        [] => String::new(),
        [only] => only.clone(),
        [rest @ .., last] => format!("{} and {last}", rest.join(", ")),
    }
}

/// Held-out error above which a model is no description of the sample: half of the light is not where it says.
const UNDESCRIBED: f64 = 0.5;

/// What the comparison says.
pub(crate) fn sentence(ranking: &[Ranked], passed_over: &[(String, String)]) -> String {
    let best = &ranking[0];
    let name = &best.fit.model.name;
    let undescribed = best.held_out_error > UNDESCRIBED;
    let mut text = match best.worst() {
        Some(worst) if undescribed => format!(
            "no model describes the sample; {name} comes nearest, and still predicts incidences that it was not fitted to \
             with an error of {} (relative L1), worst at theta_i = {:.1} deg ({}). A data-driven model (gonio build) keeps \
             what was measured",
            percent(best.held_out_error),
            worst.incidence.theta.to_degrees(),
            percent(worst.relative_l1),
        ),
        Some(worst) => format!(
            "{name} {}: it predicts incidences that it was not fitted to with an error of {} (relative L1), worst at \
             theta_i = {:.1} deg ({})",
            if passed_over.is_empty() {
                "describes the sample best"
            } else {
                "describes the sample best of the models that are determined by the readings and keep energy"
            },
            percent(best.held_out_error),
            worst.incidence.theta.to_degrees(),
            percent(worst.relative_l1),
        ),
        None => format!(
            "{name} has the lowest information criterion{}; with a single incidence nothing shows whether it holds at others",
            if passed_over.is_empty() {
                ""
            } else {
                " of the models that are determined by the readings and keep energy"
            },
        ),
    };
    let same = |alike: bool| -> Vec<String> {
        ranking[1..]
            .iter()
            .filter(|r| r.is_same(best) && r.has_parts_of(best) == alike)
            .map(|r| r.fit.model.name.clone())
            .collect()
    };
    let (alike, others) = (same(true), same(false));
    if !alike.is_empty() {
        let verb = if alike.len() == 1 { "is" } else { "are" };
        text += &format!(
            "; {} {verb} the same function in other parameters",
            listed(&alike)
        );
    }
    if !others.is_empty() {
        text += &format!("; {} fit these readings exactly as well", others.join(", "));
    }
    if !passed_over.is_empty() {
        text += &format!("; passed over: {}", passed(ranking, passed_over));
    }
    let is_next = |r: &&Ranked| !r.is_same(best) && passed_over.iter().all(|(n, _)| *n != r.fit.model.name);
    match ranking[1..].iter().find(is_next) {
        Some(next) if best.held_out.is_empty() => {
            text += &format!(
                "; next is {} ({:+.1} in AICc)",
                next.fit.model.name,
                next.fit.aicc - best.fit.aicc
            );
        }
        Some(next) if next.error() <= best.error() * TIE && next.fit.aicc > best.fit.aicc => {
            text += &format!(
                "; {} does as well ({}) but has the higher information criterion ({:+.1} in AICc)",
                next.fit.model.name,
                percent(next.held_out_error),
                next.fit.aicc - best.fit.aicc
            );
        }
        Some(next) => {
            text += &format!(
                "; next is {} ({})",
                next.fit.model.name,
                percent(next.held_out_error)
            );
        }
        None => {}
    }
    let flaws = best.flaws();
    if !flaws.is_empty() {
        text += &format!(
            ". Beware: {}; no model of similar error is free of such flaws",
            flaws.join("; ")
        );
    }
    if best.fit.warns("misfit") && !undescribed {
        text += ". Even so its residuals exceed the noise: a data-driven model will be closer";
    }
    text + "."
}

/// The models passed over with what speaks against them, the first few by name.
fn passed(ranking: &[Ranked], passed_over: &[(String, String)]) -> String {
    let error = |name: &str| ranking.iter().find(|r| r.fit.model.name == name);
    let mut parts: Vec<String> = passed_over
        .iter()
        .take(NAMED)
        .map(|(name, flaws)| match error(name) {
            Some(r) if r.held_out_error.is_finite() => {
                format!("{name} ({}): {flaws}", percent(r.held_out_error))
            }
            _ => format!("{name}: {flaws}"),
        })
        .collect();
    if passed_over.len() > NAMED {
        parts.push(format!("{} more", passed_over.len() - NAMED));
    }
    parts.join(", ")
}

fn percent(error: f64) -> String {
    format!("{:.1} %", 100.0 * error)
}

#[cfg(test)]
#[path = "ranking_tests.rs"]
mod tests;
