//! Analytic models and the virtual goniophotometer.

use gonio_bsdf as core;
use gonio_geom::{Angles, Component};
use gonio_instrument::{BeamProfile, Campaign, Instrument, InstrumentError};
use pyo3::prelude::*;
use pyo3::types::PyDict;

use crate::arrays::angles;
use crate::bsdf::Bsdf;
use crate::errors::{OrRaise, QuantityError, Raise, domain};
use crate::scan::Scan;

impl Raise for InstrumentError {
    fn raise(self) -> PyErr {
        let InstrumentError::Domain {
            field,
            found,
            allowed,
        } = self;
        domain(field, found, &allowed)
    }
}

fn component(name: &str) -> PyResult<Component> {
    match name {
        "reflection" => Ok(Component::Reflection),
        "transmission" => Ok(Component::Transmission),
        _ => Err(domain(
            "component",
            format!("{name:?}"),
            "reflection, transmission",
        )),
    }
}

/// Directional-hemispherical reflectance or transmittance of `model` by adaptive quadrature.
#[pyfunction]
#[pyo3(signature = (model, *, theta_i, phi_i, component, channel=None))]
fn directional_albedo(
    py: Python<'_>,
    model: &Bsdf,
    theta_i: f64,
    phi_i: f64,
    component: &str,
    channel: Option<&str>,
) -> PyResult<f64> {
    let wi = angles(["theta_i", "phi_i"], theta_i, phi_i)?.direction();
    let component = self::component(component)?;
    let names: Vec<String> = model.0.channels().iter().map(ToString::to_string).collect();
    let index = match channel {
        None => 0,
        Some(name) => names.iter().position(|n| n == name).ok_or_else(|| {
            QuantityError::new_err(format!(
                "channel: found {name:?}, needed one of {}",
                names.join(", ")
            ))
        })?,
    };
    Ok(py.detach(|| core::directional_albedo(model.0.as_ref(), wi, component, index)))
}

/// The instrument with the named numbers of `settings` in place of its defaults; angles in degrees.
fn instrument(settings: &Bound<'_, PyDict>) -> PyResult<Instrument> {
    let mut it = Instrument::default();
    for (key, value) in settings {
        let (key, value): (String, f64) = (key.extract()?, value.extract()?);
        let angle = value.to_radians();
        let d = &mut it.detector;
        let patch = it.path.patch.get_or_insert_default();
        match key.as_str() {
            "power" => it.beam.power = value,
            "beam_half_width" => it.beam.profile = BeamProfile::Gaussian { half_width: angle },
            "beam_radius" => it.beam.profile = BeamProfile::TopHat { radius: angle },
            "spot_diameter" => it.beam.spot_diameter = value,
            "distance" => d.distance = value,
            "aperture" => d.aperture = angle,
            "noise_readout" => d.noise_readout = value,
            "noise_relative" => d.noise_relative = value,
            "dark_level" => d.dark_level = value,
            "dark_swing" => d.dark_swing = value,
            "dark_period" => d.dark_period = value,
            "saturation" => d.saturation = value,
            "rate" => d.rate = value,
            "shadow" => d.shadow = angle,
            "pointing" => d.pointing = angle,
            "pitch_across" => it.path.pitch_across = angle,
            "pitch_along" => it.path.pitch_along = angle,
            "theta_max" => it.path.theta_max = angle,
            "jitter" => it.path.jitter = value,
            "patch_radius" => patch.radius = angle,
            "patch_pitch" => patch.pitch = angle,
            "patch_growth" => patch.growth = value,
            "patch_along" => patch.along = value,
            name => {
                return Err(domain(
                    "instrument",
                    format!("{name:?}"),
                    "power, beam_half_width, beam_radius, spot_diameter, distance, aperture, noise_readout, \
                     noise_relative, dark_level, dark_swing, dark_period, saturation, rate, shadow, pointing, \
                     pitch_across, pitch_along, theta_max, jitter, patch_radius, patch_pitch, patch_growth, \
                     patch_along",
                ));
            }
        }
    }
    Ok(it)
}

/// Records of a virtual campaign, in the order they are taken.
#[pyfunction]
#[pyo3(signature = (model, *, incidences, components, seed, sample_name=None, started=None, settings))]
#[expect(clippy::too_many_arguments, reason = "keyword-only in Python")]
fn simulate(
    py: Python<'_>,
    model: &Bsdf,
    incidences: Vec<(f64, f64)>,
    components: Vec<String>,
    seed: u64,
    sample_name: Option<String>,
    started: Option<String>,
    settings: &Bound<'_, PyDict>,
) -> PyResult<Vec<Scan>> {
    let campaign = Campaign {
        incidences: incidences
            .into_iter()
            .map(|(theta, phi)| angles(["theta_i", "phi_i"], theta, phi))
            .collect::<PyResult<Vec<Angles>>>()?,
        components: components
            .iter()
            .map(|name| component(name))
            .collect::<PyResult<Vec<_>>>()?,
        seed,
        sample_name,
        started,
        ..Campaign::default()
    };
    let instrument = instrument(settings)?;
    let records = py
        .detach(|| gonio_instrument::simulate(model.0.as_ref(), &instrument, &campaign))
        .or_raise()?;
    Ok(records.into_iter().map(Scan::from).collect())
}

pub(crate) fn register(m: &Bound<'_, PyModule>) -> PyResult<()> {
    m.add_function(wrap_pyfunction!(directional_albedo, m)?)?;
    m.add_function(wrap_pyfunction!(simulate, m)?)
}
