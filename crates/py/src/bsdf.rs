//! `Bsdf`: any scattering model behind the one trait.

use std::sync::Arc;

use gonio_bsdf as core;
use gonio_geom::Direction;
use numpy::{PyArray1, PyArrayDyn, PyArrayMethods, PyUntypedArrayMethods};
use pyo3::prelude::*;
use pyo3::types::PyDict;

use crate::arrays::Block;
use crate::batch::{eval_directions, is_single, sample_directions};
use crate::errors::{QuantityError, domain};

/// A scattering model. Angles are degrees; every argument of `eval` and `pdf` broadcasts as in numpy.
#[pyclass(frozen, subclass, module = "gonio", name = "Bsdf")]
pub(crate) struct Bsdf(pub(crate) Arc<dyn core::Bsdf>);

impl Bsdf {
    /// Position of `channel`; without one the model must have a single channel.
    pub(crate) fn channel_index(&self, channel: Option<&str>) -> PyResult<usize> {
        let there = self.0.channels();
        let names = || {
            there
                .iter()
                .map(ToString::to_string)
                .collect::<Vec<_>>()
                .join(", ")
        };
        match channel {
            None if there.len() == 1 => Ok(0),
            None => Err(QuantityError::new_err(format!(
                "channel (--channel): found none, needed one of {}",
                names()
            ))),
            // "532" and "532nm" are one channel, as where files are read.
            Some(name) => name
                .parse::<core::Channel>()
                .ok()
                .and_then(|wanted| there.iter().position(|c| *c == wanted))
                .ok_or_else(|| {
                    QuantityError::new_err(format!("channel: found {name:?}, needed one of {}", names()))
                }),
        }
    }
}

/// Directions of the four broadcast angle arrays, with the common shape.
pub(crate) struct Pairs {
    pub(crate) shape: Vec<usize>,
    pub(crate) wi: Vec<Direction>,
    pub(crate) ws: Vec<Direction>,
}

impl Pairs {
    pub(crate) fn broadcast(py: Python<'_>, angles: [&Bound<'_, PyAny>; 4]) -> PyResult<Self> {
        const NAMES: [&str; 4] = ["theta_i", "phi_i", "theta_s", "phi_s"];
        let numpy = py.import("numpy")?;
        let kwargs = PyDict::new(py);
        kwargs.set_item("dtype", "float64")?;
        let mut arrays = Vec::with_capacity(4);
        for a in angles {
            arrays.push(numpy.call_method("asarray", (a,), Some(&kwargs))?);
        }
        let same = numpy.call_method1(
            "broadcast_arrays",
            (&arrays[0], &arrays[1], &arrays[2], &arrays[3]),
        )?;
        let mut columns: [Vec<f64>; 4] = Default::default();
        let mut shape = Vec::new();
        for (k, item) in same.try_iter()?.enumerate() {
            let block: Block<'_> = item?.extract()?;
            shape = block.shape().to_vec();
            columns[k] = block.as_array().iter().copied().collect();
            let bad = columns[k]
                .iter()
                .find(|a| !a.is_finite() || (k % 2 == 0 && !(0.0..=180.0).contains(*a)));
            if let Some(bad) = bad {
                let allowed = if k % 2 == 0 {
                    "0 to 180 degrees"
                } else {
                    "a finite angle in degrees"
                };
                return Err(domain(NAMES[k], bad, allowed));
            }
        }
        let directions = |theta: &[f64], phi: &[f64]| {
            theta
                .iter()
                .zip(phi)
                .map(|(&t, &p)| Direction::from_degrees(t, p))
                .collect()
        };
        Ok(Pairs {
            shape,
            wi: directions(&columns[0], &columns[1]),
            ws: directions(&columns[2], &columns[3]),
        })
    }

    fn map<'py, T: numpy::Element>(
        &self,
        py: Python<'py>,
        f: impl Fn(Direction, Direction) -> T + Sync + Send,
    ) -> PyResult<Bound<'py, PyArrayDyn<T>>> {
        let values: Vec<T> = py.detach(|| self.wi.iter().zip(&self.ws).map(|(&wi, &ws)| f(wi, ws)).collect());
        PyArray1::from_vec(py, values).reshape(self.shape.clone())
    }
}

#[pymethods]
impl Bsdf {
    /// Names of the channels.
    #[getter]
    fn channels(&self) -> Vec<String> {
        self.0.channels().iter().map(ToString::to_string).collect()
    }

    /// Whether the model has an ideal part (mirror, unbent, refracted), which `eval` and `pdf` leave out.
    #[getter]
    fn has_delta(&self) -> bool {
        self.0.has_delta()
    }

    /// What the model promises: reciprocal, energy_conserving, isotropic.
    #[getter]
    fn properties<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let p = self.0.properties();
        let dict = PyDict::new(py);
        dict.set_item("reciprocal", p.reciprocal)?;
        dict.set_item("energy_conserving", p.energy_conserving)?;
        dict.set_item("isotropic", p.isotropic)?;
        Ok(dict)
    }

    /// f(wi, ws) in 1/sr, no cosine; shape = the broadcast shape of the angles (degrees).
    #[pyo3(signature = (*, theta_i, phi_i, theta_s, phi_s, channel=None))]
    fn eval<'py>(
        &self,
        py: Python<'py>,
        theta_i: &Bound<'py, PyAny>,
        phi_i: &Bound<'py, PyAny>,
        theta_s: &Bound<'py, PyAny>,
        phi_s: &Bound<'py, PyAny>,
        channel: Option<&str>,
    ) -> PyResult<Bound<'py, PyArrayDyn<f64>>> {
        let index = self.channel_index(channel)?;
        let pairs = Pairs::broadcast(py, [theta_i, phi_i, theta_s, phi_s])?;
        let (model, n) = (&self.0, self.0.channels().len());
        pairs.map(py, |wi, ws| {
            if n == 1 {
                return model.eval_first(wi, ws);
            }
            let mut f = vec![0.0; n];
            model.eval(wi, ws, &mut f);
            f[index]
        })
    }

    /// Whether f rests on data at the pairs: a measured model answers False where it extrapolates or has nothing, an
    /// analytic one True everywhere. Broadcasts like `eval`.
    #[pyo3(signature = (*, theta_i, phi_i, theta_s, phi_s))]
    fn has_data<'py>(
        &self,
        py: Python<'py>,
        theta_i: &Bound<'py, PyAny>,
        phi_i: &Bound<'py, PyAny>,
        theta_s: &Bound<'py, PyAny>,
        phi_s: &Bound<'py, PyAny>,
    ) -> PyResult<Bound<'py, PyArrayDyn<bool>>> {
        let pairs = Pairs::broadcast(py, [theta_i, phi_i, theta_s, phi_s])?;
        pairs.map(py, |wi, ws| self.0.has_data(wi, ws))
    }

    /// Density (1/sr of the direction s) with which `sample` returns s, given i; broadcasts like `eval`.
    #[pyo3(signature = (*, theta_i, phi_i, theta_s, phi_s))]
    fn pdf<'py>(
        &self,
        py: Python<'py>,
        theta_i: &Bound<'py, PyAny>,
        phi_i: &Bound<'py, PyAny>,
        theta_s: &Bound<'py, PyAny>,
        phi_s: &Bound<'py, PyAny>,
    ) -> PyResult<Bound<'py, PyArrayDyn<f64>>> {
        let pairs = Pairs::broadcast(py, [theta_i, phi_i, theta_s, phi_s])?;
        pairs.map(py, |wi, ws| self.0.pdf(wi, ws))
    }

    /// The ideal part of the model, which `eval` and `pdf` leave out: where light from the incidence goes without
    /// spreading (mirrored, straight through, refracted), and the share of its flux that does.
    ///
    /// The angles broadcast. Returns a dict of arrays: theta_s, phi_s (degrees, NaN where there is no such part) and
    /// share of the channel.
    #[pyo3(signature = (*, theta_i, phi_i, component, channel=None))]
    fn delta<'py>(
        &self,
        py: Python<'py>,
        theta_i: &Bound<'py, PyAny>,
        phi_i: &Bound<'py, PyAny>,
        component: &str,
        channel: Option<&str>,
    ) -> PyResult<Bound<'py, PyDict>> {
        let index = self.channel_index(channel)?;
        let component = crate::radiance::component_of(component)?;
        let pairs = Pairs::broadcast(py, [theta_i, phi_i, theta_i, phi_i])?;
        let columns = py.detach(|| {
            let mut shares = vec![0.0; self.0.channels().len()];
            let mut columns: [Vec<f64>; 3] = Default::default();
            for &w in &pairs.wi {
                let (theta, phi) = match self.0.delta(w, component, &mut shares) {
                    Some(d) => d.angles().to_degrees(),
                    None => (f64::NAN, f64::NAN),
                };
                for (c, v) in columns.iter_mut().zip([theta, phi, shares[index]]) {
                    c.push(v);
                }
            }
            columns
        });
        let dict = PyDict::new(py);
        for (name, values) in ["theta_s", "phi_s", "share"].into_iter().zip(columns) {
            dict.set_item(name, PyArray1::from_vec(py, values).reshape(pairs.shape.clone())?)?;
        }
        Ok(dict)
    }

    /// Directions sampled for one incidence from uniform numbers `u` of shape (n, 3) in [0, 1).
    ///
    /// Returns a dict of arrays of length n: theta_s, phi_s (degrees), weight = f |cos| / pdf of the first channel,
    /// pdf (1/sr), ideal. A failed sample has weight 0 and NaN angles; where ideal is true the direction has no spread,
    /// and pdf is the probability of drawing it.
    #[pyo3(signature = (*, theta_i, phi_i, u))]
    fn sample<'py>(
        &self,
        py: Python<'py>,
        theta_i: f64,
        phi_i: f64,
        u: Block<'py>,
    ) -> PyResult<Bound<'py, PyDict>> {
        let wi = crate::arrays::angles(["theta_i", "phi_i"], theta_i, phi_i)?.direction();
        let shape = u.shape();
        if shape.len() != 2 || shape[1] != 3 {
            return Err(domain("u", format!("shape {shape:?}"), "shape (n, 3)"));
        }
        let flat: Vec<f64> = u.as_array().iter().copied().collect();
        if let Some(bad) = flat.iter().find(|v| !(0.0..1.0).contains(*v)) {
            return Err(domain("u", bad, "numbers in [0, 1)"));
        }
        let (columns, ideal) = py.detach(|| {
            let mut ideal = Vec::with_capacity(flat.len() / 3);
            let mut columns: [Vec<f64>; 4] = Default::default();
            for c in &mut columns {
                c.reserve(flat.len() / 3);
            }
            for u in flat.chunks_exact(3) {
                let drawn = self.0.sample(wi, [u[0], u[1], u[2]]);
                ideal.push(drawn.is_some_and(|s| s.lobe == core::Lobe::Delta));
                let row = match drawn {
                    Some(s) => {
                        let (theta, phi) = s.direction.angles().to_degrees();
                        [theta, phi, s.weight, s.pdf]
                    }
                    None => [f64::NAN, f64::NAN, 0.0, 0.0],
                };
                for (c, v) in columns.iter_mut().zip(row) {
                    c.push(v);
                }
            }
            (columns, ideal)
        });
        let dict = PyDict::new(py);
        dict.set_item("ideal", PyArray1::from_vec(py, ideal))?;
        for (name, values) in ["theta_s", "phi_s", "weight", "pdf"].into_iter().zip(columns) {
            dict.set_item(name, PyArray1::from_vec(py, values))?;
        }
        Ok(dict)
    }

    /// f(wi, ws) in 1/sr, no cosine, of unit vectors: an array of shape (channels, n).
    ///
    /// `wi` and `ws` have shape (3,), one direction for all pairs, or (3, n), or (n, 3) for n other than 3; columns of
    /// (3, n) in C order are read in place. Where `ws` is a float32 array everything is done in single precision and
    /// the result is float32: analytic models are then within 2e-6 relative of double precision at the same vectors,
    /// times one more than the exponent where a lobe falls as e^-x. (The rounding of the vectors themselves moves a
    /// lobe of width alpha by 1e-7 / alpha of its width: use float64 where that counts.) Otherwise float64. Vectors
    /// must be unit to 1e-5 in squared length and are not normalised. Runs on the calling thread, without the
    /// interpreter's lock.
    ///
    /// `out`, a C-contiguous array of the result's shape and type, is written to and returned, as in numpy: a loop over
    /// millions of directions then spares the kernel the clearing of a new array each time, which takes as long as a
    /// simple model. After an error it holds nothing of use.
    #[pyo3(signature = (*, wi, ws, out=None))]
    fn eval_directions<'py>(
        &self,
        wi: &Bound<'py, PyAny>,
        ws: &Bound<'py, PyAny>,
        out: Option<&Bound<'py, PyAny>>,
    ) -> PyResult<Bound<'py, PyAny>> {
        Ok(if is_single(ws) {
            eval_directions::<f32>(self.0.as_ref(), wi, ws, out)?.into_any()
        } else {
            eval_directions::<f64>(self.0.as_ref(), wi, ws, out)?.into_any()
        })
    }

    /// Directions sampled from uniform numbers `u` in [0, 1) of shape (3, n), or (n, 3) for n other than 3.
    ///
    /// `wi` as for `eval_directions`. Returns a dict: ws (3, n), weight = f |cos| / pdf of shape (channels, n), pdf (n) in
    /// 1/sr. Single precision where `u` is a float32 array. The same `u` give the same directions as `sample`, up to
    /// rounding. A failed sample has weight and pdf 0 and NaN for ws; an ideal direction (mirror) has the weight of the
    /// first channel only, NaN for the others.
    #[pyo3(signature = (*, wi, u))]
    fn sample_directions<'py>(
        &self,
        wi: &Bound<'py, PyAny>,
        u: &Bound<'py, PyAny>,
    ) -> PyResult<Bound<'py, PyDict>> {
        if is_single(u) {
            sample_directions::<f32>(self.0.as_ref(), wi, u)
        } else {
            sample_directions::<f64>(self.0.as_ref(), wi, u)
        }
    }

    fn __repr__(&self) -> String {
        format!("Bsdf(channels=[{}])", self.channels().join(", "))
    }
}

pub(crate) fn register(m: &Bound<'_, PyModule>) -> PyResult<()> {
    m.add_class::<Bsdf>()
}
