//! What a model says about its own error, and about data that cannot tell it.

#![allow(
    clippy::unwrap_used,
    reason = "a test that cannot set up its material has failed"
)]

use std::f64::consts::PI;

use crate::common::{Aside, EIGHT, Noise, error, measure, thinned};
use gonio_bsdf::analytic::microfacet::catalogue::{BeckmannDielectric, GgxSchlick};
use gonio_bsdf::analytic::{Analytic, HarveyShack, Lambert, Spectrum, Sum, WardGmd};
use gonio_bsdf::{Bsdf, Channel};
use gonio_build::{BuildOptions, DataDriven};
use gonio_geom::{Component::Reflection, Direction};

const NOISE: Noise = Noise(0.01, 2e-4);

fn grey(value: f64) -> Spectrum {
    Spectrum::photopic("rho", value).unwrap()
}

fn over_lambert(rho: f64, lobe: Box<dyn Bsdf>) -> Sum {
    Sum::new(vec![Box::new(Lambert::reflection(&grey(rho)).unwrap()), lobe]).unwrap()
}

fn facets<F: gonio_bsdf::analytic::Formula>(p: &[f64]) -> Box<dyn Bsdf> {
    Box::new(Analytic::<F>::new(&[(Channel::Photopic, p.to_vec())]).unwrap())
}

fn gloss(alpha: f64) -> Sum {
    over_lambert(0.3, Box::new(WardGmd::isotropic(&grey(0.4), alpha).unwrap()))
}

#[test]
fn the_stated_error_is_within_a_factor_of_two_at_four_incidences_in_five() {
    let materials: Vec<(Sum, &[&str])> = vec![
        (gloss(0.15), &[]),
        (gloss(0.15), &["ward-gmd"]),
        (over_lambert(0.2, facets::<GgxSchlick>(&[0.1, 0.12])), &["ggx"]),
        (
            over_lambert(0.1, facets::<BeckmannDielectric>(&[1.5, 0.35])),
            &["beckmann-dielectric", "ggx-dielectric"],
        ),
        (
            over_lambert(0.2, facets::<HarveyShack>(&[0.3, 0.06, 2.4])),
            &["harvey-shack"],
        ),
    ];
    let (mut close, mut all, mut report) = (0, 0, String::new());
    for (k, (truth, without)) in materials.iter().enumerate() {
        let mut data = measure(truth, &EIGHT, &[Reflection], 88.0, NOISE);
        // A twelfth of the readings: some 3,500 an incidence.
        thinned(&mut data, 12);
        let options = BuildOptions {
            without: without.iter().map(|w| (*w).to_owned()).collect(),
            ..BuildOptions::default()
        };
        let model = DataDriven::build(&data, &options).unwrap();
        for theta in [15.0, 25.0, 35.0, 45.0, 55.0, 65.0, 75.0] {
            let wi = Direction::from_degrees(theta, 77.0);
            let stated = model.stated_error(wi, Reflection).unwrap().total();
            let (found, _) = error(truth, &model, wi, Reflection);
            all += 1;
            close += usize::from((0.5..2.0).contains(&(stated / found)));
            assert!(
                stated > found / 3.0,
                "{k} at {theta}: stated {stated}, found {found}"
            );
            report += &format!(
                "{k} {theta}: {:.3} % stated, {:.3} % found\n",
                100.0 * stated,
                100.0 * found
            );
        }
    }
    assert!(close * 5 >= all * 4, "{close} of {all}\n{report}");
}

#[test]
fn more_noise_means_a_larger_slice_error_and_as_large_a_step_of_incidence() {
    let stated = |noise| {
        let mut data = measure(&gloss(0.2), &EIGHT, &[Reflection], 88.0, noise);
        thinned(&mut data, 12);
        let model = DataDriven::build(&data, &BuildOptions::default()).unwrap();
        model
            .stated_error(Direction::from_degrees(40.0, 0.0), Reflection)
            .unwrap()
    };
    let (little, much) = (stated(Noise(0.005, 1e-4)), stated(Noise(0.03, 6e-4)));
    assert!(
        (3.0..9.0).contains(&(much.slice / little.slice)),
        "{little:?} {much:?}"
    );
    assert!(
        little.incidence.unwrap() < 1e-9,
        "nothing is interpolated at a measured incidence"
    );
}

#[test]
fn a_peak_between_the_lines_of_readings_is_called_undersampled() {
    // Rings of readings are 3 degrees apart there, the peak is 3.4 degrees wide.
    // A fifth of the light.
    let aside = Aside {
        material: gloss(0.2),
        sine: |sine| 0.7 * sine - 0.3,
        width: 0.03,
        peak: 0.2 / (PI * 0.03 * 0.03),
    };
    let data = measure(&aside, &EIGHT[..6], &[Reflection], 88.0, NOISE);
    let model = DataDriven::build(&data, &BuildOptions::default()).unwrap();
    assert!(
        model.warnings().iter().any(|w| w.contains("undersampled")),
        "{:?} {:?}",
        model.warnings(),
        model.summary()
    );
    let mut data = measure(&gloss(0.2), &EIGHT[..6], &[Reflection], 88.0, NOISE);
    thinned(&mut data, 4);
    let model = DataDriven::build(&data, &BuildOptions::default()).unwrap();
    assert!(
        !model.warnings().iter().any(|w| w.contains("undersampled")),
        "{:?}",
        model.warnings()
    );
}

#[test]
fn a_lobe_that_is_there_at_one_incidence_only_is_told() {
    let mut data = measure(&gloss(0.15), &EIGHT[..4], &[Reflection], 88.0, NOISE);
    let more = measure(
        &Lambert::reflection(&grey(0.3)).unwrap(),
        &EIGHT[4..],
        &[Reflection],
        88.0,
        NOISE,
    );
    data.slices.extend(more.slices);
    thinned(&mut data, 8);
    let model = DataDriven::build(&data, &BuildOptions::default()).unwrap();
    let said = |w: &&String| w.contains("between theta_i 40.0 and 50.0") && w.contains("not known");
    assert!(
        model.warnings().iter().any(|w| said(&w)),
        "{:?}",
        model.warnings()
    );
}

#[test]
fn a_file_given_twice_counts_once_and_copies_elsewhere_are_left_out_together() {
    let mut data = measure(&gloss(0.2), &EIGHT[..5], &[Reflection], 88.0, NOISE);
    thinned(&mut data, 10);
    let once = DataDriven::build(&data, &BuildOptions::default()).unwrap();
    data.slices.push(data.slices[2].clone());
    let twice = DataDriven::build(&data, &BuildOptions::default()).unwrap();
    assert!(
        twice.warnings().iter().any(|w| w.contains("twice")),
        "{:?}",
        twice.warnings()
    );
    let wi = Direction::from_degrees(33.0, 0.0);
    for theta in [0.0, 20.0, 33.0, 60.0] {
        let ws = Direction::from_degrees(theta, 180.0);
        assert_eq!(once.eval_first(wi, ws), twice.eval_first(wi, ws));
    }
    // The readings at 40 degrees put in at 30 degrees: nothing predicts them any more.
    data.slices.pop();
    data.slices[2] = gonio_scan::Slice {
        incidence: data.slices[2].incidence,
        ..data.slices[3].clone()
    };
    let copied = DataDriven::build(&data, &BuildOptions::default()).unwrap();
    assert!(
        copied
            .warnings()
            .iter()
            .any(|w| w.contains("holds the readings of")),
        "{:?}",
        copied.warnings()
    );
    assert!(
        copied.loo()[1].rel_l1 > 10.0 * once.loo()[1].rel_l1,
        "{:?}",
        copied.loo()
    );
}
