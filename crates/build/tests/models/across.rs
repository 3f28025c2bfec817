//! Every way of interpolating across incidences on a material it is made for, and the choice between them.

#![allow(
    clippy::unwrap_used,
    reason = "a test that cannot set up its material has failed"
)]

use crate::common::{Aside, Noise, error, measure, thinned};
use gonio_bsdf::analytic::microfacet::catalogue::GgxSchlick;
use gonio_bsdf::analytic::{
    Analytic, BoundedTransmissionLobe, HarveyShack, HarveyShackTransmission, Lambert, Spectrum, Sum, WardGmd,
};
use gonio_bsdf::{Bsdf, Channel, Properties};
use gonio_build::{BuildOptions, Candidate, DataDriven, Frame, Method};
use gonio_geom::Component::{self, Reflection, Transmission};
use gonio_geom::Direction;
use gonio_scan::Measurement;

const SIX: [(f64, f64); 6] = [
    (10.0, 180.0),
    (22.0, 180.0),
    (34.0, 180.0),
    (46.0, 180.0),
    (58.0, 180.0),
    (70.0, 180.0),
];
const BETWEEN: [f64; 5] = [16.0, 28.0, 40.0, 52.0, 64.0];
const NONE: Noise = Noise(0.0, 0.0);

fn grey(value: f64) -> Spectrum {
    Spectrum::photopic("rho", value).unwrap()
}

fn lambert(rho: f64) -> Box<dyn Bsdf> {
    Box::new(Lambert::reflection(&grey(rho)).unwrap())
}

fn sum(parts: Vec<Box<dyn Bsdf>>) -> Sum {
    Sum::new(parts).unwrap()
}

/// Every second reading of `truth` at [`SIX`].
fn read(truth: &dyn Bsdf, component: Component, noise: Noise) -> Measurement {
    let mut measurement = measure(truth, &SIX, &[component], 87.0, noise);
    thinned(&mut measurement, 2);
    measurement
}

fn by(measurement: &Measurement, method: Method, without: &[&str]) -> DataDriven {
    let options = BuildOptions {
        candidate: Some(Candidate::linear(method)),
        without: without.iter().map(|w| (*w).to_owned()).collect(),
        ..BuildOptions::default()
    };
    DataDriven::build(measurement, &options).unwrap()
}

/// Mean relative L1 error between the incidences.
fn between(truth: &dyn Bsdf, model: &DataDriven, component: Component) -> f64 {
    let each = BETWEEN.map(|t| error(truth, model, Direction::from_degrees(t, 50.0), component).0);
    each.iter().sum::<f64>() / each.len() as f64
}

/// A lobe about the direction of incidence, a Gaussian of the chord, over a diffuse floor and a mirror lobe.
struct Beads(Sum);

impl Bsdf for Beads {
    fn channels(&self) -> &[Channel] {
        self.0.channels()
    }

    fn properties(&self) -> Properties {
        self.0.properties()
    }

    fn eval(&self, wi: Direction, ws: Direction, f: &mut [f64]) {
        self.0.eval(wi, ws, f);
        if wi.side() == ws.side() {
            let chord2 = (wi.vec() - ws.vec()).length_squared();
            f[0] += 2.0 * (-chord2 / 0.15f64.powi(2)).exp() / (wi.cos_theta().abs() + ws.cos_theta().abs());
        }
    }
}

#[test]
fn what_does_not_move_is_interpolated_where_it_is() {
    let truth = Lambert::reflection(&grey(0.6)).unwrap();
    let data = read(&truth, Reflection, NONE);
    for method in [
        Method::Plain(Frame::Still),
        Method::Ratio(Frame::Still),
        Method::Components,
    ] {
        assert!(
            between(&truth, &by(&data, method, &[]), Reflection) < 5e-4,
            "{method:?}"
        );
    }
}

#[test]
fn a_lobe_of_facets_is_followed_at_the_same_half_vector() {
    let truth = sum(vec![
        lambert(0.3),
        Box::new(WardGmd::isotropic(&grey(0.4), 0.15).unwrap()),
    ]);
    let data = read(&truth, Reflection, NONE);
    let split = between(
        &truth,
        &by(&data, Method::Split(Frame::HalfVector), &["ward-gmd"]),
        Reflection,
    );
    assert!(split < 0.004, "{split}");
    // With a base that has the wrong slopes, the ratio makes up for them.
    let ratio = between(
        &truth,
        &by(&data, Method::Ratio(Frame::HalfVector), &["ward-gmd"]),
        Reflection,
    );
    assert!(ratio < 0.012, "{ratio}");
    let naive = between(&truth, &by(&data, Method::Plain(Frame::Still), &[]), Reflection);
    assert!(naive > 0.05, "the material tells the ways apart: {naive}");
}

#[test]
fn a_lobe_of_a_diffracting_layer_is_followed_in_direction_cosines() {
    let lobe = Analytic::<HarveyShack>::of(&grey(0.3), &[0.06, 2.4]).unwrap();
    let truth = sum(vec![lambert(0.2), Box::new(lobe)]);
    let data = read(&truth, Reflection, NONE);
    for method in [
        Method::Split(Frame::CosineShift),
        Method::Ratio(Frame::CosineShift),
    ] {
        let without: &[&str] = if method.needs_base() {
            &[]
        } else {
            &["harvey-shack"]
        };
        let found = between(&truth, &by(&data, method, without), Reflection);
        assert!(found < 0.005, "{method:?}: {found}");
    }
}

#[test]
fn a_lobe_that_turns_rigidly_is_followed_in_the_mirror_frame() {
    let lobe = Analytic::<BoundedTransmissionLobe>::of(&grey(0.5), &[0.15]).unwrap();
    let data = read(&lobe, Transmission, NONE);
    for method in [
        Method::Plain(Frame::Mirror),
        Method::Split(Frame::Mirror),
        Method::Ratio(Frame::Mirror),
    ] {
        let found = between(&lobe, &by(&data, method, &[]), Transmission);
        assert!(found < 0.01, "{method:?}: {found}");
    }
    let without = ["bounded-transmission-lobe", "transmission-lobe-anisotropic"];
    let ratio = between(
        &lobe,
        &by(&data, Method::Ratio(Frame::Mirror), &without),
        Transmission,
    );
    let naive = between(
        &lobe,
        &by(&data, Method::Plain(Frame::Still), &without),
        Transmission,
    );
    assert!(ratio < 0.2 * naive, "another base: {ratio}, naive {naive}");
}

#[test]
fn a_lobe_back_to_the_source_beside_one_to_the_mirror_direction_is_followed_part_by_part() {
    let truth = Beads(sum(vec![
        lambert(0.2),
        Box::new(WardGmd::isotropic(&grey(0.3), 0.15).unwrap()),
    ]));
    let data = read(&truth, Reflection, NONE);
    let parts = by(&data, Method::Components, &[]);
    assert!(
        parts.summary()[0]
            .base
            .as_ref()
            .is_some_and(|b| b.contains("retro-lobe")),
        "{:?}",
        parts.summary()
    );
    let parts = between(&truth, &parts, Reflection);
    assert!(parts < 0.015, "{parts}");
    let split = between(
        &truth,
        &by(&data, Method::Split(Frame::HalfVector), &[]),
        Reflection,
    );
    assert!(parts < 0.2 * split, "one frame cannot follow both lobes: {split}");
}

#[test]
fn the_choice_refits_its_base_and_is_close_to_the_best_that_could_be_made() {
    let truth = sum(vec![
        lambert(0.2),
        Box::new(Analytic::<GgxSchlick>::new(&[(Channel::Photopic, vec![0.1, 0.12])]).unwrap()),
    ]);
    let data = read(&truth, Reflection, Noise(0.01, 2e-4));
    let options = BuildOptions {
        without: vec!["ggx".into()],
        ..BuildOptions::default()
    };
    let chosen = DataDriven::build(&data, &options).unwrap();
    let found = between(&truth, &chosen, Reflection);
    let best = [
        Method::Ratio(Frame::HalfVector),
        Method::Components,
        Method::Split(Frame::HalfVector),
        Method::Plain(Frame::Still),
    ]
    .map(|m| between(&truth, &by(&data, m, &["ggx"]), Reflection))
    .into_iter()
    .fold(f64::INFINITY, f64::min);
    assert!(found < 1.2 * best, "{found} {best}: {:?}", chosen.summary());
    assert_eq!(chosen.loo().len(), 4);
    // Grazing incidence, 10 degrees past the data, where the last slice as it is would be off by half.
    let (l1, _) = error(&truth, &chosen, Direction::from_degrees(80.0, 0.0), Reflection);
    assert!(l1 < 0.08, "{l1}: {:?}", chosen.summary());
}

#[test]
fn exchange_of_source_and_receiver_is_used_only_where_the_readings_agree_under_it() {
    let parts = || {
        sum(vec![
            lambert(0.3),
            Box::new(WardGmd::isotropic(&grey(0.2), 0.2).unwrap()),
        ])
    };
    let data = read(&parts(), Reflection, NONE);
    let reciprocal = DataDriven::build(&data, &BuildOptions::default()).unwrap();
    assert!(
        reciprocal.summary()[0].reciprocity.unwrap() < 0.01,
        "{:?}",
        reciprocal.summary()
    );
    let one_way = Aside {
        material: parts(),
        sine: |sine| 0.7 * sine + 0.2,
        width: 0.2,
        peak: 3.0,
    };
    let data = read(&one_way, Reflection, NONE);
    let model = DataDriven::build(&data, &BuildOptions::default()).unwrap();
    let summary = &model.summary()[0];
    assert!(
        summary.reciprocity.unwrap() > 0.1 && !summary.exchange,
        "{summary:?}"
    );
}

#[test]
fn a_lobe_in_transmission_that_shifts_is_chosen_as_such() {
    let lobe = Analytic::<HarveyShackTransmission>::of(&grey(0.4), &[0.08, 2.6]).unwrap();
    let data = read(&lobe, Transmission, Noise(0.01, 2e-4));
    let model = DataDriven::build(&data, &BuildOptions::default()).unwrap();
    let found = between(&lobe, &model, Transmission);
    assert!(found < 0.006, "{found}: {:?}", model.summary());
}
