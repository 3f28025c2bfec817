//! What is told of a plan.

use super::lay::Pitch;
use super::lobe::Lobe;
use super::search::{Part, State};
use super::{Plan, PlanOptions, PlannedLobe, PlannedScan};
use crate::{Campaign, PathTable};

/// The plan of all parts.
pub(super) fn assembled(parts: &[Part], campaign: &Campaign, seconds: f64, options: &PlanOptions) -> Plan {
    let mut table = PathTable::default();
    for &incidence in &campaign.incidences {
        let own = parts.iter().filter(|p| p.incidence == incidence);
        let line = own.flat_map(|p| p.path(&p.design, campaign.seed)).collect();
        table.lines.push((incidence, line));
    }
    let scans: Vec<PlannedScan> = parts.iter().map(|p| scan(p, options)).collect();
    Plan {
        readings: table.lines.iter().map(|l| l.1.len()).sum(),
        table,
        scans,
        seconds,
    }
}

fn scan(part: &Part, options: &PlanOptions) -> PlannedScan {
    let (o, s) = (&part.outcome, &part.survey);
    let flattened = if s.top_true > 0.0 {
        (1.0 - s.top_seen / s.top_true).max(0.0)
    } else {
        0.0
    };
    let lobe = |(lobe, pitch): (&Lobe, &Pitch)| {
        let across = pitch.peak * lobe.width[1];
        let along = (pitch.peak * lobe.width[0]).min(pitch.stretch * across);
        PlannedLobe {
            at: lobe.peak.angles(),
            width: lobe.width,
            pitch: [along.min(part.design.base.max(across)), across],
            height: lobe.height,
        }
    };
    let refined = |(lobe, pitch): &(&Lobe, &Pitch)| pitch.peak * lobe.width[1] < part.design.base;
    let over = o.u_integral.max(o.error) > options.target_integral || o.u_peak > options.target_peak;
    PlannedScan {
        incidence: part.incidence,
        component: part.component,
        readings: o.readings,
        seconds: o.seconds,
        integral: o.integral,
        u_integral: o.u_integral,
        error: o.error,
        u_quadrature: o.u_quadrature,
        u_common: o.u_common,
        peak: o.peak,
        peak_at: o.peak_at,
        u_peak: o.u_peak,
        u_sampling: o.u_sampling,
        flattened,
        shaded: s.shaded,
        beyond: s.beyond,
        unread: s.unread_omega,
        base: part.design.base,
        lobes: s
            .lobes
            .iter()
            .zip(&part.design.lobes)
            .filter(refined)
            .map(lobe)
            .collect(),
        missed: match part.state {
            State::Missed(why) if over => Some(why),
            _ => None,
        },
    }
}
