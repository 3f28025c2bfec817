//! The most light that leaves a model at any of some incidences.

use gonio_bsdf::{Bsdf, Lobe};
use gonio_geom::{Angles, Component, Direction};

/// The incidence at which most of the light leaves.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Largest {
    /// Share of the light that leaves on both sides, ideal parts included.
    pub value: f64,
    /// Its standard error.
    pub error: f64,
    /// Number of the channel.
    pub channel: usize,
    /// Incidence.
    pub at: Angles,
}

/// Samples an incidence.
const SAMPLES: u32 = 4096;

/// The largest directional albedo over every 5 degrees of incidence up to 85 and at 88 on both sides, for models that are
/// not isotropic at eight azimuths: by the model's own sampler over an additive recurrence [Roberts2018]. Where the errors
/// differ, what is surely larger counts (by the value less two errors). 0 for a model that scatters nothing.
pub fn largest_albedo(model: &dyn Bsdf) -> Largest {
    let azimuths = if model.properties().isotropic { 1 } else { 8 };
    let thetas = (0..18).map(|k| 5.0 * f64::from(k)).chain([88.0]);
    let both = thetas.clone().chain(thetas.map(|t| 180.0 - t));
    let mut largest = Largest {
        value: 0.0,
        error: 0.0,
        channel: 0,
        at: Angles::from_degrees(0.0, 0.0),
    };
    for theta in both {
        for k in 0..azimuths {
            let at = Angles::from_degrees(theta, 45.0 * f64::from(k));
            for (channel, (value, error)) in albedos(model, at.direction()).into_iter().enumerate() {
                if value - 2.0 * error > largest.value - 2.0 * largest.error {
                    largest = Largest {
                        value,
                        error,
                        channel,
                        at,
                    };
                }
            }
        }
    }
    largest
}

/// Share of the light that leaves on both sides with its standard error, by channel.
fn albedos(model: &dyn Bsdf, wi: Direction) -> Vec<(f64, f64)> {
    let n = model.channels().len();
    let (mut sum, mut square) = (vec![0.0; n], vec![0.0; n]);
    let mut f = vec![0.0; n];
    for k in 1..=SAMPLES {
        let u = [0.819_172_513_4, 0.671_043_606_7, 0.549_700_477_9].map(|x| (0.5 + f64::from(k) * x).fract());
        let Some(drawn) = model
            .sample(wi, u)
            .filter(|s| s.lobe != Lobe::Delta && s.pdf > 0.0)
        else {
            continue;
        };
        model.eval(wi, drawn.direction, &mut f);
        let scale = drawn.direction.cos_theta().abs() / drawn.pdf;
        for c in 0..n {
            sum[c] += f[c] * scale;
            square[c] += (f[c] * scale).powi(2);
        }
    }
    let count = f64::from(SAMPLES);
    let mut ideal = vec![0.0; n];
    for component in [Component::Reflection, Component::Transmission] {
        let mut shares = vec![0.0; n];
        model.delta(wi, component, &mut shares);
        ideal
            .iter_mut()
            .zip(&shares)
            .for_each(|(sum, share)| *sum += share);
    }
    (0..n)
        .map(|c| {
            let mean = sum[c] / count;
            let variance = (square[c] / count - mean * mean).max(0.0);
            (mean + ideal[c], (variance / count).sqrt())
        })
        .collect()
}
