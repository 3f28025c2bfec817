//! Analytic models and the virtual goniophotometer.

use std::sync::Arc;

use gonio_bsdf as core;
use gonio_bsdf::analytic::{
    Lambert, LobeNormalisation, Spectrum, Sum, TransmissionLobe, TransmissionLobeParameters, WardGmd,
    WardGmdParameters,
};
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

/// The parameters of one part of a model; taking a parameter removes it, so that what is left is a mistake.
struct Parameters<'py> {
    model: String,
    rest: Bound<'py, PyDict>,
}

impl<'py> Parameters<'py> {
    fn new(part: &Bound<'py, PyDict>) -> PyResult<Self> {
        let mut parameters = Parameters {
            model: String::new(),
            rest: part.copy()?,
        };
        parameters.model = parameters.take("model")?;
        Ok(parameters)
    }

    fn take<T: for<'a> FromPyObject<'a, 'py, Error: Into<PyErr>>>(&self, name: &str) -> PyResult<T> {
        let Some(value) = self.rest.get_item(name)? else {
            return Err(domain(
                name,
                "nothing",
                &format!("a value for part {:?}", self.model),
            ));
        };
        self.rest.del_item(name)?;
        value.extract().map_err(Into::into)
    }

    fn photopic(&self, name: &'static str) -> PyResult<Spectrum> {
        Spectrum::photopic(name, self.take(name)?).or_raise()
    }

    fn finish(self) -> PyResult<()> {
        match self.rest.keys().iter().next() {
            None => Ok(()),
            Some(key) => Err(domain(
                &format!("part {:?}", self.model),
                format!("parameter {key}"),
                "only parameters of this model",
            )),
        }
    }
}

/// One part of an analytic model.
fn part(spec: &Bound<'_, PyDict>) -> PyResult<Box<dyn core::Bsdf>> {
    let p = Parameters::new(spec)?;
    let model: Box<dyn core::Bsdf> = match p.model.as_str() {
        "lambert" => {
            let albedo = p.photopic("albedo")?;
            match component(&p.take::<String>("component")?)? {
                Component::Reflection => Box::new(Lambert::reflection(albedo)),
                Component::Transmission => Box::new(Lambert::transmission(albedo)),
            }
        }
        "ward_gmd" => Box::new(
            WardGmd::new(WardGmdParameters {
                rho: p.photopic("rho")?,
                alpha_x: p.take("alpha_x")?,
                alpha_y: p.take("alpha_y")?,
                phi_x: p.take::<f64>("phi_x")?.to_radians(),
            })
            .or_raise()?,
        ),
        "transmission_lobe" => Box::new(
            TransmissionLobe::new(TransmissionLobeParameters {
                tau: p.photopic("tau")?,
                alpha: p.take("alpha")?,
                normalisation: LobeNormalisation::Bounded,
            })
            .or_raise()?,
        ),
        other => {
            return Err(domain(
                "model",
                format!("{other:?}"),
                "lambert, ward_gmd, transmission_lobe",
            ));
        }
    };
    p.finish()?;
    Ok(model)
}

/// A photopic analytic model, the sum of `parts`. Each part is a dict with `model` and that model's parameters:
/// lambert: component, albedo; ward_gmd: rho, alpha_x, alpha_y, phi_x (degrees); transmission_lobe: tau, alpha
/// (bounded normalisation).
#[pyfunction]
fn analytic(parts: Vec<Bound<'_, PyDict>>) -> PyResult<Bsdf> {
    let parts = parts.iter().map(part).collect::<PyResult<Vec<_>>>()?;
    Ok(Bsdf(Arc::new(Sum::new(parts).or_raise()?)))
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
    m.add_function(wrap_pyfunction!(analytic, m)?)?;
    m.add_function(wrap_pyfunction!(directional_albedo, m)?)?;
    m.add_function(wrap_pyfunction!(simulate, m)?)
}
