use std::f64::consts::PI;
use std::path::Path;

use gonio_bsdf::Bsdf;
use gonio_geom::{Component, DVec3, Direction, Side};
use proptest::prelude::*;

use super::grid::{Grid, moderated, radius};
use super::*;

/// Incidence (degrees), lobes (peak, coded width, x, y).
type Measured = ([f64; 2], Vec<(f64, u16, u16, u16)>);

fn float(out: &mut Vec<u8>, v: f64) {
    if v == 0.0 {
        out.extend([0; 5]);
        return;
    }
    let exponent = v.abs().log2().floor() as i32 + 1;
    let mantissa = (v * f64::from(-exponent).exp2() * f64::from(i32::MAX)) as i32;
    out.extend(mantissa.to_be_bytes());
    out.push(exponent as i8 as u8);
}

/// A file with transports as dense matrices.
fn file(symmetry: u8, floor: f64, nodes: &[Measured], edges: &[(i32, i32, Vec<f64>)]) -> Vec<u8> {
    let mut out = format!(
        "#?RADIANCE\npabopto2bsdf a.txt\nNAME=foil\nSYMMETRY={symmetry}\nIO_SIDES= 1 1\nCOLORIMETRY=CIE-Y\nGRIDRES=256\n\
         BSDFMIN={floor}\nFORMAT=BSDF_RBFmesh\n\n"
    )
    .into_bytes();
    out.extend([0x5a, 0x3c]);
    for (k, ([theta, phi], lobes)) in nodes.iter().enumerate() {
        out.extend((k as i32).to_be_bytes());
        let v = Direction::from_degrees(*theta, *phi).vec();
        let light: f64 = lobes.iter().map(|l| 2.0 * PI * l.0 * radius(l.1).powi(2)).sum();
        for x in [v.x, v.y, v.z, light] {
            float(&mut out, x);
        }
        out.extend((lobes.len() as i32).to_be_bytes());
        for (peak, width, x, y) in lobes {
            float(&mut out, *peak);
            for n in [0, *width, *x, *y] {
                out.extend(n.to_be_bytes());
            }
        }
    }
    out.extend((-1i32).to_be_bytes());
    for (from, to, shares) in edges {
        out.extend(from.to_be_bytes());
        out.extend(to.to_be_bytes());
        let mut zeros = 0u8;
        for share in shares {
            if zeros == 255 {
                out.push(zeros);
                zeros = 0;
            }
            if *share == 0.0 {
                zeros += 1;
            } else {
                out.push(zeros);
                zeros = 0;
                float(&mut out, *share);
            }
        }
        out.push(zeros);
    }
    out.extend([0xff; 8]);
    out
}

fn read(bytes: &[u8]) -> Interpolant {
    parse(bytes, Path::new("a.sir")).unwrap()
}

const GRID: Grid = Grid {
    cells: 256,
    sign: 1.0,
};

/// The cell of a direction.
fn cell(theta: f64, phi: f64) -> (u16, u16) {
    let wanted = Direction::from_degrees(theta, phi).vec();
    let near = |x: u16, y: u16| GRID.direction(x, y).dot(wanted);
    let all = (0..256u16).flat_map(|x| (0..256u16).map(move |y| (x, y)));
    all.max_by(|a, b| near(a.0, a.1).total_cmp(&near(b.0, b.1)))
        .unwrap()
}

/// A lobe about the mirror direction of each incidence at azimuth 180, moved whole from one to the next.
fn mirrors(thetas: &[f64]) -> Vec<u8> {
    let nodes: Vec<Measured> = thetas
        .iter()
        .map(|t| {
            let (x, y) = cell(*t, 0.0);
            ([*t, 180.0], vec![(4.0, 2000, x, y)])
        })
        .collect();
    let edges: Vec<_> = (1..thetas.len() as i32).map(|k| (k - 1, k, vec![1.0])).collect();
    file(0, 0.01, &nodes, &edges)
}

#[test]
fn a_measured_incidence_answers_with_its_own_lobes() {
    let model = read(&mirrors(&[10.0, 40.0, 60.0]));
    assert_eq!(model.component(), (Side::Front, Component::Reflection));
    assert_eq!((model.name(), model.lobes(), model.transports()), ("foil", 3, 2));
    assert!(model.properties().isotropic);
    let wi = Direction::from_degrees(40.0, 180.0);
    let (x, y) = cell(40.0, 0.0);
    for ws in [(40.0, 0.0), (35.0, 3.0), (50.0, 350.0)].map(|(t, p)| Direction::from_degrees(t, p)) {
        let exponent = (GRID.direction(x, y).dot(ws.vec()) - 1.0) / radius(2000).powi(2);
        let want = 4.0 * exponent.exp() / moderated(ws.cos_theta());
        assert!((model.eval_first(wi, ws) / want - 1.0).abs() < 1e-8);
    }
    // far from the lobe, and where nothing was measured, the least value
    let far = Direction::from_degrees(80.0, 180.0);
    assert_eq!(model.eval_first(wi, far), 0.01);
    assert_eq!(model.eval_first(far, wi), 0.01);
    assert!(!model.has_data(far, wi) && model.has_data(wi, far));
    assert_eq!(model.eval_first(Direction::from_degrees(140.0, 0.0), wi), 0.0);
}

#[test]
fn normal_incidence_beside_a_first_incidence_of_a_thousandth_of_a_degree_is_that_incidence() {
    let model = read(&mirrors(&[0.001, 40.0]));
    let up = Direction::NORMAL;
    let first = model.eval_first(Direction::from_degrees(0.001, 180.0), up);
    assert!(first > 1.0);
    assert!((model.eval_first(up, up) / first - 1.0).abs() < 1e-3);
}

#[test]
fn a_lobe_moves_with_the_incidence_and_keeps_its_light() {
    let model = read(&mirrors(&[10.0, 40.0, 60.0]));
    for theta in [17.0, 25.0, 33.0, 48.0, 55.0] {
        for phi in [180.0, 33.0] {
            let wi = Direction::from_degrees(theta, phi);
            let near = |t: f64, p: f64| model.eval_first(wi, Direction::from_degrees(t, p));
            let profile: Vec<f64> = (0..900).map(|k| f64::from(k) / 10.0).collect();
            let dsf = |t: &&f64| near(**t, phi + 180.0) * moderated(t.to_radians().cos());
            let top = profile.iter().max_by(|a, b| dsf(a).total_cmp(&dsf(b))).unwrap();
            // cells are 0.6 degrees wide
            assert!((top - theta).abs() < 0.6, "{theta}: {top}");
            // the axis may lie half a cell off the profile
            assert!((dsf(&top) / 4.0 - 1.0).abs() < 5e-3);
            assert!(model.has_data(wi, wi));
        }
    }
}

#[test]
fn an_isotropic_file_turns_exactly() {
    let model = read(&mirrors(&[0.0, 30.0, 60.0]));
    for theta in [0.0, 10.0, 30.0, 44.0] {
        let at = |turn: f64| {
            model.eval_first(
                Direction::from_degrees(theta, 180.0 + turn),
                Direction::from_degrees(theta + 4.0, 6.0 + turn),
            )
        };
        if theta > 0.0 {
            assert!((at(71.3) / at(0.0) - 1.0).abs() < 1e-9, "{theta}");
        }
    }
}

/// Four incidences of a quadrant, with a lobe each and what the corner lobes become.
fn quadrant() -> Interpolant {
    let node = |t: f64, p: f64| -> Measured {
        let (x, y) = cell(t, p + 180.0);
        ([t, p], vec![(2.0 + t / 30.0, 2500, x, y)])
    };
    let nodes = [node(5.0, 45.0), node(50.0, 5.0), node(50.0, 85.0)];
    let edges = [(0, 1, vec![1.0]), (1, 2, vec![1.0]), (0, 2, vec![1.0])];
    read(&file(1, 0.0, &nodes, &edges))
}

#[test]
fn a_triangle_of_incidences_moves_its_lobes_to_the_mirror_direction() {
    let model = quadrant();
    assert!(!model.properties().isotropic);
    for (theta, phi) in [
        (30.0, 45.0),
        (25.0, 30.0),
        (38.0, 60.0),
        (5.0, 45.0),
        (50.0, 85.0),
    ] {
        let wi = Direction::from_degrees(theta, phi);
        let top = model.eval_first(wi, wi.mirror());
        // the way along an edge, then to the third incidence, ends near the incidence, not in it
        for (t, p) in [(12.0, 0.0), (-12.0, 0.0), (0.0, 30.0), (0.0, -30.0)] {
            let off = Direction::from_degrees(theta + t, phi + 180.0 + p);
            let dsf = |d: Direction| model.eval_first(wi, d) * moderated(d.cos_theta());
            assert!(dsf(wi.mirror()) > dsf(off), "{theta}, {phi}: {t} {p}");
        }
        // what lies in other quadrants is a mirror image
        for [sx, sy] in [[-1.0, 1.0], [1.0, -1.0], [-1.0, -1.0]] {
            let image = |d: Direction| {
                let v = d.vec();
                Direction::new(DVec3::new(sx * v.x, sy * v.y, v.z)).unwrap()
            };
            let ws = Direction::from_degrees(theta + 5.0, phi + 190.0);
            let (a, b) = (model.eval_first(wi, ws), model.eval_first(image(wi), image(ws)));
            assert!((a / b - 1.0).abs() < 1e-9);
        }
        assert!(top > 1.0 && model.has_data(wi, wi));
    }
    assert!(!model.has_data(Direction::from_degrees(75.0, 45.0), Direction::NORMAL));
}

#[test]
fn samples_follow_their_density_and_carry_the_albedo() {
    for model in [read(&mirrors(&[10.0, 40.0, 60.0])), quadrant()] {
        for wi in [
            Direction::from_degrees(31.0, 40.0),
            Direction::from_degrees(50.0, 85.0),
        ] {
            let n = 200;
            let mut albedo = 0.0;
            let mut whole = 0.0;
            for k in 0..n * n {
                let [u, v] = [k / n, k % n].map(|j| (f64::from(j) + 0.5) / f64::from(n));
                let (x, y) = gonio_geom::disk::square_to_disk(u, v);
                let ws = Direction::new(DVec3::new(x, y, (1.0 - x * x - y * y).sqrt())).unwrap();
                albedo += PI * model.eval_first(wi, ws) / f64::from(n * n);
                whole += PI * model.pdf(wi, ws) / ws.cos_theta() / f64::from(n * n);
            }
            let (mut mean, mut lit) = (0.0, 0.0);
            let draws = 40_000;
            for k in 0..draws {
                let t = f64::from(k);
                let u = [0.819_172_513_4, 0.671_043_606_7, 0.549_700_477_9].map(|a: f64| (a * t).fract());
                let Some(s) = model.sample(wi, u) else { continue };
                let f = model.eval_first(wi, s.direction) * s.direction.cos_theta();
                assert!((s.pdf / model.pdf(wi, s.direction) - 1.0).abs() < 1e-6);
                assert!((s.weight * s.pdf / f - 1.0).abs() < 1e-6);
                mean += s.weight / f64::from(draws);
                lit += 1.0 / f64::from(draws);
            }
            assert!((mean / albedo - 1.0).abs() < 5e-3, "{mean} {albedo}");
            assert!((lit - whole).abs() < 5e-3, "{lit} {whole}");
        }
    }
}

#[test]
fn a_file_cut_short_anywhere_is_one_error_that_says_so() {
    let whole = mirrors(&[10.0, 40.0]);
    for n in 0..whole.len() {
        let error = parse(&whole[..n], Path::new("cut.sir"))
            .err()
            .unwrap()
            .to_string();
        assert!(error.starts_with("cut.sir"), "{n}: {error}");
    }
    let mut more = whole;
    more.push(0);
    assert!(parse(&more, Path::new("a")).is_err());
}

#[test]
fn what_no_interpolant_has_is_refused() {
    let says = |bytes: &[u8]| parse(bytes, Path::new("a.sir")).err().unwrap().to_string();
    let node = |lobes: Vec<(f64, u16, u16, u16)>| -> Measured { ([20.0, 180.0], lobes) };
    let outside = file(0, 0.0, &[node(vec![(1.0, 900, 256, 0)])], &[]);
    assert!(says(&outside).contains("a lobe in cell 256, 0, allowed 0 to 255 each"));
    assert!(says(&file(0, 0.0, &[node(vec![(-1.0, 900, 0, 0)])], &[])).contains("light -"));
    assert!(says(&file(0, 0.0, &[], &[])).contains("incidences"));
    assert!(says(&file(5, 0.0, &[node(vec![])], &[])).contains("SYMMETRY: found \"5\""));
    let two = [
        node(vec![(1.0, 900, 9, 9)]),
        ([50.0, 180.0], vec![(1.0, 900, 9, 9)]),
    ];
    assert!(says(&file(0, 0.0, &two, &[(0, 7, vec![1.0])])).contains("incidences 0 and 7"));
    let twice = [(0, 1, vec![1.0]), (1, 0, vec![1.0])];
    assert!(says(&file(0, 0.0, &two, &twice)).contains("two that no other transport joins"));
    let text = String::from_utf8_lossy(&mirrors(&[10.0])[..40]).replace("RADIANCE", "RADIOS");
    assert!(says(text.as_bytes()).contains("first line"));
    let swapped = [([50.0, 180.0], vec![]), ([20.0, 180.0], vec![])];
    assert!(says(&file(0, 0.0, &swapped, &[])).contains("out of order"));
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(400))]

    #[test]
    fn no_damage_makes_the_reader_or_the_model_panic(
        at in 150usize..400,
        value in any::<u8>(),
        also in 150usize..400,
        other in any::<u8>(),
    ) {
        let mut bytes = mirrors(&[0.0, 30.0, 60.0]);
        let n = bytes.len();
        bytes[at % n] = value;
        bytes[also % n] = other;
        if let Ok(model) = parse(&bytes, Path::new("a.sir")) {
            for (t, p) in [(10.0, 20.0), (45.0, 200.0), (30.0, 180.0)] {
                let wi = Direction::from_degrees(t, p);
                let f = model.eval_first(wi, wi.mirror());
                prop_assert!(f >= 0.0);
                let _ = model.sample(wi, [0.3, 0.4, 0.5]);
            }
        }
    }

    #[test]
    fn no_content_after_a_header_makes_the_reader_panic(tail in proptest::collection::vec(any::<u8>(), 0..300)) {
        let mut bytes = mirrors(&[10.0]);
        let start = bytes.windows(2).position(|w| w == b"\n\n").unwrap() + 4;
        bytes.truncate(start);
        bytes.extend(tail);
        let _ = parse(&bytes, Path::new("a.sir"));
    }
}
