//! A model's values as a measurement.

use gonio_bsdf::Channel;
use gonio_geom::Component;
use gonio_scan::{Spacing, Tabulation};
use pyo3::prelude::*;

use crate::arrays::angles;
use crate::bsdf::Bsdf;
use crate::errors::{OrRaise, domain};
use crate::slice::MeasurementData;

fn component(name: &str) -> PyResult<Component> {
    match name {
        "reflection" => Ok(Component::Reflection),
        "transmission" => Ok(Component::Transmission),
        _ => Err(domain(
            "components",
            format!("{name:?}"),
            "reflection, transmission",
        )),
    }
}

/// Evaluate a model at incidences and graded directions, with a stated uncertainty. Angles in degrees; what is None
/// keeps the default of the core. `incidences`: (theta_i, phi_i).
#[pyfunction]
#[pyo3(signature = (model, *, incidences=None, components=None, channels=None, pitch=None, peak_pitch=None, growth=None,
    reach=None, theta_max=None, u_relative=None, u_floor=None, sample_name=None))]
#[expect(clippy::too_many_arguments, reason = "keyword-only in Python")]
fn tabulate(
    py: Python<'_>,
    model: &Bsdf,
    incidences: Option<Vec<(f64, f64)>>,
    components: Option<Vec<String>>,
    channels: Option<Vec<String>>,
    pitch: Option<f64>,
    peak_pitch: Option<f64>,
    growth: Option<f64>,
    reach: Option<f64>,
    theta_max: Option<f64>,
    u_relative: Option<f64>,
    u_floor: Option<f64>,
    sample_name: Option<String>,
) -> PyResult<MeasurementData> {
    let mut tabulation = Tabulation {
        sample_name,
        ..Tabulation::default()
    };
    if let Some(list) = incidences {
        tabulation.incidences = list
            .into_iter()
            .map(|(theta, phi)| angles(["theta_i", "phi_i"], theta, phi))
            .collect::<PyResult<_>>()?;
    }
    if let Some(list) = components {
        tabulation.components = list.iter().map(|c| component(c)).collect::<PyResult<_>>()?;
    }
    if let Some(list) = channels {
        let parsed: Result<Vec<Channel>, _> = list.iter().map(|c| c.parse()).collect();
        tabulation.channels = Some(parsed.or_raise()?);
    }
    let default = Spacing::default();
    let angle = |value: Option<f64>, default: f64| value.map_or(default, f64::to_radians);
    tabulation.spacing = Spacing {
        pitch: angle(pitch, default.pitch),
        peak_pitch: angle(peak_pitch, default.peak_pitch),
        growth: growth.unwrap_or(default.growth),
        reach: angle(reach, default.reach),
        theta_max: angle(theta_max, default.theta_max),
    };
    tabulation.u_relative = u_relative.unwrap_or(tabulation.u_relative);
    tabulation.u_floor = u_floor.unwrap_or(tabulation.u_floor);
    let model = model.0.clone();
    py.detach(|| gonio_scan::tabulate(&*model, &tabulation))
        .or_raise()
        .map(MeasurementData::from)
}

pub(crate) fn register(m: &Bound<'_, PyModule>) -> PyResult<()> {
    m.add_function(wrap_pyfunction!(tabulate, m)?)
}
