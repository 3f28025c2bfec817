use std::f64::consts::PI;

use super::*;

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
fn a_rank_3_transmission_read_in_reverse_is_reciprocal_and_still_sampled() {
    let m = model(&[(Side::Front, Component::Transmission, Rank::Three)]);
    let (up, down) = (
        Direction::from_degrees(20.0, 10.0),
        Direction::from_degrees(130.0, 80.0),
    );
    assert_eq!(m.eval_first(up, down), m.eval_first(down, up));
    let s = m.sample(down, [0.3, 0.4, 0.2]).unwrap();
    let f = m.eval_first(down, s.direction);
    assert!((s.weight - f * s.direction.cos_theta().abs() / m.pdf(down, s.direction)).abs() < 1e-12);
    let n = 20_000;
    let mut mean = 0.0;
    for j in 1..=n {
        let t = f64::from(j);
        let u = [
            (t * 0.8191725134).fract(),
            (t * 0.6710436067).fract(),
            (t * 0.5497004779).fract(),
        ];
        mean += m.sample(down, u).map_or(0.0, |s| s.weight) / f64::from(n);
    }
    let albedo = m.directional_albedo(down, Component::Transmission);
    assert!((mean - albedo).abs() < 0.02 * albedo, "{mean} {albedo}");
}
