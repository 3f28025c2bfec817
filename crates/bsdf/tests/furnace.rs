//! Compensated microfacet models: a white furnace, a series of reflections, channels. The laws are in tests/property and
//! tests/statistical.

#![allow(clippy::unwrap_used)] // helpers outside #[test] fail a test by panicking, as the tests themselves do

use gonio_bsdf::analytic::Parametric;
use gonio_bsdf::analytic::microfacet::{CompensatedFamily, compensated};
use gonio_bsdf::{Bsdf, Channel, directional_albedo};
use gonio_geom::{Component, Direction};

fn model(family: &'static CompensatedFamily, parameters: &[f64]) -> Box<dyn Bsdf> {
    family.model(&[(Channel::Photopic, parameters.to_vec())]).unwrap()
}

/// Parameters with the width `alpha` that reflect all light, and that reflect some.
fn parameters(family: &CompensatedFamily, alpha: f64) -> [Vec<f64>; 2] {
    if family.single.position("f0").is_some() {
        [vec![1.0, alpha], vec![0.3, alpha]]
    } else {
        // Without a real part of the index nothing is absorbed: .01 is the least allowed.
        [vec![0.01, 20.0, alpha], vec![0.96, 6.69, alpha]]
    }
}

#[test]
fn a_white_furnace_stays_white_within_a_thousandth_and_makes_no_light() {
    for family in compensated().iter().filter(|f| f.single.position("f0").is_some()) {
        for alpha in [0.005, 0.05, 0.2, 0.5, 1.0] {
            let [white, _] = parameters(family, alpha);
            let model = model(family, &white);
            for degrees in [0.0, 45.0, 75.0, 88.0, 89.5, 120.0] {
                let wi = Direction::from_degrees(degrees, 10.0);
                let albedo = directional_albedo(model.as_ref(), wi, Component::Reflection, 0);
                assert!(
                    albedo > 0.999 && albedo < 1.0 + 1e-6,
                    "{}, alpha {alpha}, {degrees} degrees: {albedo}",
                    family.info().name
                );
            }
        }
    }
}

#[test]
fn compensation_never_makes_light_and_never_takes_any() {
    for family in compensated() {
        for alpha in [0.02, 0.3, 1.0] {
            for p in parameters(family, alpha) {
                let with = model(family, &p);
                for degrees in [5.0, 50.0, 80.0] {
                    let wi = Direction::from_degrees(degrees, 10.0);
                    let albedo = directional_albedo(with.as_ref(), wi, Component::Reflection, 0);
                    assert!(
                        albedo < 1.0 + 1e-6,
                        "{} {p:?} {degrees}: {albedo}",
                        family.info().name
                    );
                    let single = gonio_bsdf::analytic::family(family.single.name)
                        .unwrap()
                        .model(&[(Channel::Photopic, p.clone())])
                        .unwrap();
                    let once = directional_albedo(single.as_ref(), wi, Component::Reflection, 0);
                    // Smooth Beckmann facets lose nothing; the roughest more than a fiftieth even where facets absorb.
                    let gain = if alpha == 1.0 { 0.02 * once } else { -1e-9 };
                    assert!(
                        albedo - once > gain,
                        "{} {p:?} {degrees}: {albedo} {once}",
                        family.info().name
                    );
                }
            }
        }
    }
}

#[test]
fn channels_of_one_width_and_of_two_are_compensated_each() {
    let family = compensated()[0];
    let parts = [
        (Channel::Red, vec![0.9, 0.4]),
        (Channel::Green, vec![0.2, 0.4]),
        (Channel::Blue, vec![0.2, 0.9]),
    ];
    let all = family.model(&parts).unwrap();
    let (wi, ws) = (
        Direction::from_degrees(40.0, 0.0),
        Direction::from_degrees(60.0, 100.0),
    );
    let mut f = [0.0; 3];
    all.eval(wi, ws, &mut f);
    for (k, (channel, p)) in parts.into_iter().enumerate() {
        let one = family.model(&[(channel, p)]).unwrap();
        assert_eq!(f[k], one.eval_first(wi, ws));
    }
    assert!(family.model(&[(Channel::Red, vec![0.5, 2.0])]).is_err());
}

#[test]
fn facets_that_absorb_send_out_a_geometric_series_of_reflections() {
    // With a reflectance F that hardly depends on the angle, F E_mean (1 + F (1 - E_mean) + ...) of all light leaves;
    // E_mean is that share for F = 1 and light scattered once.
    let alpha = 1.0;
    let mean = |model: &dyn Bsdf| -> f64 {
        // Simpson in the squared cosine: 2 mu dmu.
        let n = 24;
        let sum: f64 = (0..=n)
            .map(|k| {
                let cosine = (f64::from(k) / f64::from(n)).sqrt().max(1e-4);
                let weight = [1.0, 4.0, 2.0][if k == 0 || k == n { 0 } else { 2 - (k % 2) as usize }];
                let wi = Direction::from_degrees(cosine.acos().to_degrees(), 10.0);
                weight * directional_albedo(model, wi, Component::Reflection, 0)
            })
            .sum();
        sum / f64::from(3 * n)
    };
    for family in compensated().iter().filter(|f| f.single.position("k").is_some()) {
        let name = family.info().name;
        let once = |p: &[f64]| {
            gonio_bsdf::analytic::family(family.single.name)
                .unwrap()
                .model(&[(Channel::Photopic, p.to_vec())])
                .unwrap()
        };
        // Silver-like: .95 at normal incidence, .93 to 1 elsewhere.
        let absorbing = [0.13, 4.0, alpha];
        let escaping = mean(once(&[0.01, 20.0, alpha]).as_ref()) / 0.9999;
        let f = mean(once(&absorbing).as_ref()) / escaping;
        let series = f * escaping / (1.0 - f * (1.0 - escaping));
        let all = mean(model(family, &absorbing).as_ref());
        assert!(
            (all / series - 1.0).abs() < 0.005,
            "{name}: {all} {series}, F {f}"
        );
    }
}
