use std::f64::consts::PI;

use super::*;
use crate::testing::Numbers;

/// A tree of two levels whose cells differ: a branch, one of its children a branch, the others blocks.
fn tree(rank: Rank) -> Tree {
    let n = rank.children();
    let mut b = TreeBuilder::new(rank);
    let mut k = 0u32;
    let mut next = |m: usize| -> Vec<f32> {
        (0..m)
            .map(|_| {
                k += 1;
                (f64::from(k) * 0.618_033_988_75).fract() as f32
            })
            .collect()
    };
    b.branch().unwrap();
    for child in 0..n {
        match child % 3 {
            0 => b.block(&next(1)).unwrap(),
            1 => b.block(&next(n)).unwrap(),
            _ => {
                b.branch().unwrap();
                for grandchild in 0..n {
                    b.block(&next(if grandchild % 2 == 0 { 1 } else { n })).unwrap();
                }
                b.end().unwrap();
            }
        }
    }
    b.end().unwrap();
    b.finish().unwrap()
}

fn model(keys: &[(Side, Component, Rank)]) -> TensorTree {
    let mut four = FourComponents::default();
    for (s, c, r) in keys {
        four.set(*s, *c, Some(tree(*r)));
    }
    TensorTree::new(Channel::Photopic, four)
}

#[test]
fn children_have_dimension_0_as_their_lowest_bit_and_blocks_have_it_slowest() {
    let mut b = TreeBuilder::new(Rank::Three);
    b.branch().unwrap();
    for child in 0..8u8 {
        let values: Vec<f32> = (0..8u8).map(|k| f32::from(10 * child + k)).collect();
        b.block(&values).unwrap();
    }
    b.end().unwrap();
    let t = b.finish().unwrap();
    assert_eq!(t.depth(), 2);
    assert_eq!(t.lookup(&[0.6, 0.1, 0.1, 0.0]), 10.0);
    assert_eq!(t.lookup(&[0.1, 0.1, 0.6, 0.0]), 40.0);
    assert_eq!(t.lookup(&[0.3, 0.1, 0.1, 0.0]), 4.0);
    assert_eq!(t.lookup(&[0.1, 0.1, 0.3, 0.0]), 1.0);
    assert_eq!(t.lookup(&[1.0, 1.0, 1.0, 0.0]), 77.0);
}

#[test]
fn a_cross_section_holds_what_lookup_finds_and_covers_the_square() {
    for rank in [Rank::Three, Rank::Four] {
        let t = tree(rank);
        for at in [[0.1, 0.2], [0.49, 0.9], [0.3, 0.55]] {
            let mut area = 0.0;
            t.cross_section(at, |c| {
                area += c.side * c.side;
                let (u, v) = (c.u + 0.3 * c.side, c.v + 0.8 * c.side);
                let at = match rank {
                    Rank::Three => [at[0], u, v, 0.0],
                    Rank::Four => [at[0], at[1], u, v],
                };
                assert_eq!(t.lookup(&at), f64::from(c.value));
            });
            assert!((area - 1.0).abs() < 1e-12);
        }
    }
    let t = tree(Rank::Four);
    let mut area = 0.0;
    t.reversed_cross_section([0.7, 0.2], |c| {
        area += c.side * c.side;
        let at = [c.u + 0.5 * c.side, c.v + 0.5 * c.side, 0.7, 0.2];
        assert_eq!(t.lookup(&at), f64::from(c.value));
    });
    assert!((area - 1.0).abs() < 1e-12);
}

#[test]
fn directions_of_coordinates_have_those_coordinates() {
    for rank in [Rank::Three, Rank::Four] {
        for side in Side::BOTH {
            for k in 0..50 {
                let t = f64::from(k);
                let (a, b) = ((t * 0.7548776662).fract() * 0.498, (t * 0.5698402910).fract());
                let (u, v) = ((t * 0.8191725134).fract(), (t * 0.6710436067).fract());
                let wi = lookup::incident_direction(rank, [a, b], side);
                let wi = if rank == Rank::Three { wi.rotated(t) } else { wi };
                let ws = lookup::exit_direction(rank, wi, u, v, side);
                let c = lookup::coordinates(rank, wi, ws);
                let want = if rank == Rank::Three {
                    [a, u, v, 0.0]
                } else {
                    [a, b, u, v]
                };
                for (x, y) in c.iter().zip(&want) {
                    assert!((x - y).abs() < 2e-7, "{c:?} {want:?}");
                }
            }
        }
    }
}

#[test]
fn a_rank_3_model_is_isotropic_and_a_rank_4_model_is_not() {
    let m = model(&[(Side::Front, Component::Reflection, Rank::Three)]);
    assert!(m.properties().isotropic);
    let (wi, ws) = (
        Direction::from_degrees(40.0, 10.0),
        Direction::from_degrees(30.0, 250.0),
    );
    assert_eq!(
        m.eval_first(wi, ws),
        m.eval_first(wi.rotated(1.0), ws.rotated(1.0))
    );
    assert!(
        !model(&[(Side::Front, Component::Reflection, Rank::Four)])
            .properties()
            .isotropic
    );
}

#[test]
fn samples_carry_the_albedo_and_their_pdf_covers_the_projected_hemispheres() {
    let cases = [
        vec![
            (Side::Front, Component::Reflection, Rank::Three),
            (Side::Front, Component::Transmission, Rank::Three),
        ],
        vec![
            (Side::Front, Component::Reflection, Rank::Four),
            (Side::Front, Component::Transmission, Rank::Four),
            (Side::Back, Component::Reflection, Rank::Four),
        ],
    ];
    for keys in cases {
        let m = model(&keys);
        let four = keys[0].2 == Rank::Four;
        for wi in [
            Direction::from_degrees(33.0, 70.0),
            Direction::from_degrees(140.0, 200.0),
        ] {
            if wi.side() == Side::Back && !four {
                continue;
            }
            let albedo = m.directional_albedo(wi, Component::Reflection)
                + m.directional_albedo(wi, Component::Transmission);
            let n = 4000;
            let mut inverse = 0.0;
            for j in 1..=n {
                let t = f64::from(j);
                let u = [
                    (t * 0.8191725134).fract(),
                    (t * 0.6710436067).fract(),
                    (t * 0.5497004779).fract(),
                ];
                let s = m.sample(wi, u).unwrap();
                assert!((s.pdf - m.pdf(wi, s.direction)).abs() < 1e-9 * s.pdf);
                assert!((s.weight - albedo).abs() < 1e-6 * albedo);
                inverse += s.direction.cos_theta().abs() / s.pdf / f64::from(n);
            }
            assert!((inverse - 2.0 * PI).abs() < 0.1 * 2.0 * PI, "{inverse}");
        }
    }
}

#[test]
fn a_rank_3_transmission_read_in_reverse_is_reciprocal_and_sampled_exactly() {
    let m = model(&[(Side::Front, Component::Transmission, Rank::Three)]);
    let mut numbers = Numbers::new(15);
    for theta in [180.0, 179.999_999, 179.9, 170.0, 150.0, 130.0, 110.0, 95.0, 90.1] {
        let w = if theta == 180.0 {
            Direction::NORMAL.flipped()
        } else {
            Direction::from_degrees(theta, 80.0)
        };
        let up = Direction::from_degrees(20.0, 10.0);
        assert_eq!(m.eval_first(up, w), m.eval_first(w, up));
        let albedo = m.directional_albedo(w, Component::Transmission);
        // by the midpoint rule in the square of the incidence and in azimuth, as Radiance asks
        let (n, k) = (64, 1440);
        let mut sum = 0.0;
        for a in 0..n {
            for b in 0..k {
                let sine = (f64::from(a) + 0.5) / f64::from(n);
                let phi = 360.0 * (f64::from(b) + 0.5) / f64::from(k);
                let s = Direction::from_degrees(sine.asin().to_degrees(), phi);
                sum += m.eval_first(w, s) * sine * 2.0 * PI / f64::from(n * k);
            }
        }
        assert!((sum - albedo).abs() < 0.003 * albedo, "{theta}: {sum} {albedo}");
        let mut inverse = 0.0;
        let n = 20_000;
        for _ in 0..n {
            let s = m
                .sample(w, [numbers.next(), numbers.next(), numbers.next()])
                .unwrap();
            assert!((s.weight - albedo).abs() < 1e-9 * albedo);
            let pdf = m.pdf(w, s.direction);
            assert!((s.pdf - pdf).abs() < 1e-9 * pdf, "{theta}: {s:?} {pdf}");
            inverse += s.direction.cos_theta() / s.pdf / f64::from(n);
        }
        assert!((inverse - PI).abs() < 0.05 * PI, "{theta}: {inverse}");
    }
}

/// A tree deeper than its flat top: a peak that halves the last cell of every level.
fn deep(rank: Rank) -> Tree {
    let mut b = TreeBuilder::new(rank);
    let levels = 10_u8;
    for _ in 0..levels {
        b.branch().unwrap();
    }
    for level in 0..levels {
        // The innermost branch has all its children as values, the others all but the one that went on.
        let n = rank.children() - usize::from(level > 0);
        for child in 0..n {
            b.block(&[f32::from(level) + child as f32 / 16.0]).unwrap();
        }
        b.end().unwrap();
    }
    b.finish().unwrap()
}

/// A unit vector even over the whole sphere.
fn anywhere(numbers: &mut Numbers) -> Direction {
    let d = numbers.direction();
    if numbers.next() < 0.5 {
        d.through().mirror()
    } else {
        d
    }
}

#[test]
fn values_are_those_of_the_cells_whichever_way_they_are_asked_for() {
    use crate::batch::{Directions, Number};
    let everything = [Rank::Three, Rank::Four].map(|rank| {
        let mut four = FourComponents::default();
        four.set(Side::Front, Component::Reflection, Some(deep(rank)));
        four.set(Side::Front, Component::Transmission, Some(tree(rank)));
        TensorTree::new(Channel::Photopic, four)
    });
    let mut numbers = Numbers::new(11);
    for m in everything {
        let pairs: Vec<(Direction, Direction)> = (0..3000)
            .map(|_| (anywhere(&mut numbers), anywhere(&mut numbers)))
            .collect();
        let columns = |of: fn(&(Direction, Direction)) -> Direction| {
            [0, 1, 2].map(|k| pairs.iter().map(|p| of(p).vec()[k]).collect::<Vec<f64>>())
        };
        let (wi, ws) = (columns(|p| p.0), columns(|p| p.1));
        let mut found = vec![0.0; pairs.len()];
        fn views(v: &[Vec<f64>; 3]) -> Directions<'_, f64> {
            Directions::Each([&v[0], &v[1], &v[2]])
        }
        f64::eval(&m, views(&wi), views(&ws), &mut [&mut found]);
        for ((wi, ws), found) in pairs.iter().zip(&found) {
            let component = Component::between(wi.side(), ws.side());
            let want = m.source(wi.side(), component).map_or(0.0, |s| {
                let (i, o) = if s.reversed { (*ws, *wi) } else { (*wi, *ws) };
                s.tree.lookup(&lookup::coordinates(s.tree.rank(), i, o))
            });
            assert_eq!((m.eval_first(*wi, *ws), *found), (want, want), "{wi:?} {ws:?}");
        }
    }
}

#[test]
fn the_peak_of_a_deep_tree_is_found() {
    for rank in [Rank::Three, Rank::Four] {
        let t = deep(rank);
        let grid = Grid::new(&t);
        assert_eq!(t.depth(), 10);
        let mut numbers = Numbers::new(12);
        for k in 0..5000 {
            // Ever nearer to the corner where the cells shrink.
            let near = 0.5_f64.powi(k % 12);
            let at = [(); 4].map(|()| mapping::fixed(near * numbers.next()));
            let (flat, walked) = match rank {
                Rank::Three => {
                    let at = [at[0], at[1], at[2]];
                    (grid.value(&t, at), t.descend(0, 0, at))
                }
                Rank::Four => (grid.value(&t, at), t.descend(0, 0, at)),
            };
            assert_eq!(flat, walked, "{at:?}");
        }
    }
}

#[test]
fn the_fast_map_is_the_concentric_one() {
    use gonio_geom::disk::{disk_to_square, square_to_disk};
    let mut numbers = Numbers::new(13);
    let corners = [0.0, 0.25, 0.5, 0.75, 1.0];
    let exact = corners.iter().flat_map(|u| corners.map(|v| (*u, v)));
    let random: Vec<(f64, f64)> = (0..10_000).map(|_| (numbers.next(), numbers.next())).collect();
    for (u, v) in exact.chain(random) {
        let ((x, y), (p, q)) = (square_to_disk(u, v), mapping::disk(u, v));
        assert!((x - p).abs() < 1e-15 && (y - q).abs() < 1e-15, "{u} {v}");
        let ((u, v), (p, q)) = (disk_to_square(x, y), mapping::square(x, y));
        assert!((u - p).abs() < 3e-13 && (v - q).abs() < 3e-13, "{x} {y}");
    }
}

#[test]
fn fixed_point_coordinates_are_floors_and_stay_inside() {
    let one = 1_u32 << 31;
    for (x, want) in [
        (0.0, 0),
        (0.5, one / 2),
        (0.25, one / 4),
        (1.0, one - 1),
        (-1.0, 0),
    ] {
        assert_eq!(mapping::fixed(x), want, "{x}");
    }
    assert_eq!((mapping::fixed(f64::NAN), mapping::fixed(2.0)), (0, one - 1));
    let step = 1.0 / f64::from(one);
    for x in [0.3, 0.61803, 0.999] {
        let floor = (x / step).floor() as u32;
        assert_eq!(mapping::fixed(x), floor, "{x}");
        assert_eq!(mapping::fixed((f64::from(floor) + 0.01) * step), floor);
        assert_eq!(mapping::fixed((f64::from(floor) + 0.99) * step), floor);
    }
}

#[test]
fn samples_of_many_are_those_of_one() {
    use crate::batch::{Directions, Number, SampleColumns};
    let m = model(&[
        (Side::Front, Component::Reflection, Rank::Four),
        (Side::Front, Component::Transmission, Rank::Four),
    ]);
    let mut numbers = Numbers::new(14);
    let n = 600;
    let w: Vec<Direction> = (0..n).map(|_| anywhere(&mut numbers)).collect();
    let [x, y, z] = [0, 1, 2].map(|k| w.iter().map(|w| w.vec()[k]).collect::<Vec<f64>>());
    let u = [(); 3].map(|()| (0..n).map(|_| numbers.next()).collect::<Vec<f64>>());
    let (mut a, mut b, mut c) = (vec![0.0; n], vec![0.0; n], vec![0.0; n]);
    let (mut weight, mut pdf) = (vec![0.0; n], vec![0.0; n]);
    let mut out = SampleColumns {
        direction: [&mut a, &mut b, &mut c],
        weight: vec![&mut weight],
        pdf: &mut pdf,
    };
    f64::sample(
        &m,
        Directions::Each([&x, &y, &z]),
        [&u[0], &u[1], &u[2]],
        &mut out,
    );
    for (k, w) in w.iter().enumerate() {
        // From the back there is transmission alone.
        let one = m.sample(*w, [u[0][k], u[1][k], u[2][k]]).unwrap();
        let v = one.direction.vec();
        assert!((v.x - a[k]).abs() < 1e-12 && (v.y - b[k]).abs() < 1e-12 && (v.z - c[k]).abs() < 1e-12);
        assert_eq!((one.weight, one.pdf), (weight[k], pdf[k]));
        assert!((one.pdf - m.pdf(*w, one.direction)).abs() < 1e-9 * one.pdf, "{k}");
    }
}
