//! Physics of the analytic models: albedo, reciprocity, densities, samplers.

#![allow(clippy::unwrap_used)] // helpers outside #[test] fail a test by panicking, as the tests themselves do

use std::f64::consts::PI;

use gonio_bsdf::albedo::hemispherical_integral;
use gonio_bsdf::analytic::{
    Analytic, BoundedTransmissionLobe, Lambert, Spectrum, Sum, TransmissionLobe, WardGmd, WardGmdIsotropic,
};
use gonio_bsdf::{Bsdf, Channel, directional_albedo};
use gonio_geom::{Component, Direction, Side};
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64Mcg;

fn photopic(value: f64) -> Spectrum {
    Spectrum::photopic("albedo", value).unwrap()
}

fn gmd(alpha: f64) -> Analytic<WardGmdIsotropic> {
    WardGmd::isotropic(&photopic(1.0), alpha).unwrap()
}

fn brushed() -> Analytic<WardGmd> {
    WardGmd::anisotropic(&photopic(0.8), 0.08, 0.3, 0.4).unwrap()
}

fn lobe(alpha: f64) -> Analytic<TransmissionLobe> {
    Analytic::of(&photopic(1.0), &[alpha]).unwrap()
}

fn bounded(alpha: f64) -> Analytic<BoundedTransmissionLobe> {
    Analytic::of(&photopic(1.0), &[alpha]).unwrap()
}

fn trans() -> Sum {
    Sum::new(vec![
        Box::new(Lambert::reflection(&photopic(0.2)).unwrap()),
        Box::new(WardGmd::isotropic(&photopic(0.05), 0.2).unwrap()),
        Box::new(Lambert::transmission(&photopic(0.1)).unwrap()),
        Box::new(Analytic::<BoundedTransmissionLobe>::of(&photopic(0.5), &[0.15]).unwrap()),
    ])
    .unwrap()
}

fn models() -> Vec<(&'static str, Box<dyn Bsdf>)> {
    vec![
        (
            "lambert reflection",
            Box::new(Lambert::reflection(&photopic(0.7)).unwrap()),
        ),
        (
            "lambert transmission",
            Box::new(Lambert::transmission(&photopic(0.6)).unwrap()),
        ),
        ("ward-gmd .1", Box::new(gmd(0.1))),
        ("ward-gmd .3", Box::new(gmd(0.3))),
        ("brushed", Box::new(brushed())),
        ("bounded lobe", Box::new(bounded(0.2))),
        ("square-root lobe", Box::new(lobe(0.3))),
        ("trans", Box::new(trans())),
    ]
}

fn random_direction(rng: &mut Pcg64Mcg) -> Direction {
    let z: f64 = rng.random_range(-0.99..0.99);
    Direction::from_spherical(z.acos(), rng.random_range(0.0..2.0 * PI))
}

#[test]
fn every_model_is_reciprocal() {
    let mut rng = Pcg64Mcg::seed_from_u64(11);
    for (name, model) in models() {
        assert!(model.properties().reciprocal);
        for _ in 0..2000 {
            let (a, b) = (random_direction(&mut rng), random_direction(&mut rng));
            let (f, g) = (model.eval_first(a, b), model.eval_first(b, a));
            assert!((f - g).abs() <= 1e-12 * f.max(g), "{name}: {f} and {g}");
        }
    }
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
    for alpha in [0.02f64, 0.05, 0.1, 0.3, 0.6] {
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
fn the_bounded_transmission_lobe_keeps_energy_and_the_published_one_does_not() {
    for alpha in [0.05, 0.2, 0.5, 1.0] {
        for deg in [0.0, 45.0, 80.0, 88.0, 89.9] {
            let wi = Direction::from_degrees(deg, 0.0);
            let tau = directional_albedo(&bounded(alpha), wi, Component::Transmission, 0);
            assert!(tau < 1.0, "alpha {alpha}, {deg} deg: {tau}");
        }
    }
    // Values of the published lobe at 88 degrees, rounded to two decimals.
    for (alpha, expected) in [(0.2, 1.05), (0.3, 1.18), (0.5, 1.41)] {
        let wi = Direction::from_degrees(88.0, 0.0);
        let model = lobe(alpha);
        let tau = directional_albedo(&model, wi, Component::Transmission, 0);
        assert!((tau - expected).abs() < 0.006, "alpha {alpha}: {tau}");
        assert!(!model.properties().energy_conserving);
    }
}

#[test]
fn the_transmission_lobe_falls_to_one_over_e_at_alpha() {
    let alpha = 0.05;
    let model = bounded(alpha);
    // The chord of alpha, not the arc: |t - s| = alpha.
    let off = 2.0 * (alpha / 2.0f64).asin();
    let peak = model.eval_first(Direction::NORMAL, Direction::NORMAL.through());
    let side = model.eval_first(Direction::NORMAL, Direction::from_spherical(PI - off, 0.0));
    let cosines = 0.5 * (1.0 + off.cos());
    assert!((side * cosines / peak - (-1.0f64).exp()).abs() < 1e-12);
}

#[test]
fn the_density_integrates_to_the_share_of_samples_that_succeed() {
    let mut rng = Pcg64Mcg::seed_from_u64(5);
    let n = 200_000;
    for (name, model) in models() {
        for deg in [10.0, 65.0, 130.0] {
            let wi = Direction::from_degrees(deg, 200.0);
            let mass: f64 = Side::BOTH
                .iter()
                .map(|&side| hemispherical_integral(wi, side, |ws| model.pdf(wi, ws)).value)
                .sum();
            let hits = (0..n)
                .filter(|_| model.sample(wi, rng.random()).is_some())
                .count();
            let share = hits as f64 / f64::from(n);
            // Five standard deviations of a binomial share: 24 comparisons, false alarm about 1e-5 in all.
            let sigma = (mass * (1.0 - mass).max(0.0) / f64::from(n)).sqrt();
            assert!(mass < 1.0 + 1e-6, "{name}, {deg} deg: mass {mass}");
            assert!(
                (share - mass).abs() < 5.0 * sigma + 1e-6,
                "{name}, {deg} deg: mass {mass}, share {share}"
            );
        }
    }
}

#[test]
fn the_mean_weight_of_samples_is_the_albedo() {
    let mut rng = Pcg64Mcg::seed_from_u64(6);
    let n = 100_000;
    for (name, model) in models() {
        for deg in [10.0, 65.0, 130.0] {
            let wi = Direction::from_degrees(deg, 200.0);
            let albedo: f64 = [Component::Reflection, Component::Transmission]
                .map(|c| directional_albedo(model.as_ref(), wi, c, 0))
                .iter()
                .sum();
            let (mut sum, mut squares) = (0.0, 0.0);
            for _ in 0..n {
                if let Some(s) = model.sample(wi, rng.random()) {
                    let f = model.eval_first(wi, s.direction);
                    let weight = f * s.direction.cos_theta().abs() / s.pdf;
                    assert!((weight - s.weight).abs() < 1e-8 * weight.max(1e-3), "{name}");
                    sum += s.weight;
                    squares += s.weight * s.weight;
                }
            }
            let mean = sum / f64::from(n);
            // Five standard deviations of a mean: 24 comparisons, false alarm about 1e-5 in all.
            let sigma = ((squares / f64::from(n) - mean * mean).max(0.0) / f64::from(n)).sqrt();
            assert!(
                (mean - albedo).abs() < 5.0 * sigma + 1e-6,
                "{name}, {deg} deg: {mean}, albedo {albedo}"
            );
        }
    }
}

/// Standard normal deviate of a chi-square value, after Wilson and Hilferty.
fn chi_square_deviate(chi2: f64, dof: f64) -> f64 {
    ((chi2 / dof).cbrt() - (1.0 - 2.0 / (9.0 * dof))) / (2.0 / (9.0 * dof)).sqrt()
}

#[test]
fn samplers_follow_their_densities_by_chi_square() {
    // 48 theta x 36 phi bins about the peak's hemisphere and one remainder; bins expecting fewer than 5 are pooled.
    // 24 tests at z < 4.5 each: false alarm about 1e-4 in all, with the seed fixed.
    let mut rng = Pcg64Mcg::seed_from_u64(7);
    let n = 200_000;
    let (n_theta, n_phi) = (96, 36);
    let (d_theta, d_phi) = (PI / n_theta as f64, 2.0 * PI / n_phi as f64);
    for (name, model) in models() {
        for deg in [10.0, 65.0, 130.0] {
            let wi = Direction::from_degrees(deg, 200.0);
            let mut counts = vec![0.0; n_theta * n_phi];
            for _ in 0..n {
                if let Some(s) = model.sample(wi, rng.random()) {
                    let i = ((s.direction.theta() / d_theta) as usize).min(n_theta - 1);
                    let j = ((s.direction.phi() / d_phi) as usize).min(n_phi - 1);
                    counts[i * n_phi + j] += 1.0;
                }
            }
            let (mut chi2, mut bins, mut pooled_count, mut pooled_expected) = (0.0, 0.0, 0.0, 0.0);
            let (mut total_count, mut total_expected) = (0.0, 0.0);
            // Midpoint rule with 24 x 24 nodes a bin.
            let m = 24;
            for (k, &count) in counts.iter().enumerate() {
                let (i, j) = (k / n_phi, k % n_phi);
                let mut mass = 0.0;
                for a in 0..m {
                    for b in 0..m {
                        let theta = (i as f64 + (a as f64 + 0.5) / m as f64) * d_theta;
                        let phi = (j as f64 + (b as f64 + 0.5) / m as f64) * d_phi;
                        mass += model.pdf(wi, Direction::from_spherical(theta, phi)) * theta.sin();
                    }
                }
                let expected = mass * d_theta * d_phi / (m * m) as f64 * f64::from(n);
                total_count += count;
                total_expected += expected;
                if expected < 5.0 {
                    pooled_count += count;
                    pooled_expected += expected;
                } else {
                    chi2 += (count - expected).powi(2) / expected;
                    bins += 1.0;
                }
            }
            // Failed samples are one more bin.
            pooled_count += f64::from(n) - total_count;
            pooled_expected += f64::from(n) - total_expected;
            if pooled_expected >= 5.0 {
                chi2 += (pooled_count - pooled_expected).powi(2) / pooled_expected;
                bins += 1.0;
            }
            let z = chi_square_deviate(chi2, bins - 1.0);
            assert!(z < 4.5, "{name}, {deg} deg: chi2 {chi2} in {bins} bins, z = {z}");
        }
    }
}

#[test]
fn a_sum_answers_with_the_sum_and_knows_whether_it_keeps_energy() {
    let wi = Direction::from_degrees(35.0, 10.0);
    let ws = Direction::from_degrees(50.0, 170.0);
    let parts: [Box<dyn Bsdf>; 2] = [
        Box::new(Lambert::reflection(&photopic(0.4)).unwrap()),
        Box::new(WardGmd::isotropic(&photopic(0.1), 0.15).unwrap()),
    ];
    let expected: f64 = parts.iter().map(|p| p.eval_first(wi, ws)).sum();
    let plastic = Sum::new(parts.into()).unwrap();
    assert!((plastic.eval_first(wi, ws) - expected).abs() < 1e-15);
    assert!(plastic.properties().energy_conserving && trans().properties().energy_conserving);
    let too_much = Sum::new(vec![
        Box::new(Lambert::reflection(&photopic(0.9)).unwrap()),
        Box::new(WardGmd::isotropic(&photopic(0.3), 0.15).unwrap()),
    ])
    .unwrap();
    assert!(!too_much.properties().energy_conserving);
}

#[test]
fn parameters_out_of_range_are_refused_by_name() {
    assert!(
        WardGmd::isotropic(&photopic(0.5), 0.0)
            .unwrap_err()
            .to_string()
            .starts_with("alpha: found 0")
    );
    assert!(WardGmd::isotropic(&photopic(0.5), f64::NAN).is_err());
    assert!(
        Spectrum::photopic("rho_d", 1.2)
            .unwrap_err()
            .to_string()
            .starts_with("rho_d: found 1.2")
    );
    assert!(Spectrum::new("rho_d", &[]).is_err());
    let red: Box<dyn Bsdf> =
        Box::new(Lambert::reflection(&Spectrum::new("rho_d", &[(Channel::Red, 0.1)]).unwrap()).unwrap());
    assert!(Sum::new(vec![red, Box::new(gmd(0.1))]).is_err());
    assert!(Sum::new(Vec::new()).is_err());
}

#[test]
fn light_along_the_sample_plane_is_not_scattered() {
    let wi = Direction::from_unit(gonio_geom::DVec3::X);
    for (name, model) in models() {
        assert_eq!(model.eval_first(wi, Direction::NORMAL), 0.0, "{name}");
        assert_eq!(model.eval_first(Direction::NORMAL, wi), 0.0, "{name}");
        assert!(model.sample(wi, [0.3, 0.4, 0.5]).is_none(), "{name}");
    }
}
