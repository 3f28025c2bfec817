use std::f64::consts::{PI, TAU};

use super::*;
use crate::analytic::family;
use crate::directional_albedo;
use crate::testing::Numbers;
use gonio_geom::Component;

/// A glossy reciprocal model of one channel.
fn glossy(alpha: f64) -> Box<dyn Bsdf> {
    family("ward-gmd")
        .unwrap()
        .model(&[(Channel::Green, vec![0.2, alpha])])
        .unwrap()
}

fn table(shape: [usize; 3], alpha: f64) -> HalfDifference {
    HalfDifference::of(glossy(alpha).as_ref(), shape, &[(Channel::Green, 0)]).unwrap()
}

#[test]
fn a_pair_comes_back_from_its_angles_up_to_its_azimuth() {
    let mut numbers = Numbers::new(1);
    for _ in 0..2000 {
        let (wi, ws) = (numbers.direction(), numbers.direction());
        let angles = HalfAngles::of(wi, ws).unwrap();
        let (a, b) = angles.pair();
        // phi_d modulo pi leaves open which of both is the incidence
        let same = |i: Direction, s: Direction| {
            (i.cos_theta() - wi.cos_theta()).abs() < 1e-9
                && (s.cos_theta() - ws.cos_theta()).abs() < 1e-9
                && (i.dot(s) - wi.dot(ws)).abs() < 1e-9
        };
        assert!(same(a, b) || same(b, a), "{wi:?} {ws:?} {angles:?}");
        let swapped = HalfAngles::of(ws, wi).unwrap();
        let turn = (swapped.phi_d - angles.phi_d).abs();
        assert!(turn < 1e-9 || (turn - PI).abs() < 1e-9, "{turn}");
    }
}

#[test]
fn angles_of_the_mirror_and_the_retro_direction_are_those_of_the_definition() {
    let wi = Direction::from_degrees(50.0, 20.0);
    let mirror = HalfAngles::of(wi, wi.mirror()).unwrap();
    assert!(mirror.theta_h < 1e-12 && (mirror.theta_d.to_degrees() - 50.0).abs() < 1e-9);
    let retro = HalfAngles::of(wi, wi).unwrap();
    assert!(retro.theta_d < 1e-7 && (retro.theta_h.to_degrees() - 50.0).abs() < 1e-9);
    // both directions in the plane of the normal: the azimuth about the half vector is 0 or pi
    let plane = HalfAngles::of(wi, Direction::from_degrees(20.0, 20.0)).unwrap();
    assert!(plane.phi_d < 1e-9 || (plane.phi_d - PI).abs() < 1e-9);
    assert_eq!(HalfAngles::of(wi, wi.through()), None);
}

#[test]
fn a_cell_answers_at_its_centre_with_its_own_value_by_either_rule() {
    let shape = [5, 4, 6];
    let values: Vec<f64> = (0..120).map(f64::from).collect();
    let nearest = HalfDifference::new(shape, vec![Channel::Green], values).unwrap();
    let linear = nearest.clone().with_lookup(Lookup::Trilinear);
    for cell in 0..120usize {
        let at = [cell / 24, cell / 6 % 4, cell % 6];
        let (wi, ws) = HalfDifference::centre(shape, at).pair();
        if wi.cos_theta() > 0.0 && ws.cos_theta() > 0.0 {
            assert!((nearest.eval_first(wi, ws) - cell as f64).abs() < 1e-9, "{at:?}");
            assert!((linear.eval_first(wi, ws) - cell as f64).abs() < 1e-6, "{at:?}");
        }
    }
}

#[test]
fn empty_cells_are_zero_without_data_and_do_not_pull_their_neighbours_down() {
    let mut values = vec![0.5; 4 * 4 * 4];
    values[..16].fill(-1.0);
    let table = HalfDifference::new([4, 4, 4], vec![Channel::Red], values).unwrap();
    assert_eq!(table.empty_share(), 0.25);
    let wi = Direction::from_degrees(30.0, 0.0);
    assert_eq!(table.eval_first(wi, wi.mirror()), 0.0);
    assert!(!table.has_data(wi, wi.mirror()) && table.has_data(wi, wi));
    let linear = table.with_lookup(Lookup::Trilinear);
    let mut numbers = Numbers::new(7);
    for _ in 0..500 {
        let f = linear.eval_first(numbers.direction(), numbers.direction());
        assert!(f == 0.0 || (f - 0.5).abs() < 1e-12, "{f}");
    }
}

#[test]
fn a_table_keeps_reciprocity_and_the_horizon() {
    let mut numbers = Numbers::new(3);
    for lookup in [Lookup::Nearest, Lookup::Trilinear] {
        let table = table([30, 30, 20], 0.2).with_lookup(lookup);
        for _ in 0..1000 {
            let (wi, ws) = (numbers.direction(), numbers.direction());
            let (there, back) = (table.eval_first(wi, ws), table.eval_first(ws, wi));
            assert!((there - back).abs() <= 1e-9 * there.max(1e-3), "{there} {back}");
        }
        assert_eq!(
            table.eval_first(Direction::NORMAL.flipped(), Direction::NORMAL),
            0.0
        );
    }
}

#[test]
fn finer_tables_come_closer_to_their_model() {
    let model = glossy(0.3);
    let error = |shape, lookup| {
        let table = table(shape, 0.3).with_lookup(lookup);
        let mut numbers = Numbers::new(11);
        let (mut difference, mut sum) = (0.0, 0.0);
        for _ in 0..4000 {
            let (wi, ws) = (numbers.direction(), numbers.direction());
            let f = model.eval_first(wi, ws);
            let weight = ws.cos_theta();
            difference += weight * (table.eval_first(wi, ws) - f).abs();
            sum += weight * f;
        }
        difference / sum
    };
    let coarse = error([22, 22, 45], Lookup::Nearest);
    let fine = error([45, 45, 90], Lookup::Nearest);
    let linear = error([45, 45, 90], Lookup::Trilinear);
    assert!(
        fine < 0.6 * coarse && linear < 0.3 * fine,
        "{coarse} {fine} {linear}"
    );
}

#[test]
fn samples_have_the_density_that_is_stated_and_carry_the_albedo() {
    for alpha in [0.1, 0.5] {
        let table = table([45, 45, 90], alpha).with_lookup(Lookup::Trilinear);
        for theta in [5.0, 40.0, 70.0] {
            let w = Direction::from_degrees(theta, 30.0);
            let n = 100_000;
            let mut numbers = Numbers::new(5);
            let (mut sum, mut squares, mut inverse) = (0.0, 0.0, 0.0);
            for _ in 0..n {
                let u = [numbers.next(), numbers.next(), numbers.next()];
                let Some(s) = table.sample(w, u) else { continue };
                assert!((s.pdf - table.pdf(w, s.direction)).abs() <= 1e-9 * s.pdf);
                sum += s.weight;
                squares += s.weight * s.weight;
                // the mean of cos / pi over the density is 1 where the density reaches everything
                inverse += s.direction.cos_theta() / (PI * s.pdf);
            }
            let n = f64::from(n);
            let mean = sum / n;
            let error = ((squares / n - mean * mean) / n).sqrt();
            let albedo = directional_albedo(&table, w, Component::Reflection, 0);
            assert!(
                (mean - albedo).abs() < 4.0 * error,
                "{alpha} {theta}: {mean} {albedo} {error}"
            );
            assert!(
                (inverse / n - 1.0).abs() < 0.03,
                "{alpha} {theta}: {}",
                inverse / n
            );
        }
    }
}

/// A direction of the front by its place in the unit square; equal areas are equal projected solid angles.
fn of_square(x: f64, y: f64) -> Direction {
    let (r, phi) = (x.sqrt(), TAU * y);
    Direction::from_unit(DVec3::new(r * phi.cos(), r * phi.sin(), (1.0 - x).sqrt()))
}

/// Chi-square of 300,000 samples in 400 bins of equal projected solid angle and one of failures; the bound of four
/// standard deviations is passed by chance once in some thousands of seeds, and the seed is fixed.
#[test]
fn samples_fill_bins_as_the_density_says() {
    const SIDE: usize = 20;
    const FINE: usize = 40;
    const SAMPLES: usize = 300_000;
    for (alpha, theta) in [(0.3, 20.0), (0.5, 65.0)] {
        let table = table([45, 30, 30], alpha);
        let w = Direction::from_degrees(theta, 30.0);
        let mut expected = vec![0.0; SIDE * SIDE + 1];
        let step = 1.0 / (SIDE * FINE) as f64;
        for a in 0..SIDE * FINE {
            for b in 0..SIDE * FINE {
                let d = of_square((a as f64 + 0.5) * step, (b as f64 + 0.5) * step);
                let mass = table.pdf(w, d) * PI * step * step / d.cos_theta();
                expected[a / FINE * SIDE + b / FINE] += mass;
            }
        }
        expected[SIDE * SIDE] = 1.0 - expected.iter().sum::<f64>();
        let mut counts = vec![0.0; SIDE * SIDE + 1];
        let mut numbers = Numbers::new(9);
        for _ in 0..SAMPLES {
            let u = [numbers.next(), numbers.next(), numbers.next()];
            let bin = table.sample(w, u).map_or(SIDE * SIDE, |s| {
                let v = s.direction.vec();
                let place = |x: f64| ((x * SIDE as f64) as usize).min(SIDE - 1);
                place(1.0 - v.z * v.z) * SIDE + place(v.y.atan2(v.x).rem_euclid(TAU) / TAU)
            });
            counts[bin] += 1.0;
        }
        let bins = expected
            .iter()
            .zip(&counts)
            .filter(|(e, _)| **e * SAMPLES as f64 > 10.0);
        let (mut chi_square, mut n) = (0.0, 0.0);
        for (e, c) in bins {
            let e = e * SAMPLES as f64;
            chi_square += (c - e) * (c - e) / e;
            n += 1.0;
        }
        let bound = n + 4.0 * f64::sqrt(2.0 * n);
        assert!(
            chi_square < bound,
            "{alpha} {theta}: {chi_square} in {n} bins, bound {bound}"
        );
    }
}

#[test]
fn what_makes_no_table_is_refused_by_name() {
    let refused = |shape, channels, values| {
        HalfDifference::new(shape, channels, values)
            .unwrap_err()
            .to_string()
    };
    let green = vec![Channel::Green];
    assert!(refused([0, 1, 1], green.clone(), vec![]).starts_with("shape: found [0, 1, 1]"));
    assert!(refused([usize::MAX, 2, 1], green.clone(), vec![]).starts_with("shape"));
    assert!(refused([1, 1, 2], vec![], vec![]).starts_with("channels: found none"));
    assert!(refused([1, 1, 2], green.clone(), vec![0.0]).starts_with("values: found 1 values"));
    assert!(refused([1, 1, 1], green, vec![f64::NAN]).starts_with("values: found NaN at value 1"));
    let model = glossy(0.2);
    let text = HalfDifference::of(model.as_ref(), [1, 1, 1], &[(Channel::Red, 1)])
        .unwrap_err()
        .to_string();
    assert!(text.contains("channel 1 of the model for red"), "{text}");
}

#[test]
fn a_black_table_is_sampled_without_light() {
    let black = HalfDifference::new([2, 2, 2], vec![Channel::Red], vec![0.0; 8]).unwrap();
    assert!(black.sample(Direction::NORMAL, [0.3, 0.4, 0.5]).is_none());
    let pdf = black.pdf(Direction::NORMAL, Direction::NORMAL);
    assert!((pdf - 1.0 / PI).abs() < 1e-12);
}
