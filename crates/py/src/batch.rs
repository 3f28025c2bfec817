//! Whole arrays of unit vectors in and arrays out, in the precision they come in.

use gonio_bsdf::Bsdf as Model;
use gonio_bsdf::batch::{Directions, Number, SampleColumns, first_not_uniform};
use numpy::{
    Element, PyArray1, PyArray2, PyArrayDyn, PyArrayMethods, PyReadonlyArrayDyn, PyUntypedArrayMethods,
    ndarray::ArrayView2,
};
use pyo3::prelude::*;
use pyo3::types::PyDict;

use crate::errors::domain;

/// Rows that are worked on together: columns that are not contiguous are gathered this many at a time.
const STRETCH: usize = 4096;
/// How far a squared length may be from 1.
const UNIT: f64 = 1e-5;

/// Whether `array` is of single precision: then everything is, else double.
pub(crate) fn is_single(array: &Bound<'_, PyAny>) -> bool {
    array.cast::<PyArrayDyn<f32>>().is_ok()
}

/// `array` as numpy sees it in precision `T`: itself where it is that already.
fn as_array<'py, T: Number + Element>(
    array: &Bound<'py, PyAny>,
    name: &str,
) -> PyResult<PyReadonlyArrayDyn<'py, T>> {
    let numpy = array.py().import("numpy")?;
    let array = numpy.call_method1("require", (array, T::get_dtype(array.py()), "A"))?;
    array
        .cast_into::<PyArrayDyn<T>>()
        .map_err(|_| domain(name, "no array of numbers", "an array of numbers"))?
        .try_readonly()
        .map_err(|_| domain(name, "an array that is being written to", "one that is not"))
}

/// Columns of an array of shape (3, n), or (n, 3) for any other n than 3.
fn columns<'a, T: Number + Element>(
    array: &'a PyReadonlyArrayDyn<'_, T>,
    name: &str,
    allowed: &str,
) -> PyResult<ArrayView2<'a, T>> {
    let view = array
        .as_array()
        .into_dimensionality::<numpy::ndarray::Ix2>()
        .map_err(|_| domain(name, format!("shape {:?}", array.shape()), allowed))?;
    match *view.shape() {
        [3, _] => Ok(view),
        [_, 3] => Ok(view.reversed_axes()),
        _ => Err(domain(name, format!("shape {:?}", array.shape()), allowed)),
    }
}

/// One direction for all, or columns.
enum Given<'a, T> {
    One([T; 3]),
    Each(ArrayView2<'a, T>),
}

const SHAPES: &str = "shape (3,), (3, n) or (n, 3)";

impl<'a, T: Number + Element> Given<'a, T> {
    fn read(array: &'a PyReadonlyArrayDyn<'_, T>, name: &str) -> PyResult<Self> {
        if let ([3], Ok(one)) = (
            array.shape(),
            array.as_array().into_dimensionality::<numpy::ndarray::Ix1>(),
        ) {
            return Ok(Given::One([one[0], one[1], one[2]]));
        }
        Ok(Given::Each(columns(array, name, SHAPES)?))
    }

    fn len(&self) -> Option<usize> {
        match self {
            Given::One(_) => None,
            Given::Each(view) => Some(view.shape()[1]),
        }
    }

    /// Those of rows `start..end`; columns that are not contiguous go through `scratch`.
    fn stretch<'s>(&'s self, start: usize, end: usize, scratch: &'s mut [Vec<T>; 3]) -> Directions<'s, T> {
        match self {
            Given::One(v) => Directions::One(*v),
            Given::Each(view) => Directions::Each(stretch(view, start, end, scratch)),
        }
    }
}

fn stretch<'s, T: Copy>(
    view: &'s ArrayView2<'_, T>,
    start: usize,
    end: usize,
    scratch: &'s mut [Vec<T>; 3],
) -> [&'s [T]; 3] {
    let mut k = 0;
    scratch.each_mut().map(|scratch| {
        let row = view.index_axis(numpy::ndarray::Axis(0), k);
        k += 1;
        match row.to_slice() {
            Some(whole) => &whole[start..end],
            None => {
                scratch.clear();
                scratch.extend((start..end).map(|j| row[j]));
                &scratch[..]
            }
        }
    })
}

/// The error for a vector that is not unit.
fn checked<T: Number>(d: &Directions<'_, T>, start: usize, name: &str) -> PyResult<()> {
    let Some(j) = d.first_not_unit(T::rounded(UNIT)) else {
        return Ok(());
    };
    let v = d.at(j).map(Into::<f64>::into);
    let field = match d {
        Directions::One(_) => name.to_owned(),
        Directions::Each(_) => format!("{name} of pair {}", start + j),
    };
    Err(domain(
        &field,
        format!("({}, {}, {})", v[0], v[1], v[2]),
        "a unit vector (squared length within 1e-5 of 1)",
    ))
}

fn same_length(lengths: [Option<usize>; 2], names: [&str; 2]) -> PyResult<usize> {
    match lengths {
        [Some(a), Some(b)] if a != b => Err(domain(
            names[1],
            format!("{b} vectors"),
            &format!("{a}, as many as {}", names[0]),
        )),
        [a, b] => Ok(a.or(b).unwrap_or(1)),
    }
}

/// A new array of `count` rows. numpy asks for huge pages below what it leaves unfilled, not below its zeros, and most
/// of the time of filling fresh memory goes into the faults of small ones.
fn rows<T: Number + Element>(py: Python<'_>, count: usize, n: usize) -> PyResult<Bound<'_, PyArray2<T>>> {
    let numpy = py.import("numpy")?;
    let array = numpy.call_method1("empty", ((count, n), T::get_dtype(py)))?;
    Ok(array.cast_into::<PyArray2<T>>()?)
}

/// `out` as the array to write `count` rows of `n` to.
fn given_rows<'py, T: Number + Element>(
    out: &Bound<'py, PyAny>,
    count: usize,
    n: usize,
) -> PyResult<Bound<'py, PyArray2<T>>> {
    let dtype = T::get_dtype(out.py());
    let allowed = format!("a C-contiguous {dtype} array of shape ({count}, {n})");
    let Ok(array) = out.cast::<PyArray2<T>>() else {
        let found = out.getattr("dtype").unwrap_or(out.get_type().into_any());
        return Err(domain("out", found, &allowed));
    };
    if array.shape() != [count, n] || !array.is_c_contiguous() {
        let found = format!("shape {:?}, strides {:?}", array.shape(), array.strides());
        return Err(domain("out", found, &allowed));
    }
    Ok(array.clone())
}

/// `f(wi, ws)` of shape (channels, n), in `out` where it is given.
pub(crate) fn eval_directions<'py, T: Number + Element>(
    model: &dyn Model,
    wi: &Bound<'py, PyAny>,
    ws: &Bound<'py, PyAny>,
    out: Option<&Bound<'py, PyAny>>,
) -> PyResult<Bound<'py, PyArray2<T>>> {
    let py = wi.py();
    let (wi, ws) = (as_array::<T>(wi, "wi")?, as_array::<T>(ws, "ws")?);
    let (wi, ws) = (Given::read(&wi, "wi")?, Given::read(&ws, "ws")?);
    let n = same_length([wi.len(), ws.len()], ["wi", "ws"])?;
    let channels = model.channels().len();
    let out = match out {
        Some(out) => given_rows::<T>(out, channels, n)?,
        None => rows::<T>(py, channels, n)?,
    };
    if n == 0 {
        return Ok(out);
    }
    {
        let mut out = out.try_readwrite().map_err(|_| {
            domain(
                "out",
                "read-only or shared with wi or ws",
                "a writable array of its own",
            )
        })?;
        let f = out.as_slice_mut()?;
        py.detach(|| -> PyResult<()> {
            let mut scratch: [[Vec<T>; 3]; 2] = Default::default();
            let [one, two] = &mut scratch;
            let mut rest: Vec<&mut [T]> = f.chunks_mut(n).collect();
            for start in (0..n).step_by(STRETCH) {
                let end = (start + STRETCH).min(n);
                let (wi, ws) = (wi.stretch(start, end, one), ws.stretch(start, end, two));
                let mut rows = take(&mut rest, end - start);
                T::eval(model, wi, ws, &mut rows);
                // Checked after, in the cache by then: reading memory goes on beside the arithmetic of the model.
                if start == 0 || matches!(wi, Directions::Each(_)) {
                    checked(&wi, start, "wi")?;
                }
                if start == 0 || matches!(ws, Directions::Each(_)) {
                    checked(&ws, start, "ws")?;
                }
            }
            Ok(())
        })?;
    }
    Ok(out)
}

/// The next `n` entries of every row.
fn take<'a, T>(rows: &mut Vec<&'a mut [T]>, n: usize) -> Vec<&'a mut [T]> {
    let (heads, tails) = std::mem::take(rows)
        .into_iter()
        .map(|row| row.split_at_mut(n))
        .unzip();
    *rows = tails;
    heads
}

/// Sampled directions (3, n), weights (channels, n) and densities (n).
pub(crate) fn sample_directions<'py, T: Number + Element>(
    model: &dyn Model,
    wi: &Bound<'py, PyAny>,
    u: &Bound<'py, PyAny>,
) -> PyResult<Bound<'py, PyDict>> {
    let py = wi.py();
    let (wi, u) = (as_array::<T>(wi, "wi")?, as_array::<T>(u, "u")?);
    let wi = Given::read(&wi, "wi")?;
    let u = columns(&u, "u", "shape (3, n) or (n, 3)")?;
    let n = same_length([wi.len(), Some(u.shape()[1])], ["wi", "u"])?;
    let ws = rows::<T>(py, 3, n)?;
    let weight = rows::<T>(py, model.channels().len(), n)?;
    let pdf = PyArray1::<T>::zeros(py, n, false);
    if n > 0 {
        let (mut ws, mut weight, mut pdf) = (ws.readwrite(), weight.readwrite(), pdf.readwrite());
        let (ws, weight, pdf) = (ws.as_slice_mut()?, weight.as_slice_mut()?, pdf.as_slice_mut()?);
        py.detach(|| -> PyResult<()> {
            let mut scratch: [[Vec<T>; 3]; 2] = Default::default();
            let [one, two] = &mut scratch;
            let mut rest: Vec<&mut [T]> = ws
                .chunks_mut(n)
                .chain(weight.chunks_mut(n))
                .chain([pdf])
                .collect();
            for start in (0..n).step_by(STRETCH) {
                let end = (start + STRETCH).min(n);
                let wi = wi.stretch(start, end, one);
                if start == 0 || matches!(wi, Directions::Each(_)) {
                    checked(&wi, start, "wi")?;
                }
                let u = stretch(&u, start, end, two);
                if let Some(bad) = u.iter().find_map(|column| first_not_uniform(column)) {
                    return Err(domain("u", Into::<f64>::into(bad), "numbers in [0, 1)"));
                }
                let mut rows = take(&mut rest, end - start).into_iter();
                if let (Some(x), Some(y), Some(z), Some(pdf)) =
                    (rows.next(), rows.next(), rows.next(), rows.next_back())
                {
                    let direction = [x, y, z];
                    let weight = rows.collect();
                    T::sample(
                        model,
                        wi,
                        u,
                        &mut SampleColumns {
                            direction,
                            weight,
                            pdf,
                        },
                    );
                }
            }
            Ok(())
        })?;
    }
    let dict = PyDict::new(py);
    dict.set_item("ws", ws)?;
    dict.set_item("weight", weight)?;
    dict.set_item("pdf", pdf)?;
    Ok(dict)
}
