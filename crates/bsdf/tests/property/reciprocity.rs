//! `f(wi, ws) = f(ws, wi)`.

use gonio_bsdf::analytic::Law;
use gonio_geom::{Component, Direction};

use crate::cases::{everything, materials, narrowest, pairs};
use crate::common::{build, chosen, settings};

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
fn exchanging_source_and_receiver_of_an_interface_leaves_f_over_the_squared_index_unchanged() {
    for f in chosen().into_iter().filter(|f| f.info().keeps(Law::Reciprocity)) {
        for setting in settings(f.info()) {
            let ratio = f.index_ratio(&setting.values);
            if ratio == 1.0 {
                continue;
            }
            let model = build(f, &setting);
            let index2 = |d: Direction| if d.cos_theta() < 0.0 { ratio * ratio } else { 1.0 };
            let (mut reflected, mut transmitted) = (0, 0);
            for (a, b) in refracted_pairs(narrowest(f, &setting.values), ratio) {
                let (there, back) = (
                    model.eval_first(a, b) / index2(b),
                    model.eval_first(b, a) / index2(a),
                );
                // A rounding of 1e-16 in the facet's slope counts 1 / alpha times.
                assert!(
                    (there - back).abs() <= 1e-9 * there.max(back),
                    "{} with {}: {there} and {back} for {a:?} and {b:?}",
                    f.info().name,
                    setting.label
                );
                if there > 0.0 {
                    *(if a.cos_theta() * b.cos_theta() > 0.0 {
                        &mut reflected
                    } else {
                        &mut transmitted
                    }) += 1;
                }
            }
            assert!(
                reflected > 100 && transmitted > 100,
                "{} with {}: {reflected} {transmitted}",
                f.info().name,
                setting.label
            );
        }
    }
}

/// Pairs near the mirror direction, and pairs near the refracted one, from both sides.
fn refracted_pairs(width: f64, ratio: f64) -> Vec<(Direction, Direction)> {
    let mut all = pairs(width, 14, 900);
    for (a, b) in pairs(width, 15, 600) {
        let eta = if a.cos_theta() > 0.0 { ratio } else { 1.0 / ratio };
        let v = -a.vec() / eta;
        let far2 = 1.0 - v.x * v.x - v.y * v.y;
        if far2 > 0.0 {
            let bent = gonio_geom::DVec3::new(v.x, v.y, -a.cos_theta().signum() * far2.sqrt());
            let step = (b.vec() - a.vec()) * 0.5 * width;
            all.extend(Direction::new(bent + step).map(|s| (a, s)));
        }
    }
    all
}

#[test]
fn models_that_are_not_reciprocal_say_so_and_are_not() {
    for f in chosen() {
        let keeps = f.info().keeps(Law::Reciprocity);
        for setting in settings(f.info()) {
            let model = build(f, &setting);
            let same_index = f.index_ratio(&setting.values) == 1.0;
            assert_eq!(
                model.properties().reciprocal,
                keeps && same_index,
                "{}",
                f.info().name
            );
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
