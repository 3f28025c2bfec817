//! The solver against problems with certified solutions (NIST StRD) and closed forms.

use gonio_fit::normal::Normal;
use gonio_fit::solver::{LeastSquares, Solution, SolverOptions, Stop, minimise};

/// Residuals and their derivatives at `x`, one row at a time.
struct Problem<F> {
    n: usize,
    rows: F,
}

impl<F: Fn(&[f64], &mut dyn FnMut(f64, &[f64]))> LeastSquares for Problem<F> {
    fn len(&self) -> usize {
        self.n
    }

    fn normal(&self, x: &[f64], out: &mut Normal) {
        (self.rows)(x, &mut |r, d| out.add_residual(r, d));
    }
}

fn solve<F: Fn(&[f64], &mut dyn FnMut(f64, &[f64]))>(
    rows: F,
    start: &[f64],
    low: f64,
    high: f64,
) -> Solution {
    let n = start.len();
    let options = SolverOptions {
        max_evaluations: 2000,
        ..SolverOptions::default()
    };
    minimise(
        &Problem { n, rows },
        start,
        &vec![low; n],
        &vec![high; n],
        &options,
    )
}

fn unbounded<F: Fn(&[f64], &mut dyn FnMut(f64, &[f64]))>(rows: F, start: &[f64]) -> Solution {
    solve(rows, start, f64::NEG_INFINITY, f64::INFINITY)
}

fn certify(found: &Solution, certified: &[f64], squares: f64, digits: f64) {
    assert!(found.stop.converged(), "{:?}", found.stop);
    for (x, c) in found.x.iter().zip(certified) {
        assert!(
            (x / c - 1.0).abs() < digits,
            "{x} {c} after {}",
            found.evaluations
        );
    }
    assert!((2.0 * found.normal.cost / squares - 1.0).abs() < 1e-9);
}

fn rosenbrock(x: &[f64], row: &mut dyn FnMut(f64, &[f64])) {
    row(10.0 * (x[1] - x[0] * x[0]), &[-20.0 * x[0], 10.0]);
    row(1.0 - x[0], &[-1.0, 0.0]);
}

#[test]
fn rosenbrocks_valley_leads_to_one_one() {
    let found = unbounded(rosenbrock, &[-1.2, 1.0]);
    assert!(found.x.iter().all(|x| (x - 1.0).abs() < 1e-9), "{:?}", found.x);
}

#[test]
fn a_long_step_along_a_valley_is_cut_at_the_box_without_climbing_its_side() {
    // The valley runs along x1 = -5 x0; the far minimum lies at x0 = 1e5. With both variables on the bounds that the
    // step passes, (1, -1), the cost is 32 more than at the start.
    let rows = |x: &[f64], row: &mut dyn FnMut(f64, &[f64])| {
        row(10.0 * (x[0] + 0.2 * x[1]), &[10.0, 2.0]);
        row(0.01 * (x[0] - 1e5), &[0.01, 0.0]);
    };
    let found = solve(rows, &[0.0, 0.0], -1.0, 1.0);
    assert!(found.stop.converged());
    assert_eq!(found.x[1], -1.0);
    assert!((found.x[0] - 30.0 / 100.0001).abs() < 1e-6, "{:?}", found.x);
}

#[test]
fn a_bound_across_the_valley_is_kept_and_the_minimum_on_it_found() {
    // On x0 <= 0.5 the minimum is x0 = 0.5, x1 = 0.25.
    let options = SolverOptions::default();
    let (low, high) = ([-2.0, -2.0], [0.5, 2.0]);
    let problem = Problem {
        n: 2,
        rows: rosenbrock,
    };
    let found = minimise(&problem, &[-1.2, 1.0], &low, &high, &options);
    assert!(found.stop.converged());
    assert_eq!(found.x[0], 0.5);
    assert!((found.x[1] - 0.25).abs() < 1e-9, "{:?}", found.x);
}

#[test]
fn a_start_outside_the_box_is_moved_into_it() {
    let found = solve(rosenbrock, &[50.0, -50.0], 0.0, 2.0);
    assert!(found.x.iter().all(|x| (x - 1.0).abs() < 1e-9), "{:?}", found.x);
}

#[test]
fn a_fixed_variable_stays() {
    let options = SolverOptions {
        fixed: &[true, false],
        ..SolverOptions::default()
    };
    let problem = Problem {
        n: 2,
        rows: rosenbrock,
    };
    let found = minimise(&problem, &[-1.2, 1.0], &[-9.0; 2], &[9.0; 2], &options);
    assert_eq!(found.x[0], -1.2);
    assert!((found.x[1] - 1.44).abs() < 1e-9);
}

#[test]
fn a_variable_without_influence_stays_and_does_no_harm() {
    let rows = |x: &[f64], row: &mut dyn FnMut(f64, &[f64])| row(x[0] - 3.0, &[1.0, 0.0]);
    let found = unbounded(rows, &[0.0, 7.0]);
    assert!(
        (found.x[0] - 3.0).abs() < 1e-9 && found.x[1] == 7.0,
        "{:?}",
        found.x
    );
}

#[test]
fn residuals_that_are_not_numbers_are_reported() {
    let rows = |x: &[f64], row: &mut dyn FnMut(f64, &[f64])| row(x[0].ln(), &[1.0 / x[0]]);
    assert_eq!(unbounded(rows, &[-1.0]).stop, Stop::NotFinite);
}

#[test]
fn a_set_cancel_flag_stops_the_search() {
    let cancel = std::sync::atomic::AtomicBool::new(true);
    let options = SolverOptions {
        cancel: Some(&cancel),
        ..SolverOptions::default()
    };
    let problem = Problem {
        n: 2,
        rows: rosenbrock,
    };
    let found = minimise(&problem, &[-1.2, 1.0], &[-9.0; 2], &[9.0; 2], &options);
    assert_eq!(found.stop, Stop::Cancelled);
}

#[rustfmt::skip]
const MISRA1A: [(f64, f64); 14] = [
    (10.07, 77.6), (14.73, 114.9), (17.94, 141.1), (23.93, 190.8), (29.61, 239.9), (35.18, 289.0), (40.02, 332.8),
    (44.82, 378.4), (50.76, 434.8), (55.05, 477.3), (61.01, 536.8), (66.40, 593.1), (75.47, 689.1), (81.78, 760.0),
];

#[test]
fn misra1a_reaches_its_certified_values() {
    let rows = |b: &[f64], row: &mut dyn FnMut(f64, &[f64])| {
        for (y, x) in MISRA1A {
            let e = (-b[1] * x).exp();
            row(b[0] * (1.0 - e) - y, &[1.0 - e, b[0] * x * e]);
        }
    };
    for start in [[500.0, 0.0001], [250.0, 0.0005]] {
        certify(
            &unbounded(rows, &start),
            &[2.3894212918e2, 5.5015643181e-4],
            1.2455138894e-1,
            1e-8,
        );
    }
}

#[rustfmt::skip]
const THURBER: [(f64, f64); 37] = [
    (80.574, -3.067), (84.248, -2.981), (87.264, -2.921), (87.195, -2.912), (89.076, -2.840), (89.608, -2.797),
    (89.868, -2.702), (90.101, -2.699), (92.405, -2.633), (95.854, -2.481), (100.696, -2.363), (101.060, -2.322),
    (401.672, -1.501), (390.724, -1.460), (567.534, -1.274), (635.316, -1.212), (733.054, -1.100),
    (759.087, -1.046), (894.206, -0.915), (990.785, -0.714), (1090.109, -0.566), (1080.914, -0.545),
    (1122.643, -0.400), (1178.351, -0.309), (1260.531, -0.109), (1273.514, -0.103), (1288.339, 0.010),
    (1327.543, 0.119), (1353.863, 0.377), (1414.509, 0.790), (1425.208, 0.963), (1421.384, 1.006),
    (1442.962, 1.115), (1464.350, 1.572), (1468.705, 1.841), (1447.894, 2.047), (1457.628, 2.200),
];

#[test]
fn thurber_reaches_its_certified_values() {
    let rows = |b: &[f64], row: &mut dyn FnMut(f64, &[f64])| {
        for (y, x) in THURBER {
            let (x2, x3) = (x * x, x * x * x);
            let (p, q) = (
                b[0] + b[1] * x + b[2] * x2 + b[3] * x3,
                1.0 + b[4] * x + b[5] * x2 + b[6] * x3,
            );
            let s = -p / (q * q);
            row(
                p / q - y,
                &[1.0 / q, x / q, x2 / q, x3 / q, s * x, s * x2, s * x3],
            );
        }
    };
    let certified = [
        1.2881396800e3,
        1.4910792535e3,
        5.8323836877e2,
        7.5416644291e1,
        9.6629502864e-1,
        3.9797285797e-1,
        4.9727297349e-2,
    ];
    for start in [
        [1000.0, 1000.0, 400.0, 40.0, 0.7, 0.3, 0.03],
        [1300.0, 1500.0, 500.0, 75.0, 1.0, 0.4, 0.05],
    ] {
        certify(&unbounded(rows, &start), &certified, 5.6427082397e3, 1e-7);
    }
}

#[rustfmt::skip]
const MGH09: [(f64, f64); 11] = [
    (0.1957, 4.0), (0.1947, 2.0), (0.1735, 1.0), (0.16, 0.5), (0.0844, 0.25), (0.0627, 0.167), (0.0456, 0.125),
    (0.0342, 0.1), (0.0323, 0.0833), (0.0235, 0.0714), (0.0246, 0.0625),
];

#[test]
fn mgh09_reaches_its_certified_values_from_far_away_too() {
    let rows = |b: &[f64], row: &mut dyn FnMut(f64, &[f64])| {
        for (y, x) in MGH09 {
            let (p, q) = (x * x + x * b[1], x * x + x * b[2] + b[3]);
            let s = -b[0] * p / (q * q);
            row(b[0] * p / q - y, &[p / q, b[0] * x / q, s * x, s]);
        }
    };
    let certified = [1.9280693458e-1, 1.9128232873e-1, 1.2305650693e-1, 1.3606233068e-1];
    for start in [[25.0, 39.0, 41.5, 39.0], [0.25, 0.39, 0.415, 0.39]] {
        certify(&unbounded(rows, &start), &certified, 3.0750560385e-4, 1e-6);
    }
}
