//! How much light a fitted model scatters in all.

use std::fmt;

use gonio_bsdf::Channel;
use gonio_bsdf::albedo::directional_albedo;
use gonio_geom::{Angles, Component};

use crate::{Fit, Kind};

/// Step of the derivatives by the parameters, as a share of their range.
const STEP: f64 = 1e-4;

/// The largest directional albedo (DHR + DHT) of a fitted model at the incidences that were measured.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LargestAlbedo {
    /// The albedo.
    pub value: f64,
    /// Its standard uncertainty: the covariance of the parameters, beam power included, in first order.
    pub u: f64,
    /// The incidence.
    pub incidence: Angles,
    /// The channel.
    pub channel: Channel,
}

impl LargestAlbedo {
    /// Whether it exceeds 1 by more than its expanded uncertainty (k = 2).
    pub fn exceeds_one(&self) -> bool {
        self.value > 1.0 + 2.0 * self.u
    }
}

impl fmt::Display for LargestAlbedo {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(
            f,
            "{:.3} ± {:.3} (k = 2) of the light at theta_i = {:.1} deg in channel {}",
            self.value,
            2.0 * self.u,
            self.incidence.theta.to_degrees(),
            self.channel
        )
    }
}

/// The largest albedo of `fit` over `incidences` and its channels.
pub(crate) fn largest(fit: &Fit, incidences: &[Angles]) -> Option<LargestAlbedo> {
    let model = fit.bsdf().ok()?;
    let of = |model: &dyn gonio_bsdf::Bsdf, incidence: Angles, channel: usize| -> f64 {
        [Component::Reflection, Component::Transmission]
            .into_iter()
            .filter(|c| fit.model.scatters_into(*c))
            .map(|c| directional_albedo(model, incidence.direction(), c, channel))
            .sum()
    };
    let mut top: Option<(f64, Angles, usize)> = None;
    for &incidence in incidences {
        for channel in 0..fit.channels.len() {
            let value = of(model.as_ref(), incidence, channel);
            if top.is_none_or(|t| value > t.0) {
                top = Some((value, incidence, channel));
            }
        }
    }
    let (value, incidence, at) = top?;
    let channel = fit.channels[at];
    let n = fit.estimates.len();
    let values: Vec<f64> = fit.estimates.iter().map(|e| e.value).collect();
    let slopes: Vec<f64> = (0..n)
        .map(|k| {
            let e = &fit.estimates[k];
            let known = matches!(e.kind, Kind::Value | Kind::UpperLimit) && e.u > 0.0;
            if !known || e.channel.is_some_and(|c| c != channel) {
                return 0.0;
            }
            let Some(p) = fit.model.parameters.iter().find(|p| p.name == e.name) else {
                return 0.0;
            };
            let step = STEP * (p.high - p.low);
            let moved = if e.value + step <= p.high { step } else { -step };
            let mut changed = values.clone();
            changed[k] = e.value + moved;
            let shifted = fit.model.bsdf(&fit.parameters_with(&changed));
            shifted.map_or(0.0, |m| (of(m.as_ref(), incidence, at) - value) / moved)
        })
        .collect();
    let variance: f64 = (0..n * n)
        .map(|k| slopes[k / n] * slopes[k % n] * fit.covariance[k])
        .sum();
    Some(LargestAlbedo {
        value,
        u: variance.max(0.0).sqrt(),
        incidence,
        channel,
    })
}
