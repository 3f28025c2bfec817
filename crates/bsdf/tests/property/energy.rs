//! Directional-hemispherical reflectance plus transmittance is at most 1.

use gonio_bsdf::albedo::hemispherical_integral;
use gonio_bsdf::analytic::{Law, Parametric, Role, Sum};
use gonio_bsdf::{Bsdf, Channel};
use gonio_geom::{Component, Direction};
use rayon::prelude::*;

use crate::cases::{incidences, materials, model, sums};
use crate::common::{Setting, chosen, settings};

/// Polar angles of incidence, degrees: normal, oblique, grazing, and from the back.
const THETAS: [f64; 7] = [0.0, 30.0, 60.0, 75.0, 85.0, 89.0, 120.0];

/// Total of both components and of the ideal parts for `channel`, and the bound on its numerical error.
pub(crate) fn total(model: &dyn Bsdf, wi: Direction, channel: usize) -> (f64, f64) {
    let n = model.channels().len();
    let (mut value, mut error) = (0.0, 0.0);
    for component in [Component::Reflection, Component::Transmission] {
        let part = hemispherical_integral(wi, component.scattered_side(wi.side()), |ws| {
            let cos = ws.cos_theta().abs();
            if n == 1 {
                return model.eval_first(wi, ws) * cos;
            }
            let mut f = vec![0.0; n];
            model.eval(wi, ws, &mut f);
            f[channel] * cos
        });
        let mut shares = vec![0.0; n];
        model.delta(wi, component, &mut shares);
        value += part.value + shares[channel];
        error += part.error;
    }
    (value, error)
}

/// `setting` with every amplitude at its largest or its smallest value, in every combination but all smallest. Models
/// are affine in each amplitude, so that the largest albedo is at one of these corners.
fn corners(family: &dyn Parametric, setting: &Setting) -> Vec<Vec<f64>> {
    let infos = family.info().parameters;
    let amplitudes: Vec<usize> = (0..infos.len())
        .filter(|&k| infos[k].role == Role::Amplitude)
        .collect();
    if amplitudes.is_empty() {
        return vec![setting.values.clone()];
    }
    (1..1_usize << amplitudes.len())
        .map(|bits| {
            let mut values = setting.values.clone();
            for (n, &k) in amplitudes.iter().enumerate() {
                values[k] = if bits >> n & 1 == 1 {
                    infos[k].high
                } else {
                    infos[k].low
                };
            }
            values
        })
        .collect()
}

#[test]
fn no_model_that_keeps_energy_sends_out_more_than_arrives() {
    let mut cases = Vec::new();
    for f in chosen() {
        if !f.info().keeps(Law::Energy) {
            continue;
        }
        for values in settings(f.info()).iter().flat_map(|s| corners(f, s)) {
            cases.push((f, values));
        }
    }
    let failed: Vec<String> = cases
        .par_iter()
        .flat_map_iter(|(f, values)| {
            let model = f.model(&[(Channel::Photopic, values.clone())]).unwrap();
            assert!(model.properties().energy_conserving, "{}", f.info().name);
            let checked = incidences(model.as_ref(), &THETAS).into_iter().map(|wi| {
                let (total, error) = total(model.as_ref(), wi, 0);
                (wi, total, error)
            });
            checked
                .filter(|(_, total, error)| !(*total <= 1.0 + 1e-6 && *error < 1e-3))
                .map(|(wi, total, error)| {
                    format!("{} {values:?}, {wi:?}: {total} +- {error:e}", f.info().name)
                })
                .collect::<Vec<_>>()
        })
        .collect();
    assert!(failed.is_empty(), "{}", failed.join("\n"));
}

#[test]
fn a_sum_keeps_energy_exactly_when_it_says_so() {
    for case in sums() {
        let model = case.model.as_ref();
        let most = incidences(model, &[0.0, 15.0, 50.0, 72.0, 82.0, 88.0, 110.0])
            .into_iter()
            .flat_map(|wi| (0..model.channels().len()).map(move |c| total(model, wi, c).0))
            .fold(0.0, f64::max);
        assert_eq!(
            model.properties().energy_conserving,
            most <= 1.0 + 1e-6,
            "{}: {most}",
            case.label
        );
    }
}

#[test]
fn a_material_that_claims_to_keep_energy_does() {
    let mut claims = 0;
    for case in materials() {
        let model = case.model.as_ref();
        if !model.properties().energy_conserving {
            continue;
        }
        claims += 1;
        for wi in incidences(model, &THETAS) {
            for channel in 0..3 {
                let (total, error) = total(model, wi, channel);
                assert!(
                    total <= 1.0 + 1e-6 && error < 1e-3,
                    "{}, {wi:?}: {total} +- {error:e}",
                    case.label
                );
            }
        }
    }
    assert!(claims > 5, "{claims}");
}

#[test]
fn a_sum_with_a_part_that_breaks_energy_does_not_claim_to_keep_it() {
    let parts = [("lambert", vec![0.1]), ("ward", vec![0.1, 0.2])]
        .map(|(name, p)| model(name, &[(Channel::Photopic, p)]));
    assert!(!Sum::new(parts.into()).unwrap().properties().energy_conserving);
}
