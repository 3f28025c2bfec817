//! `BSDF` and `aBSDF`: measured materials in files.

use std::path::Path;
use std::sync::Arc;

use glam::Vec3;
use gonio_bsdf::{Bsdf, Channel};
use gonio_io::radiance_xml::{self, Tabulated};
use gonio_io::rgl;
use gonio_trace::material::Material;

use super::Assembly;
use super::body::{Body0, Pane};
use super::field::Field;
use super::measured::{Diffuse, Measured};
use super::through::Table;
use super::up::Up;
use crate::error::{Place, SceneError};
use crate::text::Xform;

/// A file that has been read.
#[derive(Clone)]
pub(super) struct File {
    model: Arc<dyn Bsdf>,
    /// The same, if it is made of cells.
    table: Option<Table>,
}

impl Assembly<'_> {
    pub(super) fn bsdf(
        &mut self,
        type_word: &str,
        strings: &[String],
        reals: &[f64],
        patterned: bool,
        place: &Place,
    ) -> Result<Body0, SceneError> {
        let usage = "thickness file ux uy uz function-file transform… (no thickness for aBSDF)";
        let wrong = |found: String| place.fault("string arguments", found, usage);
        let (mut rest, mut proxy) = (strings, 0.0);
        if type_word == "BSDF" {
            let [thickness, after @ ..] = strings else {
                return Err(wrong("none".into()));
            };
            proxy = self.thickness(thickness, after.get(4..).unwrap_or_default(), reals, place)?;
            rest = after;
        }
        let [file, up @ ..] = rest else {
            return Err(wrong(format!("{} words", strings.len())));
        };
        let diffuse = diffuse(reals, place)?;
        let up = Up::read(up, reals, place, self.files)?;
        let path = self.files.find(file, place)?;
        let File { model, table } = match self.materials.files.get(&path) {
            Some(file) => file.clone(),
            None => {
                let file = match self.foreign(&path, place)? {
                    Some(model) => File { model, table: None },
                    None => load(&path, place)?,
                };
                self.materials.files.insert(path, file.clone());
                file
            }
        };
        let bare = patterned.then(|| Measured::gloss(model.clone(), table.as_ref()));
        let through = table.filter(|_| type_word == "aBSDF");
        let model = match through.is_some() || diffuse.iter().flatten().any(|d| *d > 0.0) {
            true => Arc::new(Measured::new(model, diffuse, through)),
            false => model,
        };
        Ok(Body0 {
            bare,
            pane: Some(Pane::Scattering),
            up: up.clone().field(),
            proxy: proxy as f32,
            ..Body0::from(Material::model(model, up.fixed()))
        })
    }

    /// The thickness of a `BSDF`: a number, or a function whose value does not depend on the place; the transform scales it.
    fn thickness(
        &self,
        text: &str,
        after: &[String],
        reals: &[f64],
        place: &Place,
    ) -> Result<f64, SceneError> {
        let [file, transform @ ..] = after else {
            return Ok(0.0);
        };
        let value = match text.parse::<f64>() {
            Ok(value) => value,
            Err(_) => {
                let mut words = vec![text.to_owned(), file.clone()];
                words.extend_from_slice(transform);
                let field = Field::function(&words, reals, 1, place, self.files)?;
                field.values(Vec3::ZERO, Vec3::Z, Vec3::NEG_Z).0[0]
            }
        };
        let (xform, _) = Xform::parse(transform).map_err(|(f, a)| place.fault("transform", f, a))?;
        let value = value * xform.scale.abs();
        if !(value as f32).is_finite() {
            return Err(place.fault("thickness", text, "a finite length"));
        }
        // As thin as RADIANCE calls none.
        Ok(if value.abs() <= 1e-6 { 0.0 } else { value })
    }
}

/// Diffuse parts beside those of the file.
fn diffuse(reals: &[f64], place: &Place) -> Result<Diffuse, SceneError> {
    let (parts, rest) = reals.as_chunks::<3>();
    if !rest.is_empty() || parts.len() > 3 {
        return Err(place.fault(
            "real arguments",
            reals.len().to_string(),
            "0, 3, 6 or 9: diffuse reflectance of the front, of the back, diffuse transmittance",
        ));
    }
    if let Some(bad) = reals.iter().find(|d| !(0.0..=1.0).contains(*d)) {
        return Err(place.fault("diffuse part", bad.to_string(), "0 to 1"));
    }
    let part = |k: usize| parts.get(k).copied().unwrap_or_default();
    Ok([part(0), part(1), part(2)])
}

/// The model of a file: Klems matrices and tensor trees in XML, RGL materials.
fn load(path: &Path, place: &Place) -> Result<File, SceneError> {
    let extension = path.extension().map(|e| e.to_string_lossy().to_ascii_lowercase());
    match extension.as_deref() {
        Some("xml") => {
            let channels = radiance_xml::channels(path)?;
            let channel = if channels.contains(&Channel::Photopic) {
                Channel::Photopic
            } else {
                *channels.first().ok_or_else(|| {
                    place.fault(
                        "BSDF",
                        format!("{:?}", path.display().to_string()),
                        "a file with scattering data",
                    )
                })?
            };
            let table = match radiance_xml::read(path, channel)?.model {
                Tabulated::Klems(k) => Table::Klems(Arc::new(k)),
                Tabulated::TensorTree(t) => Table::Tree(Arc::new(t)),
            };
            Ok(File {
                model: table.model(),
                table: Some(table),
            })
        }
        Some("bsdf") => {
            let model = rgl::read(path)?.model;
            let n = model.channels().len();
            if n == 1 || n == 3 {
                return Ok(File {
                    model: Arc::new(model),
                    table: None,
                });
            }
            Err(place.fault(
                "BSDF",
                format!("a file of {n} wavelengths"),
                "one with red, green and blue",
            ))
        }
        _ => Err(place.fault(
            "BSDF",
            format!("{:?}", path.display().to_string()),
            "a file .xml (Klems matrices, tensor trees) or .bsdf (RGL)",
        )),
    }
}
