//! Compensated microfacet models: a white furnace, energy, reciprocity, samples.

#![allow(clippy::unwrap_used)] // helpers outside #[test] fail a test by panicking, as the tests themselves do

use gonio_bsdf::analytic::microfacet::{CompensatedFamily, compensated};
use gonio_bsdf::{Bsdf, Channel, directional_albedo};
use gonio_geom::{Component, Direction};
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64Mcg;

fn model(family: &CompensatedFamily, parameters: &[f64]) -> Box<dyn Bsdf> {
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
fn a_white_furnace_stays_white_within_one_percent() {
    for family in compensated().iter().filter(|f| f.single.position("f0").is_some()) {
        for alpha in [0.05, 0.1, 0.2, 0.35, 0.5, 0.7, 1.0] {
            let [white, _] = parameters(family, alpha);
            let model = model(family, &white);
            for degrees in [0.0, 30.0, 60.0, 75.0, 85.0, 88.0, 89.5, 120.0] {
                let wi = Direction::from_degrees(degrees, 10.0);
                let albedo = directional_albedo(model.as_ref(), wi, Component::Reflection, 0);
                assert!(
                    (albedo - 1.0).abs() < 0.01,
                    "{}, alpha {alpha}, {degrees} degrees: {albedo}",
                    family.name
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
                    assert!(albedo < 1.0 + 2e-3, "{} {p:?} {degrees}: {albedo}", family.name);
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
                        family.name
                    );
                }
            }
        }
    }
}

#[test]
fn compensated_models_are_reciprocal_and_their_samples_follow_density_and_albedo() {
    let mut rng = Pcg64Mcg::seed_from_u64(51);
    let n = 200_000;
    for family in compensated() {
        for alpha in [0.1, 0.8] {
            let [_, p] = parameters(family, alpha);
            let model = model(family, &p);
            for degrees in [10.0, 70.0, 140.0] {
                let wi = Direction::from_degrees(degrees, 200.0);
                let albedo = directional_albedo(model.as_ref(), wi, Component::Reflection, 0);
                // The mean weight is the albedo, the mean of 1 / density the solid angle that samples reach; six
                // standard deviations in 48 comparisons.
                let (mut sum, mut squares) = (0.0, 0.0);
                let (mut above, mut expected) = (0.0, 0.0);
                for _ in 0..n {
                    if let Some(s) = model.sample(wi, rng.random()) {
                        sum += s.weight;
                        squares += s.weight * s.weight;
                        above += f64::from(u8::from(s.direction.cos_theta().abs() > 0.7));
                        let back = model.eval_first(s.direction, wi);
                        let there = model.eval_first(wi, s.direction);
                        assert!((there - back).abs() <= 1e-12 * there, "{there} {back}");
                    }
                }
                let mean = sum / f64::from(n);
                let sigma = ((squares / f64::from(n) - mean * mean).max(0.0) / f64::from(n)).sqrt();
                assert!(
                    (mean - albedo).abs() < 6.0 * sigma + 1e-6,
                    "{} {p:?} {degrees}: {mean} {albedo}",
                    family.name
                );
                expected += gonio_bsdf::albedo::hemispherical_integral(wi, wi.side(), |s| {
                    if s.cos_theta().abs() > 0.7 {
                        model.pdf(wi, s)
                    } else {
                        0.0
                    }
                })
                .value;
                let share = above / f64::from(n);
                let sigma = (expected * (1.0 - expected).max(0.0) / f64::from(n)).sqrt();
                assert!(
                    (share - expected).abs() < 6.0 * sigma + 1e-4,
                    "{} {p:?} {degrees}: {share} {expected}",
                    family.name
                );
            }
        }
    }
}

#[test]
fn channels_of_one_width_and_of_two_are_compensated_each() {
    let family = &compensated()[0];
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
