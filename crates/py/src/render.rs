//! Scenes, pictures and sensors.

use std::path::PathBuf;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};

use glam::Vec3;
use gonio_io::picture as files;
use gonio_scene::view;
use gonio_trace::camera::{Camera, View};
use gonio_trace::path::Limits;
use gonio_trace::render::{Effort, Picture, Pixel, Report, Round};
use gonio_trace::sensor::{Readings, Sensor};
use numpy::{PyArray1, PyArray2, PyArrayMethods};
use pyo3::prelude::*;
use pyo3::types::PyDict;

use crate::arrays::{Block, Column};
use crate::errors::{OrRaise, domain};
use crate::scene::Scene;

/// A view from RADIANCE's options: all of them, and the size of its picture with square pixels within `width` by `height`.
#[pyfunction]
fn view_options(text: &str, width: usize, height: usize) -> PyResult<(String, usize, usize)> {
    let (view, camera) = camera(text)?;
    let wanted = f64::from(camera.aspect());
    let (w, h) = (width as f64, height as f64);
    let (w, h) = if w > h * wanted {
        ((h * wanted).round(), h)
    } else {
        (w, (w / wanted).round())
    };
    Ok((view.to_string(), w as usize, h as usize))
}

fn camera(text: &str) -> PyResult<(View, Camera)> {
    let words: Vec<&str> = text.split_whitespace().collect();
    let view = view::parse(view::STANDARD, &words).or_raise()?;
    Ok((view, Camera::new(view).or_raise()?))
}

/// A handle on rendering in another thread.
#[pyclass(frozen, module = "gonio", name = "RenderWatch")]
pub(crate) struct RenderWatch {
    stop: AtomicBool,
    done: AtomicU64,
    error: AtomicU64,
}

#[pymethods]
impl RenderWatch {
    #[new]
    fn new() -> Self {
        RenderWatch {
            stop: AtomicBool::new(false),
            done: AtomicU64::new(0.0_f64.to_bits()),
            error: AtomicU64::new(f64::INFINITY.to_bits()),
        }
    }

    /// Share of the samples that are taken; mean standard error over mean luminance.
    fn progress(&self) -> (f64, f64) {
        let value = |of: &AtomicU64| f64::from_bits(of.load(Ordering::Relaxed));
        (value(&self.done), value(&self.error))
    }

    /// Lets the rendering end soon, with whole samples.
    fn stop(&self) {
        self.stop.store(true, Ordering::Relaxed);
    }
}

impl RenderWatch {
    /// The share of the work that is done.
    pub(crate) fn hear_of(&self, done: f64) {
        self.done.store(done.to_bits(), Ordering::Relaxed);
    }

    pub(crate) fn stop_flag(&self) -> &AtomicBool {
        &self.stop
    }

    fn hear(&self, report: Report) {
        self.done.store(report.done.to_bits(), Ordering::Relaxed);
        self.error.store(report.error.to_bits(), Ordering::Relaxed);
    }
}

/// Samples of pixels or sensors, as they stand.
#[pyclass(module = "gonio", name = "Samples")]
pub(crate) struct Samples {
    pixels: Vec<Pixel>,
    round: Round,
}

#[pymethods]
impl Samples {
    /// `places` without samples.
    #[new]
    fn new(places: usize) -> Self {
        Samples {
            pixels: vec![Pixel::default(); places],
            round: Round::default(),
        }
    }

    /// From the arrays of `to_arrays`.
    #[staticmethod]
    #[pyo3(signature = (*, sum, square, count, goal, floor))]
    fn from_arrays(
        sum: Block<'_>,
        square: Column<'_>,
        count: Column<'_>,
        goal: u32,
        floor: f64,
    ) -> PyResult<Self> {
        let sums: Vec<f64> = sum.as_array().iter().copied().collect();
        let (square, count) = (square.as_array(), count.as_array());
        if sums.len() != 3 * square.len() || count.len() != square.len() {
            return Err(domain(
                "samples",
                format!(
                    "{} sums, {} squares, {} counts",
                    sums.len(),
                    square.len(),
                    count.len()
                ),
                "three sums, a square and a count a place",
            ));
        }
        let pixels = sums
            .chunks_exact(3)
            .zip(square.iter().zip(count))
            .map(|(s, (&square, &count))| Pixel {
                sum: [s[0], s[1], s[2]],
                square,
                count: count as u32,
            })
            .collect();
        Ok(Samples {
            pixels,
            round: Round { goal, floor },
        })
    }

    /// All that is needed to go on: sum (n, 3), square, count, goal, floor.
    fn to_arrays<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let dict = PyDict::new(py);
        let sums = self.pixels.iter().flat_map(|p| p.sum).collect();
        dict.set_item(
            "sum",
            PyArray1::<f64>::from_vec(py, sums).reshape([self.pixels.len(), 3])?,
        )?;
        dict.set_item("square", self.column(py, |p| p.square))?;
        let count: Vec<u32> = self.pixels.iter().map(|p| p.count).collect();
        dict.set_item("count", PyArray1::from_vec(py, count))?;
        dict.set_item("goal", self.round.goal)?;
        dict.set_item("floor", self.round.floor)?;
        Ok(dict)
    }

    /// Mean radiance or irradiance, shape (n, 3).
    fn mean<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f64>>> {
        let values = self.pixels.iter().flat_map(Pixel::mean).collect();
        PyArray1::<f64>::from_vec(py, values).reshape([self.pixels.len(), 3])
    }

    /// Luminance or illuminance of the mean.
    fn luminance<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        self.column(py, Pixel::luminance)
    }

    /// Standard error of the luminance; infinite below two batches.
    fn error<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        self.column(py, Pixel::error)
    }
}

impl Samples {
    fn column<'py>(&self, py: Python<'py>, of: impl Fn(&Pixel) -> f64) -> Bound<'py, PyArray1<f64>> {
        PyArray1::from_vec(py, self.pixels.iter().map(of).collect())
    }

    fn take(&mut self) -> (Vec<Pixel>, Round) {
        (std::mem::take(&mut self.pixels), self.round)
    }
}

fn effort(samples: u32, relative_error: Option<f64>, bounces: u32, seed: u64) -> Effort {
    Effort {
        samples,
        relative_error,
        limits: Limits {
            bounces,
            ..Limits::default()
        },
        seed,
        share: true,
    }
}

/// On the threads that are asked for.
fn on_threads<T: Send>(threads: Option<usize>, work: impl FnOnce() -> T + Send) -> PyResult<T> {
    match threads {
        None => Ok(work()),
        Some(n) => rayon::ThreadPoolBuilder::new()
            .num_threads(n)
            .build()
            .map(|pool| pool.install(work))
            .map_err(|e| domain("threads", e, "a number the system can start")),
    }
}

/// Adds samples to the pixels of a picture `width` across.
#[pyfunction]
#[pyo3(signature = (scene, into, *, view, width, samples, relative_error, bounces, seed, watch, threads=None))]
#[expect(clippy::too_many_arguments, reason = "the options of a picture, by name")]
fn render_picture(
    py: Python<'_>,
    scene: &Scene,
    into: &Bound<'_, Samples>,
    view: &str,
    width: usize,
    samples: u32,
    relative_error: Option<f64>,
    bounces: u32,
    seed: u64,
    watch: &RenderWatch,
    threads: Option<usize>,
) -> PyResult<()> {
    let (_, camera) = camera(view)?;
    let effort = effort(samples, relative_error, bounces, seed);
    if width == 0 || into.try_borrow()?.pixels.len() % width != 0 {
        return Err(domain("width", width, "a divisor of the number of pixels"));
    }
    let (pixels, round) = into.try_borrow_mut()?.take();
    let mut picture = Picture {
        width,
        height: pixels.len() / width,
        pixels,
        round,
    };
    py.detach(|| {
        on_threads(threads, || {
            picture.render(&scene.scene, &camera, &effort, &watch.stop, &|r| watch.hear(r));
        })
    })?;
    let mut into = into.try_borrow_mut()?;
    (into.pixels, into.round) = (picture.pixels, picture.round);
    Ok(())
}

/// Adds samples to those of sensors, rows of `x y z nx ny nz`.
#[pyfunction]
#[pyo3(signature = (scene, into, *, sensors, samples, relative_error, bounces, seed, watch, threads=None))]
#[expect(clippy::too_many_arguments, reason = "the options of sensors, by name")]
fn render_sensors(
    py: Python<'_>,
    scene: &Scene,
    into: &Bound<'_, Samples>,
    sensors: Block<'_>,
    samples: u32,
    relative_error: Option<f64>,
    bounces: u32,
    seed: u64,
    watch: &RenderWatch,
    threads: Option<usize>,
) -> PyResult<()> {
    let values: Vec<f32> = sensors.as_array().iter().map(|x| *x as f32).collect();
    let sensors = values
        .chunks_exact(6)
        .enumerate()
        .map(|(k, v)| {
            Sensor::new(Vec3::new(v[0], v[1], v[2]), Vec3::new(v[3], v[4], v[5])).ok_or_else(|| {
                domain(
                    &format!("sensor {}", k + 1),
                    format!("{v:?}"),
                    "a finite point and a normal that is not zero",
                )
            })
        })
        .collect::<PyResult<Vec<_>>>()?;
    let effort = effort(samples, relative_error, bounces, seed);
    let mut readings = Readings::new(sensors);
    if into.try_borrow()?.pixels.len() != readings.sensors.len() {
        return Err(domain(
            "samples",
            into.try_borrow()?.pixels.len(),
            "one entry a sensor",
        ));
    }
    (readings.pixels, readings.round) = into.try_borrow_mut()?.take();
    py.detach(|| {
        on_threads(threads, || {
            readings.measure(&scene.scene, &effort, &watch.stop, &|r| watch.hear(r));
        })
    })?;
    let mut into = into.try_borrow_mut()?;
    (into.pixels, into.round) = (readings.pixels, readings.round);
    Ok(())
}

/// Writes a picture as .hdr or .exr, by the ending of `path`.
#[pyfunction]
#[pyo3(signature = (path, *, samples, width, view, software))]
fn write_picture(
    py: Python<'_>,
    path: PathBuf,
    samples: &Bound<'_, Samples>,
    width: usize,
    view: &str,
    software: &str,
) -> PyResult<()> {
    let samples = samples.try_borrow()?;
    let pixels = &samples.pixels;
    let radiance: Vec<[f32; 3]> = pixels.iter().map(|p| p.mean().map(|x| x as f32)).collect();
    let luminance: Vec<f32> = pixels.iter().map(|p| p.luminance() as f32).collect();
    let standard_error: Vec<f32> = pixels.iter().map(|p| p.error() as f32).collect();
    py.detach(|| {
        let picture = files::Picture {
            width,
            radiance: &radiance,
            luminance: &luminance,
            standard_error: &standard_error,
            view,
            software,
        };
        match path.extension().and_then(|e| e.to_str()) {
            Some("exr") => files::write_exr(&path, &picture).or_raise(),
            Some("hdr") => files::write_hdr(&path, &picture).or_raise(),
            _ => Err(domain("out", path.display(), ".hdr, .exr")),
        }
    })
}

pub(crate) fn register(m: &Bound<'_, PyModule>) -> PyResult<()> {
    m.add_class::<Samples>()?;
    m.add_class::<RenderWatch>()?;
    m.add_function(wrap_pyfunction!(view_options, m)?)?;
    m.add_function(wrap_pyfunction!(render_picture, m)?)?;
    m.add_function(wrap_pyfunction!(render_sensors, m)?)?;
    m.add_function(wrap_pyfunction!(write_picture, m)?)
}
