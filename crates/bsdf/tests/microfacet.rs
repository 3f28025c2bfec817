//! Microfacet models against closed forms, normalisation and an independent table.

#![allow(clippy::unwrap_used)] // helpers outside #[test] fail a test by panicking, as the tests themselves do

use std::f64::consts::{FRAC_PI_2, PI};

use gonio_bsdf::albedo::hemispherical_integral;
use gonio_bsdf::analytic::family;
use gonio_bsdf::analytic::microfacet::{Beckmann, Distribution, Elliptic, Ggx, Isotropic, Widths};
use gonio_bsdf::{Bsdf, Channel, directional_albedo};
use gonio_geom::{Component, Direction, Side};
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64Mcg;

fn model(name: &str, parameters: &[f64]) -> Box<dyn Bsdf> {
    family(name)
        .unwrap()
        .model(&[(Channel::Photopic, parameters.to_vec())])
        .unwrap()
}

fn albedo(model: &dyn Bsdf, degrees: f64, component: Component) -> f64 {
    directional_albedo(model, Direction::from_degrees(degrees, 20.0), component, 0)
}

/// `integral g(h) domega_h` over the upper hemisphere, by the midpoint rule in `tan theta = t / (1 - t)` and azimuth.
fn over_normals(g: impl Fn([f64; 3]) -> f64) -> f64 {
    let (n, m) = (4000, 180);
    let mut sum = 0.0;
    for i in 0..n {
        let t = (f64::from(i) + 0.5) / f64::from(n);
        let tan = t / (1.0 - t);
        let cos = 1.0 / tan.hypot(1.0);
        let sin = tan * cos;
        let jacobian = sin * cos * cos / ((1.0 - t) * (1.0 - t));
        for j in 0..m {
            let (s, c) = (2.0 * PI * (f64::from(j) + 0.5) / f64::from(m)).sin_cos();
            sum += jacobian * g([sin * c, sin * s, cos]);
        }
    }
    sum * 2.0 * PI / f64::from(n * m)
}

fn normalisation<D: Distribution, W: Widths>(p: &[f64]) {
    let widths = W::shape::<f64>(p);
    let projected = over_normals(|h| D::density::<W, f64>(&widths, h) * h[2]);
    assert!((projected - 1.0).abs() < 1e-5, "{p:?}: {projected}");
    // [Heitz2014], eq. 14: the facets seen from v cover what the plane does, integral D <v.h> = cos / G_1.
    for theta in [0.3f64, 1.0, 1.4] {
        let v = [theta.sin() * 0.6, theta.sin() * 0.8, theta.cos()];
        let dot = |h: [f64; 3]| (v[0] * h[0] + v[1] * h[1] + v[2] * h[2]).max(0.0);
        let seen = over_normals(|h| D::density::<W, f64>(&widths, h) * dot(h));
        let masking: f64 = D::masking::<W, f64>(&widths, v);
        assert!(
            (seen * masking - 1.0).abs() < 2e-4,
            "{p:?}, {theta}: {}",
            seen * masking
        );
    }
}

#[test]
fn facets_project_onto_the_whole_plane_and_the_visible_ones_onto_their_share() {
    for alpha in [0.2, 0.5, 1.0] {
        normalisation::<Ggx, Isotropic>(&[alpha]);
        normalisation::<Beckmann, Isotropic>(&[alpha]);
    }
    normalisation::<Ggx, Elliptic>(&[0.2, 0.6, 0.7]);
    normalisation::<Beckmann, Elliptic>(&[0.2, 0.6, 0.7]);
}

#[test]
fn the_mean_ggx_albedo_follows_the_independent_table() {
    // Cosine-weighted mean over incidences, single scattering, F = 1. Simpson in the cosine squared: 2 mu dmu.
    for (alpha, expected) in [(0.1, 0.972), (0.2, 0.916), (0.5, 0.700), (1.0, 0.409)] {
        let ggx = model("ggx", &[1.0, alpha]);
        let n = 32;
        let mean: f64 = (0..=n)
            .map(|k| {
                let mu2: f64 = f64::from(k) / f64::from(n);
                let weight = [1.0, 4.0, 2.0][if k == 0 || k == n { 0 } else { 2 - (k % 2) as usize }];
                let theta = mu2.sqrt().acos().min(FRAC_PI_2 - 1e-6).to_degrees();
                weight * albedo(ggx.as_ref(), theta, Component::Reflection)
            })
            .sum::<f64>()
            / f64::from(3 * n);
        assert!(
            (mean - expected).abs() < 0.002,
            "alpha {alpha}: {mean}, table {expected}"
        );
    }
}

#[test]
fn the_dielectric_interface_passes_on_what_the_independent_table_says() {
    // eta = 1.5, GGX. The table masks reflection by G_1(wi) G_1(ws), which is brought in here.
    let row = |alpha: f64, degrees: f64| {
        let m = model("ggx-dielectric", &[1.5, alpha]);
        let wi = Direction::from_degrees(degrees, 20.0);
        let widths = Isotropic::shape::<f64>(&[alpha]);
        let i = wi.vec().to_array();
        let reflected = hemispherical_integral(wi, Side::Front, |ws| {
            let s = ws.vec().to_array();
            let separable: f64 =
                Ggx::masking::<Isotropic, f64>(&widths, i) * Ggx::masking::<Isotropic, f64>(&widths, s);
            let correlated: f64 = Ggx::visibility::<Isotropic, f64>(&widths, i, s);
            m.eval_first(wi, ws) * ws.cos_theta() * separable / (4.0 * correlated)
        })
        .value;
        let transmitted = albedo(m.as_ref(), degrees, Component::Transmission);
        (transmitted, reflected + transmitted)
    };
    assert!((row(0.2, 10.0).1 - 0.995).abs() < 0.002, "{:?}", row(0.2, 10.0));
    assert!((row(0.5, 80.0).1 - 0.752).abs() < 0.002, "{:?}", row(0.5, 80.0));
    assert!((row(0.5, 60.0).0 - 0.840).abs() < 0.002, "{:?}", row(0.5, 60.0));
}

#[test]
fn the_albedo_of_a_narrow_refracted_lobe_is_found() {
    // The lobe is a third of alpha wide and lies off the unbent direction; weights are 1 to 1e-4.
    for degrees in [0.0, 45.0, 150.0] {
        let m = model("ggx-dielectric", &[1.5, 0.005]);
        let total: f64 = [Component::Reflection, Component::Transmission]
            .map(|c| albedo(m.as_ref(), degrees, c))
            .iter()
            .sum();
        let mut rng = Pcg64Mcg::seed_from_u64(42);
        let w = Direction::from_degrees(degrees, 20.0);
        let n = 100_000;
        let mean = (0..n)
            .filter_map(|_| m.sample(w, rng.random()))
            .map(|s| s.weight)
            .sum::<f64>()
            / f64::from(n);
        assert!((total - mean).abs() < 2e-5, "{degrees}: {total} {mean}");
    }
}

#[test]
fn a_smooth_limit_of_the_interface_reflects_and_transmits_what_fresnel_says_from_both_sides() {
    // alpha = .01 is smooth to 1e-4 in albedo away from the critical angle.
    let m = model("beckmann-dielectric", &[1.5, 0.01]);
    let fresnel = |cos_i: f64, eta: f64| {
        let cos_t = (1.0 - (1.0 - cos_i * cos_i) / (eta * eta)).sqrt();
        let s = (cos_i - eta * cos_t) / (cos_i + eta * cos_t);
        let p = (eta * cos_i - cos_t) / (eta * cos_i + cos_t);
        0.5 * (s * s + p * p)
    };
    for (degrees, eta) in [(0.0f64, 1.5), (50.0, 1.5), (180.0, 1.0 / 1.5), (150.0, 1.0 / 1.5)] {
        let f = fresnel(degrees.to_radians().cos().abs(), eta);
        let r = albedo(m.as_ref(), degrees, Component::Reflection);
        let t = albedo(m.as_ref(), degrees, Component::Transmission);
        assert!(
            (r - f).abs() < 3e-4 && (t - 1.0 + f).abs() < 3e-4,
            "{degrees}: {r} {t}, {f}"
        );
    }
    // Beyond the critical angle, 41.8 degrees inside, all light stays.
    assert!(albedo(m.as_ref(), 120.0, Component::Reflection) > 0.999);
    assert!(albedo(m.as_ref(), 120.0, Component::Transmission) < 1e-6);
}

#[test]
fn weights_of_visible_normals_never_exceed_one() {
    let mut rng = Pcg64Mcg::seed_from_u64(41);
    for (name, p) in [
        ("ggx", vec![1.0, 0.4]),
        ("beckmann-anisotropic", vec![1.0, 0.05, 0.7, 0.3]),
        ("ggx-conductor-anisotropic", vec![0.2, 3.4, 0.9, 0.1, 1.0]),
        ("ggx-dielectric", vec![1.5, 0.6]),
        ("beckmann-dielectric", vec![2.4, 0.3]),
    ] {
        let m = model(name, &p);
        for degrees in [0.0, 40.0, 80.0, 89.5, 100.0, 150.0] {
            let w = Direction::from_degrees(degrees, 77.0);
            for _ in 0..2000 {
                if let Some(s) = m.sample(w, rng.random()) {
                    assert!(s.weight <= 1.0 + 1e-9, "{name}, {degrees}: {s:?}");
                }
            }
        }
    }
}

#[test]
fn narrow_facets_seen_along_the_normal_mirror_it_with_the_density_of_slopes() {
    // f at normal incidence and mirror direction is F D(0) / 4 = f0 / (4 pi alpha^2).
    for name in ["ggx", "beckmann"] {
        let (f0, alpha) = (0.04, 0.02);
        let f = model(name, &[f0, alpha]).eval_first(Direction::NORMAL, Direction::NORMAL);
        let expected = f0 / (4.0 * PI * alpha * alpha);
        assert!((f / expected - 1.0).abs() < 1e-12, "{name}: {f} {expected}");
    }
}

#[test]
fn light_through_the_interface_from_behind_is_light_from_the_front_of_the_inverse_index() {
    // One facet refracts the same light both ways: f_t(wi, ws) cos_i cos_s / eta_s^2 is that of the exchanged pair.
    let m = model("ggx-dielectric-anisotropic", &[1.7, 0.2, 0.4, 0.5]);
    let (a, b) = (
        Direction::from_degrees(35.0, 10.0),
        Direction::from_degrees(155.0, 200.0),
    );
    let (there, back) = (m.eval_first(a, b), m.eval_first(b, a));
    assert!(there > 0.0 && (there / (1.7f64.powi(2) * back) - 1.0).abs() < 1e-12);
    assert!(!m.properties().reciprocal && m.properties().energy_conserving);
}

#[test]
fn a_facet_reflects_by_the_angle_to_its_own_normal() {
    // Two models that differ in Fresnel's reflectance alone: their ratio is that of the reflectances at the half vector.
    let schlick = |f0: f64, c: f64| f0 + (1.0 - f0) * (1.0 - c).powi(5);
    let pairs = [
        ((50.0, 10.0), (70.0, 150.0)),
        ((5.0, 10.0), (85.0, 190.0)),
        ((80.0, 0.0), (80.0, 175.0)),
    ];
    for (i, s) in pairs {
        let (wi, ws) = (
            Direction::from_degrees(i.0, i.1),
            Direction::from_degrees(s.0, s.1),
        );
        let c = wi.dot(ws).midpoint(1.0).sqrt();
        for name in ["ggx", "beckmann"] {
            let at = |f0: f64| model(name, &[f0, 0.4]).eval_first(wi, ws);
            let (got, want) = (at(0.04) / at(1.0), schlick(0.04, c));
            assert!(
                (got / want - 1.0).abs() < 1e-12,
                "{name} {i:?} {s:?}: {got} {want}"
            );
        }
        // eta = 1.5 + 0 i of a conductor and an interface of 1.5 reflect alike.
        let conductor = model("ggx-conductor", &[1.5, 0.0, 0.4]).eval_first(wi, ws);
        let interface = model("ggx-dielectric", &[1.5, 0.4]).eval_first(wi, ws);
        let mirror = model("ggx", &[1.0, 0.4]).eval_first(wi, ws);
        let g = (1.5f64.powi(2) - 1.0 + c * c).sqrt();
        let fresnel = 0.5 * (((c - g) / (c + g)).powi(2) + ((2.25 * c - g) / (2.25 * c + g)).powi(2));
        for (name, f) in [("conductor", conductor), ("interface", interface)] {
            let got = f / mirror;
            assert!(
                (got / fresnel - 1.0).abs() < 1e-12,
                "{name} {i:?} {s:?}: {got} {fresnel}"
            );
        }
    }
}
