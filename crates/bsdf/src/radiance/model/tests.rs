use std::f64::consts::PI;

use gonio_geom::{Direction, Side};

use super::super::{Metal, Mirror, Parameters, Plastic, Trans};
use super::*;
use crate::albedo::hemispherical_integral;
use crate::directional_albedo;

const REFLECTION: Component = Component::Reflection;
const TRANSMISSION: Component = Component::Transmission;

fn made(word: &str, strings: &str, reals: &[f64]) -> Box<dyn Bsdf> {
    let strings: Vec<String> = strings.split_whitespace().map(String::from).collect();
    let material = RadianceMaterial::from_arguments(word, &strings, reals)
        .unwrap()
        .unwrap();
    material.bsdf().unwrap()
}

fn deg(theta: f64, phi: f64) -> Direction {
    Direction::from_degrees(theta, phi)
}

fn shares(model: &dyn Bsdf, w: Direction, component: Component) -> [f64; 3] {
    let mut s = [f64::NAN; 3];
    model.delta(w, component, &mut s);
    s
}

fn eval(model: &dyn Bsdf, wi: Direction, ws: Direction) -> [f64; 3] {
    let mut f = [f64::NAN; 3];
    model.eval(wi, ws, &mut f);
    f
}

fn near(a: f64, b: f64, tolerance: f64) {
    assert!((a - b).abs() <= tolerance, "{a} {b}");
}

/// One of each kind that models differ by.
fn all() -> Vec<(&'static str, Box<dyn Bsdf>)> {
    vec![
        ("plastic", made("plastic", "", &[0.0, 0.4, 0.8, 0.05, 0.1])),
        ("smooth plastic", made("plastic", "", &[0.2, 0.4, 0.8, 0.05, 0.0])),
        (
            "dull smooth plastic",
            made("plastic", "", &[0.2, 0.4, 0.8, 0.01, 0.0]),
        ),
        ("metal", made("metal", "", &[0.9, 0.6, 0.2, 0.8, 0.15])),
        ("smooth metal", made("metal", "", &[0.9, 0.6, 0.2, 0.8, 0.0])),
        ("trans", made("trans", "", &[0.9, 0.8, 0.7, 0.05, 0.2, 0.6, 0.5])),
        (
            "smooth trans",
            made("trans", "", &[0.9, 0.8, 0.7, 0.05, 0.0, 0.6, 0.5]),
        ),
        (
            "plastic2",
            made("plastic2", "1 1 0 .", &[0.5, 0.4, 0.3, 0.1, 0.1, 0.3]),
        ),
        (
            "metal2",
            made("metal2", "0 0 1 .", &[0.5, 0.4, 0.3, 0.9, 0.1, 0.3]),
        ),
        (
            "trans2",
            made("trans2", "0 1 0 .", &[0.5, 0.4, 0.3, 0.1, 0.1, 0.3, 0.8, 0.9]),
        ),
        (
            "ashik2",
            made("ashik2", "1 0 0 .", &[0.3, 0.2, 0.1, 0.1, 0.2, 0.3, 50.0, 200.0]),
        ),
        ("glass", made("glass", "", &[0.96, 0.9, 0.5])),
        ("mirror", made("mirror", "", &[0.9, 0.8, 0.7])),
        ("dielectric", made("dielectric", "", &[1.0, 1.0, 1.0, 1.5, 0.0])),
    ]
}

#[test]
fn every_material_has_three_channels_and_scatters_no_more_than_all_light_at_moderate_angles() {
    for (name, model) in all() {
        assert_eq!(model.channels(), CHANNELS, "{name}");
        for theta in [0.0, 30.0, 60.0, 120.0] {
            for channel in 0..3 {
                let total: f64 = [REFLECTION, TRANSMISSION]
                    .map(|c| directional_albedo(model.as_ref(), deg(theta, 20.0), c, channel))
                    .iter()
                    .sum();
                assert!(total <= 1.0 + 1e-6, "{name} {theta} {channel}: {total}");
                assert!(total > 0.01 || theta > 90.0, "{name} {theta} {channel}: {total}");
            }
        }
    }
}

#[test]
fn materials_that_claim_reciprocity_have_it() {
    let mut broken = Vec::new();
    for (name, model) in all() {
        let mut worst: f64 = 0.0;
        for (a, b) in [
            (deg(10.0, 0.0), deg(70.0, 100.0)),
            (deg(50.0, 20.0), deg(55.0, 190.0)),
            (deg(30.0, 20.0), deg(140.0, 190.0)),
            (deg(160.0, 20.0), deg(120.0, 210.0)),
        ] {
            let (f, g) = (eval(model.as_ref(), a, b), eval(model.as_ref(), b, a));
            for (f, g) in f.into_iter().zip(g) {
                worst = worst.max((f - g).abs() / f.max(g).max(1e-30));
            }
        }
        assert!(!model.properties().reciprocal || worst < 1e-12, "{name}: {worst}");
        if worst > 1e-3 {
            broken.push(name);
        }
    }
    assert_eq!(broken, ["ashik2"]);
}

#[test]
fn rough_plastic_is_a_diffuse_part_and_an_uncoloured_gloss_without_fresnel() {
    let model = made("plastic", "", &[0.2, 0.4, 0.8, 0.05, 0.1]);
    let (wi, ws) = (deg(40.0, 0.0), deg(40.0, 180.0));
    // At the mirror direction the lobe is |h|^2 / (pi alpha^2 (h.n)^4) with h.n = |h| = 2 cos.
    let lobe = 1.0 / (PI * 0.01 * 4.0 * 40.0_f64.to_radians().cos().powi(2));
    for (f, c) in eval(model.as_ref(), wi, ws).into_iter().zip([0.2, 0.4, 0.8]) {
        near(f, c * 0.95 / PI + 0.05 * lobe, 1e-12);
    }
    assert!(!model.has_delta());
}

#[test]
fn trans_divides_the_light_as_its_arguments_say() {
    let (c, s, t, q) = ([0.9, 0.8, 0.7], 0.05, 0.6, 0.5);
    let model = made("trans", "", &[c[0], c[1], c[2], s, 0.2, t, q]);
    let back = eval(model.as_ref(), deg(0.0, 0.0), deg(110.0, 0.0));
    let front = eval(model.as_ref(), deg(0.0, 0.0), deg(89.0, 0.0));
    for k in 0..3 {
        near(back[k], c[k] * (1.0 - s) * t * (1.0 - q) / PI, 1e-6);
        near(front[k], c[k] * (1.0 - s) * (1.0 - t) / PI, 1e-6);
    }
    let through = eval(model.as_ref(), deg(0.0, 0.0), deg(180.0, 0.0));
    near(through[0] - back[0], c[0] * (1.0 - s) * t * q / (PI * 0.04), 1e-6);
}

#[test]
fn smooth_materials_follow_the_approximation_of_fresnel_above_the_threshold_only() {
    let cos = 60.0_f64.to_radians().cos();
    let f = (-5.85 * cos).exp() - 0.00287989916;
    let w = deg(60.0, 0.0);
    let plastic = made("plastic", "", &[0.2, 0.4, 0.8, 0.05, 0.0]);
    shares(plastic.as_ref(), w, REFLECTION)
        .into_iter()
        .for_each(|s| near(s, 0.05 + f * 0.95, 1e-15));
    let metal = made("metal", "", &[0.9, 0.6, 0.2, 0.8, 0.0]);
    for (s, c) in shares(metal.as_ref(), w, REFLECTION)
        .into_iter()
        .zip([0.9, 0.6, 0.2])
    {
        near(s, f + c * 0.8 * (1.0 - f), 1e-15);
    }
    let trans = made("trans", "", &[0.9, 0.8, 0.7, 0.05, 0.0, 0.6, 0.5]);
    for (s, c) in shares(trans.as_ref(), w, TRANSMISSION)
        .into_iter()
        .zip([0.9, 0.8, 0.7])
    {
        near(s, c * 0.3 * 0.95 * (1.0 - f), 1e-15);
    }
    let dull = made("plastic", "", &[0.2, 0.4, 0.8, 0.017, 0.0]);
    assert_eq!(shares(dull.as_ref(), w, REFLECTION), [0.017; 3]);
    near(eval(dull.as_ref(), w, w)[1], 0.4 * 0.983 / PI, 1e-15);
    let enter = |t: f64| 1.0 - ((-5.85 * t.to_radians().cos()).exp() - 0.00287989916);
    let found = eval(plastic.as_ref(), w, deg(80.0, 10.0))[2];
    near(found, 0.8 * 0.95 * enter(60.0) * enter(80.0) / PI, 1e-15);
}

#[test]
fn the_release_decides_the_constant_of_the_approximation() {
    near(Release::V6_1.fresnel(1.0), 0.0, 1e-9);
    near(
        Release::V6_0.fresnel(1.0),
        0.002_879_899_16 - 0.002_029_430_64,
        1e-9,
    );
    let plastic = RadianceMaterial::from(Plastic::new([0.5; 3], 0.05, 0.0).unwrap());
    let old = plastic.bsdf_of(Release::V6_0).unwrap();
    let new = plastic.bsdf_of("6.1".parse().unwrap()).unwrap();
    let difference = shares(old.as_ref(), deg(0.0, 0.0), REFLECTION)[0]
        - shares(new.as_ref(), deg(0.0, 0.0), REFLECTION)[0];
    near(difference, 0.95 * 8.504_685_2e-4, 1e-12);
    assert_eq!(
        "5.4".parse::<Release>().unwrap_err().to_string(),
        "release: found \"5.4\", allowed 6.0, 6.1"
    );
}

#[test]
fn glass_has_the_transmittances_of_the_manual_and_loses_nothing_when_clear() {
    let pane = |tn: f64| Glass {
        transmissivity: [tn; 3],
        refractive_index: None,
    };
    near(pane(0.96).transmittance(1.0)[0], 0.88, 2e-3);
    near(pane(0.96).reflectance(1.0)[0], 0.079, 1e-3);
    for theta in [0.0_f64, 30.0, 60.0, 85.0] {
        let cos = theta.to_radians().cos();
        near(
            pane(1.0).transmittance(cos)[0] + pane(1.0).reflectance(cos)[0],
            1.0,
            1e-14,
        );
        // An opaque pane reflects at its front face alone.
        let body = Dielectric::from_arguments(&[], &[1.0, 1.0, 1.0, 1.52, 0.0]).unwrap();
        near(
            pane(0.0).reflectance(cos)[0],
            body.reflectance(deg(theta, 0.0)),
            1e-14,
        );
        assert_eq!(pane(0.0).transmittance(cos)[0], 0.0);
    }
    let model = made("glass", "", &[0.96, 0.9, 0.5]);
    let mut s = [0.0; 3];
    assert_eq!(
        model.delta(deg(40.0, 10.0), TRANSMISSION, &mut s),
        Some(deg(40.0, 10.0).through())
    );
    assert_eq!(
        model.delta(Direction::from_unit(gonio_geom::DVec3::X), TRANSMISSION, &mut s),
        None
    );
}

#[test]
fn a_dielectric_refracts_by_snell_and_reflects_all_beyond_the_critical_angle() {
    let body = Dielectric::from_arguments(&[], &[0.9, 0.8, 0.5, 1.45, 25.0]).unwrap();
    near(body.index(), 1.5, 1e-15);
    near(body.reflectance(deg(0.0, 0.0)), 0.04, 1e-15);
    let w = deg(50.0, 30.0);
    let s = body.refracted(w).unwrap();
    near(s.theta().sin() * 1.5, 50.0_f64.to_radians().sin(), 1e-14);
    near(s.phi().to_degrees(), 210.0, 1e-9);
    assert_eq!(s.side(), Side::Back);
    // Back along the same way, with the same share.
    assert!(body.refracted(s).unwrap().angle_to(w) < 1e-9);
    near(body.reflectance(s), body.reflectance(w), 1e-14);
    // At Brewster's angle only one polarisation is reflected.
    let brewster = 1.5_f64.atan();
    let (ci, ct) = (brewster.cos(), brewster.sin());
    near(
        body.reflectance(Direction::from_spherical(brewster, 0.0)),
        0.5 * ((ci - 1.5 * ct) / (ci + 1.5 * ct)).powi(2),
        1e-14,
    );
    assert_eq!(body.refracted(deg(130.0, 0.0)), None);
    assert_eq!(body.reflectance(deg(130.0, 0.0)), 1.0);
    near(body.radiance_ratio(w) * body.radiance_ratio(s), 1.0, 1e-14);
    near(body.radiance_ratio(s), 2.25, 1e-14);
    near(body.internal_transmittance(2.0)[2], 0.25, 1e-15);
}

#[test]
fn a_mirror_is_black_on_its_back() {
    let mirror = RadianceMaterial::from(Mirror {
        color: [0.9, 0.8, 0.7],
        alternate: None,
    })
    .bsdf()
    .unwrap();
    assert_eq!(
        shares(mirror.as_ref(), deg(30.0, 0.0), REFLECTION),
        [0.9, 0.8, 0.7]
    );
    assert_eq!(shares(mirror.as_ref(), deg(150.0, 0.0), REFLECTION), [0.0; 3]);
    assert!(mirror.sample(deg(150.0, 0.0), [0.5; 3]).is_none());
    let s = mirror.sample(deg(30.0, 0.0), [0.5; 3]).unwrap();
    assert_eq!(
        (s.direction, s.weight, s.pdf),
        (deg(30.0, 0.0).mirror(), 0.9, 1.0)
    );
}

/// Evenly spread points of the unit cube: multiples of the powers of the root of `x^4 = x + 1`.
fn spread(n: u32) -> impl Iterator<Item = [f64; 3]> {
    const ROOT: f64 = 1.220_744_084_605_759_6;
    (0..n).map(|k| [1, 2, 3].map(|e| (0.5 + f64::from(k) * ROOT.powi(-e)).fract()))
}

#[test]
fn samples_of_every_material_return_its_albedo() {
    let n = 1 << 17;
    for (name, model) in all() {
        for theta in [5.0, 60.0, 150.0] {
            let w = deg(theta, 25.0);
            let weights = spread(n).filter_map(|u| Some(model.sample(w, u)?.weight));
            let mean = weights.sum::<f64>() / f64::from(n);
            let albedo: f64 = [REFLECTION, TRANSMISSION]
                .map(|c| directional_albedo(model.as_ref(), w, c, 0))
                .iter()
                .sum();
            assert!((mean - albedo).abs() < 1e-3, "{name} {theta}: {mean} {albedo}");
        }
    }
}

#[test]
fn densities_integrate_to_the_share_of_samples_that_have_one() {
    let n = 1 << 17;
    for (name, model) in all() {
        for theta in [5.0, 60.0] {
            let w = deg(theta, 25.0);
            let integral: f64 = [Side::Front, Side::Back]
                .map(|side| hemispherical_integral(w, side, |s| model.pdf(w, s)).value)
                .iter()
                .sum();
            let drawn = spread(n).filter_map(|u| model.sample(w, u));
            let broad = drawn.filter(|s| s.lobe != crate::Lobe::Delta).count();
            let share = broad as f64 / f64::from(n);
            assert!(
                (share - integral).abs() < 1e-3,
                "{name} {theta}: {share} {integral}"
            );
        }
    }
}

#[test]
fn a_standing_u_makes_the_lobe_round() {
    let standing = made("metal2", "0 0 1 .", &[0.5, 0.4, 0.3, 0.9, 0.1, 0.3]);
    let round = RadianceMaterial::from(Metal::new([0.5, 0.4, 0.3], 0.9, 0.05_f64.sqrt()).unwrap())
        .bsdf()
        .unwrap();
    assert!(standing.properties().isotropic);
    let (a, b) = (deg(30.0, 0.0), deg(50.0, 150.0));
    near(
        eval(standing.as_ref(), a, b)[0],
        eval(round.as_ref(), a, b)[0],
        1e-12,
    );
}

#[test]
fn the_orientation_turns_the_lobe() {
    let along = made("metal2", "1 0 0 .", &[0.5, 0.4, 0.3, 0.9, 0.05, 0.3]);
    let turned = made("metal2", "1 0 0 . -rz 30", &[0.5, 0.4, 0.3, 0.9, 0.05, 0.3]);
    let (a, b) = (deg(30.0, 0.0), deg(50.0, 150.0));
    near(
        eval(along.as_ref(), a, b)[0],
        eval(turned.as_ref(), deg(30.0, 30.0), deg(50.0, 180.0))[0],
        1e-12,
    );
    assert!(!along.properties().isotropic);
}

#[test]
fn a_black_material_and_parameters_out_of_range_are_handled() {
    let black = RadianceMaterial::from(Trans {
        color: [0.0; 3],
        specularity: 0.0,
        roughness: 0.0,
        transmissivity: 1.0,
        transmitted_specularity: 1.0,
    });
    assert_eq!(
        eval(black.bsdf().unwrap().as_ref(), deg(1.0, 0.0), deg(1.0, 0.0)),
        [0.0; 3]
    );
    let mut bad = Plastic::new([0.5; 3], 0.05, 0.1).unwrap();
    bad.color[1] = 1.2;
    let e = RadianceMaterial::from(bad).bsdf().err().unwrap();
    assert_eq!(e.to_string(), "green: found 1.2, allowed 0 to 1");
}
