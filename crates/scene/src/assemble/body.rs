//! What modifiers of one type scatter: materials of RADIANCE and boundaries of bodies.

use std::sync::Arc;

use glam::{DVec3, Vec3};
use gonio_bsdf::radiance::{Dielectric, Orientation};
use gonio_bsdf::{Bsdf, BsdfError, RadianceMaterial};
use gonio_trace::material::Material;
use gonio_trace::scene::Upward;
use gonio_trace::travel::Body as Inside;

use super::up::Up;
use crate::error::{Place, SceneError};
use crate::text::{Files, Xform};

/// A material as it is without emission and patterns.
pub(super) struct Body0 {
    pub(super) material: Material,
    /// The part that patterns leave.
    pub(super) bare: Option<Arc<dyn Bsdf>>,
    pub(super) pane: Option<Pane>,
    /// What turns it from place to place.
    pub(super) up: Option<Arc<dyn Upward>>,
    pub(super) body: Option<Inside>,
    pub(super) proxy: f32,
}

impl From<Material> for Body0 {
    fn from(material: Material) -> Self {
        Body0 {
            material,
            bare: None,
            pane: None,
            up: None,
            body: None,
            proxy: 0.0,
        }
    }
}

/// How a window lets light through.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Pane {
    /// Straight, as glass does.
    Clear,
    /// Scattered, as a blind does.
    Scattering,
}

pub(super) fn colour(rgb: [f64; 3]) -> Vec3 {
    DVec3::from_array(rgb).as_vec3()
}

/// The part of the arguments of anisotropic materials and BSDFs that says which way is up: `ux uy uz file transform…`.
pub(super) fn direction(strings: &[String], place: &Place) -> Result<DVec3, SceneError> {
    let [x, y, z, _, transform @ ..] = strings else {
        return Err(place.fault(
            "string arguments",
            strings.len().to_string(),
            "ux uy uz file transform…",
        ));
    };
    let number = |text: &String| {
        let value = text.parse::<f64>().ok().filter(|v| v.is_finite());
        value.ok_or_else(|| place.fault("ux uy uz", format!("{text:?}"), "finite numbers, or functions"))
    };
    let u = DVec3::new(number(x)?, number(y)?, number(z)?);
    let (xform, used) = Xform::parse(transform).map_err(|(f, a)| place.fault("transform", f, a))?;
    let up = xform.vector(u).normalize_or_zero();
    if up == DVec3::ZERO {
        let found = format!("{x} {y} {z} {}", transform.join(" "));
        return Err(place.fault("ux uy uz", found, "a direction that is not zero"));
    }
    match transform.get(used) {
        None => Ok(up),
        Some(word) => Err(place.fault("transform", format!("{word:?}"), "options of xform")),
    }
}

/// A material of RADIANCE.
pub(super) fn radiance(
    m: &RadianceMaterial,
    patterned: bool,
    place: &Place,
    files: &Files,
) -> Result<Body0, SceneError> {
    let plain = |color| {
        Body0::from(Material::Diffuse {
            reflectance: colour(color),
        })
    };
    match m {
        RadianceMaterial::Plastic(p) if p.specularity == 0.0 => return Ok(plain(p.color)),
        RadianceMaterial::Metal(p) if p.specularity == 0.0 => return Ok(plain(p.color)),
        RadianceMaterial::Trans(p) if p.specularity == 0.0 && p.transmissivity == 0.0 => {
            return Ok(plain(p.color));
        }
        _ => {}
    }
    let wrong = |e: BsdfError| place.fault(m.type_word(), e.to_string(), "a material with a model");
    // RADIANCE's u is a direction of the world; the model's lies in the surface, along its y.
    let mut local = m.clone();
    let along_y = Orientation::from_azimuth(std::f64::consts::FRAC_PI_2).map_err(wrong)?;
    let strings = m.strings();
    let mut up = None;
    let aside = match &mut local {
        RadianceMaterial::Plastic2(p) => Some(&mut p.orientation),
        RadianceMaterial::Metal2(p) => Some(&mut p.orientation),
        RadianceMaterial::Trans2(p) => Some(&mut p.orientation),
        RadianceMaterial::Ashik2(p) => Some(&mut p.orientation),
        _ => None,
    };
    if let Some(orientation) = aside {
        *orientation = along_y;
        up = Some(Up::read(&strings, &m.reals(), place, files)?);
    }
    let body = match m {
        RadianceMaterial::Dielectric(d) => Some(Inside {
            inside: extinction(d.transmissivity),
            outside: None,
            index: d.index() as f32,
        }),
        _ => None,
    };
    let model: Arc<dyn Bsdf> = local.bsdf().map_err(wrong)?.into();
    let bare = match patterned {
        true => bare(&local)
            .map(|b| b.bsdf().map_err(wrong))
            .transpose()?
            .map(Arc::from),
        false => None,
    };
    Ok(Body0 {
        bare,
        pane: matches!(m, RadianceMaterial::Glass(_)).then_some(Pane::Clear),
        up: up.clone().and_then(Up::field),
        body,
        ..Body0::from(Material::model(model, up.and_then(|u| u.fixed())))
    })
}

/// Extinction of a transmissivity of unit length; black media let nothing through that can be told from it.
fn extinction(transmissivity: [f64; 3]) -> Vec3 {
    colour(transmissivity.map(|t| if t < 1e-40 { 100.0 } else { -t.min(1.0).ln() }))
}

/// `interface`: the boundary of a dielectric that lies in another [Radiance, rt/dielectric.c].
pub(super) fn interface(strings: &[String], reals: &[f64], place: &Place) -> Result<Body0, SceneError> {
    let [r1, g1, b1, n1, r2, g2, b2, n2] = *reals else {
        return Err(place.fault(
            "real arguments",
            reals.len().to_string(),
            "8: transmissivity and index behind the surface, and before it",
        ));
    };
    if !strings.is_empty() {
        return Err(place.fault("string arguments", strings.len().to_string(), "0"));
    }
    if let Some(bad) = [r1, g1, b1, r2, g2, b2]
        .iter()
        .find(|t| !(0.0..=1.0).contains(*t))
    {
        return Err(place.fault("transmissivity", bad.to_string(), "0 to 1"));
    }
    if let Some(bad) = [n1, n2].iter().find(|n| !(0.1..=10.0).contains(*n)) {
        return Err(place.fault("index", bad.to_string(), "0.1 to 10"));
    }
    let boundary = RadianceMaterial::Dielectric(Dielectric {
        transmissivity: [1.0; 3],
        refractive_index: n1 / n2,
        hartmann: 0.0,
    });
    let wrong = |e: BsdfError| place.fault("interface", e.to_string(), "indices of a ratio from 0.1 to 10");
    let model: Arc<dyn Bsdf> = boundary.bsdf().map_err(wrong)?.into();
    Ok(Body0 {
        body: Some(Inside {
            inside: extinction([r1, g1, b1]),
            outside: Some(extinction([r2, g2, b2])),
            index: (n1 / n2) as f32,
        }),
        ..Body0::from(Material::model(model, None))
    })
}

/// The material with a black pattern, where that leaves something: patterns colour all of a metal, but not the gloss of
/// plastic [Radiance, rt/normal.c].
fn bare(m: &RadianceMaterial) -> Option<RadianceMaterial> {
    let mut bare = m.clone();
    match &mut bare {
        RadianceMaterial::Plastic(p) => p.color = [0.0; 3],
        RadianceMaterial::Plastic2(p) => p.color = [0.0; 3],
        RadianceMaterial::Trans(p) => p.color = [0.0; 3],
        RadianceMaterial::Trans2(p) => p.color = [0.0; 3],
        RadianceMaterial::Ashik2(p) => p.diffuse = [0.0; 3],
        _ => return None,
    }
    Some(bare)
}
