use super::*;

fn frame(symmetry: Symmetry) -> Frame {
    let isotropic = symmetry.is_isotropic();
    Frame {
        symmetry,
        width: if isotropic { [0.1, 0.1] } else { [0.07, 0.3] },
        phi_x: if isotropic { 0.0 } else { 0.6 },
        shape: [9, if isotropic { 1 } else { 8 }, 12, 16],
    }
}

#[test]
fn coordinates_of_a_pair_are_those_it_was_made_of() {
    for (symmetry, name) in Symmetry::NAMES {
        let frame = frame(symmetry);
        frame.check().unwrap();
        assert_eq!(name.parse::<Symmetry>().unwrap(), symmetry);
        let end = |axis: Axis| match axis {
            Axis::Single => 0.0,
            Axis::Ends(end) => end,
            Axis::Round => 4.0,
        };
        let mut seen = 0;
        for k in 1..2000 {
            let t = f64::from(k);
            let at = [
                (t * 0.819_172_513_4).fract(),
                end(frame.axis(1)) * (t * 0.671_043_606_7).fract(),
                (t * 0.549_700_477_9).fract(),
                end(frame.axis(3)) * (t * 0.450_2).fract(),
            ];
            let Some((wi, ws, solid_angle)) = frame.pair(at) else {
                continue;
            };
            seen += 1;
            assert!(solid_angle >= 0.0);
            let back = frame.coordinates(wi.vec().to_array(), ws.vec().to_array());
            for (a, b) in at.iter().zip(back) {
                assert!((a - b).abs() < 1e-7, "{name}: {at:?} {back:?}");
            }
        }
        assert!(seen > 500, "{name}: {seen}");
    }
}

#[test]
fn solid_angles_of_the_coordinates_fill_the_hemisphere() {
    for symmetry in [Symmetry::IsotropicChiral, Symmetry::Anisotropic] {
        let frame = frame(symmetry);
        for x in [0.1, 0.5, 0.8] {
            let (n, m) = (400, 400);
            let mut sum = 0.0;
            for a in 0..n {
                for b in 0..m {
                    let u = (f64::from(a) + 0.5) / f64::from(n);
                    let p = 4.0 * (f64::from(b) + 0.5) / f64::from(m);
                    sum += frame.pair([x, 0.3, u, p]).map_or(0.0, |p| p.2);
                }
            }
            let found = sum * 4.0 / f64::from(n * m);
            assert!((found / std::f64::consts::TAU - 1.0).abs() < 0.01, "{x}: {found}");
        }
    }
}

#[test]
fn mirrored_pairs_share_coordinates_where_the_symmetry_says_so() {
    let pair = |a: f64, b: f64| {
        [
            Direction::from_degrees(40.0, a).vec().to_array(),
            Direction::from_degrees(55.0, b).vec().to_array(),
        ]
    };
    let phi = 0.6_f64.to_degrees();
    let [wi, ws] = pair(phi + 20.0, phi + 150.0);
    let frame = frame(Symmetry::Quadrilateral);
    let wanted = frame.coordinates(wi, ws);
    for (a, b) in [(-20.0, -150.0), (160.0, 30.0), (200.0, 330.0)] {
        let [wi, ws] = pair(phi + a, phi + b);
        let found = frame.coordinates(wi, ws);
        assert!(
            wanted.iter().zip(found).all(|(a, b)| (a - b).abs() < 1e-12),
            "{a} {b}"
        );
    }
}
