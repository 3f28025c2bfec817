//! Several slices of one incidence, and light that goes where no readings stand.

#![allow(
    clippy::unwrap_used,
    reason = "a test that cannot set up its material has failed"
)]

use crate::common::{Noise, measure, slice, thinned};
use gonio_bsdf::analytic::{Lambert, Spectrum, Sum, WardGmd};
use gonio_build::{BuildOptions, Coverage, DataDriven};
use gonio_geom::{Angles, Component::Reflection, Direction};
use gonio_scan::Measurement;

const THREE: [(f64, f64); 3] = [(20.0, 180.0), (40.0, 180.0), (60.0, 180.0)];
const NOISE: Noise = Noise(0.01, 2e-4);

fn gloss(rho: f64) -> Sum {
    let grey = |v| Spectrum::photopic("rho", v).unwrap();
    Sum::new(vec![
        Box::new(Lambert::reflection(&grey(rho)).unwrap()),
        Box::new(WardGmd::isotropic(&grey(0.2), 0.2).unwrap()),
    ])
    .unwrap()
}

/// [`THREE`] of a sample, and 40 degrees once more of another one, read up to `last` degrees.
fn twice(sample: &Sum, other: &Sum, last: f64) -> Measurement {
    let mut data = measure(sample, &THREE, &[Reflection], last, NOISE);
    let again = slice(
        other,
        Angles::from_degrees(40.0, 180.0),
        &[Reflection],
        last,
        NOISE,
        7,
    );
    data.slices.push(again);
    thinned(&mut data, 4);
    data
}

fn said(model: &DataDriven) -> Option<&String> {
    model.warnings().iter().find(|w| w.contains("averaged"))
}

#[test]
fn repeats_of_one_sample_are_counted_and_agree_within_their_noise() {
    let model = DataDriven::build(&twice(&gloss(0.3), &gloss(0.3), 86.0), &BuildOptions::default()).unwrap();
    let said = said(&model).unwrap();
    assert!(
        said.contains("up to 2 slices") && said.contains("at 1 of 3") && said.contains("within their noise"),
        "{said}"
    );
    let once = DataDriven::build(
        &{
            let mut data = measure(&gloss(0.3), &THREE, &[Reflection], 86.0, NOISE);
            thinned(&mut data, 4);
            data
        },
        &BuildOptions::default(),
    )
    .unwrap();
    assert!(once.warnings().iter().all(|w| !w.contains("averaged")));
}

#[test]
fn repeats_of_other_samples_are_told_and_their_spread_is_stated() {
    // The second sample is brighter by .03 of some .5: the mean lies 3 % from both.
    let model = DataDriven::build(&twice(&gloss(0.3), &gloss(0.33), 86.0), &BuildOptions::default()).unwrap();
    let said = said(&model).unwrap();
    assert!(said.contains("more than their noise"), "{said}");
    let stated = |theta| {
        model
            .stated_error(Direction::from_degrees(theta, 180.0), Reflection)
            .unwrap()
    };
    assert!((0.02..0.05).contains(&stated(40.0).slice), "{:?}", stated(40.0));
    assert!(stated(60.0).slice < 0.01, "{:?}", stated(60.0));
}

#[test]
fn light_past_the_last_reading_is_stated_apart() {
    let share = |last: f64| {
        let mut data = measure(
            &Lambert::reflection(&Spectrum::photopic("rho", 0.5).unwrap()).unwrap(),
            &THREE,
            &[Reflection],
            last,
            NOISE,
        );
        thinned(&mut data, 8);
        let model = DataDriven::build(&data, &BuildOptions::default()).unwrap();
        let stated = |theta| {
            model
                .stated_error(Direction::from_degrees(theta, 10.0), Reflection)
                .unwrap()
        };
        assert_eq!(stated(40.0).coverage, Coverage::Measured);
        assert_eq!(stated(50.0).coverage, Coverage::Interpolated);
        assert_eq!(stated(70.0).coverage, Coverage::Extrapolated);
        stated(50.0).extrapolated
    };
    // The last ring stands at 73.5 or 82.5 degrees; a cosine lobe has the square of its cosine past it.
    for (last, ring) in [(75.0, 73.5f64), (84.0, 82.5)] {
        let wanted = ring.to_radians().cos().powi(2);
        let found = share(last);
        assert!(
            (found - wanted).abs() < 0.15 * wanted + 0.002,
            "{last}: {found} {wanted}"
        );
    }
}
