//! Values are finite and not negative wherever a direction can be.

use gonio_bsdf::Channel;
use gonio_bsdf::analytic::{Pairs, Parametric, families};
use gonio_geom::{DVec3, Direction};

use crate::cases::{Case, everything, materials, narrowest, pairs, sums};
use crate::common::{chosen, settings, wanted};

/// The normal, near it, oblique, near the horizon and on it, on both sides.
fn extremes() -> Vec<Direction> {
    let mut all = vec![Direction::from_unit(DVec3::X), Direction::from_unit(DVec3::Y)];
    for theta in [0.0, 1e-7, 1e-3, 20.0, 60.0, 85.0, 89.9, 89.9999, 90.0 - 1e-9] {
        for phi in [0.0, 37.0, 90.0, 180.0] {
            let d = Direction::from_degrees(theta, phi);
            all.extend([d, d.flipped()]);
        }
    }
    all
}

/// Every pair of extremes, and each with its mirror, unbent, retro and through-the-sample counterpart.
fn extreme_pairs() -> Vec<(Direction, Direction)> {
    let all = extremes();
    let mut pairs: Vec<_> = all
        .iter()
        .flat_map(|&a| all.iter().map(move |&b| (a, b)))
        .collect();
    for &d in &all {
        pairs.extend([(d, d), (d, d.mirror()), (d, d.through()), (d, d.flipped())]);
    }
    pairs
}

/// Each model with every setting and with each parameter at either end of its range.
fn settings_and_ends(f: &dyn Parametric) -> Vec<Vec<f64>> {
    let mut all: Vec<Vec<f64>> = settings(f.info()).into_iter().map(|s| s.values).collect();
    for (k, p) in f.info().parameters.iter().enumerate() {
        for end in [p.low, p.high] {
            let mut values = all[0].clone();
            values[k] = end;
            all.push(values);
        }
    }
    all.push(f.info().parameters.iter().map(|p| p.low).collect());
    all.push(f.info().parameters.iter().map(|p| p.high).collect());
    all
}

fn at_the_ends() -> Vec<Case> {
    let mut cases = Vec::new();
    for f in chosen() {
        for values in settings_and_ends(f) {
            cases.push(Case {
                label: format!("{} {values:?}", f.info().name),
                width: narrowest(f, &values),
                model: f.model(&[(Channel::Photopic, values)]).unwrap(),
            });
        }
    }
    cases
}

#[test]
fn values_and_densities_are_finite_and_not_negative_everywhere() {
    let fixed = extreme_pairs();
    for case in at_the_ends().iter().chain(sums()).chain(materials()) {
        let n = case.model.channels().len();
        for (a, b) in fixed.iter().copied().chain(pairs(case.width, 21, 300)) {
            let mut f = vec![f64::NAN; n];
            case.model.eval(a, b, &mut f);
            let pdf = case.model.pdf(a, b);
            for v in f.iter().copied().chain([pdf, case.model.eval_first(a, b)]) {
                assert!(
                    v >= 0.0 && v.is_finite(),
                    "{}: {f:?}, density {pdf} for {a:?}, {b:?}",
                    case.label
                );
            }
            if a.cos_theta() == 0.0 || b.cos_theta() == 0.0 {
                assert!(f.iter().all(|&v| v == 0.0) && pdf == 0.0, "{}", case.label);
            }
        }
    }
}

#[test]
fn vectorised_values_and_derivatives_are_finite_everywhere() {
    let mut columns: Vec<Pairs> = Vec::new();
    for (a, b) in extreme_pairs() {
        if columns.last().is_none_or(|c| c.wi() != a) {
            columns.push(Pairs::with_capacity(a, 1));
        }
        if let Some(last) = columns.last_mut() {
            last.push(b);
        }
    }
    for f in families().iter().filter(|f| wanted(f.info().name)) {
        for values in settings_and_ends(*f) {
            for pairs in &columns {
                let n = pairs.len();
                let mut dsf = vec![f64::NAN; n];
                let mut gradient = vec![f64::NAN; n * values.len()];
                f.dsf_and_gradient(&values, pairs.view(0..n), &mut dsf, &mut gradient);
                for (j, v) in dsf.iter().enumerate() {
                    assert!(
                        *v >= 0.0 && v.is_finite(),
                        "{} {values:?}: {v} for {:?} {:?}",
                        f.info().name,
                        pairs.wi(),
                        pairs.ws(j)
                    );
                }
                for (j, v) in gradient.iter().enumerate() {
                    assert!(
                        v.is_finite(),
                        "{} {values:?} by {}: {v} for {:?} {:?}",
                        f.info().name,
                        f.info().parameters[j / n].name,
                        pairs.wi(),
                        pairs.ws(j % n)
                    );
                }
            }
        }
    }
}

#[test]
fn sampling_with_numbers_at_the_ends_of_their_range_gives_a_direction_or_none() {
    let ends = [
        0.0,
        1e-300,
        1e-16,
        0.25,
        0.5,
        1.0 - 1e-9,
        1.0 - f64::EPSILON / 2.0,
    ];
    for case in everything() {
        for w in extremes() {
            for u in ends
                .iter()
                .flat_map(|&a| ends.iter().flat_map(move |&b| ends.map(|c| [a, b, c])))
            {
                let Some(s) = case.model.sample(w, u) else {
                    continue;
                };
                let length = s.direction.vec().length();
                assert!(
                    w.cos_theta() != 0.0
                        && s.direction.cos_theta() != 0.0
                        && (length - 1.0).abs() < 1e-12
                        && s.weight.is_finite()
                        && s.weight >= 0.0
                        && s.pdf.is_finite()
                        && s.pdf > 0.0,
                    "{}: {s:?} for {w:?}, {u:?}",
                    case.label
                );
            }
        }
    }
}
