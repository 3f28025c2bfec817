//! Noise-free measurements give their parameters back.

use crate::common::{Campaign, measure, random_parameters, rng};
use gonio_bsdf::Channel;
use gonio_fit::{FitOptions, Kind, fit, fit_model, fit_models};

/// Parameters that are not found again within 1e-6.
fn lost(name: &str, seed: u64, channels: &[Channel]) -> Vec<String> {
    let model = fit_model(name).unwrap();
    let mut rng = rng(seed);
    let truth = random_parameters(&model, channels, &mut rng);
    let measurement = measure(&model, &truth, &Campaign::default(), &mut rng);
    let options = FitOptions {
        compare: Vec::new(),
        ..FitOptions::default()
    };
    let found = fit(&measurement, &model, &options).unwrap();
    let mut lost = Vec::new();
    for ((_, truth), (_, values)) in truth.iter().zip(found.parameters()) {
        for ((p, t), v) in model.parameters.iter().zip(truth).zip(values) {
            if (v - t).abs() > 1e-6 * t.abs().max(0.1) {
                lost.push(format!("{name} seed {seed}: {} is {t}, found {v}", p.name));
            }
        }
    }
    lost
}

#[test]
fn every_model_gives_its_parameters_back() {
    for model in fit_models().unwrap() {
        for seed in 0..2 {
            assert_eq!(
                lost(&model.name, seed, &[Channel::Photopic]),
                Vec::<String>::new()
            );
        }
    }
}

#[test]
fn channels_share_what_they_share_and_nothing_else() {
    for name in ["plastic", "metal", "trans", "ward-gmd"] {
        let channels = [Channel::Red, Channel::Green, Channel::Blue];
        assert_eq!(lost(name, 7, &channels), Vec::<String>::new());
    }
}

#[test]
fn two_lobes_of_one_family_are_told_apart() {
    let model = fit_model("lambert+ward-gmd+ward-gmd").unwrap();
    let names: Vec<_> = model.parameters.iter().map(|p| p.name.as_str()).collect();
    assert_eq!(names, ["kd", "ks_1", "alpha_1", "ks_2", "alpha_2"]);
    let mut rng = rng(3);
    let truth = [(Channel::Photopic, vec![0.3, 0.1, 0.05, 0.15, 0.3])];
    let measurement = measure(&model, &truth, &Campaign::default(), &mut rng);
    let found = fit(&measurement, &model, &FitOptions::default()).unwrap();
    let mut lobes = [("ks_1", "alpha_1"), ("ks_2", "alpha_2")].map(|(k, a)| {
        let of = |name| found.estimate(name, Channel::Photopic).unwrap().value;
        (of(a), of(k))
    });
    lobes.sort_by(|a, b| a.0.total_cmp(&b.0));
    for (found, truth) in lobes.iter().zip([(0.05, 0.1), (0.3, 0.15)]) {
        assert!(
            (found.0 / truth.0 - 1.0).abs() < 1e-6 && (found.1 / truth.1 - 1.0).abs() < 1e-6,
            "{lobes:?}"
        );
    }
}

#[test]
fn a_held_parameter_stays_and_the_others_are_found() {
    let model = fit_model("plastic").unwrap();
    let mut rng = rng(1);
    let truth = [(Channel::Photopic, vec![0.4, 0.1, 0.1])];
    let measurement = measure(&model, &truth, &Campaign::default(), &mut rng);
    let options = FitOptions {
        fixed: vec![("specularity".into(), 0.1)],
        ..FitOptions::default()
    };
    let found = fit(&measurement, &model, &options).unwrap();
    let s = found.estimate("specularity", Channel::Photopic).unwrap();
    assert_eq!((s.value, s.kind, s.u), (0.1, Kind::Fixed, 0.0));
    assert!((found.estimate("alpha", Channel::Photopic).unwrap().value - 0.1).abs() < 1e-7);
}
