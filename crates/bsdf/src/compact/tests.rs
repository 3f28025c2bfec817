use gonio_geom::{Component, Direction, Side};

use super::*;
use crate::analytic::family;

/// A diffuse part and a lobe about the mirror or the unbent direction; the logarithm of the ratio is `log(node)`.
fn part(
    component: Component,
    symmetry: Symmetry,
    channels: usize,
    bits: u32,
    log: impl Fn(usize) -> f64,
) -> CompactPart {
    let (diffuse, lobe) = match component {
        Component::Reflection => ("lambert", "ward-gmd"),
        Component::Transmission => ("lambert-transmission", "transmission-lobe"),
    };
    let isotropic = symmetry.is_isotropic();
    let frame = Frame {
        symmetry,
        width: if isotropic { [0.1; 2] } else { [0.1, 0.2] },
        phi_x: if isotropic { 0.0 } else { 0.4 },
        shape: [6, if isotropic { 1 } else { 4 }, 7, 8],
    };
    let values: Vec<f64> = (0..frame.len() * channels).map(log).collect();
    CompactPart {
        base: vec![
            BaseLobe {
                model: diffuse.into(),
                parameters: vec![vec![0.3]; channels],
                weight: 0.3,
            },
            BaseLobe {
                model: lobe.into(),
                parameters: vec![vec![0.2, 0.1]; channels],
                weight: 0.2,
            },
        ],
        frame,
        table: Quantised::of(&frame, &values, bits).unwrap(),
    }
}

fn wavy(k: usize) -> f64 {
    (0.37 * k as f64).sin()
}

fn three() -> Vec<Channel> {
    vec![Channel::Red, Channel::Green, Channel::Blue]
}

fn model(symmetry: Symmetry, channels: Vec<Channel>) -> Compact {
    let mut parts = FourComponents::default();
    for (side, component) in [
        (Side::Front, Component::Reflection),
        (Side::Front, Component::Transmission),
        (Side::Back, Component::Transmission),
    ] {
        parts.set(
            side,
            component,
            Some(part(component, symmetry, channels.len(), 8, wavy)),
        );
    }
    Compact::new(channels, parts, false).unwrap()
}

fn pair(k: u32) -> (Direction, Direction) {
    let t = f64::from(k);
    let wi = Direction::from_degrees(
        1.0 + 177.0 * (t * 0.819_172_513_4).fract(),
        360.0 * (t * 0.671_043_606_7).fract(),
    );
    // most of them about the mirror and the unbent direction
    let ws = match k % 3 {
        0 => Direction::from_degrees(
            180.0 * (t * 0.549_700_477_9).fract(),
            360.0 * (t * 0.450_2).fract(),
        ),
        1 => wi.mirror().rotated(0.1 * (t * 0.549_7).fract()),
        _ => wi.through().rotated(0.1 * (t * 0.549_7).fract()),
    };
    (wi, ws)
}

#[test]
fn an_even_table_scales_the_base() {
    let channels = vec![Channel::Photopic];
    let mut parts = FourComponents::default();
    parts.set(
        Side::Front,
        Component::Reflection,
        Some(part(Component::Reflection, Symmetry::Isotropic, 1, 16, |_| 0.5)),
    );
    let compact = Compact::new(channels, parts, true).unwrap();
    let of = |name: &str, p: &[f64]| {
        family(name)
            .unwrap()
            .model(&[(Channel::Photopic, p.to_vec())])
            .unwrap()
    };
    let (diffuse, lobe) = (of("lambert", &[0.3]), of("ward-gmd", &[0.2, 0.1]));
    let mut lit = 0;
    for k in 0..3000 {
        let (wi, ws) = pair(k);
        let front = wi.side() == Side::Front && ws.side() == Side::Front;
        let wanted = (diffuse.eval_first(wi, ws) + lobe.eval_first(wi, ws)) * 0.5_f64.exp();
        let wanted = if front { wanted } else { 0.0 };
        let found = compact.eval_first(wi, ws);
        assert!((found - wanted).abs() <= 1e-6 * wanted, "{found} {wanted}");
        lit += usize::from(found > 0.0);
    }
    assert!(lit > 500, "{lit}");
}

#[test]
fn values_at_the_nodes_are_the_quantised_ones_within_half_a_step() {
    for (symmetry, _) in Symmetry::NAMES {
        for bits in [8, 16] {
            let part = part(Component::Reflection, symmetry, 1, bits, wavy);
            let (frame, step) = (part.frame, part.table.step().to_vec());
            let mut parts = FourComponents::default();
            parts.set(Side::Front, Component::Reflection, Some(part.clone()));
            let mut even = part;
            even.table = Quantised::of(&frame, &vec![0.0; frame.len()], 8).unwrap();
            let mut flat = FourComponents::default();
            flat.set(Side::Front, Component::Reflection, Some(even));
            let channels = vec![Channel::Photopic];
            let (model, base) = (
                Compact::new(channels.clone(), parts, false).unwrap(),
                Compact::new(channels, flat, false).unwrap(),
            );
            let [n0, n1, n2, n3] = frame.shape;
            let density = frame.density();
            let mut seen = 0;
            for k in 0..frame.len() {
                let node = [k / (n1 * n2 * n3), k / (n2 * n3) % n1, k / n3 % n2, k % n3];
                let at = [0, 1, 2, 3].map(|a| {
                    if density[a] > 0.0 {
                        node[a] as f64 / density[a]
                    } else {
                        0.0
                    }
                });
                // at u = 0 the azimuth has no meaning, at x = 0 that of the incidence has none; on a mirror plane a pair is
                // its own image, and this table answers either half; so are ends half a turn apart
                let mirrored = matches!(
                    symmetry,
                    Symmetry::Quadrilateral | Symmetry::Bilateral | Symmetry::HalfTurn
                );
                let met = node[0] > 0 && node[2] > 0 && !(mirrored && (node[1] == 0 || node[1] + 1 == n1));
                let Some((wi, ws, _)) = frame.pair(at).filter(|_| met) else {
                    continue;
                };
                seen += 1;
                let found = (model.eval_first(wi, ws) / base.eval_first(wi, ws)).ln();
                let error = (found - wavy(k)).abs();
                let allowed = 0.51 * f64::from(step[node[0]]) + 1e-4;
                assert!(
                    error <= allowed,
                    "{symmetry:?} {bits} {node:?}: {error} {allowed}"
                );
            }
            assert!(seen * 6 > frame.len(), "{seen} of {n0}x{n1}x{n2}x{n3}");
        }
    }
}

#[test]
fn single_precision_batches_agree_with_pairs_one_by_one() {
    for (symmetry, _) in Symmetry::NAMES {
        for channels in [
            vec![Channel::Photopic],
            three(),
            (0..6)
                .map(|k| Channel::Wavelength(400.0 + f64::from(k)))
                .collect(),
        ] {
            let model = model(symmetry, channels.clone());
            let pairs: Vec<_> = (0..2500).map(pair).collect();
            let column = |get: fn(&(Direction, Direction)) -> Direction| {
                [0, 1, 2].map(|k| {
                    pairs
                        .iter()
                        .map(|p| get(p).vec().to_array()[k] as f32)
                        .collect::<Vec<_>>()
                })
            };
            let (wi, ws) = (column(|p| p.0), column(|p| p.1));
            let mut rows = vec![vec![f32::NAN; pairs.len()]; channels.len()];
            let mut views: Vec<&mut [f32]> = rows.iter_mut().map(|r| &mut r[..]).collect();
            model.eval_f32(
                Directions::Each(wi.each_ref().map(|c| &c[..])),
                Directions::Each(ws.each_ref().map(|c| &c[..])),
                &mut views,
            );
            let mut f = vec![0.0; channels.len()];
            let mut lit = 0;
            for j in 0..pairs.len() {
                let vector = |c: &[Vec<f32>; 3]| [0, 1, 2].map(|k| f64::from(c[k][j]));
                let same = |c: &[Vec<f32>; 3]| Direction::new(vector(c).into()).unwrap();
                model.eval(same(&wi), same(&ws), &mut f);
                for (row, f) in rows.iter().zip(&f) {
                    let found = f64::from(row[j]);
                    assert!(
                        (found - f).abs() <= 2e-4 * f,
                        "{symmetry:?} pair {j}: {found} {f}"
                    );
                }
                lit += usize::from(f[0] > 0.0);
            }
            assert!(lit > 1000, "{lit}");
        }
    }
}

#[test]
fn weights_are_values_over_the_density_and_bounded() {
    for symmetry in [Symmetry::Isotropic, Symmetry::Anisotropic] {
        let model = model(symmetry, three());
        for theta in [10.0, 70.0, 140.0] {
            let w = Direction::from_degrees(theta, 25.0);
            let mut drawn = 0;
            for k in 0..5000 {
                let t = f64::from(k);
                let u = [0.819_172_513_4, 0.671_043_606_7, 0.549_700_477_9].map(|a: f64| (a * t).fract());
                let Some(s) = model.sample(w, u) else { continue };
                drawn += 1;
                let pdf = model.pdf(w, s.direction);
                let f = model.eval_first(w, s.direction) * s.direction.cos_theta().abs();
                assert!((s.pdf - pdf).abs() <= 1e-12 * pdf && (s.weight - f / pdf).abs() <= 1e-12 * s.weight);
                // the ratio is below e, the base below five times its density
                assert!(s.weight < 15.0, "{s:?}");
            }
            assert!(drawn > 3000, "{drawn}");
        }
    }
}

#[test]
fn nothing_scatters_on_the_horizon_or_into_absent_components() {
    let model = model(Symmetry::Isotropic, vec![Channel::Photopic]);
    let (front, back) = (
        Direction::from_degrees(30.0, 0.0),
        Direction::from_degrees(150.0, 0.0),
    );
    let horizon = Direction::from_unit(gonio_geom::DVec3::X);
    assert_eq!(model.eval_first(front, horizon), 0.0);
    assert_eq!(model.eval_first(horizon, front), 0.0);
    assert_eq!(model.eval_first(back, back), 0.0);
    assert!(model.eval_first(back, front) > 0.0 && model.sample(horizon, [0.5; 3]).is_none());
}

#[test]
fn what_does_not_fit_together_is_refused_by_name() {
    let good = || part(Component::Reflection, Symmetry::Isotropic, 1, 8, wavy);
    let refused = |change: &dyn Fn(&mut CompactPart)| {
        let mut part = good();
        change(&mut part);
        let mut parts = FourComponents::default();
        parts.set(Side::Front, Component::Reflection, Some(part));
        match Compact::new(vec![Channel::Photopic], parts, true) {
            Ok(_) => panic!("accepted"),
            Err(BsdfError::Domain { field, .. }) => field,
        }
    };
    assert_eq!(refused(&|p| p.frame.shape[0] = 5), "codes");
    assert_eq!(refused(&|p| p.frame.shape[1] = 2), "shape");
    assert_eq!(refused(&|p| p.frame.width = [0.1, 0.2]), "width");
    assert_eq!(
        refused(&|p| p.base[0].model = "lambert-transmission".into()),
        "base"
    );
    assert_eq!(refused(&|p| p.base[0].model = "nothing".into()), "model");
    assert_eq!(refused(&|p| p.base[0].weight = 0.0), "weight");
    assert_eq!(refused(&|p| p.base[1].parameters[0][1] = 7.0), "alpha");
    assert_eq!(refused(&|p| p.base[1].parameters.clear()), "parameters");
    assert_eq!(refused(&|p| p.base.clear()), "parts");
    let part = good();
    let table = |offset: f32, step: f32| {
        let rows = part.frame.shape[0];
        let codes = part.table.codes().to_vec();
        Quantised::of_codes(&part.frame, codes, vec![offset; rows], vec![step; rows]).map(|_| ())
    };
    assert!(table(0.5, 0.1).is_ok());
    for (offset, step) in [(f32::NAN, 0.1), (0.0, -0.1), (0.0, 1.0)] {
        assert!(
            matches!(
                table(offset, step),
                Err(BsdfError::Domain { field: "offset", .. })
            ),
            "{offset} {step}"
        );
    }
}

#[test]
fn one_incidence_for_all_pairs_gives_what_each_its_own_gives() {
    for (symmetry, _) in Symmetry::NAMES {
        for channels in [vec![Channel::Photopic], three()] {
            let model = model(symmetry, channels.clone());
            for theta in [0.0, 25.0, 80.0, 130.0] {
                let wi = Direction::from_degrees(theta, 77.0)
                    .vec()
                    .to_array()
                    .map(|v| v as f32);
                let pairs: Vec<_> = (0..1100).map(|k| pair(k).1.vec().to_array()).collect();
                let ws = [0, 1, 2].map(|k| pairs.iter().map(|p| p[k] as f32).collect::<Vec<_>>());
                let each = wi.map(|v| vec![v; pairs.len()]);
                let columns = |c: &[Vec<f32>; 3], wi: Directions<'_, f32>| {
                    let mut rows = vec![vec![f32::NAN; pairs.len()]; channels.len()];
                    let mut views: Vec<&mut [f32]> = rows.iter_mut().map(|r| &mut r[..]).collect();
                    model.eval_f32(wi, Directions::Each(c.each_ref().map(|c| &c[..])), &mut views);
                    rows
                };
                let one = columns(&ws, Directions::One(wi));
                let all = columns(&ws, Directions::Each(each.each_ref().map(|c| &c[..])));
                let mut lit = 0;
                for (a, b) in one.iter().flatten().zip(all.iter().flatten()) {
                    assert!((a - b).abs() <= 2e-5 * b, "{symmetry:?} {theta}: {a} {b}");
                    lit += usize::from(*b > 0.0);
                }
                assert!(lit > 200, "{symmetry:?} {theta}: {lit}");
            }
        }
    }
}

#[test]
fn stored_tables_come_back_as_they_were() {
    for (symmetry, _) in Symmetry::NAMES {
        for bits in [8, 16] {
            let part = part(Component::Reflection, symmetry, 2, bits, wavy);
            let stored = part.table.coded(&part.frame);
            assert_eq!(Quantised::of_coded(&part.frame, &stored).unwrap(), part.table);
        }
        let frame = part(Component::Reflection, symmetry, 1, 8, wavy).frame;
        let values: Vec<f64> = (0..2 * frame.len()).map(wavy).collect();
        let table = Quantised::near(&frame, &values, 0.02, &vec![0.0; values.len()]).unwrap();
        let stored = table.coded(&frame);
        assert!(stored.iter().all(|c| c.offset == [0.0] && c.step.len() == 1));
        assert_eq!(Quantised::of_coded(&frame, &stored).unwrap(), table);
        for (found, wanted) in table.values(&frame).iter().zip(&values) {
            assert!((found - wanted).abs() <= 0.0101, "{found} {wanted}");
        }
    }
}

/// A part that repeats after half a turn only, and not in a mirror.
#[test]
fn a_half_turn_of_both_directions_changes_nothing() {
    let model = model(Symmetry::HalfTurn, vec![Channel::Photopic]);
    let turned = |d: Direction| {
        let v = d.vec();
        Direction::from_unit(gonio_geom::DVec3::new(-v.x, -v.y, v.z))
    };
    let mirrored = |d: Direction| {
        let v = d.vec();
        Direction::from_unit(gonio_geom::DVec3::new(v.x, -v.y, v.z))
    };
    let (mut lit, mut handed) = (0, 0);
    for k in 0..2000 {
        let (wi, ws) = pair(k);
        let (a, b) = (model.eval_first(wi, ws), model.eval_first(turned(wi), turned(ws)));
        assert!((a - b).abs() <= 1e-5 * a, "{a} {b}");
        lit += usize::from(a > 0.0);
        handed += usize::from((model.eval_first(mirrored(wi), mirrored(ws)) / a - 1.0).abs() > 0.05);
    }
    assert!(lit > 500 && handed > 300, "{lit} {handed}");
}

/// Shares of the front over 3 polar angles and 5 azimuths.
fn share(symmetry: Symmetry, channels: usize) -> IdealPart {
    let shape = [3, if symmetry.is_isotropic() { 1 } else { 5 }];
    IdealPart {
        symmetry,
        phi_x: 0.0,
        shape,
        shares: (0..channels * shape[0] * shape[1])
            .map(|k| 0.2 + 0.01 * k as f32)
            .collect(),
    }
}

#[test]
fn light_that_does_not_spread_is_kept_apart_and_drawn_by_its_share() {
    for symmetry in [Symmetry::Isotropic, Symmetry::Quadrilateral, Symmetry::HalfTurn] {
        let both = [(true, 2), (false, 1)].map(|(scatters, n)| {
            let mut parts = FourComponents::default();
            if scatters {
                parts.set(
                    Side::Front,
                    Component::Reflection,
                    Some(part(Component::Reflection, symmetry, n, 8, wavy)),
                );
            }
            let mut ideal = FourComponents::default();
            ideal.set(Side::Front, Component::Transmission, Some(share(symmetry, n)));
            (
                scatters,
                Compact::with_ideal(three()[..n].to_vec(), parts, ideal, false).unwrap(),
            )
        });
        for (scatters, model) in both {
            let w = Direction::from_degrees(40.0, 30.0);
            let mut shares = vec![0.0; model.channels().len()];
            let straight = model.delta(w, Component::Transmission, &mut shares).unwrap();
            assert!(straight.angle_to(w.through()) < 1e-12 && model.has_delta());
            assert_eq!(model.eval_first(w, straight), 0.0);
            let (mut drawn, mut mean) = (0, 0.0);
            let n = 20_000;
            for k in 0..n {
                let t = f64::from(k);
                let u = [0.819_172_513_4, 0.671_043_606_7, 0.549_700_477_9].map(|a: f64| (a * t).fract());
                let Some(s) = model.sample(w, u) else { continue };
                if s.lobe == crate::Lobe::Delta {
                    assert!(s.direction.angle_to(straight) < 1e-12);
                    assert!((s.weight * s.pdf - shares[0]).abs() < 1e-12);
                    mean += s.weight / f64::from(n);
                    drawn += 1;
                } else {
                    assert!((s.pdf / model.pdf(w, s.direction) - 1.0).abs() < 1e-12);
                }
            }
            assert!((mean - shares[0]).abs() < 0.02 * shares[0], "{mean} {shares:?}");
            assert_eq!(drawn == n, !scatters);
            let back = Direction::from_degrees(140.0, 30.0);
            assert!(model.delta(back, Component::Transmission, &mut shares).is_none());
        }
    }
}

#[test]
fn shares_are_those_of_the_nodes_and_linear_between_them() {
    let mut ideal = FourComponents::default();
    let part = IdealPart {
        shares: vec![0.9, 0.5, 0.1],
        ..share(Symmetry::Isotropic, 1)
    };
    ideal.set(Side::Back, Component::Reflection, Some(part.clone()));
    let model = Compact::with_ideal(vec![Channel::Photopic], FourComponents::default(), ideal, true).unwrap();
    for (x, wanted) in [(0.0, 0.9), (0.25, 0.7), (0.5, 0.5), (0.9, 0.18)] {
        let theta = Frame::cos_theta_i(x).clamp(-1.0, 1.0).acos().to_degrees();
        let mut found = [0.0];
        let w = Direction::from_degrees(180.0 - theta, 50.0);
        let to = model.delta(w, Component::Reflection, &mut found).unwrap();
        assert!(
            (found[0] - wanted).abs() < 1e-6 && to.angle_to(w.mirror()) < 1e-12,
            "{found:?} {wanted}"
        );
    }
    for shares in [vec![0.5; 2], vec![0.5, 1.5, 0.0], vec![0.5, f32::NAN, 0.0]] {
        let mut ideal = FourComponents::default();
        ideal.set(
            Side::Front,
            Component::Reflection,
            Some(IdealPart {
                shares,
                ..part.clone()
            }),
        );
        let made = Compact::with_ideal(vec![Channel::Photopic], FourComponents::default(), ideal, true);
        assert!(matches!(made, Err(BsdfError::Domain { field: "shares", .. })));
    }
}
