//! What every law test varies: parameters by their role, and incidences.

#![allow(dead_code)] // each test program uses its share

use gonio_bsdf::Bsdf;
use gonio_bsdf::Channel;
use gonio_bsdf::analytic::{ModelInfo, ParameterInfo, Parametric, Role, models};
use gonio_geom::Direction;

/// Lobe widths, from a polished surface to a nearly matt one.
pub(crate) const WIDTHS: [f64; 5] = [0.005, 0.02, 0.1, 0.3, 0.6];

/// Polar angles of incidence on the front, degrees.
pub(crate) const FRONT: [f64; 7] = [0.0, 15.0, 30.0, 45.0, 60.0, 75.0, 85.0];

/// Polar angles of incidence on the back, degrees.
pub(crate) const BACK: [f64; 2] = [160.0, 115.0];

/// Azimuth of incidence, degrees: not 0, so that a forgotten azimuth shows.
pub(crate) const AZIMUTH: f64 = 200.0;

/// Whether `GONIO_MODELS` names `name` or nothing is named.
pub(crate) fn wanted(name: &str) -> bool {
    std::env::var("GONIO_MODELS").map_or(true, |names| names.split(',').any(|n| n == name))
}

/// The models that are tested: all, or those that `GONIO_MODELS` names.
pub(crate) fn chosen() -> Vec<&'static dyn Parametric> {
    models().filter(|m| wanted(m.info().name)).collect()
}

/// One choice of parameters of a model.
pub(crate) struct Setting {
    pub(crate) label: String,
    pub(crate) values: Vec<f64>,
}

/// The settings of a model that every law test runs through, made from the roles of its parameters: each width with
/// all widths alike, widths in the ratio 1 to 4 where there are several, and each index and exponent at two more
/// values.
pub(crate) fn settings(info: &ModelInfo) -> Vec<Setting> {
    let base: Vec<f64> = info.parameters.iter().map(base_value).collect();
    let widths: Vec<usize> = with_role(info, |r| r == Role::Width);
    let mut all = vec![base.clone()];
    for width in WIDTHS {
        all.push(with_widths(info, &base, &widths, width, 1.0));
    }
    if widths.len() > 1 {
        for (width, ratio) in [(0.005, 4.0), (0.05, 4.0), (0.6, 0.25)] {
            all.push(with_widths(info, &base, &widths, width, ratio));
        }
    }
    for k in with_role(info, |r| matches!(r, Role::Index | Role::Exponent)) {
        for share in [0.15, 0.7] {
            let mut values = base.clone();
            values[k] = between(&info.parameters[k], share);
            all.push(values);
        }
    }
    let mut settings: Vec<Setting> = Vec::new();
    for values in all {
        if settings.iter().all(|s| s.values != values) {
            let label = info
                .parameters
                .iter()
                .zip(&values)
                .map(|(p, v)| format!("{} {}", p.name, (v * 1e4).round() / 1e4))
                .collect::<Vec<_>>()
                .join(", ");
            settings.push(Setting { label, values });
        }
    }
    settings
}

/// The model of `family` with one photopic channel.
pub(crate) fn build(family: &dyn Parametric, setting: &Setting) -> Box<dyn Bsdf> {
    family
        .model(&[(Channel::Photopic, setting.values.clone())])
        .unwrap_or_else(|e| panic!("{} with {}: {e}", family.info().name, setting.label))
}

/// The incidence at `theta` degrees.
pub(crate) fn incidence(theta: f64) -> Direction {
    Direction::from_degrees(theta, AZIMUTH)
}

fn with_role(info: &ModelInfo, test: impl Fn(Role) -> bool) -> Vec<usize> {
    (0..info.parameters.len())
        .filter(|&k| test(info.parameters[k].role))
        .collect()
}

fn base_value(p: &ParameterInfo) -> f64 {
    match p.role {
        // A part of no weight would not be tested.
        Role::Amplitude if p.default <= 0.0 => between(p, 0.3),
        Role::Angle => (0.4f64).clamp(p.low, p.high),
        _ => p.default,
    }
}

fn with_widths(info: &ModelInfo, base: &[f64], widths: &[usize], width: f64, ratio: f64) -> Vec<f64> {
    let mut values = base.to_vec();
    for (n, &k) in widths.iter().enumerate() {
        let p = &info.parameters[k];
        values[k] = (width * ratio.powi(n as i32)).clamp(p.low, p.high);
    }
    values
}

/// The value at `share` of the range, in the logarithm when it spans two decades.
fn between(p: &ParameterInfo, share: f64) -> f64 {
    if p.low > 0.0 && p.high / p.low >= 100.0 {
        (p.low.ln() + share * (p.high / p.low).ln()).exp()
    } else {
        p.low + share * (p.high - p.low)
    }
}
