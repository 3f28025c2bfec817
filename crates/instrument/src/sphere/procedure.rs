//! The procedures of DIN 5036-3: from readings to reflectance or transmittance and its parts [DIN5036].
//!
//! With T the share of the beam's light that the sample sends into the sphere and p the part of it that goes through the trap's
//! cone, a sphere reads, its trap closed or open,
//!
//! ```text
//! sample     V_c = K_c ((T - p) e + p q)            V_o = K_o (T - p) e
//! standard   V_c = K_c rho_N ((1 - F) e + F q)      V_o = K_o rho_N (1 - F) e
//! ```
//!
//! K is what the sphere makes of light that its wall has reflected once, F the share of the standard's light that goes through
//! the cone, q the reflectance of the plug over that of the wall, and e the share of diffuse light that meets wall
//! at first, not a port: `e = 1 - sum f_j (1 - rho_j / rho_w) / ((1 - F) (1 - f_sample))` over the ports but the trap
//! [Goebel1967]. Gloss meets the plug alone and loses nothing there, so a procedure without e finds too much of it.
//!
//! K hangs on what lies in the ports. It cancels where sample and standard are both in the sphere all the time and change
//! places (comparison), or where an auxiliary lamp tells the ratio of K with the one and the other; without either, the result carries
//! the substitution error.

use std::sync::Arc;
use std::sync::atomic::AtomicBool;

use gonio_bsdf::Bsdf;

use super::plan::{Arrangement, PortName};
use super::reading::{Effort, Filling, Means, Source, State, read};
use super::{Port, Sphere};
use crate::InstrumentError;
use crate::device::Progress;

/// How the change of the sphere by the sample is dealt with.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Method {
    /// It is not: sample and standard are put into the one port in turn.
    Substitution,
    /// An auxiliary lamp is read with either.
    Auxiliary,
    /// Both are in the sphere all the time.
    Comparison,
}

/// A value with its standard error.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Estimate {
    /// The value.
    pub value: f64,
    /// Standard error of the rays.
    pub u: f64,
}

/// One reading of the detector.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Reading {
    /// The lamp.
    pub source: Source,
    /// Whether the sample is measured; otherwise the standard, in transmission the open port.
    pub sample: bool,
    /// Whether the trap is open.
    pub trap_open: bool,
    /// Share of the lamp's flux that reaches the detector.
    pub flux: Estimate,
}

/// What a sphere says of a sample. Without a trap there is the total alone.
#[derive(Clone, Debug, PartialEq)]
pub struct SphereResult {
    /// Reflectance or transmittance T.
    pub total: Estimate,
    /// Its part outside the trap's cone, T - p.
    pub diffuse: Option<Estimate>,
    /// Its part p through the trap, diffuse light in the cone included.
    pub port: Option<Estimate>,
    /// What is called the regular (specular) part: p without diffuse light, `(p - F T) / (1 - F)`, as of a mirror on a
    /// Lambertian ground.
    pub regular: Option<Estimate>,
    /// The total as a procedure without corrections has it: ratio of readings, times the standard.
    pub plain_total: Estimate,
    /// The regular part of such a procedure: the difference of its total and of the same ratio with the trap open.
    pub plain_regular: Option<Estimate>,
    /// All readings.
    pub readings: Vec<Reading>,
    /// Half angle of the round cone that takes the same share of Lambertian light as the trap, radians.
    pub half_angle: Option<f64>,
    /// That share, F.
    pub diffuse_share: Option<f64>,
}

/// What is read: source, whether the sample is measured, whether the trap is open.
type Key = (Source, bool, bool);

/// Measures one channel of a model. `None` when `stop` was set before the end.
///
/// # Errors
/// [`InstrumentError::Domain`] for a method whose port or lamp the sphere has not, the comparison of transmission, and a channel
/// that the model has not.
pub fn measure(
    sphere: &Sphere,
    model: &Arc<dyn Bsdf>,
    channel: usize,
    method: Method,
    effort: &Effort,
    stop: &AtomicBool,
    report: Progress<'_>,
) -> Result<Option<SphereResult>, InstrumentError> {
    check(sphere, method)?;
    let sample = Filling::Model {
        model: model.clone(),
        channel,
    };
    let keys = keys(sphere, method);
    let states: Vec<(State, Source)> = keys
        .iter()
        .map(|&(source, measured, trap_open)| {
            let state = sphere.state(&sample, method, measured, trap_open);
            (state, source)
        })
        .collect();
    let Some(means) = read(sphere, &states, effort, stop, report)? else {
        return Ok(None);
    };
    Ok(Some(sphere.evaluate(method, &keys, &means)))
}

fn check(sphere: &Sphere, method: Method) -> Result<(), InstrumentError> {
    let domain = |found: &str, allowed: &str| InstrumentError::Domain {
        field: "method",
        found: found.into(),
        allowed: allowed.into(),
    };
    let has = |name| sphere.port(name).is_some();
    match method {
        Method::Auxiliary if !has(PortName::Auxiliary) => Err(domain(
            "auxiliary for a sphere without an auxiliary lamp",
            "a sphere with one, or another method",
        )),
        Method::Comparison if sphere.plan.arrangement == Arrangement::Transmission => {
            Err(domain("comparison in transmission", "substitution, auxiliary"))
        }
        Method::Comparison if !has(PortName::Comparison) => Err(domain(
            "comparison for a sphere without a comparison port",
            "a sphere with one, or another method",
        )),
        _ => Ok(()),
    }
}

/// The readings of a procedure.
fn keys(sphere: &Sphere, method: Method) -> Vec<Key> {
    let traps: &[bool] = match sphere.port(PortName::Trap) {
        Some(_) => &[false, true],
        None => &[false],
    };
    let sources: &[Source] = match method {
        Method::Auxiliary => &[Source::Beam, Source::Auxiliary],
        _ => &[Source::Beam],
    };
    let reflection = sphere.plan.arrangement == Arrangement::Reflection;
    let mut keys = Vec::new();
    for source in sources {
        for measured in [true, false] {
            // Without a sample the beam leaves by an open trap: there is nothing to read.
            for open in traps.iter().filter(|open| reflection || measured || !**open) {
                keys.push((*source, measured, *open));
            }
        }
    }
    keys
}

impl Sphere {
    fn state(&self, sample: &Filling, method: Method, measured: bool, trap_open: bool) -> State {
        let reference = match self.plan.arrangement {
            Arrangement::Reflection => Filling::Lambert(self.plan.standard),
            Arrangement::Transmission => Filling::Open,
        };
        let other = |filling: &Filling| match method {
            Method::Comparison => filling.clone(),
            _ => Filling::Plug,
        };
        let (there, beside) = match measured {
            true => (sample.clone(), other(&reference)),
            false => (reference, other(sample)),
        };
        State {
            sample: there,
            comparison: beside,
            trap_open,
        }
    }

    /// The result of readings, with errors by leaving out each replicate in turn [EfronStein1981].
    fn evaluate(&self, method: Method, keys: &[Key], means: &[Means]) -> SphereResult {
        let cone = self.cone();
        let share = cone.as_ref().map_or(0.0, |c| c.diffuse_share());
        let n = means.first().map_or(0, |m| m.0.len());
        let sums: Vec<f64> = means.iter().map(|m| m.0.iter().sum()).collect();
        let of = |left_out: Option<usize>| {
            let values: Vec<f64> = sums
                .iter()
                .zip(means)
                .map(|(sum, m)| match left_out {
                    Some(k) => (sum - m.0[k]) / (n as f64 - 1.0),
                    None => sum / n as f64,
                })
                .collect();
            self.parts(method, keys, &values, share)
        };
        let all = of(None);
        let each: Vec<[f64; 6]> = (0..n).map(|k| of(Some(k))).collect();
        let estimate = |k: usize| {
            let mean = each.iter().map(|e| e[k]).sum::<f64>() / n as f64;
            let square: f64 = each.iter().map(|e| (e[k] - mean).powi(2)).sum();
            Estimate {
                value: all[k],
                u: (square * (n as f64 - 1.0) / n as f64).sqrt(),
            }
        };
        let trap = cone.is_some();
        let if_trap = |k| trap.then(|| estimate(k));
        SphereResult {
            total: estimate(0),
            diffuse: if_trap(1),
            port: if_trap(2),
            regular: if_trap(3),
            plain_total: estimate(4),
            plain_regular: if_trap(5),
            readings: keys
                .iter()
                .zip(means)
                .map(|(&(source, sample, trap_open), m)| Reading {
                    source,
                    sample,
                    trap_open,
                    flux: Estimate {
                        value: m.value(),
                        u: m.error(),
                    },
                })
                .collect(),
            half_angle: cone.as_ref().map(|c| c.half_angle()),
            diffuse_share: trap.then_some(share),
        }
    }

    /// Total, diffuse, port, regular, and the plain total and regular part.
    fn parts(&self, method: Method, keys: &[Key], values: &[f64], share: f64) -> [f64; 6] {
        let read = |source, measured, open| {
            let at = keys.iter().position(|k| *k == (source, measured, open));
            at.map_or(f64::NAN, |k| values[k])
        };
        // How much less the sphere makes of light with the reference in its port than with the sample.
        let changed = |open, reference_open| match method {
            Method::Auxiliary => {
                read(Source::Auxiliary, false, reference_open) / read(Source::Auxiliary, true, open)
            }
            _ => 1.0,
        };
        let closed = read(Source::Beam, true, false) / read(Source::Beam, false, false);
        let has_trap = self.port(PortName::Trap).is_some();
        match self.plan.arrangement {
            Arrangement::Reflection => {
                let standard = self.plan.standard;
                let total = standard * closed;
                if !has_trap {
                    let corrected = total * changed(false, false);
                    return [corrected, f64::NAN, f64::NAN, f64::NAN, total, f64::NAN];
                }
                let opened = read(Source::Beam, true, true) / read(Source::Beam, false, true);
                let plain = [total, standard * (closed - opened)];
                let (closed, opened) = (closed * changed(false, false), opened * changed(true, true));
                let q = self.plan.plug / self.plan.wall;
                let beside = |reflectance: f64| match method {
                    Method::Comparison => reflectance,
                    _ => self.plan.plug,
                };
                let with_sample = self.first(share, beside(standard));
                let with_standard = self.first(share, beside(standard * closed));
                let diffuse = standard * (1.0 - share) * (with_standard / with_sample) * opened;
                let whole = standard * ((1.0 - share) * with_standard + share * q) * closed;
                parts(diffuse, (whole - diffuse * with_sample) / q, share, plain)
            }
            Arrangement::Transmission => {
                if !has_trap {
                    let corrected = closed * changed(false, false);
                    return [corrected, f64::NAN, f64::NAN, f64::NAN, closed, f64::NAN];
                }
                let opened = read(Source::Beam, true, true) / read(Source::Beam, false, false);
                let plain = [closed, closed - opened];
                let (closed, opened) = (closed * changed(false, false), opened * changed(true, false));
                let q = self.plan.plug / self.plan.wall;
                let diffuse = q * opened / self.first(share, self.plan.plug);
                parts(diffuse, closed - opened, share, plain)
            }
        }
    }

    /// Share of the light outside the trap's cone that meets wall first; `beside` is the reflectance of what fills the comparison
    /// port.
    fn first(&self, share: f64, beside: f64) -> f64 {
        let own = self.port(PortName::Sample).map_or(0.0, Port::fraction);
        let lost: f64 = self
            .ports
            .iter()
            .map(|p| {
                let reflectance = match p.name {
                    PortName::Sample | PortName::Trap => return 0.0,
                    PortName::Entrance | PortName::Auxiliary => 0.0,
                    PortName::Detector => self.plan.detector.reflectance,
                    PortName::Comparison => beside,
                };
                p.fraction() * (1.0 - reflectance / self.plan.wall)
            })
            .sum();
        1.0 - lost / ((1.0 - share) * (1.0 - own))
    }
}

fn parts(diffuse: f64, port: f64, share: f64, plain: [f64; 2]) -> [f64; 6] {
    let total = diffuse + port;
    let regular = (port - share * total) / (1.0 - share);
    [total, diffuse, port, regular, plain[0], plain[1]]
}
