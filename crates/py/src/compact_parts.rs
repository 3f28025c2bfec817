//! The parts of a compact model as files have them.

use gonio_bsdf::analytic::lobe_named;
use gonio_bsdf::compact::{BaseLobe, Coded, CompactPart, Frame, IdealPart, Quantised};
use gonio_geom::{Component, Side};
use numpy::{PyArray1, PyArrayDyn, PyArrayMethods, PyReadonlyArrayDyn};
use pyo3::exceptions::PyKeyError;
use pyo3::prelude::*;
use pyo3::types::{PyBytes, PyDict};

use crate::errors::{OrRaise, domain};
use crate::radiance::{component_of, side_of};

/// A part as files have it: angles in degrees, so that what is read is what was written, to the last bit.
#[derive(Clone)]
pub(crate) struct StoredPart {
    pub(crate) side: Side,
    pub(crate) component: Component,
    pub(crate) phi_x: f64,
    pub(crate) base: Vec<StoredLobe>,
    pub(crate) frame: Frame,
    pub(crate) table: Quantised,
}

#[derive(Clone)]
pub(crate) struct StoredLobe {
    model: String,
    weight: f64,
    /// Name and one value a channel, angles in degrees.
    parameters: Vec<(String, Vec<f64>)>,
}

impl StoredPart {
    pub(crate) fn of(side: Side, component: Component, part: &CompactPart) -> PyResult<Self> {
        let base = part.base.iter().map(StoredLobe::of).collect::<PyResult<_>>()?;
        Ok(StoredPart {
            side,
            component,
            phi_x: part.frame.phi_x.to_degrees(),
            base,
            frame: part.frame,
            table: part.table.clone(),
        })
    }

    pub(crate) fn part(&self, channels: usize) -> PyResult<CompactPart> {
        Ok(CompactPart {
            base: self
                .base
                .iter()
                .map(|l| l.lobe(channels))
                .collect::<PyResult<_>>()?,
            frame: Frame {
                phi_x: self.phi_x.to_radians(),
                ..self.frame
            },
            table: self.table.clone(),
        })
    }

    pub(crate) fn dict<'py>(&self, py: Python<'py>, channels: usize) -> PyResult<Bound<'py, PyDict>> {
        let d = PyDict::new(py);
        d.set_item("side", self.side.to_string())?;
        d.set_item("component", self.component.to_string())?;
        d.set_item("symmetry", self.frame.symmetry.name())?;
        d.set_item("width", self.frame.width)?;
        d.set_item("phi_x", self.phi_x)?;
        let base = self
            .base
            .iter()
            .map(|l| l.dict(py))
            .collect::<PyResult<Vec<_>>>()?;
        d.set_item("base", base)?;
        let [a, b, c, e] = self.frame.shape;
        let shape = [channels, a, b, c, e];
        let table = &self.table;
        d.set_item("codes", PyArray1::from_slice(py, table.codes()).reshape(shape)?)?;
        for (name, values) in [("offset", table.offset()), ("step", table.step())] {
            d.set_item(name, PyArray1::from_slice(py, values).reshape([channels, a])?)?;
        }
        d.set_item("theta_i", PyArray1::from_vec(py, thetas(a)))?;
        let coded = table.coded(&self.frame);
        let stored = coded
            .iter()
            .map(|channel| {
                let one = PyDict::new(py);
                one.set_item("bytes", PyBytes::new(py, &channel.bytes))?;
                one.set_item("offset", PyArray1::from_slice(py, &channel.offset))?;
                one.set_item("step", PyArray1::from_slice(py, &channel.step))?;
                Ok(one)
            })
            .collect::<PyResult<Vec<_>>>()?;
        d.set_item("shape", self.frame.shape)?;
        d.set_item("coded", stored)?;
        Ok(d)
    }
}

/// Polar angles of `n` nodes of incidence, degrees.
fn thetas(n: usize) -> Vec<f64> {
    let theta = |k: usize| {
        let cos = Frame::cos_theta_i(k as f64 / (n - 1) as f64);
        cos.clamp(-1.0, 1.0).acos().to_degrees()
    };
    (0..n).map(theta).collect()
}

/// Shares of light that does not spread, as files have them: `phi_x` in degrees.
#[derive(Clone)]
pub(crate) struct StoredIdeal {
    pub(crate) side: Side,
    pub(crate) component: Component,
    pub(crate) phi_x: f64,
    pub(crate) part: IdealPart,
}

impl StoredIdeal {
    pub(crate) fn of(side: Side, component: Component, part: &IdealPart) -> Self {
        StoredIdeal {
            side,
            component,
            phi_x: part.phi_x.to_degrees(),
            part: part.clone(),
        }
    }

    pub(crate) fn part(&self) -> IdealPart {
        IdealPart {
            phi_x: self.phi_x.to_radians(),
            ..self.part.clone()
        }
    }

    pub(crate) fn dict<'py>(&self, py: Python<'py>, channels: usize) -> PyResult<Bound<'py, PyDict>> {
        let d = PyDict::new(py);
        d.set_item("side", self.side.to_string())?;
        d.set_item("component", self.component.to_string())?;
        d.set_item("symmetry", self.part.symmetry.name())?;
        d.set_item("phi_x", self.phi_x)?;
        let [a, b] = self.part.shape;
        let shares = PyArray1::from_slice(py, &self.part.shares).reshape([channels, a, b])?;
        d.set_item("shares", shares)?;
        d.set_item("theta_i", PyArray1::from_vec(py, thetas(a)))?;
        Ok(d)
    }
}

pub(crate) fn stored_ideal(part: &Bound<'_, PyDict>) -> PyResult<StoredIdeal> {
    let text = |key: &str| -> PyResult<String> { item(part, key)?.extract() };
    let view: PyReadonlyArrayDyn<'_, f32> = item(part, "shares")?.extract()?;
    let [_, a, b] = view.as_array().shape()[..] else {
        let found = format!("shape {:?}", view.as_array().shape());
        return Err(domain("shares", found, "three dimensions"));
    };
    if a < 2 {
        return Err(domain("shares", format!("{a} polar angles"), "two or more"));
    }
    Ok(StoredIdeal {
        side: side_of(&text("side")?)?,
        component: component_of(&text("component")?)?,
        phi_x: item(part, "phi_x")?.extract()?,
        part: IdealPart {
            symmetry: text("symmetry")?.parse().or_raise()?,
            phi_x: 0.0,
            shape: [a, b],
            shares: view.as_array().iter().copied().collect(),
        },
    })
}

impl StoredLobe {
    fn of(lobe: &BaseLobe) -> PyResult<Self> {
        let info = lobe_named(&lobe.model).or_raise()?.info();
        let parameters = info
            .parameters
            .iter()
            .enumerate()
            .map(|(k, p)| {
                let unit = |v: f64| if p.unit == "rad" { v.to_degrees() } else { v };
                let values = lobe.parameters.iter().map(|row| unit(row[k])).collect();
                (p.name.to_owned(), values)
            })
            .collect();
        Ok(StoredLobe {
            model: lobe.model.clone(),
            weight: lobe.weight,
            parameters,
        })
    }

    fn lobe(&self, channels: usize) -> PyResult<BaseLobe> {
        let info = lobe_named(&self.model).or_raise()?.info();
        let expected: Vec<&str> = info.parameters.iter().map(|p| p.name).collect();
        let mut rows = vec![Vec::with_capacity(expected.len()); channels];
        if self.parameters.len() != expected.len() {
            let found: Vec<&str> = self.parameters.iter().map(|p| p.0.as_str()).collect();
            return Err(domain("parameters", found.join(", "), &expected.join(", ")));
        }
        for p in info.parameters {
            let given = self.parameters.iter().find(|(name, _)| name == p.name);
            let values = given.map(|(_, v)| v).ok_or_else(|| {
                domain(
                    "parameters",
                    format!("no {}", p.name),
                    &format!("{} of {}", expected.join(", "), self.model),
                )
            })?;
            if values.len() != channels {
                let allowed = format!("{channels}, one a channel");
                return Err(domain(p.name, format!("{} values", values.len()), &allowed));
            }
            for (row, v) in rows.iter_mut().zip(values) {
                row.push(if p.unit == "rad" { v.to_radians() } else { *v });
            }
        }
        Ok(BaseLobe {
            model: self.model.clone(),
            parameters: rows,
            weight: self.weight,
        })
    }

    fn dict<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let d = PyDict::new(py);
        d.set_item("model", &self.model)?;
        d.set_item("weight", self.weight)?;
        let parameters = PyDict::new(py);
        for (name, values) in &self.parameters {
            parameters.set_item(name, values)?;
        }
        d.set_item("parameters", parameters)?;
        Ok(d)
    }
}

fn item<'py>(dict: &Bound<'py, PyDict>, key: &str) -> PyResult<Bound<'py, PyAny>> {
    dict.get_item(key)?
        .ok_or_else(|| PyKeyError::new_err(key.to_owned()))
}

pub(crate) fn stored(part: &Bound<'_, PyDict>) -> PyResult<StoredPart> {
    let text = |key: &str| -> PyResult<String> { item(part, key)?.extract() };
    let width: [f64; 2] = item(part, "width")?.extract()?;
    let lobes: Vec<Bound<'_, PyDict>> = item(part, "base")?.extract()?;
    let base = lobes
        .iter()
        .map(|lobe| {
            let parameters = item(lobe, "parameters")?;
            let parameters = parameters.cast::<PyDict>()?;
            Ok(StoredLobe {
                model: item(lobe, "model")?.extract()?,
                weight: item(lobe, "weight")?.extract()?,
                parameters: parameters
                    .iter()
                    .map(|(k, v)| Ok((k.extract()?, v.extract()?)))
                    .collect::<PyResult<_>>()?,
            })
        })
        .collect::<PyResult<_>>()?;
    let frame = |shape: [usize; 4]| -> PyResult<Frame> {
        Ok(Frame {
            symmetry: text("symmetry")?.parse().or_raise()?,
            width,
            phi_x: 0.0,
            shape,
        })
    };
    let (frame, table) = if let Some(coded) = part.get_item("coded")? {
        let frame = frame(item(part, "shape")?.extract()?)?;
        let coded: Vec<Bound<'_, PyDict>> = coded.extract()?;
        let channels = coded.iter().map(channel).collect::<PyResult<Vec<_>>>()?;
        (frame, Quantised::of_coded(&frame, &channels).or_raise()?)
    } else {
        plain(part, frame)?
    };
    Ok(StoredPart {
        side: side_of(&text("side")?)?,
        component: component_of(&text("component")?)?,
        phi_x: item(part, "phi_x")?.extract()?,
        base,
        frame,
        table,
    })
}

/// A channel of a table, coded.
fn channel(of: &Bound<'_, PyDict>) -> PyResult<Coded> {
    let singles = |key: &str| -> PyResult<Vec<f32>> {
        let view: PyReadonlyArrayDyn<'_, f32> = item(of, key)?.extract()?;
        Ok(view.as_array().iter().copied().collect())
    };
    Ok(Coded {
        bytes: item(of, "bytes")?.extract()?,
        offset: singles("offset")?,
        step: singles("step")?,
    })
}

/// A table of codes one by one, as version 1 of the format has them.
fn plain(
    part: &Bound<'_, PyDict>,
    frame: impl Fn([usize; 4]) -> PyResult<Frame>,
) -> PyResult<(Frame, Quantised)> {
    let codes = item(part, "codes")?;
    let (codes, shape): (Vec<i16>, _) = if let Ok(array) = codes.cast::<PyArrayDyn<i8>>() {
        let view = array.readonly();
        (
            view.as_array().iter().map(|c| i16::from(*c)).collect(),
            view.as_array().shape().to_vec(),
        )
    } else if let Ok(array) = codes.cast::<PyArrayDyn<i16>>() {
        let view = array.readonly();
        (
            view.as_array().iter().copied().collect(),
            view.as_array().shape().to_vec(),
        )
    } else {
        return Err(domain("codes", codes.get_type(), "an array of int8 or int16"));
    };
    let [_, n0, n1, n2, n3] = shape[..] else {
        return Err(domain("codes", format!("shape {shape:?}"), "five dimensions"));
    };
    let singles = |key: &str| -> PyResult<Vec<f32>> {
        let view: PyReadonlyArrayDyn<'_, f32> = item(part, key)?.extract()?;
        Ok(view.as_array().iter().copied().collect())
    };
    let frame = frame([n0, n1, n2, n3])?;
    let table = Quantised::of_codes(&frame, codes, singles("offset")?, singles("step")?).or_raise()?;
    Ok((frame, table))
}
