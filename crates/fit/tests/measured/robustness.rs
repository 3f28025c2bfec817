//! Outliers, wrong models, narrow lobes and bad input.

use crate::common::{Campaign, measure, rng, uniform};
use gonio_bsdf::Channel;
use gonio_fit::metric::Metric;
use gonio_fit::{
    Fit, FitError, FitOptions, Interval, Kind, Reason, Selection, candidates, fit, fit_model, select,
};
use gonio_scan::{Flags, Measurement};

const P: Channel = Channel::Photopic;

fn noisy() -> Campaign {
    Campaign {
        noise: (0.01, 2e-4),
        ..Campaign::default()
    }
}

/// Plastic of colour 0.4, specularity 0.06, alpha 0.12.
fn plastic(campaign: &Campaign, seed: u64) -> Measurement {
    let model = fit_model("plastic").unwrap();
    measure(&model, &[(P, vec![0.4, 0.06, 0.12])], campaign, &mut rng(seed))
}

fn run(measurement: &Measurement, model: &str) -> Result<Fit, FitError> {
    fit(measurement, &fit_model(model).unwrap(), &FitOptions::default())
}

#[test]
fn two_readings_in_a_thousand_that_are_wrong_move_no_parameter_by_its_uncertainty() {
    for seed in 0..5 {
        let clean = plastic(&noisy(), seed);
        let mut spoilt = clean.clone();
        let mut rng = rng(100 + seed);
        for d in spoilt.slices.iter_mut().flat_map(|s| &mut s.dsf) {
            if uniform(&mut rng, 0.0, 1.0) < 0.002 {
                *d *= uniform(&mut rng, 2.0, 20.0);
            }
        }
        let (clean, spoilt) = (run(&clean, "plastic").unwrap(), run(&spoilt, "plastic").unwrap());
        for (a, b) in clean.estimates.iter().zip(&spoilt.estimates) {
            assert!((a.value - b.value).abs() < b.u, "seed {seed}: {a:?} {b:?}");
        }
    }
}

#[test]
fn the_wrong_model_shows_in_the_spread_between_metrics() {
    // Two lobes fitted with one.
    let truth = fit_model("lambert+ward-gmd+ward-gmd").unwrap();
    let q = [(P, vec![0.3, 0.03, 0.08, 0.03, 0.25])];
    let measurement = measure(&truth, &q, &noisy(), &mut rng(5));
    let found = run(&measurement, "plastic").unwrap();
    let spec = found.estimate("specularity", P).unwrap();
    assert!(
        spec.u_model > 10.0 * spec.u && spec.u_model > 0.1 * spec.value,
        "{spec:?}"
    );
    assert!(
        found.warns("metric_spread") && found.warns("misfit"),
        "{:?}",
        found.warnings
    );
    // The right model shows none.
    let right = run(&plastic(&noisy(), 5), "plastic").unwrap();
    assert!(
        right.estimates.iter().all(|e| e.u_model < 5.0 * e.u),
        "{:?}",
        right.estimates
    );
    assert!(right.warnings.is_empty(), "{:?}", right.warnings);
}

#[test]
fn microfacets_fitted_with_the_wrong_slopes_show_in_the_spread_between_metrics() {
    let truth = fit_model("ggx").unwrap();
    let q = [(P, vec![0.3, 0.05, 0.12])];
    let measurement = measure(&truth, &q, &noisy(), &mut rng(8));
    let (wrong, right) = (
        run(&measurement, "ward-gmd").unwrap(),
        run(&measurement, "ggx").unwrap(),
    );
    // Noise alone moves the parameters far less than the choice of the metric does.
    let noise = right.estimate("alpha", P).unwrap().u;
    let alpha = wrong.estimate("alpha", P).unwrap();
    assert!(
        alpha.u_model > 10.0 * noise && alpha.u_model > 2.0 * alpha.u,
        "{noise} {alpha:?}"
    );
    assert!(
        wrong.warns("metric_spread") && wrong.warns("misfit"),
        "{:?}",
        wrong.warnings
    );
    for estimate in &right.estimates {
        assert!(estimate.u_model < 5.0 * estimate.u, "{estimate:?}");
    }
    assert!(right.warnings.is_empty(), "{:?}", right.warnings);
}

#[test]
fn models_with_an_axis_are_tried_where_the_sample_was_turned() {
    let straight = plastic(&noisy(), 3);
    let turned = Campaign {
        phi_i: 65.0,
        ..noisy()
    };
    let mut both = straight.clone();
    both.slices.extend(plastic(&turned, 4).slices);
    let names = |m: &Measurement| -> Vec<String> {
        let models = candidates(m, &Selection::default()).unwrap();
        models.into_iter().map(|m| m.name).collect()
    };
    let (few, all) = (names(&straight), names(&both));
    assert!(few.iter().any(|n| n == "plastic") && !few.iter().any(|n| n == "plastic2"));
    assert!(all.iter().any(|n| n == "plastic") && all.iter().any(|n| n == "plastic2"));
}

#[test]
fn correlated_residuals_widen_the_uncertainties() {
    let truth = fit_model("lambert+ward-gmd+ward-gmd").unwrap();
    let q = [(P, vec![0.3, 0.03, 0.08, 0.01, 0.16])];
    let measurement = measure(&truth, &q, &noisy(), &mut rng(5));
    let wrong = run(&measurement, "plastic").unwrap();
    let right = run(&plastic(&noisy(), 5), "plastic").unwrap();
    assert!(wrong.design_effect > 2.0, "{}", wrong.design_effect);
    assert_eq!(right.design_effect, 1.0);
}

#[test]
fn the_beam_power_enters_amplitudes_and_not_widths() {
    let campaign = Campaign {
        u_common: 0.02,
        ..noisy()
    };
    let found = run(&plastic(&campaign, 3), "ward-gmd").unwrap();
    let of = |name| found.estimate(name, P).unwrap();
    for name in ["kd", "ks"] {
        let e = of(name);
        assert!((e.u_common / (0.02 * e.value) - 1.0).abs() < 0.02, "{e:?}");
    }
    assert!(of("alpha").u_common < 0.1 * of("alpha").u);
}

#[test]
fn the_beam_profile_does_not_widen_the_lobe() {
    let campaign = Campaign {
        beam: Some(4.0),
        noise: (0.005, 1e-4),
        ..Campaign::default()
    };
    let measurement = plastic(&campaign, 8);
    let model = fit_model("plastic").unwrap();
    let with = fit(&measurement, &model, &FitOptions::default()).unwrap();
    let options = FitOptions {
        signature: false,
        ..FitOptions::default()
    };
    let without = fit(&measurement, &model, &options).unwrap();
    let alpha = |f: &Fit| f.estimate("alpha", P).unwrap().clone();
    let (with, without) = (alpha(&with), alpha(&without));
    assert!(with.low < 0.12 && 0.12 < with.high, "{with:?}");
    assert!(without.low > 0.12, "{without:?}");
}

#[test]
fn a_lobe_narrower_than_the_beam_gives_an_upper_limit() {
    let model = fit_model("plastic").unwrap();
    let campaign = Campaign {
        beam: Some(3.0),
        ..noisy()
    };
    let truth = [(P, vec![0.4, 0.06, 0.006])];
    let measurement = measure(&model, &truth, &campaign, &mut rng(2));
    let found = run(&measurement, "plastic").unwrap();
    let alpha = found.estimate("alpha", P).unwrap();
    assert_eq!(alpha.kind, Kind::UpperLimit);
    assert!(alpha.high > 0.006 && alpha.high < 0.06, "{alpha:?}");
    assert!(found.warns("unresolved"));
}

#[test]
fn a_sample_without_a_peak_says_so() {
    let model = fit_model("lambert").unwrap();
    let measurement = measure(&model, &[(P, vec![0.6])], &noisy(), &mut rng(2));
    let found = run(&measurement, "plastic").unwrap();
    assert!(
        found.warns("no_peak") || found.warns("undetermined"),
        "{:?}",
        found.warnings
    );
    let s = found.estimate("specularity", P).unwrap();
    assert!(s.value < 0.01 && s.high < 0.05, "{s:?}");
}

#[test]
fn an_amplitude_at_zero_has_an_interval_from_the_profile() {
    let model = fit_model("lambert").unwrap();
    let measurement = measure(&model, &[(P, vec![0.6])], &noisy(), &mut rng(4));
    let options = FitOptions {
        fixed: vec![("alpha".into(), 0.1)],
        ..FitOptions::default()
    };
    let found = fit(&measurement, &fit_model("plastic").unwrap(), &options).unwrap();
    let s = found.estimate("specularity", P).unwrap();
    assert_eq!(s.interval, Interval::Profile);
    assert!(s.low == 0.0 && s.high > 0.0 && s.high < 0.01, "{s:?}");
}

#[test]
fn a_broad_lobe_is_called_hard_to_tell_from_the_diffuse_part() {
    let model = fit_model("ward-gmd").unwrap();
    let measurement = measure(&model, &[(P, vec![0.3, 0.1, 0.7])], &noisy(), &mut rng(2));
    let found = run(&measurement, "ward-gmd").unwrap();
    assert!(found.warns("broad_lobe"), "{:?}", found.warnings);
    let n = found.estimates.len();
    assert!(found.correlation[1] < -0.5, "{:?}", &found.correlation[..n]);
}

#[test]
fn all_zero_readings_are_no_signal() {
    let mut measurement = plastic(&noisy(), 1);
    measurement.slices.iter_mut().for_each(|s| s.dsf.fill(0.0));
    assert!(matches!(
        run(&measurement, "plastic"),
        Err(FitError::NoSignal { .. })
    ));
}

#[test]
fn noise_alone_is_no_signal() {
    let model = fit_model("lambert").unwrap();
    let measurement = measure(&model, &[(P, vec![0.0])], &noisy(), &mut rng(9));
    assert!(matches!(
        run(&measurement, "lambert"),
        Err(FitError::NoSignal { .. })
    ));
}

#[test]
fn fewer_readings_than_parameters_are_refused_with_the_reason() {
    let mut measurement = plastic(&noisy(), 1);
    for slice in &mut measurement.slices {
        slice.flags.fill(Flags::SATURATED);
    }
    let error = run(&measurement, "plastic").unwrap_err();
    assert!(
        matches!(error, FitError::TooFewReadings { found: 0, .. }),
        "{error}"
    );
    assert!(error.to_string().contains("saturated"), "{error}");
}

#[test]
fn readings_that_are_no_numbers_are_counted_and_do_no_harm() {
    let mut measurement = plastic(&noisy(), 1);
    let clean = run(&measurement, "plastic").unwrap();
    let mut count = 0;
    for slice in &mut measurement.slices {
        for d in slice.dsf.iter_mut().step_by(3) {
            *d = f64::NAN;
            count += 1;
        }
    }
    let found = run(&measurement, "plastic").unwrap();
    assert!(found.warns("missing_readings"));
    let missing = found
        .excluded
        .iter()
        .find(|e| e.reason == Reason::NoData)
        .unwrap();
    assert_eq!(missing.count, count);
    for (a, b) in clean.estimates.iter().zip(&found.estimates) {
        assert!((a.value - b.value).abs() < 3.0 * b.u, "{a:?} {b:?}");
    }
    measurement.slices.iter_mut().for_each(|s| s.dsf.fill(f64::NAN));
    assert!(matches!(
        run(&measurement, "plastic"),
        Err(FitError::TooFewReadings { .. })
    ));
}

#[test]
fn readings_of_the_other_hemisphere_name_the_convention() {
    let mut measurement = plastic(&noisy(), 1);
    for slice in &mut measurement.slices {
        slice
            .theta_s
            .iter_mut()
            .for_each(|t| *t = std::f64::consts::PI - *t);
    }
    let error = run(&measurement, "plastic").unwrap_err();
    assert!(matches!(error, FitError::WrongSide { .. }), "{error}");
    assert!(error.to_string().contains("theta_s"), "{error}");
}

#[test]
fn a_lost_column_and_an_unknown_channel_are_named() {
    let mut measurement = plastic(&noisy(), 1);
    let options = FitOptions {
        selection: Selection {
            channels: vec![Channel::Red],
            ..Selection::default()
        },
        ..FitOptions::default()
    };
    let model = fit_model("plastic").unwrap();
    let error = fit(&measurement, &model, &options).unwrap_err();
    assert!(
        error.to_string().contains("red") && error.to_string().contains("photopic"),
        "{error}"
    );
    measurement.slices[0].omega.pop();
    assert!(matches!(
        run(&measurement, "plastic"),
        Err(FitError::Columns { field: "omega", .. })
    ));
    assert!(
        fit_model("no such model")
            .unwrap_err()
            .to_string()
            .contains("plastic")
    );
}

#[test]
fn without_stated_uncertainties_they_come_from_the_residuals() {
    let mut measurement = plastic(&noisy(), 1);
    measurement.slices.iter_mut().for_each(|s| s.u_dsf.fill(0.0));
    let found = run(&measurement, "plastic").unwrap();
    assert!(found.warns("noise_unknown"));
    for (e, truth) in found.estimates.iter().zip([0.4, 0.06, 0.12]) {
        assert!((e.value - truth).abs() < 4.0 * e.u && e.u < 0.02 * truth, "{e:?}");
    }
}

#[test]
fn a_set_cancel_flag_ends_the_fit() {
    let cancel = std::sync::atomic::AtomicBool::new(true);
    let options = FitOptions {
        cancel: Some(&cancel),
        ..FitOptions::default()
    };
    let model = fit_model("plastic").unwrap();
    let found = fit(&plastic(&noisy(), 1), &model, &options);
    assert_eq!(found.unwrap_err(), FitError::Cancelled);
}

#[test]
fn every_metric_finds_the_right_model() {
    let measurement = plastic(&noisy(), 6);
    let model = fit_model("plastic").unwrap();
    for metric in Metric::ALL {
        let options = FitOptions {
            metric,
            ..FitOptions::default()
        };
        let found = fit(&measurement, &model, &options).unwrap();
        for (e, truth) in found.estimates.iter().zip([0.4, 0.06, 0.12]) {
            assert!((e.value / truth - 1.0).abs() < 0.03, "{metric:?}: {e:?}");
        }
    }
}

#[test]
fn the_true_model_is_chosen_and_the_choice_explained() {
    let measurement = plastic(&noisy(), 7);
    let models =
        ["lambert", "ward-duer", "metal2", "plastic", "ashikhmin-shirley"].map(|n| fit_model(n).unwrap());
    let choice = select(&measurement, &models, &FitOptions::default()).unwrap();
    assert_eq!(choice.ranking[0].fit.model.name, "plastic", "{}", choice.sentence);
    assert!(
        choice.sentence.starts_with("plastic describes the sample best"),
        "{}",
        choice.sentence
    );
    assert_eq!(choice.ranking[0].held_out.len(), 4);
    let order: Vec<_> = choice
        .ranking
        .iter()
        .map(|r| (r.fit.model.name.clone(), r.held_out_error, r.fit.aicc))
        .collect();
    assert!(order[2].0 == "ward-duer", "{order:?}");
    assert!(choice.failed.is_empty());
}
