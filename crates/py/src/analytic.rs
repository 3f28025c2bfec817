//! Analytic models by name, and the registry as data.

use std::sync::Arc;

use gonio_bsdf as core;
use gonio_bsdf::Channel;
use gonio_bsdf::analytic::{
    Law, ModelInfo, ParameterInfo, Parametric, Role, Scatters, Sum, lobe_named, models,
};
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyList};

use crate::bsdf::Bsdf;
use crate::errors::{OrRaise, domain};

/// A parameter of one part: one value for every channel, or one a channel.
enum Value {
    All(f64),
    Each(Vec<(Channel, f64)>),
}

impl Value {
    fn read(info: &ParameterInfo, given: &Bound<'_, PyAny>) -> PyResult<Self> {
        let scale = if info.unit == "rad" {
            1f64.to_radians()
        } else {
            1.0
        };
        let Ok(dict) = given.cast::<PyDict>() else {
            return Ok(Value::All(given.extract::<f64>()? * scale));
        };
        let mut values = Vec::new();
        for (channel, value) in dict {
            let channel: Channel = channel.extract::<String>()?.parse().or_raise()?;
            values.push((channel, value.extract::<f64>()? * scale));
        }
        Ok(Value::Each(values))
    }

    fn at(&self, channel: Channel, info: &ParameterInfo) -> PyResult<f64> {
        match self {
            Value::All(v) => Ok(*v),
            Value::Each(values) => values
                .iter()
                .find(|(c, _)| *c == channel)
                .map(|(_, v)| *v)
                .ok_or_else(|| domain(info.name, "nothing", &format!("a value for channel {channel}"))),
        }
    }
}

/// One part as given: its model and the values of its parameters.
struct Part {
    model: &'static dyn Parametric,
    values: Vec<Value>,
}

impl Part {
    fn read(spec: &Bound<'_, PyDict>) -> PyResult<Self> {
        let rest = spec.copy()?;
        let Some(name) = rest.get_item("model")? else {
            return Err(domain("model", "nothing", "the name of a model"));
        };
        rest.del_item("model")?;
        let model = lobe_named(&name.extract::<String>()?).or_raise()?;
        let info = model.info();
        let mut values = Vec::with_capacity(info.parameters.len());
        for p in info.parameters {
            let Some(given) = rest.get_item(p.name)? else {
                return Err(domain(
                    p.name,
                    "nothing",
                    &format!("a value for part {:?}", info.name),
                ));
            };
            rest.del_item(p.name)?;
            values.push(Value::read(p, &given)?);
        }
        match rest.keys().iter().next() {
            None => Ok(Part { model, values }),
            Some(key) => Err(domain(
                &format!("part {:?}", info.name),
                format!("parameter {key}"),
                &names(info),
            )),
        }
    }

    fn channels(&self) -> impl Iterator<Item = Channel> {
        self.values.iter().flat_map(|v| match v {
            Value::All(_) => Vec::new(),
            Value::Each(values) => values.iter().map(|(c, _)| *c).collect(),
        })
    }

    fn build(&self, channels: &[Channel]) -> PyResult<Box<dyn core::Bsdf>> {
        let infos = self.model.info().parameters;
        let parameters = channels
            .iter()
            .map(|&c| {
                let p: PyResult<Vec<f64>> = self.values.iter().zip(infos).map(|(v, i)| v.at(c, i)).collect();
                Ok((c, p?))
            })
            .collect::<PyResult<Vec<_>>>()?;
        self.model.model(&parameters).or_raise()
    }
}

fn names(info: &ModelInfo) -> String {
    info.parameters
        .iter()
        .map(|p| p.name)
        .collect::<Vec<_>>()
        .join(", ")
}

/// Name of a parameter's role.
pub(crate) fn role_name(role: Role) -> &'static str {
    match role {
        Role::Amplitude => "amplitude",
        Role::Width => "width",
        Role::Angle => "angle",
        Role::Index => "index",
        Role::Exponent => "exponent",
    }
}

/// An analytic model, the sum of `parts`. Each part is a dict with `model`, a name of `model_families`, and that
/// model's parameters (angles in degrees): a number for every channel or a dict from channel to number. Without any
/// such dict the model is photopic.
#[pyfunction]
fn analytic(parts: Vec<Bound<'_, PyDict>>) -> PyResult<Bsdf> {
    let parts = parts.iter().map(Part::read).collect::<PyResult<Vec<_>>>()?;
    let mut channels = Vec::new();
    for c in parts.iter().flat_map(Part::channels) {
        if !channels.contains(&c) {
            channels.push(c);
        }
    }
    if channels.is_empty() {
        channels.push(Channel::Photopic);
    }
    let mut built = parts
        .iter()
        .map(|p| p.build(&channels))
        .collect::<PyResult<Vec<_>>>()?;
    if built.len() == 1 {
        return Ok(Bsdf(Arc::from(built.remove(0))));
    }
    Ok(Bsdf(Arc::new(Sum::new(built).or_raise()?)))
}

/// Every analytic model as data: name, title, source, scatters, parameters (name, unit, low, high, default, role,
/// meaning; angles in degrees) and the laws it breaks by design with the measured amount.
#[pyfunction]
fn model_families(py: Python<'_>) -> PyResult<Bound<'_, PyList>> {
    let list = PyList::empty(py);
    for f in models() {
        let info = f.info();
        let dict = PyDict::new(py);
        dict.set_item("name", info.name)?;
        dict.set_item("title", info.title)?;
        dict.set_item("source", info.source)?;
        dict.set_item(
            "scatters",
            match info.scatters {
                Scatters::Reflection => "reflection",
                Scatters::Transmission => "transmission",
                Scatters::Both => "both",
            },
        )?;
        let parameters = PyList::empty(py);
        for p in info.parameters {
            let angle = p.unit == "rad";
            let degrees = |v: f64| if angle { v.to_degrees() } else { v };
            let row = PyDict::new(py);
            row.set_item("name", p.name)?;
            row.set_item("unit", if angle { "degree" } else { p.unit })?;
            row.set_item("low", degrees(p.low))?;
            row.set_item("high", degrees(p.high))?;
            row.set_item("default", degrees(p.default))?;
            row.set_item("role", role_name(p.role))?;
            row.set_item("meaning", p.meaning)?;
            parameters.append(row)?;
        }
        dict.set_item("parameters", parameters)?;
        let breaks = PyDict::new(py);
        for b in info.breaks {
            let law = match b.law {
                Law::Reciprocity => "reciprocity",
                Law::Energy => "energy",
            };
            breaks.set_item(law, b.amount)?;
        }
        dict.set_item("breaks", breaks)?;
        list.append(dict)?;
    }
    Ok(list)
}

pub(crate) fn register(m: &Bound<'_, PyModule>) -> PyResult<()> {
    m.add_function(wrap_pyfunction!(analytic, m)?)?;
    m.add_function(wrap_pyfunction!(model_families, m)?)
}
