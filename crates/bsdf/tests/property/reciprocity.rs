//! `f(wi, ws) = f(ws, wi)`.

use gonio_bsdf::analytic::Law;

use crate::cases::{chosen, narrowest, pairs, registered, sums};
use crate::common::{build, settings};

/// Relative rounding that two orders of the same arithmetic may differ by.
const ROUNDING: f64 = 1e-10;

#[test]
fn exchanging_source_and_receiver_leaves_every_reciprocal_model_unchanged() {
    let mut tried = 0;
    for case in registered().iter().chain(&sums()) {
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
        assert!(lit > 100, "{}: only {lit} pairs scatter", case.label);
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
