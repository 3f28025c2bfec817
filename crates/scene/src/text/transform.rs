//! Items moved, turned and renamed [Radiance, gen/xform.c].

use glam::DVec3;
use gonio_bsdf::RadianceMaterial;
use gonio_io::radiance_material::{Body, Item};

use super::xform::Xform;
use crate::error::{Place, SceneError};

/// What one `xform` does.
#[derive(Clone, Debug)]
pub struct Change {
    /// The transform.
    pub xform: Xform,
    /// Its options, for the types that carry them as words.
    pub words: Vec<String>,
    /// Modifier that all surfaces take (`-m`).
    pub modifier: Option<String>,
    /// Put before the names of surfaces (`-n`).
    pub prefix: Option<String>,
    /// Whether surfaces are turned inside out (`-I`).
    pub invert: bool,
}

/// The types whose front is on the other side.
const INVERSE: [[&str; 2]; 3] = [["sphere", "bubble"], ["cylinder", "tube"], ["cone", "cup"]];

/// Surfaces; all other types are modifiers.
pub(crate) const SURFACES: [&str; 11] = [
    "polygon", "sphere", "bubble", "cylinder", "tube", "cone", "cup", "ring", "source", "instance", "mesh",
];

/// Types that carry a transform at the end of their words, anisotropic materials apart.
const CARRIERS: [&str; 18] = [
    "instance",
    "mesh",
    "texfunc",
    "texdata",
    "plasfunc",
    "metfunc",
    "transfunc",
    "BRTDfunc",
    "plasdata",
    "metdata",
    "transdata",
    "brightfunc",
    "colorfunc",
    "brightdata",
    "colordata",
    "colorpict",
    "BSDF",
    "aBSDF",
];

impl Change {
    /// Changes `item` in place.
    ///
    /// # Errors
    /// A list of arguments of the wrong length.
    pub fn apply(&self, item: &mut Item, place: &Place) -> Result<(), SceneError> {
        let type_word = match &item.body {
            Body::Material(m) => m.type_word().to_owned(),
            Body::Alias(_) => return Ok(()),
            Body::Other { type_word, .. } => type_word.clone(),
        };
        if SURFACES.contains(&type_word.as_str()) {
            if let Some(modifier) = &self.modifier {
                item.modifier.clone_from(modifier);
            }
            if let Some(prefix) = &self.prefix {
                item.id = format!("{prefix}.{}", item.id);
            }
        }
        match &mut item.body {
            Body::Material(m) => {
                if let Some(changed) = self.material(m, place)? {
                    *m = changed;
                }
            }
            Body::Alias(_) => {}
            Body::Other {
                type_word,
                strings,
                reals,
                ..
            } => {
                if self.invert
                    && let Some([a, b]) = INVERSE.iter().find(|pair| pair.contains(&type_word.as_str()))
                {
                    *type_word = if type_word == a { (*b).into() } else { (*a).into() };
                }
                if CARRIERS.contains(&type_word.as_str()) {
                    self.carry(strings);
                }
                self.reals(type_word, reals, place)?;
            }
        }
        Ok(())
    }

    fn carry(&self, strings: &mut Vec<String>) {
        if self.words.first().is_some_and(|w| w != "-i") {
            strings.extend(["-i".into(), "1".into()]);
        }
        strings.extend_from_slice(&self.words);
    }

    /// The material after the transform, where that changes it.
    fn material(&self, m: &RadianceMaterial, place: &Place) -> Result<Option<RadianceMaterial>, SceneError> {
        let (mut strings, mut reals) = (m.strings(), m.reals());
        match m {
            RadianceMaterial::Plastic2(_)
            | RadianceMaterial::Metal2(_)
            | RadianceMaterial::Trans2(_)
            | RadianceMaterial::Ashik2(_) => self.carry(&mut strings),
            // Transmitted per unit of length.
            RadianceMaterial::Dielectric(_) => {
                for r in reals.iter_mut().take(3) {
                    *r = r.powf(1.0 / self.xform.scale.abs());
                }
            }
            _ => return Ok(None),
        }
        match RadianceMaterial::from_arguments(m.type_word(), &strings, &reals) {
            Some(Ok(changed)) => Ok(Some(changed)),
            Some(Err(e)) => Err(place.fault("xform", e.to_string(), "a material that can be scaled")),
            None => Ok(None),
        }
    }

    fn reals(&self, type_word: &str, reals: &mut [f64], place: &Place) -> Result<(), SceneError> {
        let scale = self.xform.scale.abs();
        let reverse = (self.xform.scale < 0.0) != self.invert;
        let count = |n: usize, allowed: &str| {
            if reals.len() == n {
                return Ok(());
            }
            Err(place.fault("real arguments", reals.len().to_string(), allowed))
        };
        let get = |reals: &[f64], k: usize| DVec3::new(reals[k], reals[k + 1], reals[k + 2]);
        let set = |reals: &mut [f64], k: usize, v: DVec3| reals[k..k + 3].copy_from_slice(&v.to_array());
        let point = |reals: &mut [f64], k: usize| set(reals, k, self.xform.point(get(reals, k)));
        let vector = |reals: &mut [f64], k: usize| set(reals, k, self.xform.vector(get(reals, k)));
        match type_word {
            "polygon" => {
                if !reals.len().is_multiple_of(3) {
                    return Err(place.fault(
                        "real arguments",
                        reals.len().to_string(),
                        "x y z of each corner of a polygon",
                    ));
                }
                for k in (0..reals.len()).step_by(3) {
                    point(reals, k);
                }
                if reverse {
                    reals.reverse();
                    for corner in reals.chunks_exact_mut(3) {
                        corner.reverse();
                    }
                }
            }
            "sphere" | "bubble" => {
                count(4, "4: centre and radius of a sphere")?;
                point(reals, 0);
                reals[3] *= scale;
            }
            "cylinder" | "tube" => {
                count(7, "7: ends and radius of a cylinder")?;
                point(reals, 0);
                point(reals, 3);
                reals[6] *= scale;
            }
            "cone" | "cup" => {
                count(8, "8: ends and radii of a cone")?;
                point(reals, 0);
                point(reals, 3);
                reals[6] *= scale;
                reals[7] *= scale;
            }
            "ring" => {
                count(8, "8: centre, normal and radii of a ring")?;
                point(reals, 0);
                vector(reals, 3);
                if self.invert {
                    reals[3..6].iter_mut().for_each(|n| *n = -*n);
                }
                reals[6] *= scale;
                reals[7] *= scale;
            }
            "source" => {
                count(4, "4: direction and angle of a source")?;
                vector(reals, 0);
            }
            "glow" => {
                count(4, "4: red green blue radius of a glow")?;
                reals[3] *= scale;
            }
            "spotlight" => {
                count(7, "7: red green blue angle and direction of a spotlight")?;
                vector(reals, 4);
            }
            _ => {}
        }
        Ok(())
    }
}
