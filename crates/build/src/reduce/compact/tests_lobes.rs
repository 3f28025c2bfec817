//! Lobes about the incidence, and light that leaves unscattered.

use super::tests::{FRONT, Formula, errors, front, radiance};
use super::*;
use gonio_bsdf::compact::Symmetry;
use gonio_bsdf::{Channel, Properties};
use gonio_geom::{DVec3, Direction};
use std::f64::consts::PI;

#[test]
fn a_lobe_about_the_incidence_is_part_of_the_base_and_drawn() {
    let square = |v: DVec3| v.length_squared();
    let beads = Formula {
        isotropic: true,
        f: move |i: DVec3, s: DVec3| {
            let h = (i + s) / (i + s).length();
            let facets = (-(1.0 / (h.z * h.z) - 1.0) / 0.0225).exp();
            0.1 / PI + 0.8 * facets + 3.0 * (-square(i - s) / 0.01).exp() * 2.0 / (i.z + s.z)
        },
    };
    let reduced = to_compact(&beads, &front()).unwrap();
    let part = reduced.model.parts().get(FRONT.0, FRONT.1).unwrap();
    let names: Vec<&str> = part.base.iter().map(|l| l.model.as_str()).collect();
    assert!(names.iter().any(|n| n.ends_with("retro-lobe")), "{names:?}");
    let (mean, most) = errors(&beads, &reduced.model, FRONT.1, &[0.0, 50.0], 0.06);
    assert!(mean < 0.01 && most < 0.03, "{mean} {most}");
    assert!(part.bytes_per_channel() <= 16_000);
    // what is drawn stands about the incidence as often as the light does
    let wi = Direction::from_degrees(50.0, 20.0);
    let (mut light, mut near) = (0.0, 0.0);
    for k in 0..60_000u32 {
        let t = f64::from(k);
        let u = [0.819_172_513_4, 0.671_043_606_7, 0.549_700_477_9].map(|a: f64| (a * t).fract());
        let Some(s) = reduced.model.sample(wi, u) else {
            continue;
        };
        assert!(s.weight < 20.0, "{s:?}");
        light += s.weight;
        if s.direction.angle_to(wi) < 0.2 {
            near += s.weight;
        }
    }
    let (mut total, mut about) = (0.0, 0.0);
    for k in 0..400_000u32 {
        let t = f64::from(k) + 0.5;
        let z = (t * 0.754_877_666_25).fract();
        let (r, phi) = ((1.0 - z * z).sqrt(), 2.0 * PI * (t * 0.569_840_290_998).fract());
        let s = Direction::from_unit(DVec3::new(r * phi.cos(), r * phi.sin(), z));
        let f = beads.eval_first(wi, s) * z;
        total += f;
        about += if s.angle_to(wi) < 0.2 { f } else { 0.0 };
    }
    let (found, wanted) = (near / light, about / total);
    assert!((found - wanted).abs() < 0.02 && wanted > 0.1, "{found} {wanted}");
}

#[test]
fn two_crossed_lobes_and_one_about_the_incidence_come_within_two_percent() {
    let ward = |x: f64, y: f64, phi: f64| {
        move |i: DVec3, s: DVec3| {
            let (sin, cos) = phi.sin_cos();
            let h = i + s;
            let (hx, hy) = (cos * h.x + sin * h.y, cos * h.y - sin * h.x);
            let slopes = ((hx / x).powi(2) + (hy / y).powi(2)) / (h.z * h.z);
            (-slopes).exp() * h.length_squared() / (PI * x * y * h.z.powi(4))
        }
    };
    let (first, second) = (ward(0.06, 0.25, 0.35), ward(0.12, 0.3, -0.6));
    let model = Formula {
        isotropic: false,
        f: move |i: DVec3, s: DVec3| {
            // not the shape of any lobe of a base
            let retro = (-((i - s).length() / 0.15).powf(1.6)).exp() * 2.0 / (i.z + s.z);
            0.15 / PI + 0.12 * first(i, s) + 0.15 * second(i, s) + 0.7 * retro
        },
    };
    let reduced = to_compact(
        &model,
        &CompactOptions {
            target: 0.015,
            ..front()
        },
    )
    .unwrap();
    let part = reduced.model.parts().get(FRONT.0, FRONT.1).unwrap();
    assert_eq!(part.frame.symmetry, Symmetry::HalfTurn);
    // the lobe about the incidence ends in a point
    let (mean, _) = errors(&model, &reduced.model, FRONT.1, &[0.0, 40.0, 80.0, 130.0], 0.12);
    assert!(
        mean < 0.02 && part.bytes_per_channel() <= 400_000,
        "{mean} {}",
        part.bytes_per_channel()
    );
}

#[test]
fn mirrored_and_straight_light_is_kept_as_shares_beside_the_scattered() {
    // trans: diffuse on both sides, a mirrored and a straight part
    let trans = radiance("trans", &[0.9, 0.4, 0.8, 0.1, 0.0, 0.6, 0.7]);
    let reduced = to_compact(trans.as_ref(), &CompactOptions::default()).unwrap();
    assert!(reduced.model.has_delta());
    let n = trans.channels().len();
    for theta in [0.0, 12.0, 40.0, 66.0, 80.0, 100.0, 150.0] {
        let w = Direction::from_degrees(theta, 30.0);
        for component in [Component::Reflection, Component::Transmission] {
            let (mut wanted, mut found) = (vec![0.0; n], vec![0.0; n]);
            let to = trans.delta(w, component, &mut wanted);
            let own = reduced.model.delta(w, component, &mut found);
            assert_eq!(to.is_some(), own.is_some(), "{theta} {component}");
            if let (Some(a), Some(b)) = (to, own) {
                assert!(a.angle_to(b) < 1e-9);
            }
            for (a, b) in wanted.iter().zip(&found) {
                assert!((a - b).abs() < 0.006, "{theta} {component}: {wanted:?} {found:?}");
            }
        }
    }
    assert!(reduced.ideal_error.iter().all(|(.., e)| *e < 0.006));
    // a mirror alone has no table
    let mirror = radiance("mirror", &[0.8, 0.7, 0.6]);
    let reduced = to_compact(mirror.as_ref(), &CompactOptions::default()).unwrap();
    assert!(reduced.model.parts().is_empty() && !reduced.model.ideal().is_empty());
    let wi = Direction::from_degrees(35.0, 10.0);
    let s = reduced.model.sample(wi, [0.3, 0.4, 0.5]).unwrap();
    assert!(s.direction.angle_to(wi.mirror()) < 1e-9 && (s.weight - 0.8).abs() < 1e-3 && s.pdf == 1.0);
    assert!((reduced.max_albedo - 0.8).abs() < 1e-3);
}

#[test]
fn shares_that_depend_on_azimuth_are_kept_in_what_symmetry_they_have() {
    struct Screen(f64);
    impl Bsdf for Screen {
        fn channels(&self) -> &[Channel] {
            &[Channel::Photopic]
        }
        fn properties(&self) -> Properties {
            Properties {
                reciprocal: false,
                energy_conserving: true,
                isotropic: false,
            }
        }
        fn eval(&self, _: Direction, _: Direction, f: &mut [f64]) {
            f[0] = 0.0;
        }
        fn delta(&self, w: Direction, c: Component, shares: &mut [f64]) -> Option<Direction> {
            shares[0] = 0.0;
            if c == Component::Reflection || w.cos_theta() <= 0.0 {
                return None;
            }
            let v = w.vec();
            shares[0] = 0.3 * (-2.0 * v.x * v.x - 0.5 * v.y * v.y).exp() + 0.1 * v.x * (v.y + self.0);
            shares[0] = shares[0].max(0.0);
            (shares[0] > 0.0).then(|| w.through())
        }
    }
    for (shift, wanted) in [(0.0, Symmetry::HalfTurn), (0.4, Symmetry::Anisotropic)] {
        let model = Screen(shift);
        let options = CompactOptions {
            target: 0.01,
            ..CompactOptions::default()
        };
        let reduced = to_compact(&model, &options).unwrap();
        let part = reduced
            .model
            .ideal()
            .get(Side::Front, Component::Transmission)
            .unwrap();
        assert_eq!(part.symmetry, wanted);
        let (mut a, mut b) = ([0.0], [0.0]);
        for k in 0..500 {
            let t = f64::from(k);
            let w = Direction::from_degrees(85.0 * (0.37 * t).fract(), 360.0 * (0.611 * t).fract());
            model.delta(w, Component::Transmission, &mut a);
            reduced.model.delta(w, Component::Transmission, &mut b);
            assert!((a[0] - b[0]).abs() < 0.006, "{wanted:?} {a:?} {b:?}");
        }
    }
}
