//! What is told of a plan.

use super::lay::Pitch;
use super::lobe::Lobe;
use super::search::{Part, State};
use super::{Plan, PlanOptions, PlannedLobe, PlannedScan};
use crate::{Campaign, Output, PathTable};

/// The plan of all parts.
pub(super) fn assembled(
    parts: &[Part],
    campaign: &Campaign,
    outputs: &[Output],
    seconds: f64,
    options: &PlanOptions,
) -> Plan {
    let mut table = PathTable::default();
    for &incidence in &campaign.incidences {
        let own = parts.iter().filter(|p| p.incidence == incidence);
        let line = own.flat_map(|p| p.path(&p.design, campaign.seed)).collect();
        table.lines.push((incidence, line));
    }
    let scans: Vec<PlannedScan> = parts.iter().filter_map(|p| scan(p, options)).collect();
    Plan {
        readings: table.lines.iter().map(|l| l.1.len()).sum(),
        table,
        scans,
        channels: outputs.iter().map(|o| o.channel).collect(),
        seconds,
    }
}

/// `None` of a part that was not tried.
fn scan(part: &Part, options: &PlanOptions) -> Option<PlannedScan> {
    let (o, s) = (&part.outcome, &part.survey);
    let [integral, peak] = o.deciding()?;
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
    let over = integral.of_integral() > options.target_integral || peak.u_peak > options.target_peak;
    Some(PlannedScan {
        incidence: part.incidence,
        component: part.component,
        readings: o.readings,
        seconds: o.seconds,
        channel_integral: integral.channel,
        integral: integral.integral,
        u_integral: integral.u_integral,
        error: integral.error,
        u_quadrature: integral.u_quadrature,
        u_common: integral.u_common,
        channel_peak: peak.channel,
        peak: peak.peak,
        peak_at: peak.peak_at,
        u_peak: peak.u_peak,
        u_sampling: peak.u_sampling,
        flattened: s.flattened,
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
    })
}
