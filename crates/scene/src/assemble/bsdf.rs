//! `BSDF` and `aBSDF`: measured materials in files.

use std::path::Path;
use std::sync::Arc;

use gonio_bsdf::{Bsdf, Channel};
use gonio_io::radiance_xml::{self, Tabulated};
use gonio_io::rgl;
use gonio_trace::material::Material;

use super::Assembly;
use super::material::{Body0, direction};
use crate::error::{Place, SceneError};

impl Assembly<'_> {
    pub(super) fn bsdf(
        &mut self,
        type_word: &str,
        strings: &[String],
        reals: &[f64],
        place: &Place,
    ) -> Result<Body0, SceneError> {
        let usage = "thickness file ux uy uz function-file transform… (no thickness for aBSDF)";
        let wrong = |found: String| place.fault("string arguments", found, usage);
        let mut rest = strings;
        if type_word == "BSDF" {
            let [thickness, after @ ..] = strings else {
                return Err(wrong("none".into()));
            };
            if thickness.parse::<f64>().ok() != Some(0.0) {
                return Err(place.fault(
                    "thickness",
                    format!("{thickness:?}"),
                    "0: geometry behind a proxy is not shown yet",
                ));
            }
            rest = after;
        }
        let [file, up @ ..] = rest else {
            return Err(wrong(format!("{} words", strings.len())));
        };
        if !reals.is_empty() {
            return Err(place.fault(
                "real arguments",
                reals.len().to_string(),
                "0: diffuse parts beside those of the file are not added yet",
            ));
        }
        let up = direction(up, place)?.as_vec3();
        let path = self.files.find(file, place)?;
        let model = match self.materials.files.get(&path) {
            Some(model) => model.clone(),
            None => {
                let model = load(&path, place)?;
                self.materials.files.insert(path, model.clone());
                model
            }
        };
        if type_word == "aBSDF" {
            self.warn(
                place,
                "light that comes straight through stays spread over the cells of the table",
            );
        }
        Ok(Body0 {
            material: Material::model(model, Some(up)),
            bare: None,
            pane: true,
        })
    }
}

/// The model of a file: Klems matrices and tensor trees in XML, RGL materials.
fn load(path: &Path, place: &Place) -> Result<Arc<dyn Bsdf>, SceneError> {
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
            Ok(match radiance_xml::read(path, channel)?.model {
                Tabulated::Klems(k) => Arc::new(k),
                Tabulated::TensorTree(t) => Arc::new(t),
            })
        }
        Some("bsdf") => {
            let model = rgl::read(path)?.model;
            let n = model.channels().len();
            if n == 1 || n == 3 {
                return Ok(Arc::new(model));
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
