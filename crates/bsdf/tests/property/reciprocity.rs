//! `f(wi, ws) = f(ws, wi)`.

use gonio_bsdf::analytic::Law;
use gonio_geom::{Component, Direction};

use crate::cases::{chosen, everything, materials, narrowest, pairs};
use crate::common::{build, settings};

/// Relative rounding that two orders of the same arithmetic may differ by.
const ROUNDING: f64 = 1e-10;

#[test]
fn exchanging_source_and_receiver_leaves_every_reciprocal_model_unchanged() {
    let mut tried = 0;
    for case in everything() {
        if !case.model.properties().reciprocal {
            continue;
        }
        let mut lit = 0;
        for (a, b) in pairs(case.width, 11, 900) {
            let n = case.model.channels().len();
            let (mut f, mut g) = (vec![0.0; n], vec![0.0; n]);
            case.model.eval(a, b, &mut f);
            case.model.eval(b, a, &mut g);
            for (f, g) in f.into_iter().zip(g) {
                assert!(
                    (f - g).abs() <= ROUNDING * f.max(g),
                    "{}: {f} and {g} for {a:?} and {b:?}",
                    case.label
                );
                lit += usize::from(f > 0.0);
            }
        }
        assert!(
            lit > 100 || case.model.has_delta(),
            "{}: only {lit} pairs scatter",
            case.label
        );
        tried += 1;
    }
    assert!(tried > 0);
}

#[test]
fn models_that_are_not_reciprocal_say_so_and_are_not() {
    for f in chosen() {
        let keeps = f.info().keeps(Law::Reciprocity);
        for setting in settings(f.info()) {
            let model = build(f, &setting);
            assert_eq!(model.properties().reciprocal, keeps, "{}", f.info().name);
        }
        if keeps {
            continue;
        }
        let worst = settings(f.info())
            .iter()
            .flat_map(|s| {
                let (model, width) = (build(f, s), narrowest(f, &s.values));
                pairs(width, 12, 300).into_iter().map(move |(a, b)| {
                    let (f, g) = (model.eval_first(a, b), model.eval_first(b, a));
                    (f - g).abs() / f.max(g).max(f64::MIN_POSITIVE)
                })
            })
            .fold(0.0, f64::max);
        assert!(
            worst > 1e-3,
            "{} is reciprocal within {worst:e}: the exemption is not needed",
            f.info().name
        );
    }
}

#[test]
fn materials_that_are_not_reciprocal_say_so_and_are_not() {
    for case in materials() {
        if case.model.properties().reciprocal {
            continue;
        }
        let worst = pairs(case.width, 13, 900)
            .into_iter()
            .map(|(a, b)| {
                let (f, g) = (case.model.eval_first(a, b), case.model.eval_first(b, a));
                (f - g).abs() / f.max(g).max(f64::MIN_POSITIVE)
            })
            .fold(0.0, f64::max);
        assert!(worst > 1e-3, "{} is reciprocal within {worst:e}", case.label);
    }
}

#[test]
fn light_on_an_ideal_path_goes_back_the_way_it_came() {
    let mut tried = 0;
    for case in everything() {
        let n = case.model.channels().len();
        for theta in [0.0, 20.0, 60.0, 85.0, 95.0, 150.0, 180.0] {
            let w = Direction::from_degrees(theta, 200.0);
            for component in [Component::Reflection, Component::Transmission] {
                let (mut there, mut back) = (vec![f64::NAN; n], vec![f64::NAN; n]);
                let Some(d) = case.model.delta(w, component, &mut there) else {
                    assert!(there.iter().all(|&s| s == 0.0), "{}", case.label);
                    continue;
                };
                let home = case.model.delta(d, component, &mut back);
                assert!(
                    home.is_some_and(|h| h.angle_to(w) < 1e-7)
                        && there.iter().zip(&back).all(|(a, b)| (a - b).abs() < 1e-12),
                    "{} at {theta} degrees, {component}: {there:?} to {d:?}, {back:?} to {home:?}",
                    case.label
                );
                tried += 1;
            }
        }
    }
    assert!(tried > 50, "{tried}");
}
