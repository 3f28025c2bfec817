//! Materials: RADIANCE's by their arguments, models in files, lights.

use gonio_bsdf::RadianceMaterial;
use gonio_io::radiance_material::{Item, VOID};

use super::node::{Field, Record};
use super::object::Object;
use super::{alias, item};
use crate::error::SceneError;
use crate::text::Entry;

/// Luminance of radiance (1, 1, 1), and the weights of its channels, as RADIANCE has them.
const EFFICACY: f64 = 179.0;
const WEIGHTS: [f64; 3] = [0.2651, 0.6701, 0.0648];

/// The forms of a material beside those of RADIANCE.
const FORMS: &str = "a type of Radiance with its arguments ({plastic: [.5, .5, .5, 0, 0]}), {model: file}, \
                     {light: {lumens: …}}, {alias: name}";

/// The material of this name; lights share their flux over what the objects have of it.
pub(super) fn read(name: &str, field: &Field<'_>, objects: &[Object]) -> Result<Entry, SceneError> {
    if field.is_text() {
        let text = field.text(FORMS)?;
        let mut words = text.split_whitespace();
        let type_word = words.next().unwrap_or("").to_owned();
        let number = |w: &str| w.parse::<f64>().ok().filter(|v| v.is_finite());
        let reals: Option<Vec<f64>> = words.map(number).collect();
        let reals = reals.ok_or_else(|| field.fault(format!("{text:?}"), "a type and finite numbers"))?;
        return radiance(name, &type_word, &reals, None, field);
    }
    let record = field.record(&known())?;
    let forms: Vec<&(String, Field<'_>)> = record.fields.iter().filter(|(n, _)| n != "up").collect();
    let [(form, value)] = forms.as_slice() else {
        return Err(field.fault(format!("{} forms", forms.len()), FORMS));
    };
    match form.as_str() {
        "alias" => Ok(alias(
            name,
            &value.text("the name of another material")?,
            &value.place(),
        )),
        "model" => {
            let file = value.text("a file of a model")?;
            let up = up(&record)?.unwrap_or([0.0, 0.0, 1.0]).map(|x| x.to_string());
            let [x, y, z] = up;
            let strings = vec!["0".into(), file, x, y, z, ".".into()];
            Ok(item(VOID, "BSDF", name, strings, vec![], &value.place()))
        }
        "light" => light(name, value, objects),
        type_word => {
            let reals = value.numbers("a list of numbers, the arguments of the material")?;
            radiance(name, type_word, &reals, up(&record)?, value)
        }
    }
}

fn known() -> Vec<&'static str> {
    let mut known = vec!["alias", "model", "light", "up"];
    known.extend(RadianceMaterial::TYPES);
    known
}

fn up(record: &Record<'_>) -> Result<Option<[f64; 3]>, SceneError> {
    record.get("up").map(Field::vector).transpose()
}

/// A material of RADIANCE; anisotropic ones have `up` for their direction.
fn radiance(
    name: &str,
    type_word: &str,
    reals: &[f64],
    up: Option<[f64; 3]>,
    field: &Field<'_>,
) -> Result<Entry, SceneError> {
    let anisotropic = type_word.ends_with('2');
    let strings: Vec<String> = if anisotropic {
        let up = up.unwrap_or([0.0, 0.0, 1.0]);
        up.iter().map(f64::to_string).chain([".".into()]).collect()
    } else {
        Vec::new()
    };
    match RadianceMaterial::from_arguments(type_word, &strings, reals) {
        Some(Ok(material)) => {
            let place = field.place();
            Ok(Entry {
                item: Item {
                    line: place.line,
                    ..Item::material(name, material)
                },
                place,
            })
        }
        Some(Err(e)) => Err(field.fault(e.to_string(), format!("the arguments of {type_word}"))),
        None => {
            let allowed = format!("a type of Radiance: {}", RadianceMaterial::TYPES.join(", "));
            Err(field.fault(format!("{type_word:?}"), allowed))
        }
    }
}

/// A Lambertian emitter of its front.
fn light(name: &str, field: &Field<'_>, objects: &[Object]) -> Result<Entry, SceneError> {
    const MOST: f64 = 1e18;
    let record = field.record(&["radiance", "luminance", "lumens", "colour"])?;
    let colour = match record.get("colour") {
        None => [1.0; 3],
        Some(field) => {
            let colour = field.vector()?;
            if colour.iter().any(|c| !(0.0..=MOST).contains(c)) || colour == [0.0; 3] {
                return Err(field.fault(format!("{colour:?}"), "red, green, blue of at least 0, not all 0"));
            }
            colour
        }
    };
    let luminous: f64 = EFFICACY * WEIGHTS.iter().zip(colour).map(|(w, c)| w * c).sum::<f64>();
    let given: Vec<&(String, Field<'_>)> = record.fields.iter().filter(|(n, _)| n != "colour").collect();
    let [(unit, value)] = given.as_slice() else {
        let allowed =
            "one of radiance (W/m2 sr), luminance (cd/m2), lumens (of all that has this material together)";
        return Err(field.fault(format!("{} of them", given.len()), allowed));
    };
    let scale = match unit.as_str() {
        "radiance" if value.is_list() => {
            let reals = value.vector()?.to_vec();
            return Ok(item(VOID, "light", name, vec![], reals, &value.place()));
        }
        "radiance" => value.number(0.0..=MOST)?,
        "luminance" => value.number(0.0..=MOST)? / luminous,
        _ => {
            let area: f64 = objects.iter().map(|o| o.area(name)).sum();
            if area <= 0.0 {
                let allowed = "objects with surfaces of this material, to share the flux";
                return Err(value.fault("no area", allowed));
            }
            value.number(0.0..=MOST)? / (std::f64::consts::PI * area * luminous)
        }
    };
    let reals = colour.iter().map(|c| scale * c).collect();
    Ok(item(VOID, "light", name, vec![], reals, &value.place()))
}
