//! A law is broken only where a model says so, and as far as it says.

use std::path::Path;

use gonio_bsdf::Channel;
use gonio_bsdf::analytic::Law;
use gonio_geom::Direction;

use crate::common::chosen;
use crate::energy::total;

#[test]
fn every_exemption_is_real_and_as_large_as_stated() {
    for f in chosen() {
        let info = f.info();
        for exemption in info.breaks {
            let witness = exemption.witness;
            let model = f
                .model(&[(Channel::Photopic, witness.parameters.to_vec())])
                .unwrap();
            let wi = Direction::from_degrees(witness.theta_i, 0.0);
            let got = match exemption.law {
                Law::Energy => {
                    let (total, error) = total(model.as_ref(), wi, 0);
                    assert!(error < 1e-3 * total, "{}: {total} +- {error}", info.name);
                    assert!(total > 1.0 + 1e-4, "{}: total {total} breaks no law", info.name);
                    total
                }
                Law::Reciprocity => {
                    let ws = Direction::from_degrees(witness.theta_s, 180.0);
                    let (f, g) = (model.eval_first(wi, ws), model.eval_first(ws, wi));
                    let difference = (f - g).abs() / f.max(g);
                    assert!(difference > 1e-3, "{}: {f} and {g} break no law", info.name);
                    difference
                }
            };
            let rounding = last_digit(witness.measured);
            assert!(
                (got - witness.measured).abs() <= rounding,
                "{}: {got}, stated {}",
                info.name,
                witness.measured
            );
            let stated = witness.measured.to_string();
            assert!(
                exemption.law != Law::Energy || exemption.amount.contains(&stated),
                "{}: {:?} does not name {stated}",
                info.name,
                exemption.amount
            );
        }
    }
}

/// One unit of the last decimal of `value` as written.
fn last_digit(value: f64) -> f64 {
    let text = value.to_string();
    let decimals = text.split_once('.').map_or(0, |(_, fraction)| fraction.len());
    10f64.powi(-(decimals as i32))
}

#[test]
fn no_model_is_exempt_from_a_law_twice() {
    for f in chosen() {
        for law in [Law::Energy, Law::Reciprocity] {
            let times = f.info().breaks.iter().filter(|b| b.law == law).count();
            assert!(times <= 1, "{} breaks {law:?} {times} times", f.info().name);
        }
    }
}

/// The pages of docs/models, one text.
fn pages() -> String {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../docs/models");
    std::fs::read_dir(folder)
        .unwrap()
        .map(|entry| std::fs::read_to_string(entry.unwrap().path()).unwrap())
        .collect()
}

#[test]
fn every_model_has_its_page_and_the_page_says_how_far_a_law_is_broken() {
    let text = pages();
    for f in chosen() {
        let info = f.info();
        assert!(
            text.contains(&format!("`{}`", info.name)),
            "no page in docs/models names {}",
            info.name
        );
        for exemption in info.breaks {
            let stated = exemption.witness.measured.to_string();
            assert!(text.contains(&stated), "no page names {stated} of {}", info.name);
        }
    }
}
