//! Models that do not suit the sample: the search ends at a minimum all the same.

use crate::common::{Campaign, measure, rng};
use gonio_bsdf::Channel;
use gonio_fit::metric::Metric;
use gonio_fit::{Fit, FitOptions, fit, fit_model};
use gonio_scan::Measurement;

const P: Channel = Channel::Photopic;

fn sample(model: &str, q: &[f64]) -> Measurement {
    let campaign = Campaign {
        noise: (0.01, 2e-4),
        ..Campaign::default()
    };
    measure(
        &fit_model(model).unwrap(),
        &[(P, q.to_vec())],
        &campaign,
        &mut rng(3),
    )
}

fn run(measurement: &Measurement, model: &str) -> Fit {
    fit(measurement, &fit_model(model).unwrap(), &FitOptions::default()).unwrap()
}

fn error(found: &Fit) -> f64 {
    let sum: f64 = found.residuals.iter().map(|r| r.relative_l1).sum();
    sum / found.residuals.len() as f64
}

#[test]
fn a_conductor_finds_the_reflectance_of_a_dielectric() {
    // eta and k of the start reflect twenty times as much, and differ along a direction that hardly matters.
    let measurement = sample("ggx", &[0.01, 0.06, 0.3]);
    for name in ["ggx-conductor", "ggx-conductor-anisotropic"] {
        let found = run(&measurement, name);
        assert!(
            found.converged && error(&found) < 0.15,
            "{name}: {}",
            error(&found)
        );
    }
}

#[test]
fn a_lobe_with_tails_too_faint_settles() {
    let measurement = sample("ggx", &[0.02, 0.5, 0.02]);
    for name in ["ward-gmd", "beckmann", "metal"] {
        let found = run(&measurement, name);
        assert!(found.converged, "{name} after {}", found.evaluations);
    }
}

#[test]
fn a_peak_that_the_model_lacks_does_not_rule_the_rest() {
    let measurement = sample("ward-gmd", &[0.05, 0.3, 0.1]);
    let found = run(&measurement, "lambert");
    let kd = found.estimate("kd", P).unwrap().value;
    assert!(kd < 0.15, "{kd}");
    // Light and peak are missed, and said to be; the right model misses neither.
    assert!(found.warns("bias") && found.warns("peak"), "{:?}", found.warnings);
    let right = run(&measurement, "ward-gmd");
    assert!(
        !right.warns("bias") && !right.warns("peak"),
        "{:?}",
        right.warnings
    );
}

#[test]
fn a_misfit_shows_in_every_metric() {
    let measurement = sample("ggx", &[0.02, 0.5, 0.02]);
    for metric in Metric::ALL {
        let options = FitOptions {
            metric,
            ..FitOptions::default()
        };
        let found = fit(&measurement, &fit_model("plastic").unwrap(), &options).unwrap();
        assert!(found.warns("misfit"), "{metric:?}: {:?}", found.warnings);
        assert!(found.estimates.iter().any(|e| e.u_model > 0.0), "{metric:?}");
    }
}

#[test]
fn two_lobes_of_one_kind_come_narrow_first() {
    for (narrow, broad) in [(0.05, 0.2), (0.08, 0.4)] {
        let measurement = sample("lambert+ward-gmd+ward-gmd", &[0.2, 0.1, broad, 0.05, narrow]);
        let found = run(&measurement, "lambert+ward-gmd+ward-gmd");
        for (name, truth) in [
            ("alpha_1", narrow),
            ("alpha_2", broad),
            ("ks_1", 0.05),
            ("ks_2", 0.1),
        ] {
            let e = found.estimate(name, P).unwrap();
            assert!((e.value / truth - 1.0).abs() < 0.05, "{e:?}");
        }
    }
}
