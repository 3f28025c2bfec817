use std::f64::consts::PI;

use gonio_bsdf::analytic::{Sum, family};
use gonio_bsdf::compact::Symmetry;
use gonio_bsdf::{Channel, Properties, directional_albedo};
use gonio_geom::{DVec3, Direction};

use super::super::compare;
use super::*;

pub(super) const FRONT: (Side, Component) = (Side::Front, Component::Reflection);

fn part(name: &str, values: &[f64]) -> Box<dyn Bsdf> {
    let family = family(name).unwrap();
    family.model(&[(Channel::Photopic, values.to_vec())]).unwrap()
}

pub(super) fn radiance(kind: &str, reals: &[f64]) -> Box<dyn Bsdf> {
    gonio_bsdf::RadianceMaterial::from_arguments(kind, &[], reals)
        .unwrap()
        .unwrap()
        .bsdf()
        .unwrap()
}

fn sum(parts: &[(&str, &[f64])]) -> Sum {
    Sum::new(parts.iter().map(|(name, p)| part(name, p)).collect()).unwrap()
}

/// Front reflection alone.
pub(super) fn front() -> CompactOptions {
    CompactOptions {
        components: Some(vec![FRONT]),
        ..CompactOptions::default()
    }
}

/// Any isotropic or anisotropic formula of the front's reflection.
pub(super) struct Formula<F> {
    pub(super) isotropic: bool,
    pub(super) f: F,
}

impl<F: Fn(DVec3, DVec3) -> f64 + Send + Sync> Bsdf for Formula<F> {
    fn channels(&self) -> &[Channel] {
        &[Channel::Photopic]
    }

    fn properties(&self) -> Properties {
        Properties {
            reciprocal: false,
            energy_conserving: true,
            isotropic: self.isotropic,
        }
    }

    fn eval(&self, wi: Direction, ws: Direction, f: &mut [f64]) {
        let lit = wi.cos_theta() > 0.0 && ws.cos_theta() > 0.0;
        f[0] = if lit { (self.f)(wi.vec(), ws.vec()) } else { 0.0 };
    }
}

/// Mean and largest relative L1 error at incidences that no table was made for; albedo and peak are within 2 % and `peak`.
pub(super) fn errors(
    model: &dyn Bsdf,
    reduced: &dyn Bsdf,
    component: Component,
    phis: &[f64],
    peak: f64,
) -> (f64, f64) {
    let (mut most, mut total, mut n) = (0.0f64, 0.0, 0.0);
    for theta in [0.0, 7.0, 22.0, 37.0, 52.0, 67.0, 75.0] {
        for phi in phis {
            let wi = Direction::from_degrees(theta, *phi);
            let found = compare((model, 0), (reduced, 0), wi, component).unwrap();
            most = most.max(found.rel_l1);
            total += found.rel_l1;
            n += 1.0;
            let [a, b] = found.albedo;
            assert!((b / a - 1.0).abs() < 0.02, "{theta} {phi}: albedo {a} {b}");
            let [a, b] = found.peak;
            assert!((b / a - 1.0).abs() < peak, "{theta} {phi}: peak {a} {b}");
        }
    }
    (total / n, most)
}

fn judged(name: &str, model: &dyn Bsdf, phis: &[f64], most_bytes: usize) -> Symmetry {
    let reduced = to_compact(model, &front()).unwrap();
    let part = reduced.model.parts().get(FRONT.0, FRONT.1).unwrap();
    let stated = reduced.error.get(FRONT.0, FRONT.1).unwrap()[0];
    let (mean, most) = errors(model, &reduced.model, FRONT.1, phis, 0.06);
    let (shape, bytes) = (part.frame.shape, part.bytes_per_channel());
    assert!(
        mean < 0.01 && most < 0.03,
        "{name} {shape:?}: mean {mean}, largest {most}"
    );
    assert!(
        stated <= 0.0055 && stated > 0.2 * mean,
        "{name}: stated {stated}, found {mean}"
    );
    assert!(bytes <= most_bytes, "{name}: {bytes} bytes");
    part.frame.symmetry
}

#[test]
fn isotropic_materials_come_within_a_percent_in_fewer_than_16_kilobytes() {
    type Part<'a> = (&'a str, &'a [f64]);
    let materials: [(&str, &[Part<'_>]); 6] = [
        ("coated", &[("oren-nayar", &[0.35, 0.4]), ("ggx", &[0.04, 0.2])]),
        ("metal", &[("ggx-conductor", &[1.2, 7.0, 0.06])]),
        ("satin", &[("lambert", &[0.1]), ("beckmann", &[0.04, 0.35])]),
        ("polished", &[("lambert", &[0.1]), ("abg", &[0.05, 0.0016, 2.0])]),
        ("matte", &[("oren-nayar", &[0.8, 0.5])]),
        (
            "two lobes",
            &[
                ("lambert", &[0.2]),
                ("beckmann", &[0.1, 0.02]),
                ("ward", &[0.3, 0.2]),
            ],
        ),
    ];
    for (name, parts) in materials {
        let symmetry = judged(name, &sum(parts), &[0.0, 40.0], 16_000);
        assert_eq!(symmetry, Symmetry::Isotropic);
    }
}

#[test]
fn a_lobe_away_from_the_mirror_direction_is_kept() {
    let model = Formula {
        isotropic: true,
        f: |i: DVec3, s: DVec3| {
            let tilt = i.x.hypot(i.y);
            let sin = (0.75 * tilt + 0.15).min(0.99);
            let cos = if tilt > 1e-12 {
                [-i.x / tilt, -i.y / tilt]
            } else {
                [1.0, 0.0]
            };
            let axis = DVec3::new(sin * cos[0], sin * cos[1], (1.0 - sin * sin).sqrt());
            0.05 / PI + 0.6 * ((2.0 * axis.dot(s) - 2.0) / 0.0144).exp() / (PI * 0.0144) / s.z.max(0.05)
        },
    };
    let reduced = to_compact(&model, &front()).unwrap();
    let (mean, _) = errors_from(&model, &reduced.model, &[20.0, 35.0, 50.0, 65.0]);
    assert!(mean < 0.02, "{mean}");
}

fn errors_from(model: &dyn Bsdf, reduced: &dyn Bsdf, thetas: &[f64]) -> (f64, f64) {
    let each: Vec<f64> = thetas
        .iter()
        .map(|t| {
            let wi = Direction::from_degrees(*t, 0.0);
            compare((model, 0), (reduced, 0), wi, FRONT.1).unwrap().rel_l1
        })
        .collect();
    let most = each.iter().copied().fold(0.0, f64::max);
    (each.iter().sum::<f64>() / each.len() as f64, most)
}

#[test]
fn anisotropic_materials_come_within_a_percent_in_fewer_than_400_kilobytes() {
    let brushed = sum(&[
        ("lambert", &[0.1]),
        ("beckmann-anisotropic", &[0.5, 0.02, 0.4, 0.0]),
    ]);
    let symmetry = judged("brushed", &brushed, &[0.0, 33.0, 101.0], 380_000);
    assert_eq!(symmetry, Symmetry::Quadrilateral);
    let crossed = sum(&[
        ("lambert", &[0.1]),
        ("ward-gmd-anisotropic", &[0.2, 0.08, 0.25, 0.0]),
        ("ward-gmd-anisotropic", &[0.2, 0.05, 0.15, 0.7]),
    ]);
    let symmetry = judged("crossed", &crossed, &[0.0, 33.0, 101.0], 380_000);
    assert_eq!(symmetry, Symmetry::HalfTurn);
}

#[test]
fn handedness_of_an_isotropic_material_survives() {
    let handed = Formula {
        isotropic: true,
        f: |i: DVec3, s: DVec3| (0.4 + 0.3 * (i.x * s.y - i.y * s.x)) / PI,
    };
    let reduced = to_compact(&handed, &front()).unwrap();
    let frame = reduced.model.parts().get(FRONT.0, FRONT.1).unwrap().frame;
    assert_eq!(frame.symmetry, Symmetry::IsotropicChiral);
    let wi = Direction::from_degrees(60.0, 10.0);
    let values = [80.0, -60.0].map(|phi| reduced.model.eval_first(wi, Direction::from_degrees(50.0, phi)));
    let wanted = [80.0, -60.0].map(|phi| handed.eval_first(wi, Direction::from_degrees(50.0, phi)));
    for (found, wanted) in values.iter().zip(wanted) {
        assert!((found / wanted - 1.0).abs() < 0.03, "{found} {wanted}");
    }
}

#[test]
fn every_component_of_a_panel_that_differs_by_side_is_kept_apart() {
    struct Panel(Sum, Sum);
    impl Bsdf for Panel {
        fn channels(&self) -> &[Channel] {
            self.0.channels()
        }
        fn properties(&self) -> Properties {
            Properties {
                energy_conserving: false,
                ..self.0.properties()
            }
        }
        fn eval(&self, wi: Direction, ws: Direction, f: &mut [f64]) {
            if wi.side() == Side::Front {
                self.0.eval(wi, ws, f)
            } else {
                self.1.eval(wi, ws, f)
            }
        }
    }
    let panel = Panel(
        sum(&[
            ("lambert", &[0.1]),
            ("ggx", &[0.04, 0.1]),
            ("lambert-transmission", &[0.05]),
            ("bounded-transmission-lobe", &[0.15, 0.15]),
        ]),
        sum(&[("lambert", &[0.5]), ("ggx", &[0.04, 0.3])]),
    );
    let reduced = to_compact(&panel, &CompactOptions::default()).unwrap();
    let keys: Vec<_> = reduced.model.parts().iter().map(|(s, c, _)| (s, c)).collect();
    assert_eq!(
        keys,
        [
            (Side::Front, Component::Reflection),
            (Side::Front, Component::Transmission),
            (Side::Back, Component::Reflection),
        ]
    );
    for (side, component) in keys {
        for theta in [10.0, 45.0, 70.0] {
            let wi = Direction::from_degrees(if side == Side::Back { 180.0 - theta } else { theta }, 20.0);
            let e = compare((&panel, 0), (&reduced.model, 0), wi, component)
                .unwrap()
                .rel_l1;
            assert!(e < 0.02, "{side} {component} {theta}: {e}");
        }
    }
    let mean: f64 = (0..40_000u32)
        .filter_map(|k| {
            let t = f64::from(k);
            let u = [0.819_172_513_4, 0.671_043_606_7, 0.549_700_477_9].map(|a: f64| (a * t).fract());
            reduced.model.sample(Direction::from_degrees(45.0, 20.0), u)
        })
        .map(|s| s.weight / 40_000.0)
        .sum();
    let wi = Direction::from_degrees(45.0, 20.0);
    let wanted: f64 = [Component::Reflection, Component::Transmission]
        .map(|c| directional_albedo(&panel, wi, c, 0))
        .iter()
        .sum();
    assert!((mean / wanted - 1.0).abs() < 0.02, "{mean} {wanted}");
    assert!(reduced.max_albedo < 1.0 && reduced.model.properties().energy_conserving);
}

#[test]
fn colours_share_lobes_and_keep_their_ratios() {
    let coloured = |name: &str, values: [[f64; 2]; 3]| {
        let channels = [Channel::Red, Channel::Green, Channel::Blue];
        let n = family(name).unwrap().info().parameters.len();
        let p: Vec<_> = channels
            .into_iter()
            .zip(values.map(|v| v[..n].to_vec()))
            .collect();
        family(name).unwrap().model(&p).unwrap()
    };
    let model = Sum::new(vec![
        coloured("lambert", [[0.5, 0.0], [0.2, 0.0], [0.05, 0.0]]),
        coloured("beckmann", [[0.05, 0.15], [0.05, 0.15], [0.05, 0.15]]),
    ])
    .unwrap();
    let reduced = to_compact(&model, &front()).unwrap();
    for theta in [15.0, 60.0] {
        let wi = Direction::from_degrees(theta, 0.0);
        for channel in 0..3 {
            let e = compare((&model, channel), (&reduced.model, channel), wi, FRONT.1).unwrap();
            assert!(e.rel_l1 < 0.015, "{theta} {channel}: {e:?}");
        }
    }
    let one = to_compact(
        &model,
        &CompactOptions {
            channels: Some(vec![2]),
            ..front()
        },
    )
    .unwrap();
    assert_eq!(one.model.channels(), [Channel::Blue]);
    let wi = Direction::from_degrees(30.0, 0.0);
    assert!(compare((&model, 2), (&one.model, 0), wi, FRONT.1).unwrap().rel_l1 < 0.015);
}

#[test]
fn a_byte_budget_is_kept_and_costs_precision() {
    let model = sum(&[("oren-nayar", &[0.5, 0.5]), ("beckmann", &[0.3, 0.1])]);
    let with = |max_bytes: usize, bits: Option<u32>| {
        let options = CompactOptions {
            max_bytes: Some(max_bytes),
            bits,
            target: 1e-3,
            ..front()
        };
        let reduced = to_compact(&model, &options).unwrap();
        let part = reduced.model.parts().get(FRONT.0, FRONT.1).unwrap();
        assert!(part.bytes_per_channel() <= max_bytes);
        let most = part.table.codes().iter().map(|c| c.unsigned_abs()).max().unwrap();
        // every range is used to its ends
        assert!(
            bits.is_none_or(|b| u32::from(most) == (1 << (b - 1)) - 1),
            "{bits:?} {most}"
        );
        reduced.error.get(FRONT.0, FRONT.1).unwrap()[0]
    };
    let (small, large) = (with(1000, Some(8)), with(16_000, None));
    assert!(large < 0.5 * small && small < 0.2, "{small} {large}");
}

#[test]
fn ideal_parts_and_options_out_of_range_are_refused() {
    let model = sum(&[("lambert", &[0.5])]);
    let refused = |options: CompactOptions| match to_compact(&model, &options) {
        Ok(_) => panic!("accepted"),
        Err(BsdfError::Domain { field, .. }) => field,
    };
    let base = CompactOptions::default;
    assert_eq!(
        refused(CompactOptions {
            target: 0.0,
            ..base()
        }),
        "target"
    );
    assert_eq!(
        refused(CompactOptions {
            target: f64::NAN,
            ..base()
        }),
        "target"
    );
    assert_eq!(
        refused(CompactOptions {
            max_bytes: Some(10),
            ..base()
        }),
        "max_bytes"
    );
    assert_eq!(
        refused(CompactOptions {
            bits: Some(12),
            ..base()
        }),
        "bits"
    );
    assert_eq!(
        refused(CompactOptions {
            channels: Some(vec![1]),
            ..base()
        }),
        "channel"
    );
    assert_eq!(
        refused(CompactOptions {
            channels: Some(vec![]),
            ..base()
        }),
        "channels"
    );
    assert_eq!(
        refused(CompactOptions {
            components: Some(vec![]),
            ..base()
        }),
        "components"
    );
    let glass = radiance("dielectric", &[0.8, 0.8, 0.8, 1.5, 0.0]);
    match to_compact(glass.as_ref(), &base()) {
        Err(BsdfError::Domain { found, .. }) => assert!(found.contains("bends"), "{found}"),
        _ => panic!("accepted"),
    }
}
