//! Patterns: functions of place and direction [Radiance, rt/p_func.c, rt/p_data.c].

use std::sync::Arc;

use glam::{DVec3, Vec3};
use gonio_io::radiance_material::Body;
use gonio_io::read_bytes;
use gonio_trace::pattern::{Pattern, Texture};

use super::field::Field;
use super::modifier::{Modifier, type_word};
use crate::error::{Place, SceneError};
use crate::sky::cie::CieSky;
use crate::sky::perez::PerezSky;
use crate::text::Files;

/// A factor by functions or data; one value is grey, negative ones count as 0.
struct Coloured(Field);

impl Pattern for Coloured {
    fn multiplier(&self, point: Vec3, normal: Vec3, direction: Vec3) -> Vec3 {
        let (values, n) = self.0.values(point, normal, direction);
        let values = Vec3::from(values.map(|v| v.max(0.0) as f32));
        if n == 1 { Vec3::splat(values.x) } else { values }
    }
}

/// A normal turned by functions or data, which have the axes of the transform.
struct Turned(Field);

impl Texture for Turned {
    fn shift(&self, point: Vec3, normal: Vec3, direction: Vec3) -> Vec3 {
        let (values, _) = self.0.values(point, normal, direction);
        self.0.seat().world(DVec3::from(values)).as_vec3()
    }
}

/// A sky whose formula comes with gonio, without the interpreter: it is asked for at every turn.
struct Shipped(Arc<dyn Fn([f64; 3]) -> f64 + Send + Sync>);

impl Pattern for Shipped {
    fn multiplier(&self, _point: Vec3, _normal: Vec3, direction: Vec3) -> Vec3 {
        Vec3::splat((self.0)(direction.as_dvec3().to_array()).max(0.0) as f32)
    }
}

/// The sky that one of the shipped function files stands for, or that of RADIANCE with the same name.
fn shipped_sky(
    file: &str,
    name: &str,
    reals: &[f64],
    place: &Place,
    files: &Files,
) -> Result<Option<Shipped>, SceneError> {
    let radiance = |digest: u64| -> Result<bool, SceneError> {
        match files.find(file, place) {
            Ok(path) => Ok(digest_of(&read_bytes(&path)?) == digest),
            Err(_) => Ok(true),
        }
    };
    Ok(match (file, name) {
        ("perezlum.cal", "skybright") if radiance(PEREZLUM)? => {
            PerezSky::of_pattern(reals).map(|s| Shipped(Arc::new(move |d| s.radiance(d))))
        }
        ("skybright.cal", "skybr") if radiance(SKYBRIGHT)? => {
            CieSky::of_pattern(reals).map(|s| Shipped(Arc::new(move |d| s.radiance(d))))
        }
        _ => None,
    })
}

/// Digests of the files of RADIANCE, unchanged since 2018 and 2003; others of the same names are interpreted.
const PEREZLUM: u64 = 0x224e_ff54_4dbd_073a;
const SKYBRIGHT: u64 = 0x8398_9d0c_93b9_92d4;

/// FNV-1a of a function file without comments and white space.
fn digest_of(text: &[u8]) -> u64 {
    let mut depth = 0_u32;
    let mut digest = 0xcbf2_9ce4_8422_2325_u64;
    for byte in text {
        match byte {
            b'{' => depth += 1,
            b'}' => depth = depth.saturating_sub(1),
            _ if depth > 0 || byte.is_ascii_whitespace() => {}
            _ => digest = (digest ^ u64::from(*byte)).wrapping_mul(0x100_0000_01b3),
        }
    }
    digest
}

/// The pattern of a modifier.
pub(super) fn pattern(modifier: &Modifier, files: &Files) -> Result<Arc<dyn Pattern>, SceneError> {
    let place = &modifier.place;
    let word = type_word(&modifier.body);
    let Body::Other { strings, reals, .. } = &*modifier.body else {
        return Err(place.fault("type", word, "a pattern"));
    };
    if let ("brightfunc", [name, file]) = (word, strings.as_slice())
        && let Some(sky) = shipped_sky(file, name, reals, place, files)?
    {
        return Ok(Arc::new(sky));
    }
    let field = match word {
        "brightfunc" => Field::function(strings, reals, 1, place, files),
        "colorfunc" => Field::function(strings, reals, 3, place, files),
        "brightdata" => Field::data(strings, reals, 1, place, files),
        "colordata" => Field::data(strings, reals, 3, place, files),
        "colorpict" => Field::picture(strings, reals, 3, place, files),
        _ => Err(place.fault(
            "type",
            word,
            "brightfunc, colorfunc, brightdata, colordata, colorpict: text as a pattern is not rendered, and without it the \
             scene would look otherwise",
        )),
    };
    Ok(Arc::new(Coloured(field?)))
}

/// The texture of a modifier.
pub(super) fn texture(modifier: &Modifier, files: &Files) -> Result<Arc<dyn Texture>, SceneError> {
    let place = &modifier.place;
    let word = type_word(&modifier.body);
    let field = match &*modifier.body {
        Body::Other { strings, reals, .. } if word == "texfunc" => {
            Field::function(strings, reals, 3, place, files)
        }
        Body::Other { strings, reals, .. } => Field::data(strings, reals, 3, place, files),
        _ => Err(place.fault("type", word, "texfunc, texdata")),
    };
    Ok(Arc::new(Turned(field?)))
}

/// The share of the first part of a mixture; `strings` follow the two names.
pub(super) fn share(
    modifier: &Modifier,
    strings: &[String],
    files: &Files,
) -> Result<Arc<dyn Pattern>, SceneError> {
    let place = &modifier.place;
    let word = type_word(&modifier.body);
    let field = match &*modifier.body {
        Body::Other { reals, .. } if word == "mixfunc" => Field::function(strings, reals, 1, place, files),
        Body::Other { reals, .. } if word == "mixdata" => Field::data(strings, reals, 1, place, files),
        Body::Other { reals, .. } if word == "mixpict" => Field::picture(strings, reals, 1, place, files),
        _ => Err(place.fault("type", word, "mixfunc, mixdata, mixpict: text is not rendered")),
    };
    Ok(Arc::new(Coloured(field?)))
}

#[cfg(test)]
mod tests {
    use super::digest_of;

    #[test]
    fn digests_of_function_files_see_neither_comments_nor_white_space() {
        let plain = digest_of(b"a=b+1;c(x)=x;");
        assert_eq!(
            digest_of(b"{ of { what } it says }\na = b + 1 ;\r\n c(x) = x;\t"),
            plain
        );
        assert_ne!(digest_of(b"a=b+2;c(x)=x;"), plain);
        assert_eq!(digest_of(b""), 0xcbf2_9ce4_8422_2325);
    }
}
