//! The virtual integrating sphere.

use std::collections::HashMap;
use std::f64::consts::FRAC_PI_2;

use gonio_bsdf::cone;
use gonio_instrument::sphere::{
    Arrangement, Baffle, Detector, Effort, Estimate, Method, Place, Plan, PortName, Source, Sphere,
    SphereResult, Trap, measure,
};
use pyo3::exceptions::PyKeyboardInterrupt;
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyList};

use crate::arrays::angles;
use crate::bsdf::Bsdf;
use crate::errors::{OrRaise, domain};
use crate::render::RenderWatch;
use crate::simulate::component;

/// A baffle: the two ports it stands between, how far on the way, radius (m), reflectance.
type BaffleRow = (String, String, f64, f64, f64);

/// An integrating sphere; `gonio.sphere` says how it is used.
#[pyclass(frozen, module = "gonio", name = "IntegratingSphere")]
pub(crate) struct IntegratingSphere(Sphere);

const PORTS: [PortName; 6] = [
    PortName::Sample,
    PortName::Entrance,
    PortName::Trap,
    PortName::Detector,
    PortName::Comparison,
    PortName::Auxiliary,
];

fn port(name: &str) -> PyResult<PortName> {
    PORTS.into_iter().find(|p| p.to_string() == name).ok_or_else(|| {
        domain(
            "port",
            format!("{name:?}"),
            &PORTS.map(|p| p.to_string()).join(", "),
        )
    })
}

/// Numbers by name, each asked for once.
struct Settings(HashMap<String, f64>);

impl Settings {
    fn number(&mut self, name: &str) -> PyResult<f64> {
        let found = self.0.remove(name);
        found.ok_or_else(|| domain("settings", format!("no {name}"), "every number of the sphere"))
    }

    fn angle(&mut self, name: &str) -> PyResult<f64> {
        self.number(name).map(f64::to_radians)
    }

    fn place(&mut self, name: &str) -> PyResult<Place> {
        Ok(Place {
            theta: self.angle(&format!("{name}_theta"))?,
            phi: self.angle(&format!("{name}_phi"))?,
            radius: self.number(&format!("{name}_radius"))?,
        })
    }

    fn place_if_there(&mut self, name: &str) -> PyResult<Option<Place>> {
        let there = self.0.contains_key(&format!("{name}_radius"));
        there.then(|| self.place(name)).transpose()
    }
}

#[pymethods]
impl IntegratingSphere {
    /// Lengths in metres, angles in degrees.
    #[new]
    #[pyo3(signature = (*, arrangement, settings, baffles))]
    fn new(arrangement: &str, settings: HashMap<String, f64>, baffles: Vec<BaffleRow>) -> PyResult<Self> {
        let arrangement = match arrangement {
            "reflection" => Arrangement::Reflection,
            "transmission" => Arrangement::Transmission,
            name => {
                return Err(domain(
                    "arrangement",
                    format!("{name:?}"),
                    "reflection, transmission",
                ));
            }
        };
        let mut s = Settings(settings);
        let trap = match s.0.contains_key("trap_radius") {
            true => Some(Trap {
                radius: s.number("trap_radius")?,
                residual: s.number("trap_residual")?,
            }),
            false => None,
        };
        let view = s.angle("detector_view")?;
        let plan = Plan {
            arrangement,
            radius: s.number("radius")?,
            wall: s.number("wall")?,
            standard: s.number("standard")?,
            plug: s.number("plug")?,
            theta_i: s.angle("theta_i")?,
            phi_i: s.angle("phi_i")?,
            beam_radius: s.number("beam_radius")?,
            divergence: s.angle("divergence")?,
            sample_radius: s.number("sample_radius")?,
            entrance_radius: s.number("entrance_radius")?,
            trap,
            detector: Detector {
                place: s.place("detector")?,
                reflectance: s.number("detector_reflectance")?,
                view: if view > FRAC_PI_2 - 1e-9 { FRAC_PI_2 } else { view },
            },
            comparison: s.place_if_there("comparison")?,
            auxiliary: s.place_if_there("auxiliary")?,
            baffles: baffles
                .into_iter()
                .map(|(a, b, at, radius, reflectance)| {
                    Ok(Baffle {
                        between: [port(&a)?, port(&b)?],
                        at,
                        radius,
                        reflectance,
                    })
                })
                .collect::<PyResult<_>>()?,
        };
        if let Some(name) = s.0.keys().next() {
            return Err(domain("settings", format!("{name:?}"), "numbers of the sphere"));
        }
        Sphere::new(plan).map(IntegratingSphere).or_raise()
    }

    /// Ports as (name, unit vector from the middle of the sphere, half angle in degrees, share of the area).
    #[getter]
    fn ports(&self) -> Vec<(String, [f64; 3], f64, f64)> {
        let row = |p: &gonio_instrument::sphere::Port| {
            let half = p.half_angle.to_degrees();
            (p.name.to_string(), p.axis.to_array(), half, p.fraction())
        };
        self.0.ports.iter().map(row).collect()
    }

    /// Baffles as (middle, unit normal, radius), in radii of the sphere.
    #[getter]
    fn screens(&self) -> Vec<([f64; 3], [f64; 3], f64)> {
        let screens = self.0.screens.iter();
        screens
            .map(|s| (s.middle.to_array(), s.normal.to_array(), s.radius))
            .collect()
    }

    /// Share of diffuse light that the trap takes, and half angle in degrees of the round cone that takes as much.
    #[getter]
    fn cone(&self, py: Python<'_>) -> Option<(f64, f64)> {
        py.detach(|| {
            let cone = self.0.cone()?;
            Some((cone.diffuse_share(), cone.half_angle().to_degrees()))
        })
    }

    /// All that a model scatters into the hemisphere that is measured, and the part of it in the trap's cone.
    #[pyo3(signature = (model, *, channel=None))]
    fn integrals(&self, py: Python<'_>, model: &Bsdf, channel: Option<&str>) -> PyResult<(f64, Option<f64>)> {
        let k = model.channel_index(channel)?;
        Ok(py.detach(|| {
            let port = self.0.cone().map(|c| c.integral(model.0.as_ref(), k));
            (self.0.whole(model.0.as_ref(), k), port)
        }))
    }

    /// The multiplier by the balance of flux; `filled` are reflectances of what fills ports.
    #[pyo3(signature = (*, first, filled))]
    fn multiplier(&self, first: f64, filled: HashMap<String, f64>) -> PyResult<f64> {
        let filled: Vec<(PortName, f64)> = filled
            .iter()
            .map(|(name, rho)| Ok((port(name)?, *rho)))
            .collect::<PyResult<_>>()?;
        Ok(self.0.multiplier(first, &filled))
    }

    /// What the sphere says of a model: values as (value, standard error), and the readings.
    #[pyo3(signature = (model, *, channel, method, rays, seed, watch))]
    #[expect(clippy::too_many_arguments, reason = "keyword arguments of Python")]
    fn measure<'py>(
        &self,
        py: Python<'py>,
        model: &Bsdf,
        channel: Option<&str>,
        method: &str,
        rays: u32,
        seed: u64,
        watch: &RenderWatch,
    ) -> PyResult<Bound<'py, PyDict>> {
        let method = match method {
            "substitution" => Method::Substitution,
            "auxiliary" => Method::Auxiliary,
            "comparison" => Method::Comparison,
            name => {
                let allowed = "substitution, auxiliary, comparison";
                return Err(domain("method", format!("{name:?}"), allowed));
            }
        };
        let k = model.channel_index(channel)?;
        let found = py
            .detach(|| {
                let report = |done: f64| watch.hear_of(done);
                let effort = Effort { rays, seed };
                measure(&self.0, &model.0, k, method, &effort, watch.stop_flag(), &report)
            })
            .or_raise()?
            .ok_or_else(|| PyKeyboardInterrupt::new_err("stopped"))?;
        as_dict(py, &found)
    }
}

fn as_dict<'py>(py: Python<'py>, found: &SphereResult) -> PyResult<Bound<'py, PyDict>> {
    let pair = |e: Estimate| (e.value, e.u);
    let dict = PyDict::new(py);
    dict.set_item("total", pair(found.total))?;
    dict.set_item("diffuse", found.diffuse.map(pair))?;
    dict.set_item("port", found.port.map(pair))?;
    dict.set_item("regular", found.regular.map(pair))?;
    dict.set_item("plain_total", pair(found.plain_total))?;
    dict.set_item("plain_regular", found.plain_regular.map(pair))?;
    dict.set_item("diffuse_share", found.diffuse_share)?;
    dict.set_item("half_angle", found.half_angle.map(f64::to_degrees))?;
    let readings = PyList::empty(py);
    for r in &found.readings {
        let source = match r.source {
            Source::Beam => "beam",
            Source::Auxiliary => "auxiliary",
        };
        readings.append((source, r.sample, r.trap_open, r.flux.value, r.flux.u))?;
    }
    dict.set_item("readings", readings)?;
    Ok(dict)
}

/// What a model sends into a round cone about the mirrored or unbent direction; angles in degrees.
#[pyfunction]
#[pyo3(signature = (model, *, theta_i, phi_i, component, half_angle, channel=None))]
fn cone_integral(
    py: Python<'_>,
    model: &Bsdf,
    theta_i: f64,
    phi_i: f64,
    component: &str,
    half_angle: f64,
    channel: Option<&str>,
) -> PyResult<f64> {
    let wi = angles(["theta_i", "phi_i"], theta_i, phi_i)?.direction();
    let component = self::component(component)?;
    if !(0.0..=90.0).contains(&half_angle) {
        return Err(domain("half_angle", half_angle, "0 to 90 degrees"));
    }
    let k = model.channel_index(channel)?;
    Ok(py.detach(|| cone::cone_integral(model.0.as_ref(), wi, component, k, half_angle.to_radians())))
}

pub(crate) fn register(m: &Bound<'_, PyModule>) -> PyResult<()> {
    m.add_class::<IntegratingSphere>()?;
    m.add_function(wrap_pyfunction!(cone_integral, m)?)
}
