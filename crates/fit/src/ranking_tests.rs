use gonio_bsdf::Channel;
use gonio_bsdf::analytic::Role;
use gonio_geom::Angles;

use super::*;
use crate::metric::{Loss, Metric};
use crate::{Estimate, Interval, Kind, LargestAlbedo, Weights, fit_model, fit_models};

/// A model of which nothing is known but its errors at incidences, its criterion and whether a parameter is open.
fn model(name: &str, errors: &[f64], aicc: f64, open: Option<Open>) -> Ranked {
    let estimate = Estimate {
        name: "kd".into(),
        unit: "1".into(),
        role: Role::Amplitude,
        channel: None,
        value: 0.5,
        u: 0.1,
        u_common: 0.0,
        u_model: 0.0,
        low: 0.3,
        high: 0.7,
        kind: Kind::Value,
        interval: Interval::Quadratic,
        open,
    };
    let fit = Fit {
        model: fit_model(name).unwrap(),
        metric: Metric::Chi2,
        loss: Loss::Linear,
        weights: Weights::Predicted,
        channels: vec![Channel::Photopic],
        estimates: vec![estimate],
        covariance: vec![0.01],
        correlation: vec![1.0],
        other_metrics: Vec::new(),
        readings: 100,
        excluded: Vec::new(),
        blocks: 100,
        cost: 50.0,
        dispersion: Some(1.0),
        design_effect: 1.0,
        aicc,
        evaluations: 1,
        converged: true,
        residuals: Vec::new(),
        predicted: Vec::new(),
        albedo: None,
        sphere: Vec::new(),
        warnings: Vec::new(),
    };
    let held_out: Vec<HeldOut> = errors
        .iter()
        .map(|&relative_l1| HeldOut {
            incidence: Angles::from_degrees(30.0, 0.0),
            residuals: Vec::new(),
            relative_l1,
        })
        .collect();
    Ranked {
        fit,
        held_out_error: errors.iter().sum::<f64>() / errors.len() as f64,
        held_out,
    }
}

fn scattering(mut ranked: Ranked, value: f64, u: f64) -> Ranked {
    ranked.fit.albedo = Some(LargestAlbedo {
        value,
        u,
        incidence: Angles::from_degrees(75.0, 0.0),
        channel: Channel::Photopic,
    });
    ranked
}

/// Names in their order, those passed over, and the sentence.
fn ordered(mut ranking: Vec<Ranked>) -> (Vec<String>, Vec<(String, String)>, String) {
    let names: Vec<String> = fit_models().unwrap().into_iter().map(|m| m.name).collect();
    let passed_over = order(&mut ranking, &names);
    let said = sentence(&ranking, &passed_over);
    let found = ranking.into_iter().map(|r| r.fit.model.name).collect();
    (found, passed_over, said)
}

#[test]
fn a_model_with_an_open_parameter_is_passed_over_for_a_sound_one_of_nearly_the_same_error() {
    let (order, passed_over, said) = ordered(vec![
        model("harvey-shack", &[0.030, 0.040], -100.0, Some(Open::Vague)),
        model("abg", &[0.031, 0.040], -101.0, Some(Open::Range)),
        model("ward", &[0.033, 0.042], -90.0, None),
        model("lambert", &[0.1, 0.1], -20.0, None),
    ]);
    assert_eq!(order, ["ward", "harvey-shack", "abg", "lambert"]);
    let names: Vec<_> = passed_over.iter().map(|(n, _)| n.as_str()).collect();
    assert_eq!(names, ["harvey-shack", "abg"]);
    assert!(
        said.starts_with(
            "ward describes the sample best of the models that are determined by the readings and keep energy"
        ),
        "{said}"
    );
    assert!(
        said.contains("harvey-shack (3.5 %): the readings leave kd open"),
        "{said}"
    );
    assert!(said.contains("abg (3.6 %): kd ends at a bound"), "{said}");
    assert!(said.contains("next is lambert"), "{said}");
}

#[test]
fn a_sound_model_that_is_much_worse_does_not_win_but_the_flaw_is_told() {
    let (order, passed_over, said) = ordered(vec![
        model("ward", &[0.036, 0.042], -90.0, None),
        model("abg", &[0.030, 0.040], -100.0, Some(Open::Vague)),
    ]);
    assert_eq!(order, ["abg", "ward"]);
    assert!(passed_over.is_empty());
    assert!(said.starts_with("abg describes the sample best: "), "{said}");
    assert!(said.contains("Beware: the readings leave kd open"), "{said}");
}

#[test]
fn a_model_that_misses_half_of_the_light_describes_nothing() {
    let of = |error| ordered(vec![model("abg", &[error, error], -100.0, None)]).2;
    assert!(of(0.45).starts_with("abg describes the sample best: "));
    let said = of(0.76);
    assert!(
        said.starts_with("no model describes the sample; abg comes nearest"),
        "{said}"
    );
    assert!(said.contains("76.0 %") && said.contains("gonio build"), "{said}");
}

#[test]
fn more_light_than_there_is_counts_beyond_its_expanded_uncertainty_only() {
    let ward = || model("ward", &[0.033, 0.042], -90.0, None);
    let ggx = |u| scattering(model("ggx", &[0.030, 0.040], -100.0, None), 1.05, u);
    assert_eq!(ordered(vec![ggx(0.03), ward()]).0, ["ggx", "ward"]);
    let (order, passed_over, _) = ordered(vec![ggx(0.02), ward()]);
    assert_eq!(order, ["ward", "ggx"]);
    assert!(
        passed_over[0].1.contains("1.050 ± 0.040 (k = 2) of the light"),
        "{}",
        passed_over[0].1
    );
}

#[test]
fn the_plastic_comes_first_of_models_that_are_one_function_whatever_their_order_and_rounding() {
    // Criteria on both sides of a step of 0.01, as rounding leaves them.
    let of = |name, k: f64| model(name, &[0.04 + 1e-9 * k, 0.05], -1664.535 + 1e-9 * k, None);
    for names in [
        ["ward-gmd", "metal", "plastic"],
        ["metal", "plastic", "ward-gmd"],
        ["plastic", "ward-gmd", "metal"],
    ] {
        let ranking = names
            .iter()
            .zip([-1.0, 0.0, 1.0])
            .map(|(n, k)| of(n, k))
            .collect();
        let (order, _, said) = ordered(ranking);
        assert_eq!(order, ["plastic", "metal", "ward-gmd"]);
        assert!(
            said.contains("metal and ward-gmd are the same function in other parameters"),
            "{said}"
        );
    }
}

#[test]
fn with_a_single_incidence_the_criterion_decides_what_is_nearly_as_good() {
    let abg = || model("abg", &[], -100.0, Some(Open::Undetermined));
    assert_eq!(ordered(vec![abg(), model("ward", &[], -98.5, None)]).0[0], "ward");
    assert_eq!(ordered(vec![abg(), model("ward", &[], -97.5, None)]).0[0], "abg");
}

#[test]
fn errors_that_no_instrument_resolves_are_ties() {
    let (order, _, _) = ordered(vec![
        model("abg", &[1e-12, 1e-12], -90.0, None),
        model("lambert", &[1e-9, 1e-9], -94.0, None),
    ]);
    assert_eq!(order, ["lambert", "abg"]);
}
