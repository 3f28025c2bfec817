//! Readings of an integrating sphere beside those of a goniometer, and alone.

use gonio_bsdf::cone::cone_integral;
use gonio_bsdf::{Channel, directional_albedo};
use gonio_fit::{
    Fit, FitError, FitModel, FitOptions, Kind, SphereData, SpherePart, SphereReading, fit, fit_model,
    fit_sphere,
};
use gonio_geom::{Angles, Component, Direction};

use crate::common::{Campaign, measure, normal, rng};

const HALF: f64 = 0.087;

fn eight() -> Angles {
    Direction::from_degrees(8.0, 0.0).angles()
}

/// Total and light beyond the trap, with independent uncertainties.
fn readings(model: &FitModel, truth: &[f64], u: f64) -> SphereData {
    let q = [(Channel::Photopic, truth.to_vec())];
    let bsdf = model.bsdf(&q).unwrap();
    let wi = eight().direction();
    let total = directional_albedo(bsdf.as_ref(), wi, Component::Reflection, 0);
    let port = cone_integral(bsdf.as_ref(), wi, Component::Reflection, 0, HALF);
    let reading = |part, value| SphereReading {
        channel: Channel::Photopic,
        incidence: eight(),
        component: Component::Reflection,
        part,
        value,
    };
    SphereData {
        readings: vec![
            reading(SpherePart::Total, total),
            reading(SpherePart::Rest(HALF), total - port),
        ],
        covariance: vec![u * u, 0.0, 0.0, u * u],
    }
}

fn value(fit: &Fit, name: &str) -> (f64, f64) {
    let e = fit.estimate(name, Channel::Photopic).unwrap();
    (e.value, e.u)
}

#[test]
fn a_sphere_alone_gives_colour_and_specularity_of_a_plastic_of_known_roughness() {
    let model = fit_model("plastic").unwrap();
    for (colour, specularity, alpha) in [(0.4, 0.05, 0.02), (0.1, 0.1, 0.08), (0.8, 0.03, 0.12)] {
        let options = FitOptions {
            fixed: vec![("alpha".into(), alpha)],
            sphere: readings(&model, &[colour, specularity, alpha], 1e-3),
            ..FitOptions::default()
        };
        let found = fit_sphere(&model, &options).unwrap();
        let (c, u_c) = value(&found, "color");
        let (s, u_s) = value(&found, "specularity");
        assert!(
            (c - colour).abs() < 1e-5 && (s - specularity).abs() < 1e-5,
            "{c} {s}"
        );
        assert!(u_c > 1e-4 && u_s > 1e-4, "{u_c} {u_s}");
        assert_eq!(found.sphere.len(), 2);
        assert!((found.sphere[0].predicted - found.sphere[0].reading.value).abs() < 1e-6);
    }
}

#[test]
fn the_uncertainties_of_a_sphere_alone_are_those_of_its_scatter() {
    let model = fit_model("plastic").unwrap();
    let exact = readings(&model, &[0.4, 0.08, 0.05], 1e-3);
    let mut rng = rng(5);
    let mut squares = [0.0; 2];
    let mut stated = [0.0; 2];
    let n = 60;
    for _ in 0..n {
        let mut sphere = exact.clone();
        for r in &mut sphere.readings {
            r.value += 1e-3 * normal(&mut rng);
        }
        let options = FitOptions {
            fixed: vec![("alpha".into(), 0.05)],
            sphere,
            ..FitOptions::default()
        };
        let found = fit_sphere(&model, &options).unwrap();
        for (k, (name, truth)) in [("color", 0.4), ("specularity", 0.08)].into_iter().enumerate() {
            let (v, u) = value(&found, name);
            squares[k] += (v - truth).powi(2) / f64::from(n);
            stated[k] += u / f64::from(n);
        }
    }
    // The scatter of 60 is known to 9 %; three times that.
    for k in 0..2 {
        assert!(
            (squares[k].sqrt() / stated[k] - 1.0).abs() < 0.28,
            "{squares:?} {stated:?}"
        );
    }
}

#[test]
fn a_sphere_sets_the_level_where_the_beam_power_is_not_well_known() {
    let model = fit_model("plastic").unwrap();
    let truth = [0.4, 0.08, 0.1];
    let mut rng = rng(2);
    let campaign = Campaign {
        u_common: 0.03,
        noise: (0.01, 2e-4),
        ..Campaign::default()
    };
    let mut measurement = measure(
        &model,
        &[(Channel::Photopic, truth.to_vec())],
        &campaign,
        &mut rng,
    );
    // The beam power was 3 % off.
    for slice in &mut measurement.slices {
        for (d, u) in slice.dsf.iter_mut().zip(&mut slice.u_dsf) {
            *d *= 1.03;
            *u *= 1.03;
        }
    }
    let alone = fit(&measurement, &model, &FitOptions::default()).unwrap();
    let options = FitOptions {
        sphere: readings(&model, &truth, 1e-3),
        ..FitOptions::default()
    };
    let both = fit(&measurement, &model, &options).unwrap();
    let (before, after) = (value(&alone, "color"), value(&both, "color"));
    assert!(before.0 - 0.4 > 0.01, "{before:?}");
    assert!(
        (after.0 - 0.4).abs() < 3.0 * after.1 && after.1 < 0.3 * before.1,
        "{before:?} {after:?}"
    );
    let (alpha, u) = value(&both, "alpha");
    assert!((alpha - 0.1).abs() < 4.0 * u, "{alpha} {u}");
    let total = &both.sphere[0];
    let (without, u) = total.before.unwrap();
    assert!(without - total.reading.value > 0.005 && u > 0.005, "{total:?}");
    assert!(
        (total.predicted - total.reading.value).abs() < 2.0 * total.u,
        "{total:?}"
    );
    assert!(!both.warns("sphere_disagrees"));
    // The predictions are those of the new parameters.
    let ratio = both.predicted[0][100] / alone.predicted[0][100];
    assert!(
        (ratio - after.0 / before.0).abs() < 0.01,
        "{ratio} {before:?} {after:?}"
    );
}

#[test]
fn a_sphere_that_reads_another_sample_is_told() {
    let model = fit_model("plastic").unwrap();
    let mut rng = rng(4);
    let truth = [(Channel::Photopic, vec![0.4, 0.08, 0.1])];
    let measurement = measure(&model, &truth, &Campaign::default(), &mut rng);
    let options = FitOptions {
        sphere: readings(&model, &[0.6, 0.08, 0.1], 1e-3),
        ..FitOptions::default()
    };
    let found = fit(&measurement, &model, &options).unwrap();
    assert!(found.warns("sphere_disagrees"), "{:?}", found.warnings);
}

#[test]
fn readings_that_cannot_be_used_are_refused() {
    let model = fit_model("plastic").unwrap();
    let good = readings(&model, &[0.4, 0.08, 0.1], 1e-3);
    let with = |change: fn(&mut SphereData)| {
        let mut sphere = good.clone();
        change(&mut sphere);
        let options = FitOptions {
            fixed: vec![("alpha".into(), 0.1)],
            sphere,
            ..FitOptions::default()
        };
        fit_sphere(&model, &options)
    };
    assert!(with(|_| ()).is_ok());
    assert!(matches!(
        with(|s| s.covariance[0] = 0.0),
        Err(FitError::Domain { field: "sphere", .. })
    ));
    assert!(matches!(
        with(|s| s.covariance = vec![1e-6; 4]),
        Err(FitError::Domain { field: "sphere", .. })
    ));
    assert!(matches!(
        with(|s| s.readings[1].part = SpherePart::Port(2.0)),
        Err(FitError::Domain {
            field: "sphere.half_angle",
            ..
        })
    ));
    assert!(matches!(
        with(|s| s.readings[1].component = Component::Transmission),
        Err(FitError::Model { .. })
    ));
    let free = FitOptions {
        sphere: good.clone(),
        ..FitOptions::default()
    };
    assert!(matches!(
        fit_sphere(&model, &free),
        Err(FitError::TooFewReadings { .. })
    ));
    let kinds = with(|_| ()).unwrap();
    assert_eq!(
        kinds.estimate("alpha", Channel::Photopic).unwrap().kind,
        Kind::Fixed
    );
}
