//! The measurement that an instrument without noise, of infinite resolution, would make of a model.
//!
//! The virtual goniophotometer (crate instrument) writes raw readings with everything an instrument adds. This is the
//! other end: values of the model itself where data are wanted, to fit other models to it or to compare with it.

mod directions;
#[cfg(test)]
mod tests;

use gonio_bsdf::{Bsdf, Channel};
use gonio_geom::{Angles, Component, Direction};
use rayon::prelude::*;

use crate::process::combine;
use crate::{Flags, Measurement, ScanError, Slice};

pub use directions::Spacing;

/// What to evaluate, and the uncertainty the values are given.
#[derive(Clone, Debug, PartialEq)]
pub struct Tabulation {
    /// Directions of incidence, none on the horizon.
    pub incidences: Vec<Angles>,
    /// Hemispheres of the receiver, relative to the side of incidence.
    pub components: Vec<Component>,
    /// Channels of the model; `None` takes all of them.
    pub channels: Option<Vec<Channel>>,
    /// Where the receiver stands.
    pub spacing: Spacing,
    /// Standard uncertainty of each value relative to it, independent from value to value, `[0, 1]`.
    pub u_relative: f64,
    /// Standard uncertainty of each DSF at 0, 1/sr, `>= 0`.
    pub u_floor: f64,
    /// Name of the sample.
    pub sample_name: Option<String>,
}

impl Default for Tabulation {
    /// Reflection at 8, 20, 35, 50, 60, 70 and 75 degrees; 1 % and 0.0002/sr.
    fn default() -> Self {
        Tabulation {
            incidences: [8.0, 20.0, 35.0, 50.0, 60.0, 70.0, 75.0]
                .map(|theta| Angles::from_degrees(theta, 0.0))
                .to_vec(),
            components: vec![Component::Reflection],
            channels: None,
            spacing: Spacing::default(),
            u_relative: 0.01,
            u_floor: 2e-4,
            sample_name: None,
        }
    }
}

fn domain(field: &'static str, found: String, allowed: &str) -> ScanError {
    ScanError::Domain {
        field,
        found,
        allowed: allowed.into(),
    }
}

impl Tabulation {
    fn check(&self) -> Result<(), ScanError> {
        self.spacing.check()?;
        if self.incidences.is_empty() {
            return Err(domain("incidences", "none".into(), "at least one"));
        }
        for incidence in &self.incidences {
            let (theta, phi) = incidence.to_degrees();
            // both comparisons are false for NaN
            if !((theta - 90.0).abs() > 1e-3 && phi.is_finite()) {
                return Err(domain(
                    "incidences",
                    format!("theta_i = {theta}, phi_i = {phi} degrees"),
                    "theta_i of 0 to 180 degrees but 90, finite phi_i",
                ));
            }
        }
        let twice = self.components.len() == 2 && self.components[0] == self.components[1];
        if self.components.is_empty() || self.components.len() > 2 || twice {
            return Err(domain(
                "components",
                format!("{:?}", self.components),
                "reflection, transmission or both, each once",
            ));
        }
        if !(0.0..=1.0).contains(&self.u_relative) {
            return Err(domain("u_relative", self.u_relative.to_string(), "0 to 1"));
        }
        if !(self.u_floor >= 0.0 && self.u_floor.is_finite()) {
            return Err(domain(
                "u_floor",
                self.u_floor.to_string(),
                "a finite number >= 0",
            ));
        }
        Ok(())
    }
}

/// Evaluates `model` over the hemispheres asked for, densely about the mirror and the unbent direction.
///
/// One slice an incidence and channel: incidences in their order, channels as asked for within each, in the same
/// directions. Values are exact (no noise is added); `u_dsf^2 = u_floor^2 + (u_relative dsf)^2`. Directions in which the
/// model [has no data](Bsdf::has_data) are left out, so that the integrals count them as extrapolated.
///
/// # Errors
/// [`ScanError::Domain`] for a setting out of its range, and for an incidence at which the model has no data in any
/// direction; [`ScanError::Mismatch`] for a channel that the model does not have.
pub fn tabulate(model: &dyn Bsdf, tabulation: &Tabulation) -> Result<Measurement, ScanError> {
    tabulation.check()?;
    let channels = channels(model, tabulation)?;
    let slices: Vec<Vec<Slice>> = tabulation
        .incidences
        .par_iter()
        .map(|&incidence| at_incidence(model, tabulation, &channels, incidence))
        .collect::<Result<_, _>>()?;
    Ok(Measurement {
        slices: slices.into_iter().flatten().collect(),
        sample_name: tabulation.sample_name.clone(),
        ..Measurement::default()
    })
}

/// Places in the model of the channels asked for.
fn channels(model: &dyn Bsdf, tabulation: &Tabulation) -> Result<Vec<usize>, ScanError> {
    let there = model.channels();
    let Some(asked) = &tabulation.channels else {
        return Ok((0..there.len()).collect());
    };
    let place = |channel: &Channel| {
        there.iter().position(|c| c == channel).ok_or_else(|| {
            let names: Vec<String> = there.iter().map(Channel::to_string).collect();
            ScanError::Mismatch {
                what: "channel".into(),
                found: channel.to_string(),
                needed: format!("one of {}", names.join(", ")),
            }
        })
    };
    asked.iter().map(place).collect()
}

fn at_incidence(
    model: &dyn Bsdf,
    tabulation: &Tabulation,
    channels: &[usize],
    incidence: Angles,
) -> Result<Vec<Slice>, ScanError> {
    let wi = incidence.direction();
    let mut directions: Vec<Direction> = Vec::new();
    for &component in &tabulation.components {
        directions.extend(tabulation.spacing.directions(wi, component));
    }
    // the angles a slice holds name the direction that is evaluated
    let angles: Vec<Angles> = directions
        .iter()
        .map(|d| d.angles())
        .filter(|a| model.has_data(wi, a.direction()))
        .collect();
    if angles.is_empty() {
        let (theta, phi) = incidence.to_degrees();
        return Err(domain(
            "incidences",
            format!("theta_i = {theta}, phi_i = {phi} degrees, where the model has no data"),
            "incidences the model has data for",
        ));
    }
    let mut f = vec![0.0; model.channels().len()];
    let mut dsf = vec![Vec::with_capacity(angles.len()); channels.len()];
    for a in &angles {
        let ws = a.direction();
        model.eval(wi, ws, &mut f);
        for (column, &k) in dsf.iter_mut().zip(channels) {
            column.push(f[k] * ws.cos_theta().abs());
        }
    }
    dsf.into_iter()
        .zip(channels)
        .map(|(dsf, &k)| {
            let u_dsf: Vec<f64> = dsf
                .iter()
                .map(|d| tabulation.u_floor.hypot(tabulation.u_relative * d))
                .collect();
            let flags = dsf.iter().zip(&u_dsf).map(|(d, u)| flag(*d, *u)).collect();
            let mut slice = Slice {
                incidence,
                channel: model.channels()[k],
                theta_s: angles.iter().map(|a| a.theta).collect(),
                phi_s: angles.iter().map(|a| a.phi).collect(),
                dsf,
                u_dsf,
                omega: Vec::new(),
                flags,
                u_common: 0.0,
                integrals: Vec::new(),
            };
            combine(&mut slice, 0.0)?;
            Ok(slice)
        })
        .collect()
}

fn flag(dsf: f64, u: f64) -> Flags {
    if !dsf.is_finite() {
        Flags::NO_DATA
    } else if dsf < 2.0 * u {
        Flags::BELOW_NOISE
    } else {
        Flags::NONE
    }
}
