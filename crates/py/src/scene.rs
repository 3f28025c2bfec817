//! Scenes, read or made.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use glam::Vec3;
use gonio_bsdf::Channel;
use gonio_scene::text::{Files, ModelReader};
use gonio_scene::view;
use gonio_trace::camera::ViewError;
use gonio_trace::material::Material;
use gonio_trace::scene::{self, SceneError};
use gonio_trace::studio;
use pyo3::prelude::*;

use crate::bsdf::Bsdf;
use crate::errors::{DomainError, OrRaise, QuantityError, Raise};

impl Raise for ViewError {
    fn raise(self) -> PyErr {
        DomainError::new_err(self.to_string())
    }
}

impl Raise for SceneError {
    fn raise(self) -> PyErr {
        DomainError::new_err(self.to_string())
    }
}

/// What is rendered.
#[pyclass(frozen, module = "gonio", name = "Scene")]
pub(crate) struct Scene {
    pub(crate) scene: Arc<scene::Scene>,
    view: Option<String>,
}

impl Scene {
    fn new(scene: scene::Scene, view: Option<String>) -> Self {
        Scene {
            scene: Arc::new(scene),
            view,
        }
    }
}

#[pymethods]
impl Scene {
    /// Number of triangles and curved surfaces.
    #[getter]
    fn primitives(&self) -> usize {
        self.scene.primitives()
    }

    /// The view that its file names, by RADIANCE's options; None without.
    #[getter]
    fn view(&self) -> Option<&str> {
        self.view.as_deref()
    }

    fn __repr__(&self) -> String {
        format!("Scene({} primitives)", self.scene.primitives())
    }
}

impl Raise for gonio_scene::SceneError {
    fn raise(self) -> PyErr {
        use gonio_scene::SceneError as E;
        match self {
            E::Text(error) => error.raise(),
            E::Parts(error) => error.raise(),
            E::View(error) => error.raise(),
        }
    }
}

/// The scene of files of RADIANCE text and YAML, and what it is read without. `model` reads models in files that neither of
/// RADIANCE nor RGL are.
#[pyfunction]
#[pyo3(signature = (paths, search, *, model))]
fn read_scene(
    py: Python<'_>,
    paths: Vec<PathBuf>,
    search: Vec<PathBuf>,
    model: Py<PyAny>,
) -> PyResult<(Scene, Vec<String>)> {
    py.detach(|| {
        let (loaded, mut warnings) = load(&paths, search, model)?;
        if is_dark(&loaded.parts) {
            warnings.push(
                "the scene has no light: surfaces are black where they do not emit (a sky at night is black as well)"
                    .to_owned(),
            );
        }
        let view = loaded.view.map(|v| v.to_string());
        let scene = scene::Scene::new(loaded.parts).or_raise()?;
        Ok((Scene::new(scene, view), warnings))
    })
}

/// Whether nothing lights a scene: no lamp that emits, and no sky but a black one.
fn is_dark(parts: &scene::Parts) -> bool {
    const DIRECTIONS: u32 = 1000;
    let golden = std::f32::consts::PI * (3.0 - 5.0_f32.sqrt());
    let direction = |k: u32| {
        let z = 1.0 - (2 * k + 1) as f32 / DIRECTIONS as f32;
        let (sin, cos) = (golden * k as f32).sin_cos();
        let r = (1.0 - z * z).sqrt();
        Vec3::new(r * cos, r * sin, z)
    };
    let shines = |sky: &gonio_trace::light::Sky| {
        (0..DIRECTIONS).any(|k| sky.radiance(direction(k)).max_element() > 0.0)
    };
    !parts.lights.iter().any(|l| l.radiance().max_element() > 0.0) && !parts.sky.as_ref().is_some_and(shines)
}

/// What files of scenes hold, and the warnings about it; without the interpreter.
pub(crate) fn load(
    paths: &[PathBuf],
    search: Vec<PathBuf>,
    model: Py<PyAny>,
) -> PyResult<(gonio_scene::Loaded, Vec<String>)> {
    let read = move |path: &Path| -> Result<Arc<dyn gonio_bsdf::Bsdf>, String> {
        Python::attach(|py| {
            let made = model.call1(py, (path,));
            let made = made.and_then(|m| Ok(m.bind(py).cast::<Bsdf>()?.get().0.clone()));
            made.map_err(|e| e.value(py).to_string())
        })
    };
    let files = Files {
        search,
        models: Some(ModelReader(Arc::new(read))),
    };
    let loaded = gonio_scene::read_with(paths, &files).or_raise()?;
    let warnings = loaded.warnings.iter().map(ToString::to_string).collect();
    Ok((loaded, warnings))
}

/// A ball of a model on a plane, under a lamp and a sky, and the view of it.
#[pyfunction]
fn studio_scene(model: &Bsdf) -> PyResult<(Scene, String)> {
    let channels = model.0.channels();
    if channels.len() != 1 && channels != [Channel::Red, Channel::Green, Channel::Blue] {
        let names: Vec<String> = channels.iter().map(ToString::to_string).collect();
        return Err(QuantityError::new_err(format!(
            "channels of the model: found {}, needed one, or red, green, blue",
            names.join(", ")
        )));
    }
    let up = (!model.0.properties().isotropic).then_some(Vec3::Z);
    let scene = studio::scene(Material::model(Arc::clone(&model.0), up)).or_raise()?;
    Ok((Scene::new(scene, None), studio::view().to_string()))
}

/// All options of the view of a file.
#[pyfunction]
fn read_view(path: PathBuf) -> PyResult<String> {
    Ok(view::read(&path).or_raise()?.to_string())
}

pub(crate) fn register(m: &Bound<'_, PyModule>) -> PyResult<()> {
    m.add_class::<Scene>()?;
    m.add_function(wrap_pyfunction!(studio_scene, m)?)?;
    m.add_function(wrap_pyfunction!(read_scene, m)?)?;
    m.add_function(wrap_pyfunction!(read_view, m)?)
}
