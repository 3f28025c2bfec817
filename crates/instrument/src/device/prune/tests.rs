//! Merging of averages with noise.

use super::energy::ENERGY;
use super::*;

const ALL: PruneOptions = PruneOptions {
    tolerance: 0.0,
    max_cells: usize::MAX,
};

/// Noise of a Gaussian kind: twelve even numbers.
fn noise(state: &mut u64) -> f64 {
    let mut one = || {
        *state = state
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1_442_695_040_888_963_407);
        (*state >> 33) as f64 / f64::from(1u32 << 31)
    };
    (0..12).map(|_| one()).sum::<f64>() - 6.0
}

fn averages(log2: u8, truth: impl Fn([f64; 4]) -> f64, error: f64) -> Averages {
    let n = 1usize << log2;
    let mut state = 7;
    let at = |k: usize| (k as f64 + 0.5) / n as f64;
    let values: Vec<f32> = (0..n.pow(4))
        .map(|k| {
            let place = [k / n.pow(3), k / (n * n) % n, k / n % n, k % n].map(at);
            (truth(place) + error * noise(&mut state)) as f32
        })
        .collect();
    Averages {
        rank: Rank::Four,
        log2,
        variances: vec![(error * error) as f32; values.len()],
        values,
        reciprocal: false,
    }
}

#[test]
fn what_differs_by_its_errors_alone_becomes_few_cells_near_the_truth() {
    let found = prune(&averages(3, |_| 1.0, 0.1), &ALL).unwrap();
    // 16 children stay by chance in about 1 % of the 256 nodes, and those of a direction whose energy is off by chance.
    assert!(found.tree.len() < 1000, "{}", found.tree.len());
    let worst = |p: [f64; 4]| (found.tree.lookup(&p) - 1.0).abs() / found.errors.lookup(&p);
    assert!(worst([0.1, 0.2, 0.3, 0.4]) < 4.0, "{:?}", found.errors);
    assert!(found.deviation < 0.05, "{}", found.deviation);
    assert!((found.mean - 1.0).abs() < 0.01);
}

#[test]
fn a_ridge_keeps_its_cells_and_the_estimated_deviation_is_that_from_the_truth() {
    let ridge = |[a, b, u, v]: [f64; 4]| 0.3 + 20.0 * (-((a - u).powi(2) + (b - v).powi(2)) / 0.02).exp();
    let given = averages(4, ridge, 0.3);
    // Values below 0 do not occur in averages of light.
    let given = Averages {
        values: given.values.iter().map(|v| v.max(0.0)).collect(),
        ..given
    };
    let found = prune(&given, &ALL).unwrap();
    assert!(found.tree.len() < 40_000, "{}", found.tree.len());
    let n = 16usize;
    let at = |k: usize| (k as f64 + 0.5) / n as f64;
    let mut square = 0.0;
    for k in 0..n.pow(4) {
        let p = [k / n.pow(3), k / (n * n) % n, k / n % n, k % n].map(at);
        square += (found.tree.lookup(&p) - ridge(p)).powi(2);
    }
    let actual = (square / n.pow(4) as f64).sqrt();
    assert!(actual < 0.2, "{actual}");
    assert!(
        (found.deviation / actual - 1.0).abs() < 0.25,
        "{} {actual}",
        found.deviation
    );
}

#[test]
fn cells_are_merged_to_the_number_that_is_allowed_and_the_mean_stays() {
    let slope = |[a, b, u, v]: [f64; 4]| 0.2 + a + 0.5 * b + u * v;
    let exact = averages(4, slope, 0.0);
    assert_eq!(prune(&exact, &ALL).unwrap().tree.len(), 1 << 16);
    let few = PruneOptions {
        tolerance: 0.0,
        max_cells: 1000,
    };
    let found = prune(&exact, &few).unwrap();
    assert!(
        found.tree.len() <= 1000 && found.tree.len() > 900,
        "{}",
        found.tree.len()
    );
    assert!(found.merged > 0.01 && found.merged < 0.2, "{}", found.merged);
    let loose = PruneOptions {
        tolerance: 0.05,
        max_cells: usize::MAX,
    };
    let loose = prune(&exact, &loose).unwrap();
    assert!(loose.merged <= 0.05 && loose.tree.len() < 1 << 15);
    let mut albedo = 0.0;
    for k in 0..256 {
        albedo += loose
            .tree
            .albedo([(f64::from(k / 16) + 0.5) / 16.0, (f64::from(k % 16) + 0.5) / 16.0])
            / 256.0;
    }
    assert!((albedo / (std::f64::consts::PI * loose.mean) - 1.0).abs() < 1e-3);
}

#[test]
fn the_energy_of_each_incidence_is_kept_within_its_errors() {
    // Albedos that change with the incidence by less than single values show.
    let truth = |[a, _, u, _]: [f64; 4]| 1.0 + 0.6 * (6.0 * a).sin() + 0.1 * u;
    let given = averages(3, truth, 0.6);
    let given = Averages {
        values: given.values.iter().map(|v| v.max(0.0)).collect(),
        ..given
    };
    let found = prune(&given, &ALL).unwrap();
    assert!(found.tree.len() < 4096, "{}", found.tree.len());
    for i in 0..64 {
        let at = [(i / 8) as f64 / 8.0 + 0.06, (i % 8) as f64 / 8.0 + 0.06];
        let own: f64 = given.values[64 * i..64 * i + 64]
            .iter()
            .map(|v| f64::from(*v))
            .sum();
        let kept = found.tree.albedo(at) / std::f64::consts::PI * 64.0;
        // Values are rounded to a twentieth of their errors.
        assert!(
            (kept - own).abs() < 1.05 * ENERGY * 0.6 * 8.0,
            "{i}: {kept} {own}"
        );
    }
}

#[test]
fn a_list_of_another_length_is_refused() {
    let mut short = averages(2, |_| 1.0, 0.0);
    short.values.pop();
    assert!(prune(&short, &ALL).unwrap_err().to_string().contains("values"));
    let mut negative = averages(2, |_| 1.0, 0.0);
    negative.variances[3] = -1.0;
    assert!(prune(&negative, &ALL).is_err());
}
