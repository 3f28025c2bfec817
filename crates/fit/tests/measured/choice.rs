//! Which model wins where several describe the readings about as well.

use crate::common::{Campaign, measure, rng};
use gonio_bsdf::Channel;
use gonio_fit::{Choice, FitOptions, Selection, candidates, fit, fit_model, select};
use gonio_scan::Measurement;

const P: Channel = Channel::Photopic;

/// A matte sample: no peak to resolve, so the grid has one pitch.
fn matte(model: &str, q: &[f64], noise: (f64, f64), seed: u64) -> Measurement {
    let campaign = Campaign {
        incidences: vec![10.0, 30.0, 50.0, 70.0],
        pitch: (8.0, 4.0),
        noise,
        ..Campaign::default()
    };
    let model = fit_model(model).unwrap();
    measure(&model, &[(P, q.to_vec())], &campaign, &mut rng(seed))
}

fn chosen(measurement: &Measurement) -> Choice {
    let models = candidates(measurement, &Selection::default()).unwrap();
    select(measurement, &models, &FitOptions::default()).unwrap()
}

#[test]
fn a_white_diffuser_is_described_by_a_diffuse_model() {
    for (name, q) in [
        ("lambert", vec![0.95]),
        ("oren-nayar", vec![0.95, 20.0_f64.to_radians()]),
    ] {
        for seed in 0..3 {
            let choice = chosen(&matte(name, &q, (0.01, 2e-4), seed));
            assert_eq!(choice.ranking[0].fit.model.name, name, "{}", choice.sentence);
        }
    }
}

#[test]
fn a_diffuser_without_any_noise_is_described_by_a_diffuse_model() {
    let mut exact = matte("lambert", &[0.95], (0.0, 0.0), 0);
    for slice in &mut exact.slices {
        slice.u_dsf = slice.dsf.iter().map(|d| 0.01 * d).collect();
    }
    let choice = chosen(&exact);
    assert_eq!(choice.ranking[0].fit.model.name, "lambert", "{}", choice.sentence);
}

#[test]
fn no_winner_has_flaws_where_a_sound_model_has_nearly_its_error() {
    for seed in 0..3 {
        // A broad sheen: many lobes come close, some of them at the ends of their ranges.
        let choice = chosen(&matte("ward", &[0.9, 0.12, 0.6], (0.02, 1e-3), seed));
        let best = &choice.ranking[0];
        assert!(best.flaws().is_empty(), "{:?}: {}", best.flaws(), choice.sentence);
        for (name, flaws) in &choice.passed_over {
            assert!(!flaws.is_empty(), "{name}: {}", choice.sentence);
        }
    }
}

#[test]
fn plastic_stands_before_metal_and_ward_gmd_for_one_channel() {
    let sample = matte("plastic", &[0.4, 0.06, 0.3], (0.01, 2e-4), 4);
    for names in [["metal", "ward-gmd", "plastic"], ["ward-gmd", "plastic", "metal"]] {
        let models = names.map(|n| fit_model(n).unwrap());
        let choice = select(&sample, &models, &FitOptions::default()).unwrap();
        let order: Vec<_> = choice.ranking.iter().map(|r| r.fit.model.name.as_str()).collect();
        assert_eq!(order, ["plastic", "metal", "ward-gmd"]);
        assert!(
            choice
                .sentence
                .contains("metal and ward-gmd are the same function in other parameters"),
            "{}",
            choice.sentence
        );
    }
}

#[test]
fn the_albedo_of_a_diffuse_model_is_as_uncertain_as_its_reflectance() {
    let sample = matte("lambert", &[0.95], (0.01, 2e-4), 5);
    let found = fit(&sample, &fit_model("lambert").unwrap(), &FitOptions::default()).unwrap();
    let (kd, top) = (&found.estimates[0], found.albedo.unwrap());
    assert!((top.value - kd.value).abs() < 1e-5, "{top:?}");
    assert!((top.u / kd.u - 1.0).abs() < 0.01, "{top:?} {kd:?}");
    assert!(!top.exceeds_one());
}

#[test]
fn a_fit_to_more_light_than_there_is_says_so_unless_its_uncertainty_allows_it() {
    let ggx = || matte("ggx", &[0.97, 0.1, 0.3], (0.01, 2e-4), 6);
    let found = |m: &Measurement| fit(m, &fit_model("ggx").unwrap(), &FitOptions::default()).unwrap();
    let bright = found(&ggx());
    assert!(bright.albedo.unwrap().exceeds_one());
    let text = |f: &gonio_fit::Fit| {
        f.warnings
            .iter()
            .find(|w| w.code == "energy")
            .unwrap()
            .text
            .clone()
    };
    assert!(
        text(&bright).contains("check the beam power"),
        "{}",
        text(&bright)
    );
    let mut doubtful = ggx();
    for slice in &mut doubtful.slices {
        slice.u_common = 0.1;
        for (u, d) in slice.u_dsf.iter_mut().zip(&slice.dsf) {
            *u = u.hypot(0.1 * d);
        }
    }
    let doubtful = found(&doubtful);
    assert!(!doubtful.albedo.unwrap().exceeds_one(), "{:?}", doubtful.albedo);
    assert!(
        text(&doubtful).contains("within its uncertainty"),
        "{}",
        text(&doubtful)
    );
}
