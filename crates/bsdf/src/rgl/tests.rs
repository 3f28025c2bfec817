use std::f64::consts::{FRAC_PI_2, PI, TAU};

use gonio_geom::{DVec3, Direction};

use super::warp::{Blend, Warp};
use super::*;
use crate::testing::Numbers;

fn table(shape: &[usize], mut f: impl FnMut(&[usize]) -> f64) -> Table {
    let n: usize = shape.iter().product();
    let mut at = vec![0; shape.len()];
    let values = (0..n)
        .map(|k| {
            let mut rest = k;
            for (d, size) in shape.iter().enumerate().rev() {
                at[d] = rest % size;
                rest /= size;
            }
            f(&at) as f32
        })
        .collect();
    Table {
        shape: shape.to_vec(),
        values,
    }
}

/// A smooth material with a broad lobe; `phi_i` over the whole turn or a part of it.
fn material(phi_i: &[f64]) -> RglTables {
    let (np, nt) = (phi_i.len(), 4);
    let wave = |k: usize, n: usize| (TAU * k as f64 / n as f64).cos();
    RglTables {
        theta_i: (0..nt).map(|k| FRAC_PI_2 * k as f64 / 3.0).collect(),
        phi_i: phi_i.to_vec(),
        ndf: table(&[5, 9], |a| 3.0 - 0.3 * a[1] as f64 + 0.1 * wave(a[0], 4)),
        sigma: table(&[3, 7], |a| 1.0 - 0.1 * a[1] as f64),
        // towards the pole the density of the coordinates vanishes as the solid angle of a cell does
        vndf: table(&[np, nt, 17, 33], |a| {
            let x = a[3] as f64 / 32.0;
            x.powi(3) * (1.0 - 0.9 * x) * (1.0 + 0.2 * a[1] as f64 + 0.3 * wave(a[2] + a[0], 16))
        }),
        luminance: table(&[np, nt, 9, 11], |a| {
            1.0 + 0.1 * (a[3] * a[2]) as f64 * (1.0 + a[0] as f64)
        }),
        spectra: table(&[np, nt, 2, 9, 11], |a| {
            if a[2] == 0 {
                0.3 + 0.02 * (a[4] + a[1] + 2 * a[0]) as f64
            } else {
                -0.2 + 0.05 * a[3] as f64
            }
        }),
        channels: vec![Channel::Red, Channel::Blue],
        valid: None,
        jacobian: true,
    }
}

fn full_turn() -> Vec<f64> {
    (0..7).map(|k| -PI + TAU * f64::from(k) / 6.0).collect()
}

fn eval(model: &Rgl, wi: Direction, ws: Direction) -> [f64; 2] {
    let mut f = [f64::NAN; 2];
    model.eval(wi, ws, &mut f);
    f
}

#[test]
fn inverting_a_sampled_point_gives_the_uniform_point_back() {
    let mut numbers = Numbers::new(1);
    let mut values = table(&[2, 6, 8], |_| numbers.next());
    values.values[3] = 0.0;
    values.values[60] = 0.0;
    let warp = Warp::new(values).unwrap();
    let blend = Blend::new((0, 0.0), (0, 0.3), 2);
    for _ in 0..10_000 {
        let (u, v) = (numbers.next(), numbers.next());
        let ([x, y], density) = warp.sample(&blend, u, v).unwrap();
        let ([a, b], same) = warp.invert(&blend, x, y);
        assert!((a - u).abs() < 1e-9 && (b - v).abs() < 1e-9, "{u} {v}: {a} {b}");
        assert!((density / same - 1.0).abs() < 1e-9);
        assert!((warp.density(&blend, x, y) / same - 1.0).abs() < 1e-9);
    }
}

#[test]
fn the_density_of_a_warp_is_the_jacobian_of_its_inverse() {
    let mut numbers = Numbers::new(2);
    let warp = Warp::new(table(&[2, 5, 7], |_| 0.1 + numbers.next())).unwrap();
    let blend = Blend::new((0, 0.0), (0, 0.6), 2);
    let h = 1e-6;
    for _ in 0..1000 {
        let (x, y) = (0.001 + 0.99 * numbers.next(), 0.001 + 0.99 * numbers.next());
        let ([u, v], density) = warp.invert(&blend, x, y);
        let ([ux, vx], _) = warp.invert(&blend, x + h, y);
        let ([uy, vy], _) = warp.invert(&blend, x, y + h);
        let jacobian = ((ux - u) * (vy - v) - (uy - u) * (vx - v)) / (h * h);
        assert!(
            (jacobian / density - 1.0).abs() < 1e-3,
            "{x} {y}: {jacobian} {density}"
        );
    }
}

#[test]
fn constant_tables_give_the_closed_form() {
    let mut tables = material(&[0.0]);
    tables.spectra.values.fill(0.25);
    tables.ndf.values.fill(2.0);
    tables.sigma.values.fill(0.5);
    let plain = Rgl::new(RglTables {
        jacobian: false,
        ..tables.clone()
    })
    .unwrap();
    let model = Rgl::new(tables).unwrap();
    let mut numbers = Numbers::new(3);
    for _ in 0..1000 {
        let (wi, ws) = (numbers.direction(), numbers.direction());
        let c = ws.cos_theta();
        assert!((eval(&plain, wi, ws)[0] * c - 0.25).abs() < 1e-12);
        assert!((eval(&model, wi, ws)[1] * c - 0.25).abs() < 1e-12);
    }
}

#[test]
fn values_between_incidences_are_linear_in_the_angle() {
    let mut tables = material(&[0.0]);
    let n = tables.spectra.values.len() / 4;
    for (k, v) in tables.spectra.values.iter_mut().enumerate() {
        *v = (k / n) as f32;
    }
    tables.jacobian = false;
    let model = Rgl::new(tables).unwrap();
    let ws = Direction::from_degrees(20.0, 70.0);
    for theta in [0.0, 10.0, 37.5, 60.0, 82.0] {
        let f = eval(&model, Direction::from_degrees(theta, 0.0), ws)[0];
        assert!((f * ws.cos_theta() - theta / 30.0).abs() < 1e-6, "{theta}: {f}");
    }
}

#[test]
fn an_isotropic_material_turns_with_the_incidence() {
    let model = Rgl::new(material(&[0.0])).unwrap();
    assert!(model.is_isotropic() && model.properties().isotropic);
    let mut numbers = Numbers::new(4);
    for _ in 0..1000 {
        let (wi, ws, turn) = (numbers.direction(), numbers.direction(), TAU * numbers.next());
        let (a, b) = (
            eval(&model, wi, ws),
            eval(&model, wi.rotated(turn), ws.rotated(turn)),
        );
        assert!((a[0] / b[0] - 1.0).abs() < 1e-9 && (a[1] - b[1]).abs() < 1e-9);
    }
}

#[test]
fn parts_of_a_turn_stand_for_the_whole_by_their_symmetry() {
    let part = |end: f64| -> Vec<f64> { (0..4).map(|k| -PI + end * f64::from(k) / 3.0).collect() };
    let half = Rgl::new(material(&part(PI))).unwrap();
    let quarter = Rgl::new(material(&part(FRAC_PI_2))).unwrap();
    let mirrored = |d: Direction, x: f64, y: f64| Direction::new(d.vec() * DVec3::new(x, y, 1.0)).unwrap();
    let mut numbers = Numbers::new(5);
    let mut differs = 0;
    for _ in 0..1000 {
        let (wi, ws) = (numbers.direction(), numbers.direction());
        let same = |m: &Rgl, x: f64, y: f64| {
            let (a, b) = (
                eval(m, wi, ws)[0],
                eval(m, mirrored(wi, x, y), mirrored(ws, x, y))[0],
            );
            (a / b - 1.0).abs() < 1e-9
        };
        assert!(same(&half, -1.0, -1.0));
        assert!(same(&quarter, -1.0, 1.0) && same(&quarter, 1.0, -1.0));
        differs += usize::from(!same(&half, -1.0, 1.0));
    }
    assert!(differs > 900);
}

#[test]
fn values_below_zero_are_raised_to_it_and_kept_aside() {
    let model = Rgl::new(material(&[0.0])).unwrap();
    let mut numbers = Numbers::new(6);
    let (mut negative, mut signed) = (0, [0.0; 2]);
    for _ in 0..1000 {
        let (wi, ws) = (numbers.direction(), numbers.direction());
        model.eval_signed(wi, ws, &mut signed);
        let f = eval(&model, wi, ws);
        assert_eq!(f, signed.map(|v| v.max(0.0)));
        negative += usize::from(signed[1] < 0.0);
    }
    assert!(negative > 50);
}

#[test]
fn nothing_is_scattered_from_or_to_the_back() {
    let model = Rgl::new(material(&[0.0])).unwrap();
    let (up, down) = (
        Direction::from_degrees(30.0, 0.0),
        Direction::from_degrees(120.0, 0.0),
    );
    let horizon = Direction::new(DVec3::X).unwrap();
    for (wi, ws) in [(up, down), (down, up), (down, down), (up, horizon), (horizon, up)] {
        assert_eq!(eval(&model, wi, ws), [0.0; 2]);
        assert_eq!(Bsdf::pdf(&model, wi, ws), 0.0);
        assert!(!model.has_data(wi, ws));
    }
    assert!(model.sample(down, [0.5; 3]).is_none());
}

#[test]
fn data_end_at_the_last_measured_incidence_and_at_nodes_below_the_horizon() {
    let mut tables = material(&[0.0]);
    let nodes = tables.luminance.values.len() / 4;
    let mut valid = vec![true; 4 * nodes];
    valid[nodes..nodes + 55].fill(false);
    tables.valid = Some(valid);
    let model = Rgl::new(tables).unwrap();
    assert_eq!(model.measured_theta_i().len(), 3);
    let at = |theta: f64, ws| model.has_data(Direction::from_degrees(theta, 0.0), ws);
    let mut numbers = Numbers::new(7);
    let mut masked = [0; 3];
    for _ in 0..2000 {
        let ws = numbers.direction();
        assert!(at(0.0, ws) && at(60.0, ws) && !at(61.0, ws) && !at(90.0, ws));
        masked[0] += usize::from(!at(30.0, ws));
        masked[1] += usize::from(!at(36.0, ws));
        masked[2] += usize::from(!at(46.0, ws));
    }
    // five of nine rows of the second incidence: their weight falls with the angle from it, and below half beyond 45
    assert!(
        masked[0] > masked[1] && masked[1] > 100 && masked[2] == 0,
        "{masked:?}"
    );
}

/// Pearson's statistic of sampled directions against the integral of `pdf` over cells of a hemisphere, in standard
/// deviations of its distribution.
fn deviation(model: &Rgl, wi: Direction, seed: u64) -> f64 {
    const SAMPLES: usize = 400_000;
    const CELLS: (usize, usize) = (10, 20);
    const SUB: usize = 24;
    let mut numbers = Numbers::new(seed);
    let mut found = vec![0.0; CELLS.0 * CELLS.1 + 1];
    let cell = |d: Direction| {
        let i = ((d.cos_theta() * CELLS.0 as f64) as usize).min(CELLS.0 - 1);
        let j = ((d.phi() / TAU * CELLS.1 as f64) as usize).min(CELLS.1 - 1);
        i * CELLS.1 + j
    };
    for _ in 0..SAMPLES {
        let u = [numbers.next(), numbers.next(), numbers.next()];
        let place = model
            .sample(wi, u)
            .map_or(CELLS.0 * CELLS.1, |s| cell(s.direction));
        found[place] += 1.0;
    }
    let mut expected = vec![0.0; CELLS.0 * CELLS.1 + 1];
    let omega = TAU / (CELLS.0 * CELLS.1 * SUB * SUB) as f64;
    for i in 0..CELLS.0 * SUB {
        for j in 0..CELLS.1 * SUB {
            let z = (i as f64 + 0.5) / (CELLS.0 * SUB) as f64;
            let phi = TAU * (j as f64 + 0.5) / (CELLS.1 * SUB) as f64;
            let r = (1.0 - z * z).sqrt();
            let d = Direction::new(DVec3::new(r * phi.cos(), r * phi.sin(), z)).unwrap();
            expected[cell(d)] += omega * SAMPLES as f64 * Bsdf::pdf(model, wi, d);
        }
    }
    let inside: f64 = expected.iter().sum();
    expected[CELLS.0 * CELLS.1] = SAMPLES as f64 - inside;
    let (mut sum, mut cells) = (0.0, 0.0);
    for (f, e) in found.iter().zip(&expected).filter(|(_, e)| **e > 20.0) {
        sum += (f - e).powi(2) / e;
        cells += 1.0;
    }
    assert!(cells > 100.0);
    (sum - cells) / (2.0_f64 * cells).sqrt()
}

/// False alarms: less than one in 1000 for each of the six cases (normal approximation, 4 standard deviations, the
/// quadrature of the cells included).
#[test]
fn samples_follow_the_density() {
    for phi_i in [vec![0.0], full_turn()] {
        let mut tables = material(&phi_i);
        // every channel positive, so that no sample fails for its weight
        tables.spectra.values.iter_mut().for_each(|v| *v = v.abs() + 0.1);
        let model = Rgl::new(tables).unwrap();
        for theta in [10.0, 40.0, 75.0] {
            let d = deviation(&model, Direction::from_degrees(theta, 33.0), 11);
            assert!(d.abs() < 4.0, "{theta} degrees, {} azimuths: {d}", phi_i.len());
        }
    }
}

#[test]
fn a_sample_carries_its_value_over_its_density() {
    let model = Rgl::new(material(&full_turn())).unwrap();
    let mut numbers = Numbers::new(8);
    for _ in 0..1000 {
        let w = numbers.direction();
        let Some(s) = model.sample(w, [numbers.next(), numbers.next(), 0.0]) else {
            continue;
        };
        let f = eval(&model, w, s.direction)[0];
        assert!((s.pdf / Bsdf::pdf(&model, w, s.direction) - 1.0).abs() < 1e-12);
        assert!((s.weight * s.pdf / (f * s.direction.cos_theta()) - 1.0).abs() < 1e-12);
    }
}

#[test]
fn tables_that_do_not_fit_are_refused_with_their_name() {
    type Spoil = fn(&mut RglTables);
    let cases: [(&str, Spoil); 16] = [
        ("theta_i", |t| t.theta_i.clear()),
        ("theta_i", |t| t.theta_i.swap(0, 1)),
        ("theta_i", |t| t.theta_i[0] = f64::NAN),
        ("theta_i", |t| t.theta_i[3] = 1.8),
        ("phi_i", |t| t.phi_i = vec![0.0, 0.1, 0.2]),
        ("vndf", |t| t.phi_i.push(0.5)),
        ("ndf", |t| t.ndf.values[3] = -1.0),
        ("sigma", |t| t.sigma.values[3] = 0.0),
        ("vndf", |t| t.vndf.values[3] = f32::INFINITY),
        ("vndf", |t| t.vndf.values.fill(0.0)),
        ("luminance", |t| t.luminance.values[..99].fill(0.0)),
        ("luminance", |t| {
            t.luminance.shape.pop();
        }),
        ("channels", |t| t.channels.clear()),
        ("spectra", |t| t.channels.push(Channel::Green)),
        ("spectra", |t| t.spectra.values[7] = f32::NAN),
        ("valid", |t| t.valid = Some(vec![true])),
    ];
    for (field, spoil) in cases {
        let mut tables = material(&[0.0]);
        spoil(&mut tables);
        let text = Rgl::new(tables).unwrap_err().to_string();
        assert!(text.starts_with(&format!("{field}: found")), "{field}: {text}");
    }
}
