//! Drawing directions from a base.

use gonio_geom::{Component, DVec3, Direction};

use super::{Base, Fitted, raised};

/// Samples of a part that tell how much light it scatters.
const SAMPLES: usize = 32;

/// Polar angles of incidence at which that is asked, evenly from the normal to the horizon.
const INCIDENCES: usize = 6;

/// Least weight of a part over the greatest one.
const LEAST: f64 = 0.1;

/// Probability of each part: its light, averaged over incidence.
pub(super) fn probabilities(parts: &[Fitted]) -> Vec<f64> {
    let light = |part: &Fitted| {
        let mut sum = 0.0;
        for k in 0..INCIDENCES {
            let wi = Direction::from_degrees(90.0 * (k as f64 + 0.5) / INCIDENCES as f64, 180.0);
            for m in 0..SAMPLES {
                let u = |step: f64| ((m as f64 + 0.5) * step).fract();
                let drawn = part
                    .model
                    .sample(wi, [u(0.819_172_513), u(0.671_043_607), u(0.549_700_478)]);
                sum += drawn.map_or(0.0, |s| s.weight);
            }
        }
        sum
    };
    let all: Vec<f64> = parts.iter().map(light).collect();
    let most = all.iter().copied().fold(f64::MIN_POSITIVE, f64::max);
    let all: Vec<f64> = all.into_iter().map(|v| v.max(LEAST * most)).collect();
    let total: f64 = all.iter().sum();
    all.into_iter().map(|v| v / total).collect()
}

impl Base {
    /// Density with which [`Base::draw`] gives `s`, 1/sr.
    pub(crate) fn density(&self, i: DVec3, s: DVec3) -> f64 {
        let (wi, ws) = (Direction::from_unit(raised(i)), self.scattered(s));
        self.parts
            .iter()
            .zip(&self.probabilities)
            .map(|(part, p)| p * part.model.pdf(wi, ws))
            .sum()
    }

    /// A local direction on the upper hemisphere; `None` is a failed sample.
    pub(crate) fn draw(&self, i: DVec3, u: [f64; 3]) -> Option<DVec3> {
        let mut rest = u[2];
        let last = self.parts.len().checked_sub(1)?;
        let mut k = 0;
        while k < last && rest >= self.probabilities[k] {
            rest -= self.probabilities[k];
            k += 1;
        }
        let within = (rest / self.probabilities[k]).clamp(0.0, 1.0 - f64::EPSILON);
        let wi = Direction::from_unit(raised(i));
        let drawn = self.parts[k]
            .model
            .sample(wi, [u[0], u[1], within])?
            .direction
            .vec();
        match self.component {
            Component::Reflection if drawn.z > 0.0 => Some(drawn),
            Component::Transmission if drawn.z < 0.0 => Some(DVec3::new(drawn.x, drawn.y, -drawn.z)),
            _ => None,
        }
    }
}
