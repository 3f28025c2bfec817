//! Models built from simulated readings of known materials.

#![allow(
    clippy::unwrap_used,
    reason = "a test that cannot set up its material has failed"
)]

use std::sync::LazyLock;

use crate::common::{EIGHT, Noise, error, measure};
use gonio_bsdf::Bsdf;
use gonio_bsdf::analytic::{Analytic, BoundedTransmissionLobe, Lambert, Spectrum, Sum, WardGmd};
use gonio_build::{BuildOptions, Coverage, DataDriven};
use gonio_geom::{
    Component::{Reflection, Transmission},
    Direction,
};
use proptest::prelude::*;

/// Incidences between those of [`EIGHT`].
const HELD_OUT: [f64; 7] = [15.0, 25.0, 35.0, 45.0, 55.0, 65.0, 75.0];

/// 1 % of the DSF and 2e-4 1/sr.
const NOISE: Noise = Noise(0.01, 2e-4);

fn grey(value: f64) -> Spectrum {
    Spectrum::photopic("rho", value).unwrap()
}

fn gloss(alpha: f64) -> Sum {
    Sum::new(vec![
        Box::new(Lambert::reflection(&grey(0.3)).unwrap()),
        Box::new(WardGmd::isotropic(&grey(0.4), alpha).unwrap()),
    ])
    .unwrap()
}

fn built(measurement: &gonio_scan::Measurement) -> DataDriven {
    DataDriven::build(measurement, &BuildOptions::default()).unwrap()
}

/// Keeps the marked readings of a slice.
fn retain(slice: &mut gonio_scan::Slice, keep: &[bool]) {
    for column in [
        &mut slice.theta_s,
        &mut slice.phi_s,
        &mut slice.dsf,
        &mut slice.u_dsf,
        &mut slice.omega,
    ] {
        let mut k = keep.iter();
        column.retain(|_| k.next().copied().unwrap_or(false));
    }
    slice.flags.truncate(slice.dsf.len());
}

/// A diffuse reflection and a rough transmission, read on both hemispheres.
static TRANSLUCENT: LazyLock<(Sum, DataDriven)> = LazyLock::new(|| {
    let lobe = Analytic::<BoundedTransmissionLobe>::of(&grey(0.5), &[0.15]).unwrap();
    let truth = Sum::new(vec![
        Box::new(Lambert::reflection(&grey(0.2)).unwrap()),
        Box::new(Lambert::transmission(&grey(0.1)).unwrap()),
        Box::new(lobe),
    ])
    .unwrap();
    let incidences = [(0.0, 0.0), (20.0, 0.0), (40.0, 0.0), (60.0, 0.0), (75.0, 0.0)];
    let measurement = measure(&truth, &incidences, &[Reflection, Transmission], 86.0, NOISE);
    let model = built(&measurement);
    (truth, model)
});

#[test]
fn a_lambertian_sample_is_reproduced_to_a_thousandth_everywhere_extrapolated_too() {
    let truth = Lambert::reflection(&grey(0.6)).unwrap();
    let model = built(&measure(
        &truth,
        &EIGHT[1..6],
        &[Reflection],
        82.0,
        Noise(0.0, 0.0),
    ));
    let f = 0.6 / std::f64::consts::PI;
    for theta_i in [0.0, 5.0, 20.0, 33.0, 60.0, 75.0, 89.0] {
        for theta_s in [0.0, 10.0, 50.0, 80.0, 85.0, 89.9] {
            for phi in [0.0, 90.0, 180.0, 271.0] {
                let wi = Direction::from_degrees(theta_i, 40.0);
                let value = model.eval_first(wi, Direction::from_degrees(theta_s, phi));
                assert!(
                    (value / f - 1.0).abs() < 1e-3,
                    "{theta_i} {theta_s} {phi}: {value}"
                );
            }
        }
    }
}

#[test]
fn glossy_incidences_that_were_not_measured_are_predicted_within_two_per_cent() {
    for (alpha, mean_limit) in [(0.2, 0.005), (0.05, 0.01)] {
        let truth = gloss(alpha);
        let model = built(&measure(&truth, &EIGHT, &[Reflection], 88.0, NOISE));
        assert!(
            model.summary()[0].candidate.method.needs_base(),
            "{:?}",
            model.summary()
        );
        let mut mean = 0.0;
        for theta in HELD_OUT {
            let wi = Direction::from_degrees(theta, 77.0);
            let (l1, dhr) = error(&truth, &model, wi, Reflection);
            assert!(l1 < 0.02 && dhr.abs() < 0.005, "{alpha} {theta}: {l1} {dhr}");
            mean += l1 / HELD_OUT.len() as f64;
        }
        assert!(mean < mean_limit, "{alpha}: {mean}");
        // Held-out readings carry 1 % noise, of which an L1 norm sees 0.8 %.
        let loo = model.loo();
        assert_eq!(loo.len(), 6);
        assert!(loo.iter().all(|e| (0.005..0.03).contains(&e.rel_l1)), "{loo:?}");
        // Beyond the last incidence the same facets answer.
        let (l1, _) = error(&truth, &model, Direction::from_degrees(85.0, 0.0), Reflection);
        assert!(l1 < 0.03, "{alpha}: {l1}");
    }
}

#[test]
fn a_measured_incidence_is_reproduced_within_its_noise() {
    let truth = gloss(0.1);
    let model = built(&measure(&truth, &EIGHT[2..5], &[Reflection], 88.0, NOISE));
    let (l1, dhr) = error(&truth, &model, Direction::from_degrees(40.0, 180.0), Reflection);
    assert!(l1 < 0.008 && dhr.abs() < 0.003, "{l1} {dhr}");
}

#[test]
fn a_transmission_lobe_moves_with_the_through_direction() {
    let (truth, model) = &*TRANSLUCENT;
    for theta in [10.0, 30.0, 50.0] {
        let wi = Direction::from_degrees(theta, 120.0);
        let (l1, dht) = error(truth, model, wi, Transmission);
        assert!(l1 < 0.05 && dht.abs() < 0.02, "{theta}: {l1} {dht}");
        let (l1, _) = error(truth, model, wi, Reflection);
        assert!(l1 < 0.01, "{theta}: reflection {l1}");
    }
}

#[test]
fn the_albedo_stays_below_one_and_near_the_truth() {
    let (truth, model) = &*TRANSLUCENT;
    assert!(model.properties().energy_conserving);
    for theta in 0..90 {
        let albedo = model.albedo(Direction::from_degrees(f64::from(theta), 10.0));
        assert!(albedo < 1.001, "{theta}: {albedo}");
    }
    let wi = Direction::from_degrees(30.0, 0.0);
    let exact = gonio_bsdf::directional_albedo(truth, wi, Reflection, 0)
        + gonio_bsdf::directional_albedo(truth, wi, Transmission, 0);
    assert!((model.albedo(wi) / exact - 1.0).abs() < 0.01);
}

#[test]
fn an_anisotropic_lobe_keeps_its_two_widths_between_measured_incidences() {
    let truth = WardGmd::anisotropic(&grey(0.5), 0.1, 0.25, 0.0).unwrap();
    let mut incidences = vec![(0.0, 0.0)];
    for theta in [20.0, 40.0, 60.0] {
        incidences.extend((0..8).map(|k| (theta, 45.0 * f64::from(k))));
    }
    let mut measurement = measure(&truth, &incidences, &[Reflection], 86.0, NOISE);
    for slice in &mut measurement.slices {
        // A third of the readings is enough for these widths.
        let keep: Vec<bool> = (0..slice.len()).map(|k| k % 3 == 0).collect();
        retain(slice, &keep);
    }
    let model = built(&measurement);
    assert!(!model.properties().isotropic);
    for (theta, phi) in [(30.0, 22.5), (30.0, 0.0), (50.0, 110.0), (10.0, 300.0)] {
        let wi = Direction::from_degrees(theta, phi);
        let (l1, dhr) = error(&truth, &model, wi, Reflection);
        assert!(l1 < 0.03 && dhr.abs() < 0.01, "{theta} {phi}: {l1} {dhr}");
    }
}

#[test]
fn the_mask_tells_measured_interpolated_extrapolated_and_missing_apart() {
    let model = built(&measure(&gloss(0.2), &EIGHT[1..4], &[Reflection], 80.0, NOISE));
    let coverage = |theta_i, theta_s| {
        model.coverage(
            Direction::from_degrees(theta_i, 0.0),
            Direction::from_degrees(theta_s, 100.0),
        )
    };
    assert_eq!(coverage(30.0, 40.0), Coverage::Measured);
    assert_eq!(coverage(35.0, 40.0), Coverage::Interpolated);
    assert_eq!(coverage(30.0, 86.0), Coverage::Extrapolated);
    assert_eq!(coverage(60.0, 40.0), Coverage::Extrapolated);
    assert_eq!(coverage(30.0, 140.0), Coverage::Missing);
}

#[test]
fn one_measured_half_is_mirrored_and_said_so() {
    let truth = gloss(0.2);
    let mut measurement = measure(&truth, &EIGHT[1..4], &[Reflection], 86.0, NOISE);
    for slice in &mut measurement.slices {
        let keep: Vec<bool> = slice.phi_s.iter().map(|p| *p <= std::f64::consts::PI).collect();
        retain(slice, &keep);
    }
    let model = built(&measurement);
    assert!(model.warnings().iter().any(|w| w.contains("mirror image")));
    let (l1, _) = error(&truth, &model, Direction::from_degrees(25.0, 180.0), Reflection);
    assert!(l1 < 0.01, "{l1}");
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(5000))]
    #[test]
    fn no_value_is_negative_or_not_finite(
        theta_i in 0.0..180.0f64, phi_i in 0.0..360.0f64, theta_s in 0.0..180.0f64, phi_s in 0.0..360.0f64,
    ) {
        let model = &TRANSLUCENT.1;
        let f = model.eval_first(Direction::from_degrees(theta_i, phi_i), Direction::from_degrees(theta_s, phi_s));
        prop_assert!(f.is_finite() && f >= 0.0);
        if theta_i > 90.0 {
            prop_assert_eq!(f, 0.0, "nothing was measured from the back");
        }
    }
}
