//! The direction u of the anisotropic materials.

use gonio_geom::DVec3;

use crate::BsdfError;

/// Where u points: `ux uy uz function-file transform…`, the string arguments of the anisotropic types.
///
/// RADIANCE reads the three components as expressions of its function language, so that u may change over the
/// surface; gonio evaluates plain numbers only and keeps the rest as text. u is projected into the surface.
#[derive(Clone, Debug, PartialEq)]
pub struct Orientation {
    components: [String; 3],
    function_file: String,
    transform: Vec<String>,
}

impl Default for Orientation {
    /// u along x.
    fn default() -> Self {
        Orientation {
            components: ["1", "0", "0"].map(String::from),
            function_file: ".".into(),
            transform: Vec::new(),
        }
    }
}

impl Orientation {
    /// u along `u`, of any length.
    ///
    /// # Errors
    /// [`BsdfError::Domain`] when a component is not finite or all are zero.
    pub fn new(u: DVec3) -> Result<Self, BsdfError> {
        if !u.is_finite() || u == DVec3::ZERO {
            return Err(BsdfError::Domain {
                field: "ux uy uz",
                found: format!("{} {} {}", u.x, u.y, u.z),
                allowed: "three finite numbers that are not all zero".into(),
            });
        }
        Ok(Orientation {
            components: [u.x, u.y, u.z].map(|c| c.to_string()),
            ..Orientation::default()
        })
    }

    /// u in the surface at azimuth `phi`, radians, any finite value.
    ///
    /// # Errors
    /// [`BsdfError::Domain`] when `phi` is not finite.
    pub fn from_azimuth(phi: f64) -> Result<Self, BsdfError> {
        Orientation::new(DVec3::new(phi.cos(), phi.sin(), 0.0))
    }

    /// The orientation of these string arguments, kept as they are.
    ///
    /// # Errors
    /// [`BsdfError::Domain`] when there are fewer than four.
    pub fn from_strings(strings: &[String]) -> Result<Self, BsdfError> {
        let [x, y, z, file, transform @ ..] = strings else {
            return Err(BsdfError::Domain {
                field: "string arguments",
                found: strings.len().to_string(),
                allowed: "at least 4: ux uy uz function-file transform…".into(),
            });
        };
        Ok(Orientation {
            components: [x, y, z].map(Clone::clone),
            function_file: file.clone(),
            transform: transform.to_vec(),
        })
    }

    /// The string arguments.
    pub fn strings(&self) -> Vec<String> {
        let mut strings = self.components.to_vec();
        strings.push(self.function_file.clone());
        strings.extend_from_slice(&self.transform);
        strings
    }

    /// u as a vector, not normalised, the transform applied (`-rx -ry -rz` in degrees, `-mx -my -mz`, `-s`; `-t` does
    /// not turn it).
    ///
    /// # Errors
    /// [`BsdfError::Domain`] for a component that is an expression, not a number, and for other words of a transform.
    pub fn vector(&self) -> Result<DVec3, BsdfError> {
        let [x, y, z] = &self.components;
        let mut u = DVec3::new(component("ux", x)?, component("uy", y)?, component("uz", z)?);
        let mut words = self.transform.iter();
        while let Some(word) = words.next() {
            match word.as_str() {
                "-mx" => u.x = -u.x,
                "-my" => u.y = -u.y,
                "-mz" => u.z = -u.z,
                "-t" => {
                    for _ in 0..3 {
                        number(word, words.next())?;
                    }
                }
                "-s" => u *= number(word, words.next())?,
                "-rx" | "-ry" | "-rz" => {
                    let (s, c) = number(word, words.next())?.to_radians().sin_cos();
                    u = match word.as_str() {
                        "-rx" => DVec3::new(u.x, c * u.y - s * u.z, s * u.y + c * u.z),
                        "-ry" => DVec3::new(c * u.x + s * u.z, u.y, c * u.z - s * u.x),
                        _ => DVec3::new(c * u.x - s * u.y, s * u.x + c * u.y, u.z),
                    };
                }
                other => {
                    return Err(BsdfError::Domain {
                        field: "transform",
                        found: format!("{other:?}"),
                        allowed: "-rx -ry -rz -mx -my -mz -s -t".into(),
                    });
                }
            }
        }
        Ok(u)
    }

    /// The azimuth of u in the surface, radians; `None` when u stands on the surface, which RADIANCE takes for no
    /// orientation at all.
    ///
    /// # Errors
    /// Those of [`Orientation::vector`].
    pub fn azimuth(&self) -> Result<Option<f64>, BsdfError> {
        let u = self.vector()?;
        Ok((u.x != 0.0 || u.y != 0.0).then(|| u.y.atan2(u.x)))
    }
}

fn component(field: &'static str, text: &str) -> Result<f64, BsdfError> {
    let value = text.parse::<f64>().ok().filter(|v| v.is_finite());
    value.ok_or_else(|| BsdfError::Domain {
        field,
        found: format!("{text:?}"),
        allowed: "a number; expressions of a function file are kept but not evaluated".into(),
    })
}

fn number(word: &str, text: Option<&String>) -> Result<f64, BsdfError> {
    let value = text.and_then(|t| t.parse::<f64>().ok()).filter(|v| v.is_finite());
    value.ok_or_else(|| BsdfError::Domain {
        field: "transform",
        found: format!("{word} {}", text.map_or("", String::as_str)),
        allowed: format!("{word} with its numbers"),
    })
}
