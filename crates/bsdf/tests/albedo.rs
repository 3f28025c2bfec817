//! Albedo by quadrature against closed forms and one-dimensional integrals.

#![allow(clippy::unwrap_used)] // helpers outside #[test] fail a test by panicking, as the tests themselves do

use std::f64::consts::PI;

use gonio_bsdf::albedo::hemispherical_integral;
use gonio_bsdf::analytic::{Analytic, Lambert, Spectrum, WardGmd, WardGmdIsotropic};
use gonio_bsdf::directional_albedo;
use gonio_geom::{Component, Direction};

fn photopic(value: f64) -> Spectrum {
    Spectrum::photopic("albedo", value).unwrap()
}

fn gmd(alpha: f64) -> Analytic<WardGmdIsotropic> {
    WardGmd::isotropic(&photopic(1.0), alpha).unwrap()
}

#[test]
fn the_lambert_albedo_is_its_parameter() {
    for deg in [0.0, 8.0, 60.0, 89.0, 120.0] {
        let wi = Direction::from_degrees(deg, 30.0);
        let r = Lambert::reflection(&photopic(0.37)).unwrap();
        let t = Lambert::transmission(&photopic(0.37)).unwrap();
        assert!((directional_albedo(&r, wi, Component::Reflection, 0) - 0.37).abs() < 1e-12);
        assert!((directional_albedo(&t, wi, Component::Transmission, 0) - 0.37).abs() < 1e-12);
        assert_eq!(directional_albedo(&r, wi, Component::Transmission, 0), 0.0);
        assert_eq!(directional_albedo(&t, wi, Component::Reflection, 0), 0.0);
    }
}

#[test]
fn the_ward_gmd_albedo_follows_the_independent_table() {
    // Product quadrature of 512 x 512 nodes, rounded to three digits; theta_i in degrees.
    let theta = [0.0, 30.0, 60.0, 75.0, 80.0, 85.0, 89.0, 89.9];
    let table = [
        (0.1, [0.990, 0.988, 0.974, 0.918, 0.867, 0.813, 0.861, 0.965]),
        (0.3, [0.910, 0.893, 0.819, 0.778, 0.780, 0.814, 0.917, 0.984]),
    ];
    for (alpha, row) in table {
        for (deg, expected) in theta.into_iter().zip(row) {
            let wi = Direction::from_degrees(deg, 20.0);
            let got = directional_albedo(&gmd(alpha), wi, Component::Reflection, 0);
            assert!(
                (got - expected).abs() < 0.002,
                "alpha {alpha}, {deg} deg: {got}, table {expected}"
            );
        }
    }
}

#[test]
fn the_ward_gmd_albedo_at_normal_incidence_follows_the_one_dimensional_integral() {
    // Along the normal the weight 2 c_s/(1+c_s), c_s = cos(2 delta), is averaged over exp(-tan^2(delta)/alpha^2):
    // with q = tan^2(delta), c_s = (1-q)/(1+q), albedo = integral_0^1 (1-q) exp(-q/alpha^2) dq / alpha^2
    //   = 1 - alpha^2 (1 - exp(-1/alpha^2)).
    for alpha in [0.002f64, 0.005, 0.02, 0.05, 0.1, 0.3, 0.6] {
        let a2 = alpha * alpha;
        let expected = 1.0 - a2 * (1.0 - (-1.0 / a2).exp());
        let got = directional_albedo(&gmd(alpha), Direction::NORMAL, Component::Reflection, 0);
        assert!((got - expected).abs() < 1e-9, "alpha {alpha}: {got}, {expected}");
    }
}

#[test]
fn the_albedo_of_narrow_oblique_lobes_is_the_mean_weight_over_facets() {
    // The same integral in the other coordinates: the mean of 2 c_s/(c_i+c_s) over Gaussian facet slopes, by the
    // trapezoid rule, which converges exponentially for a Gaussian.
    let (n, reach) = (1200, 6.5);
    for (alpha_x, alpha_y, deg) in [
        (0.005, 0.005, 30.0),
        (0.005, 0.005, 75.0),
        (0.005, 0.02, 60.0),
        (0.02, 0.02, 60.0),
        (0.02, 0.02, 8.0),
        (0.05, 0.2, 45.0),
        (0.02, 0.4, 30.0),
    ] {
        let wi = Direction::from_degrees(deg, 70.0);
        let w = wi.vec();
        let mut mean = 0.0;
        for i in 0..=n {
            for j in 0..=n {
                let x = reach * (2.0 * f64::from(i) / f64::from(n) - 1.0);
                let y = reach * (2.0 * f64::from(j) / f64::from(n) - 1.0);
                let h = gonio_geom::DVec3::new(alpha_x * x, alpha_y * y, 1.0).normalize();
                let s = 2.0 * w.dot(h) * h - w;
                if s.z > 0.0 && w.dot(h) > 0.0 {
                    mean += (-x * x - y * y).exp() * 2.0 * s.z / (w.z + s.z);
                }
            }
        }
        mean *= (2.0 * reach / f64::from(n)).powi(2) / PI;
        let model = WardGmd::anisotropic(&photopic(1.0), alpha_x, alpha_y, 0.0).unwrap();
        let got = directional_albedo(&model, wi, Component::Reflection, 0);
        assert!(
            (got - mean).abs() < 1e-6,
            "{alpha_x} {alpha_y} {deg}: {got}, {mean}"
        );
    }
}

#[test]
fn a_narrow_lobe_away_from_the_mirror_direction_is_found() {
    // A von Mises-Fisher density of width .004, concentration 2/.004^2, about a direction in the plane of incidence.
    let wi = Direction::from_degrees(50.0, 200.0);
    for (theta, phi) in [(31.0, 20.0), (14.0, 200.0), (150.0, 20.0)] {
        let axis = Direction::from_degrees(theta, phi);
        let a2 = 0.004f64.powi(2);
        let density = |d: Direction| (-(d.vec() - axis.vec()).length_squared() / a2).exp() / (PI * a2);
        let got = hemispherical_integral(wi, axis.side(), density);
        assert!((got.value - 1.0).abs() < 1e-6, "{theta}: {got:?}");
    }
}
