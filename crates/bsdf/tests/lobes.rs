//! Albedos of the lobes against independent figures and closed forms.

#![allow(clippy::unwrap_used)] // helpers outside #[test] fail a test by panicking, as the tests themselves do

use gonio_bsdf::analytic::{families, family};
use gonio_bsdf::{Bsdf, Channel, directional_albedo};
use gonio_geom::{Component, Direction};

fn model(name: &str, parameters: &[f64]) -> Box<dyn Bsdf> {
    family(name)
        .unwrap()
        .model(&[(Channel::Photopic, parameters.to_vec())])
        .unwrap()
}

fn dhr(name: &str, parameters: &[f64], theta_i: f64) -> f64 {
    let wi = Direction::from_degrees(theta_i, 20.0);
    directional_albedo(model(name, parameters).as_ref(), wi, Component::Reflection, 0)
}

#[test]
fn the_albedos_of_the_ward_lobes_follow_the_independent_table() {
    // Product quadrature of 512 x 512 nodes, rounded to three digits or to the last one given; theta_i in degrees.
    let theta = [0.0, 30.0, 60.0, 75.0, 80.0, 85.0, 89.0, 89.9];
    let table = [
        (
            "ward",
            0.1,
            [0.971, 0.842, 0.489, 0.259, 0.184, 0.120, 0.110, 0.270],
        ),
        (
            "ward",
            0.3,
            [0.794, 0.691, 0.422, 0.280, 0.245, 0.234, 0.360, 1.037],
        ),
        (
            "ward-duer",
            0.1,
            [0.981, 0.981, 0.981, 0.968, 0.947, 0.977, 2.10, 16.2],
        ),
        (
            "ward-duer",
            0.3,
            [0.856, 0.855, 0.824, 0.838, 0.918, 1.25, 4.30, 39.0],
        ),
    ];
    for (name, alpha, row) in table {
        for (deg, expected) in theta.into_iter().zip(row) {
            let rounding = match expected {
                e if e > 20.0 => 0.5,
                e if e > 5.0 => 0.05,
                e if e > 1.2 => 0.005,
                _ => 0.0,
            };
            for anisotropic in [false, true] {
                let (name, p) = if anisotropic {
                    (format!("{name}-anisotropic"), vec![1.0, alpha, alpha, 0.7])
                } else {
                    (name.to_owned(), vec![1.0, alpha])
                };
                let got = dhr(&name, &p, deg);
                assert!(
                    (got - expected).abs() < 0.002 + rounding,
                    "{name} {alpha}, {deg} degrees: {got}, table {expected}"
                );
            }
        }
    }
}

#[test]
fn the_ashikhmin_shirley_lobe_keeps_its_albedo_below_the_independent_maximum() {
    // Metal of f0 = 1 over no base: .996 at most, by the same quadrature.
    let mut most = 0.0_f64;
    for alpha in [0.02, 0.1, 0.3, 0.6, 1.0] {
        for deg in [0.0, 30.0, 60.0, 75.0, 85.0, 89.0] {
            most = most.max(dhr("ashikhmin-shirley", &[0.0, 1.0, alpha], deg));
        }
    }
    assert!(most > 0.98 && most < 1.0, "{most}");
}

#[test]
fn the_ashikhmin_shirley_base_follows_its_closed_form() {
    // The integral over ws of 28/(23 pi) (1 - (1 - cos_s/2)^5) cos_s is 1.
    for deg in [0.0, 30.0, 60.0, 80.0, 89.0_f64] {
        let with = dhr("ashikhmin-shirley", &[0.6, 0.1, 0.2], deg);
        let got = with - dhr("ashikhmin-shirley", &[0.0, 0.1, 0.2], deg);
        let want = 0.6 * 0.9 * (1.0 - (1.0 - 0.5 * deg.to_radians().cos()).powi(5));
        assert!((got - want).abs() < 1e-6, "{deg}: {got} {want}");
    }
}

#[test]
fn oren_nayar_without_roughness_is_lambertian_and_the_albedo_follows_its_closed_form() {
    for deg in [0.0, 30.0, 60.0, 85.0, 89.0_f64] {
        assert!((dhr("oren-nayar", &[0.7, 0.0], deg) - 0.7).abs() < 1e-7);
        let sigma = 0.35_f64;
        let a = 1.0 - 0.5 * sigma.powi(2) / (sigma.powi(2) + 0.33);
        let b = 0.45 * sigma.powi(2) / (sigma.powi(2) + 0.09);
        // 2/pi times the integral of sin a tan b cos_s sin_s over theta_s, below and above theta_i.
        let t = deg.to_radians();
        let below = t.sin() * (t / 2.0 - (2.0 * t).sin() / 4.0);
        let above = t.tan() * (1.0 - t.sin().powi(3)) / 3.0;
        let want = 0.7 * (a + b * 2.0 / std::f64::consts::PI * (below + above));
        let got = dhr("oren-nayar", &[0.7, sigma], deg);
        assert!((got - want).abs() < 1e-5, "{deg}: {got} {want}");
    }
}

#[test]
fn lobes_shifted_in_direction_cosines_have_rho_at_normal_incidence_and_less_elsewhere() {
    let shifted = families()
        .iter()
        .filter(|f| f.info().position("roll_off").is_some());
    let mut seen = 0;
    for f in shifted {
        seen += 1;
        for (roll_off, g) in [(0.01, 0.5), (0.003, 1.5), (0.05, 2.0), (0.2, 3.0), (1.0, 8.0)] {
            let model = f.model(&[(Channel::Photopic, vec![0.3, roll_off, g])]).unwrap();
            let mut last = 0.3;
            for deg in [0.0, 30.0, 60.0, 80.0, 89.0] {
                let wi = Direction::from_degrees(deg, 20.0);
                let got: f64 = [Component::Reflection, Component::Transmission]
                    .map(|c| directional_albedo(model.as_ref(), wi, c, 0))
                    .iter()
                    .sum();
                let name = f.info().name;
                if deg == 0.0 {
                    assert!((got - 0.3).abs() < 3e-5, "{name} {roll_off} {g}: {got}");
                } else {
                    assert!(got < last + 1e-5, "{name} {roll_off} {g}, {deg} degrees: {got}");
                }
                last = got;
            }
        }
    }
    assert_eq!(seen, 4);
}

#[test]
fn a_transmission_lobe_is_alpha_wide_and_a_reflection_lobe_of_the_same_alpha_twice_that() {
    let alpha: f64 = 0.01;
    let fall = |name: &str, off: f64, back: bool| {
        let m = model(name, &[0.5, alpha]);
        let at = |angle: f64| {
            let theta = angle.to_degrees();
            let ws = Direction::from_degrees(if back { 180.0 - theta } else { theta }, 70.0);
            m.eval_first(Direction::NORMAL, ws)
        };
        at(off) / at(0.0)
    };
    let one = (-1.0f64).exp();
    for name in ["transmission-lobe", "bounded-transmission-lobe"] {
        let f = fall(name, alpha, true);
        assert!((f / one - 1.0).abs() < 1e-3, "{name}: {f}");
    }
    for name in ["ward", "ward-duer", "ward-gmd", "beckmann"] {
        let f = fall(name, 2.0 * alpha, false);
        assert!((f / one - 1.0).abs() < 2e-3, "{name}: {f}");
    }
}
