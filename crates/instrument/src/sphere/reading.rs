//! What the detector of a sphere reads: the share of a lamp's light that reaches it.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};

use gonio_bsdf::Bsdf;
use rayon::prelude::*;

use super::Sphere;
use super::plan::PortName;
use super::walk::{Numbers, Walk};
use crate::InstrumentError;
use crate::device::Progress;

/// What fills a port.
#[derive(Clone)]
pub enum Filling {
    /// Nothing: light leaves.
    Open,
    /// A plug.
    Plug,
    /// A Lambertian reflector.
    Lambert(f64),
    /// One channel of a model.
    Model {
        /// The model, front inward; in transmission outward.
        model: Arc<dyn Bsdf>,
        /// Which of its channels.
        channel: usize,
    },
}

/// What fills the ports that are changed over.
#[derive(Clone)]
pub struct State {
    /// The sample's port.
    pub sample: Filling,
    /// The comparison port.
    pub comparison: Filling,
    /// Whether the gloss trap is open; a plug closes it otherwise.
    pub trap_open: bool,
}

/// The lamp that shines.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Source {
    /// The beam onto the sample.
    Beam,
    /// The auxiliary lamp, through the middle of the sphere onto the wall.
    Auxiliary,
}

/// How many rays are followed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Effort {
    /// Rays of each reading, rounded up to 32 times a power of two.
    pub rays: u32,
    /// The same seed gives the same readings, whatever the number of threads.
    pub seed: u64,
}

impl Default for Effort {
    fn default() -> Self {
        Effort {
            rays: 1 << 18,
            seed: 1,
        }
    }
}

/// Independent scramblings of the rays, whose scatter is the standard error.
const REPLICATES: u32 = 32;

/// Means of a reading over each replicate: shares of the lamp's flux. Those of several readings belong together: the same rays
/// lead into the sphere.
#[derive(Clone, Debug, PartialEq)]
pub struct Means(pub Vec<f64>);

impl Means {
    /// Mean over all rays.
    pub fn value(&self) -> f64 {
        self.0.iter().sum::<f64>() / self.0.len() as f64
    }

    /// Its standard error.
    pub fn error(&self) -> f64 {
        let (n, mean) = (self.0.len() as f64, self.value());
        let square: f64 = self.0.iter().map(|x| (x - mean).powi(2)).sum();
        (square / (n * (n - 1.0))).sqrt()
    }
}

/// Reads a sphere in several states, one after the other with the same rays. `None` when `stop` was set before the end.
///
/// # Errors
/// [`InstrumentError::Domain`] for a channel that a model has not, and an auxiliary lamp that is not there.
pub fn read(
    sphere: &Sphere,
    states: &[(State, Source)],
    effort: &Effort,
    stop: &AtomicBool,
    report: Progress<'_>,
) -> Result<Option<Vec<Means>>, InstrumentError> {
    let walks: Vec<Walk<'_>> = states
        .iter()
        .map(|(state, _)| Walk::new(sphere, state))
        .collect::<Result<_, _>>()?;
    if states.iter().any(|s| s.1 == Source::Auxiliary) && sphere.port(PortName::Auxiliary).is_none() {
        return Err(InstrumentError::Domain {
            field: "auxiliary",
            found: "no lamp".into(),
            allowed: "a sphere with one".into(),
        });
    }
    let batch = effort.rays.div_ceil(REPLICATES).next_power_of_two();
    let work: Vec<(usize, u32)> = (0..states.len())
        .flat_map(|k| (0..REPLICATES).map(move |r| (k, r)))
        .collect();
    let done = AtomicUsize::new(0);
    let means: Option<Vec<f64>> = work
        .par_iter()
        .map(|(k, replicate)| {
            if stop.load(Ordering::Relaxed) {
                return None;
            }
            let mut sum = 0.0;
            for ray in 0..batch {
                let mut numbers = Numbers::new(effort.seed ^ u64::from(*replicate) << 32, ray);
                sum += walks[*k].share(states[*k].1, &mut numbers);
            }
            let done = done.fetch_add(1, Ordering::Relaxed) + 1;
            report(done as f64 / work.len() as f64);
            Some(sum / f64::from(batch))
        })
        .collect();
    Ok(means.map(|means| {
        means
            .chunks(REPLICATES as usize)
            .map(|c| Means(c.to_vec()))
            .collect()
    }))
}
