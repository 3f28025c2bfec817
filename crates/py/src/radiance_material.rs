//! Radiance materials and their text.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use gonio_bsdf::RadianceMaterial as Material;
use gonio_bsdf::radiance::{Orientation, Release};
use gonio_io::radiance_material::{self as text, Body, Item, NamedMaterial, VOID};
use pyo3::prelude::*;
use pyo3::types::PyDict;

use crate::bsdf::Bsdf;
use crate::errors::{OrRaise, domain};

/// A material as it stands in a Radiance scene.
///
/// Parameters are keywords under the names of the Radiance manual: red, green, blue, spec, rough (plastic, metal), with
/// trans, tspec (trans), urough, vrough (plastic2, metal2, trans2), dred to sblue, upower, vpower (ashik2), rtn, gtn,
/// btn, n (glass; n may be left out), and hc (dielectric). `strings` are the string arguments: ux, uy, uz, function
/// file and transform of the anisotropic types ("1 0 0 ." when left out), the alternate material of a mirror.
#[pyclass(frozen, eq, module = "gonio", name = "RadianceMaterial")]
#[derive(PartialEq)]
pub(crate) struct RadianceMaterial(NamedMaterial);

impl RadianceMaterial {
    fn item(&self) -> Item {
        Item {
            modifier: self.0.modifier.clone(),
            id: self.0.id.clone(),
            body: Body::Material(self.0.material.clone()),
            line: self.0.line,
        }
    }
}

#[pymethods]
impl RadianceMaterial {
    #[new]
    #[pyo3(signature = (r#type, *, id, strings=None, modifier=VOID, **parameters))]
    fn new(
        r#type: &str,
        id: &str,
        strings: Option<Vec<String>>,
        modifier: &str,
        parameters: Option<&Bound<'_, PyDict>>,
    ) -> PyResult<Self> {
        let Some(arguments) = Material::arguments_of(r#type) else {
            return Err(domain(
                "type",
                format!("{:?}", r#type),
                &Material::TYPES.join(", "),
            ));
        };
        let mut given: BTreeMap<String, f64> = match parameters {
            Some(dict) => dict.extract()?,
            None => BTreeMap::new(),
        };
        let mut reals = Vec::new();
        for argument in arguments {
            match given.remove(argument.name) {
                Some(value) => reals.push(value),
                None if argument.optional => {}
                None => {
                    let allowed = format!("{} to {}", argument.low, argument.high);
                    return Err(domain(argument.name, "nothing", &allowed));
                }
            }
        }
        if let Some(name) = given.keys().next() {
            let names: Vec<&str> = arguments.iter().map(|a| a.name).collect();
            return Err(domain(r#type, format!("parameter {name}"), &names.join(", ")));
        }
        let strings = strings.unwrap_or_else(|| match r#type {
            "plastic2" | "metal2" | "trans2" | "ashik2" => Orientation::default().strings(),
            _ => Vec::new(),
        });
        let material = Material::from_arguments(r#type, &strings, &reals)
            .transpose()
            .or_raise()?;
        let made = RadianceMaterial(NamedMaterial {
            id: id.into(),
            modifier: modifier.into(),
            // The type is one of those with arguments.
            material: material.ok_or_else(|| domain("type", r#type, &Material::TYPES.join(", ")))?,
            line: 0,
        });
        text::to_text(&[made.item()], &[]).or_raise()?;
        Ok(made)
    }

    /// plastic, metal, trans, plastic2, metal2, trans2, ashik2, glass, mirror or dielectric.
    #[getter]
    fn r#type(&self) -> &'static str {
        self.0.material.type_word()
    }

    /// Its name.
    #[getter]
    fn id(&self) -> &str {
        &self.0.id
    }

    /// The pattern or texture that changes it over the surface, "void" for none.
    #[getter]
    fn modifier(&self) -> &str {
        &self.0.modifier
    }

    /// Line of the file it was read from, counted from 1; 0 for a material that was not read.
    #[getter]
    fn line(&self) -> u64 {
        self.0.line
    }

    /// The real arguments by name, in order.
    #[getter]
    fn parameters<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let dict = PyDict::new(py);
        for (argument, value) in self.0.material.arguments().iter().zip(self.0.material.reals()) {
            dict.set_item(argument.name, value)?;
        }
        Ok(dict)
    }

    /// The string arguments.
    #[getter]
    fn strings(&self) -> Vec<String> {
        self.0.material.strings()
    }

    /// The material as text of a Radiance scene.
    #[getter]
    fn text(&self) -> PyResult<String> {
        text::to_text(&[self.item()], &[]).or_raise()
    }

    /// The material as a model with the channels red, green and blue, as Radiance evaluates it in its direct
    /// calculation.
    ///
    /// `release` (6.0 or 6.1) decides the constant of the approximation of Fresnel's law that smooth plastic, metal and
    /// trans have. A pattern or texture that modifies the material is not known here: DomainError, unless
    /// `ignore_modifier`. DomainError too for an orientation that is not made of numbers.
    #[pyo3(signature = (*, release="6.1", ignore_modifier=false))]
    fn bsdf(&self, release: &str, ignore_modifier: bool) -> PyResult<Bsdf> {
        if self.0.modifier != VOID && !ignore_modifier {
            return Err(domain(
                "modifier",
                format!("{:?} of {:?}", self.0.modifier, self.0.id),
                "void: what a pattern or texture does is not known; ignore_modifier=True leaves it out",
            ));
        }
        let release: Release = release.parse().or_raise()?;
        Ok(Bsdf(Arc::from(self.0.material.bsdf_of(release).or_raise()?)))
    }

    fn __repr__(&self) -> String {
        let values: Vec<String> = self
            .0
            .material
            .arguments()
            .iter()
            .zip(self.0.material.reals())
            .map(|(a, v)| format!("{}={v}", a.name))
            .collect();
        format!(
            "RadianceMaterial({:?}, id={:?}, {})",
            self.0.material.type_word(),
            self.0.id,
            values.join(", ")
        )
    }
}

fn listed(materials: Vec<NamedMaterial>) -> Vec<RadianceMaterial> {
    materials.into_iter().map(RadianceMaterial).collect()
}

/// The materials of a Radiance scene file, in order, aliases of materials among them. Raises FormatError and OSError.
#[pyfunction]
fn read_radiance_materials(py: Python<'_>, path: PathBuf) -> PyResult<Vec<RadianceMaterial>> {
    py.detach(|| {
        let items = text::read(&path)?;
        text::materials(&path, &items)
    })
    .map(listed)
    .or_raise()
}

/// The materials of a Radiance scene given as text. Raises FormatError.
#[pyfunction]
fn parse_radiance_materials(content: &str) -> PyResult<Vec<RadianceMaterial>> {
    let path = Path::new("text");
    let items = text::read_from(path, content.as_bytes()).or_raise()?;
    text::materials(path, &items).map(listed).or_raise()
}

/// Write materials as a Radiance scene file under `comments`, whole or not at all. Raises FormatError and OSError.
#[pyfunction]
fn write_radiance_materials(
    py: Python<'_>,
    path: PathBuf,
    materials: Vec<PyRef<'_, RadianceMaterial>>,
    comments: Vec<String>,
) -> PyResult<()> {
    let items: Vec<Item> = materials.iter().map(|m| m.item()).collect();
    py.detach(|| text::write(&path, &items, &comments)).or_raise()
}

pub(crate) fn register(m: &Bound<'_, PyModule>) -> PyResult<()> {
    m.add_class::<RadianceMaterial>()?;
    m.add_function(wrap_pyfunction!(read_radiance_materials, m)?)?;
    m.add_function(wrap_pyfunction!(parse_radiance_materials, m)?)?;
    m.add_function(wrap_pyfunction!(write_radiance_materials, m)?)
}
