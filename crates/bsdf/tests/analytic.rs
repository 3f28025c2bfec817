//! Physics of the analytic models: reciprocity, energy, sums, bad input.

#![allow(clippy::unwrap_used)] // helpers outside #[test] fail a test by panicking, as the tests themselves do

use std::f64::consts::PI;

use gonio_bsdf::analytic::{
    Analytic, BoundedTransmissionLobe, Lambert, Spectrum, Sum, TransmissionLobe, WardGmd, WardGmdIsotropic,
};
use gonio_bsdf::{Bsdf, Channel, directional_albedo};
use gonio_geom::{Component, Direction};
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64Mcg;

fn photopic(value: f64) -> Spectrum {
    Spectrum::photopic("albedo", value).unwrap()
}

fn gmd(alpha: f64) -> Analytic<WardGmdIsotropic> {
    WardGmd::isotropic(&photopic(1.0), alpha).unwrap()
}

fn brushed() -> Analytic<WardGmd> {
    WardGmd::anisotropic(&photopic(0.8), 0.08, 0.3, 0.4).unwrap()
}

fn lobe(alpha: f64) -> Analytic<TransmissionLobe> {
    Analytic::of(&photopic(1.0), &[alpha]).unwrap()
}

fn bounded(alpha: f64) -> Analytic<BoundedTransmissionLobe> {
    Analytic::of(&photopic(1.0), &[alpha]).unwrap()
}

fn trans() -> Sum {
    Sum::new(vec![
        Box::new(Lambert::reflection(&photopic(0.2)).unwrap()),
        Box::new(WardGmd::isotropic(&photopic(0.05), 0.2).unwrap()),
        Box::new(Lambert::transmission(&photopic(0.1)).unwrap()),
        Box::new(Analytic::<BoundedTransmissionLobe>::of(&photopic(0.5), &[0.15]).unwrap()),
    ])
    .unwrap()
}

fn models() -> Vec<(&'static str, Box<dyn Bsdf>)> {
    vec![
        (
            "lambert reflection",
            Box::new(Lambert::reflection(&photopic(0.7)).unwrap()),
        ),
        (
            "lambert transmission",
            Box::new(Lambert::transmission(&photopic(0.6)).unwrap()),
        ),
        ("ward-gmd .1", Box::new(gmd(0.1))),
        ("ward-gmd .3", Box::new(gmd(0.3))),
        ("brushed", Box::new(brushed())),
        ("bounded lobe", Box::new(bounded(0.2))),
        ("square-root lobe", Box::new(lobe(0.3))),
        ("trans", Box::new(trans())),
    ]
}

fn random_direction(rng: &mut Pcg64Mcg) -> Direction {
    let z: f64 = rng.random_range(-0.99..0.99);
    Direction::from_spherical(z.acos(), rng.random_range(0.0..2.0 * PI))
}

#[test]
fn every_model_is_reciprocal() {
    let mut rng = Pcg64Mcg::seed_from_u64(11);
    for (name, model) in models() {
        assert!(model.properties().reciprocal);
        for _ in 0..2000 {
            let (a, b) = (random_direction(&mut rng), random_direction(&mut rng));
            let (f, g) = (model.eval_first(a, b), model.eval_first(b, a));
            assert!((f - g).abs() <= 1e-12 * f.max(g), "{name}: {f} and {g}");
        }
    }
}

#[test]
fn the_bounded_transmission_lobe_keeps_energy_and_the_published_one_does_not() {
    for alpha in [0.05, 0.2, 0.5, 1.0] {
        for deg in [0.0, 45.0, 80.0, 88.0, 89.9] {
            let wi = Direction::from_degrees(deg, 0.0);
            let tau = directional_albedo(&bounded(alpha), wi, Component::Transmission, 0);
            assert!(tau < 1.0, "alpha {alpha}, {deg} deg: {tau}");
        }
    }
    // Values of the published lobe at 88 degrees, rounded to two decimals.
    for (alpha, expected) in [(0.2, 1.05), (0.3, 1.18), (0.5, 1.41)] {
        let wi = Direction::from_degrees(88.0, 0.0);
        let model = lobe(alpha);
        let tau = directional_albedo(&model, wi, Component::Transmission, 0);
        assert!((tau - expected).abs() < 0.006, "alpha {alpha}: {tau}");
        assert!(!model.properties().energy_conserving);
    }
}

#[test]
fn the_transmission_lobe_falls_to_one_over_e_at_alpha() {
    let alpha = 0.05;
    let model = bounded(alpha);
    // The chord of alpha, not the arc: |t - s| = alpha.
    let off = 2.0 * (alpha / 2.0f64).asin();
    let peak = model.eval_first(Direction::NORMAL, Direction::NORMAL.through());
    let side = model.eval_first(Direction::NORMAL, Direction::from_spherical(PI - off, 0.0));
    let cosines = 0.5 * (1.0 + off.cos());
    assert!((side * cosines / peak - (-1.0f64).exp()).abs() < 1e-12);
}

#[test]
fn a_sum_answers_with_the_sum_and_knows_whether_it_keeps_energy() {
    let wi = Direction::from_degrees(35.0, 10.0);
    let ws = Direction::from_degrees(50.0, 170.0);
    let parts: [Box<dyn Bsdf>; 2] = [
        Box::new(Lambert::reflection(&photopic(0.4)).unwrap()),
        Box::new(WardGmd::isotropic(&photopic(0.1), 0.15).unwrap()),
    ];
    let expected: f64 = parts.iter().map(|p| p.eval_first(wi, ws)).sum();
    let plastic = Sum::new(parts.into()).unwrap();
    assert!((plastic.eval_first(wi, ws) - expected).abs() < 1e-15);
    assert!(plastic.properties().energy_conserving && trans().properties().energy_conserving);
    let too_much = Sum::new(vec![
        Box::new(Lambert::reflection(&photopic(0.9)).unwrap()),
        Box::new(WardGmd::isotropic(&photopic(0.3), 0.15).unwrap()),
    ])
    .unwrap();
    assert!(!too_much.properties().energy_conserving);
}

#[test]
fn parameters_out_of_range_are_refused_by_name() {
    assert!(
        WardGmd::isotropic(&photopic(0.5), 0.0)
            .unwrap_err()
            .to_string()
            .starts_with("alpha: found 0")
    );
    assert!(WardGmd::isotropic(&photopic(0.5), f64::NAN).is_err());
    assert!(
        Spectrum::photopic("rho_d", 1.2)
            .unwrap_err()
            .to_string()
            .starts_with("rho_d: found 1.2")
    );
    assert!(Spectrum::new("rho_d", &[]).is_err());
    let red: Box<dyn Bsdf> =
        Box::new(Lambert::reflection(&Spectrum::new("rho_d", &[(Channel::Red, 0.1)]).unwrap()).unwrap());
    assert!(Sum::new(vec![red, Box::new(gmd(0.1))]).is_err());
    assert!(Sum::new(Vec::new()).is_err());
}

#[test]
fn light_along_the_sample_plane_is_not_scattered() {
    let wi = Direction::from_unit(gonio_geom::DVec3::X);
    for (name, model) in models() {
        assert_eq!(model.eval_first(wi, Direction::NORMAL), 0.0, "{name}");
        assert_eq!(model.eval_first(Direction::NORMAL, wi), 0.0, "{name}");
        assert!(model.sample(wi, [0.3, 0.4, 0.5]).is_none(), "{name}");
    }
}
