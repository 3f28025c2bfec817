//! What a sample says about itself. Whether samples follow their density is the business of tests/statistical.

use gonio_bsdf::albedo::hemispherical_integral;
use gonio_bsdf::analytic::Sum;
use gonio_bsdf::{Bsdf, Channel, Lobe};
use gonio_geom::{Component, Direction, Side};
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64Mcg;

use crate::cases::{everything, incidences, model, sums};

/// Incidences of the weight test, degrees.
const THETAS: [f64; 5] = [0.0, 35.0, 70.0, 88.0, 140.0];

#[test]
fn a_weight_is_the_value_times_the_cosine_over_the_density() {
    let mut rng = Pcg64Mcg::seed_from_u64(31);
    for case in everything() {
        let model = case.model.as_ref();
        let mut drawn = 0;
        for wi in incidences(model, &THETAS) {
            for _ in 0..200 {
                let Some(s) = model.sample(wi, rng.random()) else {
                    continue;
                };
                drawn += 1;
                if s.lobe == Lobe::Delta {
                    let share = ideal_share(model, wi, s.direction);
                    assert!(
                        s.pdf <= 1.0 && (s.weight * s.pdf - share).abs() <= 1e-12,
                        "{}: {s:?}, share {share}",
                        case.label
                    );
                    continue;
                }
                let pdf = model.pdf(wi, s.direction);
                let weight = model.eval_first(wi, s.direction) * s.direction.cos_theta().abs() / pdf;
                assert!(
                    (s.pdf - pdf).abs() <= 1e-12 * pdf && (s.weight - weight).abs() <= 1e-12 * weight,
                    "{}: {s:?}, density {pdf}, weight {weight}",
                    case.label
                );
            }
        }
        assert!(drawn > 100, "{}: only {drawn} samples succeed", case.label);
    }
}

/// Share of the light that takes the ideal direction `d`, in the first channel.
fn ideal_share(model: &dyn Bsdf, wi: Direction, d: Direction) -> f64 {
    let mut shares = vec![0.0; model.channels().len()];
    let mut sum = 0.0;
    for component in [Component::Reflection, Component::Transmission] {
        if let Some(to) = model.delta(wi, component, &mut shares)
            && to.angle_to(d) < 1e-7
        {
            sum += shares[0];
        }
    }
    sum
}

#[test]
fn the_density_of_a_sum_integrates_to_the_share_of_samples_that_succeed() {
    let mut rng = Pcg64Mcg::seed_from_u64(32);
    let n = 100_000;
    for case in sums() {
        let model = case.model.as_ref();
        for wi in incidences(model, &[5.0, 65.0, 130.0]) {
            let mass: f64 = Side::BOTH
                .iter()
                .map(|&side| hemispherical_integral(wi, side, |ws| model.pdf(wi, ws)).value)
                .sum();
            let hits = (0..n)
                .filter(|_| model.sample(wi, rng.random()).is_some())
                .count();
            let share = hits as f64 / f64::from(n);
            // Five standard deviations of a binomial share: 40 comparisons, false alarm about 2e-5 in all.
            let sigma = (mass * (1.0 - mass).max(0.0) / f64::from(n)).sqrt();
            assert!(
                mass < 1.0 + 1e-5 && (share - mass).abs() < 5.0 * sigma + 1e-5,
                "{}: mass {mass}, share {share}",
                case.label
            );
        }
    }
}

#[test]
fn a_sum_draws_a_part_that_only_a_later_channel_has() {
    let two = |name: &str, red: &[f64], blue: &[f64]| {
        model(
            name,
            &[(Channel::Red, red.to_vec()), (Channel::Blue, blue.to_vec())],
        )
    };
    let sum = Sum::new(vec![
        two("lambert", &[0.4], &[0.0]),
        two("ward-gmd", &[0.0, 0.05], &[0.4, 0.05]),
    ])
    .unwrap();
    let wi = Direction::from_degrees(30.0, 0.0);
    let mut rng = Pcg64Mcg::seed_from_u64(33);
    let near = (0..1000)
        .filter_map(|_| sum.sample(wi, rng.random()))
        .filter(|s| s.direction.angle_to(wi.mirror()) < 0.3)
        .count();
    // Both parts send out about the same: half of the samples, and four per cent of the diffuse ones, are near.
    assert!((430..600).contains(&near), "{near}");
}
