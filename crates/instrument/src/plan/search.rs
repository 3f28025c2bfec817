//! The search for the pitches.

use gonio_bsdf::Bsdf;
use gonio_geom::{Angles, Component, Direction};

use super::field::Field;
use super::forecast::{Asked, Outcome, outcomes};
use super::lay::{Design, Limits, Pitch, directions};
use super::lobe::Lobe;
use super::report::assembled;
use super::steps::{savings, steps};
use super::survey::{Survey, survey};
use super::{Missed, Plan, PlanOptions, on};
use crate::campaign_check::check_model;
use crate::readout::recorded;
use crate::session::random_stream;
use crate::trial::{Trials, overhead};
use crate::{Campaign, Instrument, InstrumentError};

/// Rounds of refinement at most.
const ROUNDS: usize = 30;
/// Rounds of coarsening at most.
const SAVINGS: usize = 8;
/// Share of a target that the forecast stays below: claims scatter from campaign to campaign.
const MARGIN: f64 = 0.9;
/// Share of the variance of a missed target below which the path is not to blame.
const BLAME: f64 = 0.1;
/// Pitches over a lobe before any refinement, in widths.
const FLANK: f64 = 0.8;
pub(super) const STRETCH: f64 = 6.0;
/// Root mean square of what the highest of readings `p` widths apart lacks of a Gaussian, over `p^2`: the mean fourth power
/// of the distance to the nearest point of a square lattice is `7/180 p^4`.
const LACK: f64 = 0.197;
/// What a refinement has to lower the excess by for the logarithm of its readings, and how many in turn may not.
const HELP: f64 = 0.2;
const PATIENCE: usize = 3;
/// Readings of a hemisphere at most.
const MOST: usize = 400_000;
/// One incidence and hemisphere.
pub(super) struct Part {
    pub(super) incidence: Angles,
    pub(super) component: Component,
    /// DHR or DHT of the material, one an output of the detector.
    pub(super) integrals: Vec<f64>,
    pub(super) survey: Survey,
    pub(super) limits: Limits,
    pub(super) design: Design,
    pub(super) outcome: Outcome,
    pub(super) state: State,
    /// The last design that lowered the excess, and rounds since.
    pub(super) best: Option<(Design, Outcome)>,
    pub(super) stalled: usize,
    pub(super) stream: u64,
}

#[derive(Clone, Copy, PartialEq)]
pub(super) enum State {
    Open,
    Met,
    Missed(Missed),
}

impl Part {
    pub(super) fn path(&self, design: &Design, seed: u64) -> Vec<Direction> {
        let mut rng = random_stream(seed, self.stream);
        let path = directions(design, &self.survey.lobes, &self.limits, &mut rng);
        path.into_iter().map(|d| recorded(d).direction()).collect()
    }

    fn asked(&self, design: &Design, seed: u64) -> Asked {
        Asked {
            incidence: self.incidence,
            component: self.component,
            path: self.path(design, seed),
            integrals: self.integrals.clone(),
        }
    }
}

/// By how much the targets are exceeded, as the sum of logarithms; zero where every detector meets both.
fn excess(outcome: &Outcome, options: &PlanOptions) -> f64 {
    let over = |u: f64, target: f64| (u / (MARGIN * target)).ln().max(0.0);
    outcome.deciding().map_or(f64::INFINITY, |[integral, peak]| {
        over(integral.of_integral(), options.target_integral) + over(peak.u_peak, options.target_peak)
    })
}

/// Whether a denser path could bring a missed target closer, of any detector.
fn path_is_to_blame(outcome: &Outcome, options: &PlanOptions) -> bool {
    let part = |u: f64, own: f64, target: f64| u > MARGIN * target && own * own > BLAME * u * u;
    outcome.claims.iter().any(|c| {
        let noise = (c.u_integral.powi(2) - c.u_quadrature.powi(2) - c.u_common.powi(2))
            .max(0.0)
            .sqrt();
        c.error > MARGIN * options.target_integral
            || part(c.u_integral, c.u_quadrature.hypot(noise), options.target_integral)
            || part(c.u_peak, c.u_sampling, options.target_peak)
    })
}

pub(super) fn search(
    model: &dyn Bsdf,
    instrument: &Instrument,
    campaign: &Campaign,
    options: &PlanOptions,
    mut watch: impl FnMut(usize, usize) -> bool,
) -> Result<Option<Plan>, InstrumentError> {
    let instrument = Instrument {
        path: crate::DetectorPath {
            theta_max: instrument.path.theta_max,
            patch: None,
            ..crate::DetectorPath::default()
        },
        ..instrument.clone()
    };
    check_model(model, &instrument, campaign)?;
    let watched = |done: usize, watch: &mut dyn FnMut(usize, usize) -> bool| watch(done, ROUNDS);
    if !watched(0, &mut watch) {
        return Ok(None);
    }
    let outputs = instrument.detector.outputs_for(model.channels())?;
    let mut trials = Trials::begun(model, &instrument, &outputs, campaign);
    let mut measure = |paths: Vec<Asked>| outcomes(&mut trials, options.u_calibration, paths);
    let mut parts = Vec::new();
    for &incidence in &campaign.incidences {
        let of = |k| Field::new(model, &instrument, &outputs[k..=k], incidence.direction());
        let fields: Vec<Field<'_>> = (0..outputs.len()).map(of).collect();
        for &component in &campaign.components {
            parts.push(first(
                &instrument,
                options,
                &fields,
                incidence,
                component,
                parts.len(),
            ));
        }
    }
    let seed = campaign.seed;
    let paths = parts.iter().map(|p| p.asked(&p.design, seed));
    let found = measure(paths.collect())?;
    for (part, outcome) in parts.iter_mut().zip(found) {
        part.outcome = outcome.ok_or_else(|| unread(part))?;
    }
    let fixed = overhead(&instrument, campaign);
    let total = |parts: &[Part]| fixed + parts.iter().map(|p| p.outcome.seconds).sum::<f64>();
    if let Some(time) = options.time
        && total(&parts) > time
    {
        return Err(InstrumentError::Domain {
            field: "time",
            found: format!("{time:.0} s"),
            allowed: format!(
                "at least {:.0} s: the coarsest path of {} incidences, dark records and scans of the beam",
                total(&parts).ceil(),
                campaign.incidences.len()
            ),
        });
    }
    for round in 1..=ROUNDS {
        for part in &mut parts {
            if part.state == State::Open && excess(&part.outcome, options) == 0.0 {
                part.state = State::Met;
            } else if part.state == State::Open && !path_is_to_blame(&part.outcome, options) {
                part.state = State::Missed(Missed::Instrument);
            }
        }
        let mut tried: Vec<(usize, Design)> = Vec::new();
        for (k, part) in parts.iter().enumerate().filter(|(_, p)| p.state == State::Open) {
            tried.extend(steps(part).into_iter().map(|d| (k, d)));
        }
        if tried.is_empty() {
            break;
        }
        let paths = tried.iter().map(|(k, d)| parts[*k].asked(d, seed));
        let found = measure(paths.collect())?;
        let mut results: Vec<(usize, Design, Outcome)> = tried
            .into_iter()
            .zip(found)
            .filter_map(|((k, design), outcome)| Some((k, design, outcome?)))
            .collect();
        for k in 0..parts.len() {
            if parts[k].state != State::Open {
                continue;
            }
            let others = total(&parts) - parts[k].outcome.seconds;
            let (own, rest): (Vec<_>, Vec<_>) = results.into_iter().partition(|r| r.0 == k);
            results = rest;
            take_best(&mut parts[k], own, options, options.time.map(|t| t - others));
        }
        if !watched(round, &mut watch) {
            return Ok(None);
        }
    }
    for part in parts.iter_mut().filter(|p| p.state == State::Open) {
        part.state = if excess(&part.outcome, options) == 0.0 {
            State::Met
        } else {
            State::Missed(Missed::Pitch)
        };
    }
    for _ in 0..SAVINGS {
        let mut tried: Vec<(usize, Design)> = Vec::new();
        for (k, part) in parts.iter().enumerate().filter(|(_, p)| p.state == State::Met) {
            tried.extend(savings(part, options).into_iter().map(|d| (k, d)));
        }
        if tried.is_empty() {
            break;
        }
        let paths = tried.iter().map(|(k, d)| parts[*k].asked(d, seed));
        let found = measure(paths.collect())?;
        let mut saved = false;
        for ((k, design), outcome) in tried.into_iter().zip(found) {
            let Some(outcome) = outcome else { continue };
            let part = &mut parts[k];
            let cheaper = outcome.readings < part.outcome.readings
                && (options.time.is_none() || outcome.seconds <= part.outcome.seconds);
            if cheaper && excess(&outcome, options) == 0.0 {
                (part.design, part.outcome, saved) = (design, outcome, true);
            }
        }
        if !saved {
            break;
        }
        if !watched(ROUNDS, &mut watch) {
            return Ok(None);
        }
    }
    let seconds = total(&parts);
    Ok(watched(ROUNDS, &mut watch).then(|| assembled(&parts, campaign, &outputs, seconds, options)))
}

fn unread(part: &Part) -> InstrumentError {
    let (theta, phi) = part.incidence.to_degrees();
    InstrumentError::Domain {
        field: "plan",
        found: format!(
            "no light to read at theta_i = {theta} degrees, phi_i = {phi} degrees ({})",
            part.component
        ),
        allowed: "hemispheres that the material scatters into".into(),
    }
}

/// The part with its coarsest design.
fn first(
    instrument: &Instrument,
    options: &PlanOptions,
    fields: &[Field<'_>],
    incidence: Angles,
    component: Component,
    index: usize,
) -> Part {
    let wi = incidence.direction();
    let (theta_max, shadow) = (instrument.path.theta_max, instrument.detector.shadow);
    let mut survey = survey(fields, wi, component, theta_max, shadow);
    let noise = instrument.detector.noise_relative.hypot(options.u_calibration);
    let left = (MARGIN * options.target_peak).powi(2) - noise * noise;
    // A tenth of the target is left to the path where noise alone exceeds it.
    let left = left.max(0.01 * options.target_peak.powi(2)).sqrt();
    let peak = (left / LACK).sqrt().min(FLANK);
    let mut lobes: Vec<Pitch> = survey
        .lobes
        .iter()
        .map(|_| Pitch {
            peak,
            flank: FLANK,
            stretch: STRETCH,
        })
        .collect();
    let asked = options
        .regions
        .iter()
        .filter(|r| on(r.at.direction(), wi, component));
    for region in asked {
        // One width is the radius: the pitch is even over it.
        survey
            .lobes
            .push(Lobe::round(region.at.direction(), region.radius, 1.0));
        let pitch = region.pitch / region.radius;
        lobes.push(Pitch {
            peak: pitch,
            flank: pitch,
            stretch: 1.0,
        });
    }
    Part {
        incidence,
        component,
        integrals: fields.iter().map(|f| f.integral(component)).collect(),
        survey,
        limits: Limits {
            side: component.scattered_side(wi.side()),
            theta_max,
            shadow: (component == Component::Reflection && shadow > 0.0).then_some((wi, shadow)),
        },
        design: Design {
            base: options.largest_pitch,
            lobes,
        },
        outcome: Outcome::default(),
        state: State::Open,
        best: None,
        stalled: 0,
        stream: PATHS + index as u64,
    }
}

/// First random stream of planned paths.
const PATHS: u64 = 1 << 41;

/// Takes the design that lowers the excess most for its readings; the finest of all where none does.
fn take_best(
    part: &mut Part,
    results: Vec<(usize, Design, Outcome)>,
    options: &PlanOptions,
    time: Option<f64>,
) {
    let before = excess(&part.outcome, options);
    let readings = part.outcome.readings as f64;
    let count = results.len();
    let mut affordable: Vec<_> = results
        .into_iter()
        .filter(|r| time.is_none_or(|t| r.2.seconds <= t))
        .collect();
    let seconds = part.outcome.seconds;
    // Where time is short it is what counts.
    let gain = |o: &Outcome| {
        let cost = match options.time {
            Some(_) if seconds > 0.0 => o.seconds / seconds,
            _ => o.readings as f64 / readings,
        };
        (before - excess(o, options)) / cost.ln().max(0.02)
    };
    let best =
        (0..affordable.len()).max_by(|&a, &b| gain(&affordable[a].2).total_cmp(&gain(&affordable[b].2)));
    // The last design is finer everywhere.
    let best = best.map(|k| {
        if gain(&affordable[k].2) > 0.0 {
            k
        } else {
            affordable.len() - 1
        }
    });
    match best.map(|k| affordable.swap_remove(k)) {
        Some((_, design, outcome)) => {
            let lowest = part.best.as_ref().map_or(before, |b| excess(&b.1, options));
            let (fell, cost) = (
                lowest - excess(&outcome, options),
                outcome.readings as f64 / readings,
            );
            part.stalled = if fell > HELP * cost.ln().max(0.1) {
                part.best = None;
                0
            } else {
                part.best
                    .get_or_insert_with(|| (part.design.clone(), part.outcome.clone()));
                part.stalled + 1
            };
            (part.design, part.outcome) = (design, outcome);
            if (part.stalled == PATIENCE || part.outcome.readings > MOST)
                && excess(&part.outcome, options) > 0.0
            {
                if let Some(best) = part.best.take() {
                    (part.design, part.outcome) = best;
                }
                part.state = State::Missed(Missed::Pitch);
            }
        }
        None => part.state = State::Missed(if count > 0 { Missed::Time } else { Missed::Pitch }),
    }
}
