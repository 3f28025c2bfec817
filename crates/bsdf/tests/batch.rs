//! Batches agree with one pair at a time, for every analytic model and for sums.

#![allow(clippy::unwrap_used)] // helpers outside #[test] fail a test by panicking, as the tests themselves do

use gonio_bsdf::analytic::{Role, Scatters, Sum, families};
use gonio_bsdf::batch::{Directions, SampleColumns, first_not_uniform};
use gonio_bsdf::{Bsdf, Channel};
use gonio_geom::{DVec3, Direction};

const CHANNELS: [Channel; 5] = [
    Channel::Red,
    Channel::Green,
    Channel::Blue,
    Channel::Photopic,
    Channel::Wavelength(532.0),
];

/// Every family with one, three and five channels of different amplitudes, and with a width of its own a channel.
fn models() -> Vec<(String, Box<dyn Bsdf>)> {
    let mut models: Vec<(String, Box<dyn Bsdf>)> = Vec::new();
    for family in families() {
        let info = family.info();
        for (channels, own_width) in [(1, false), (3, false), (5, false), (3, true)] {
            let parameters: Vec<_> = (0..channels)
                .map(|c| {
                    let mut p = info.defaults();
                    for (value, i) in p.iter_mut().zip(info.parameters) {
                        let step = c as f64;
                        match i.role {
                            Role::Amplitude => *value *= 1.0 - 0.15 * step,
                            // The index of a conductor; that of an interface moves its lobe too.
                            Role::Index if info.scatters == Scatters::Reflection => {
                                *value *= 1.0 + 0.1 * step
                            }
                            Role::Width if own_width => *value *= 1.0 - 0.15 * step,
                            _ => {}
                        }
                    }
                    (CHANNELS[c], p)
                })
                .collect();
            let name = format!("{} of {channels} channels, own widths {own_width}", info.name);
            models.push((name, family.model(&parameters).unwrap()));
        }
    }
    let rgb = |name: &str, scale: f64| {
        let family = gonio_bsdf::analytic::family(name).unwrap();
        let p = |a: f64| {
            let mut p = family.info().defaults();
            p[0] *= a * scale;
            p
        };
        let channels = [
            (Channel::Red, p(1.0)),
            (Channel::Green, p(0.5)),
            (Channel::Blue, p(0.2)),
        ];
        family.model(&channels).unwrap()
    };
    let parts = vec![
        rgb("lambert", 0.6),
        rgb("ward-gmd", 0.3),
        rgb("transmission-lobe", 0.2),
    ];
    models.push(("a sum".into(), Box::new(Sum::new(parts).unwrap())));
    models
}

/// 2000 pairs on both sides, half of them near the mirror or the unbent direction; no whole number of blocks.
fn pairs() -> Vec<(Direction, Direction)> {
    (0..2000)
        .map(|k| {
            let t = f64::from(k);
            let wi = Direction::from_degrees((0.5 + 1.63 * t) % 180.0, 3.0 * t);
            let near = Direction::from_degrees(
                (wi.theta().to_degrees() + 2.0 * (0.37 * t).sin()).clamp(0.1, 179.9),
                3.0 * t + 180.0 + 2.0 * (0.71 * t).cos(),
            );
            let ws = match k % 4 {
                0 => near,
                1 => near.flipped(),
                _ => Direction::from_degrees((179.0 - 1.71 * t).rem_euclid(180.0), 41.0 * t),
            };
            (wi, ws)
        })
        .collect()
}

fn columns<T>(directions: impl Iterator<Item = Direction>, to: impl Fn(f64) -> T) -> [Vec<T>; 3] {
    let mut columns: [Vec<T>; 3] = [Vec::new(), Vec::new(), Vec::new()];
    for d in directions {
        for (column, v) in columns.iter_mut().zip(d.vec().to_array()) {
            column.push(to(v));
        }
    }
    columns
}

fn each<T>(columns: &[Vec<T>; 3]) -> Directions<'_, T> {
    Directions::Each(columns.each_ref().map(|c| &c[..]))
}

fn rows<T>(values: &mut [T], n: usize) -> Vec<&mut [T]> {
    values.chunks_mut(n).collect()
}

/// Values in single precision of single-precision vectors, and in double precision of the same vectors.
fn both(model: &dyn Bsdf, wi: [[f32; 3]; 2000], ws: &[Vec<f32>; 3], one: bool) -> (Vec<f32>, Vec<f64>) {
    let (n, channels) = (ws[0].len(), model.channels().len());
    let wi: [Vec<f32>; 3] = std::array::from_fn(|k| wi.iter().map(|v| v[k]).collect());
    let double = |c: &[Vec<f32>; 3]| {
        c.each_ref()
            .map(|c| c.iter().map(|v| f64::from(*v)).collect::<Vec<_>>())
    };
    let mut single = vec![f32::NAN; n * channels];
    let mut exact = vec![f64::NAN; n * channels];
    let first = [wi[0][0], wi[1][0], wi[2][0]];
    let from = if one { Directions::One(first) } else { each(&wi) };
    model.eval_f32(from, each(ws), &mut rows(&mut single, n));
    let (wi64, ws64) = (double(&wi), double(ws));
    let from = if one {
        Directions::One(first.map(f64::from))
    } else {
        each(&wi64)
    };
    model.eval_f64(from, each(&ws64), &mut rows(&mut exact, n));
    (single, exact)
}

#[test]
fn double_precision_batches_give_the_values_of_single_pairs() {
    let pairs = pairs();
    let n = pairs.len();
    let wi = columns(pairs.iter().map(|p| p.0), |v| v);
    let ws = columns(pairs.iter().map(|p| p.1), |v| v);
    for (name, model) in models() {
        let channels = model.channels().len();
        let mut got = vec![f64::NAN; n * channels];
        model.eval_f64(each(&wi), each(&ws), &mut rows(&mut got, n));
        let mut want = vec![0.0; channels];
        let mut lit = 0;
        for (j, (wi, ws)) in pairs.iter().enumerate() {
            model.eval(*wi, *ws, &mut want);
            for (c, &want) in want.iter().enumerate() {
                let got = got[c * n + j];
                assert!(
                    (got - want).abs() <= 1e-11 * want.max(1e-290),
                    "{name}: {got} {want}"
                );
                lit += usize::from(want > 0.0);
            }
        }
        assert!(lit > n / 4 * channels, "{name}: only {lit} values are lit");
    }
}

#[test]
fn single_precision_batches_agree_with_double_precision_at_the_same_vectors() {
    let pairs = pairs();
    let wi: [[f32; 3]; 2000] = std::array::from_fn(|j| pairs[j].0.vec().to_array().map(|v| v as f32));
    let ws = columns(pairs.iter().map(|p| p.1), |v| v as f32);
    for (name, model) in models() {
        for one in [false, true] {
            let (single, exact) = both(model.as_ref(), wi, &ws, one);
            let top = exact.iter().fold(0.0_f64, |m, v| m.max(*v));
            assert!(top > 0.0, "{name}");
            for (s, e) in single.iter().zip(&exact) {
                // A lobe e^-x loses what x loses, and x is at most ln(top / value) or so.
                let tolerance = 2e-6 * (1.0 + (top / e.max(1e-30 * top)).ln());
                assert!(
                    (f64::from(*s) - e).abs() <= tolerance * e + 1e-28 * top,
                    "{name}: {s} {e}"
                );
            }
        }
    }
}

#[test]
fn sampled_batches_follow_the_sampler_of_single_directions() {
    let n = 1003;
    let u: [Vec<f64>; 3] = [0.754_877_666, 0.569_840_291, 0.362_476_88]
        .map(|a: f64| (0..n).map(|k| (a * (k as f64 + 0.5)).fract()).collect());
    let u32s = u
        .each_ref()
        .map(|c| c.iter().map(|v| *v as f32).collect::<Vec<_>>());
    for (name, model) in models() {
        let channels = model.channels().len();
        for w in [
            Direction::from_degrees(40.0, 20.0),
            Direction::from_degrees(130.0, 250.0),
        ] {
            let mut buffer = vec![f64::NAN; n * (4 + channels)];
            let mut single = vec![f32::NAN; n * (4 + channels)];
            model.sample_f64(
                Directions::One(w.vec().to_array()),
                u.each_ref().map(|c| &c[..]),
                &mut sample_columns(&mut buffer, n),
            );
            model.sample_f32(
                Directions::One(w.vec().to_array().map(|v| v as f32)),
                u32s.each_ref().map(|c| &c[..]),
                &mut sample_columns(&mut single, n),
            );
            let mut f = vec![0.0; channels];
            let mut drawn = 0;
            for j in 0..n {
                let at = |k: usize| buffer[k * n + j];
                let at32 = |k: usize| f64::from(single[k * n + j]);
                let Some(sample) = model.sample(w, [u[0][j], u[1][j], u[2][j]]) else {
                    assert!(at(0).is_nan() && at(3) == 0.0 && at(4) == 0.0, "{name}");
                    continue;
                };
                drawn += 1;
                let s = DVec3::new(at(0), at(1), at(2));
                assert!(
                    (s - sample.direction.vec()).length() < 1e-12,
                    "{name}: {s} {sample:?}"
                );
                assert!(
                    (at(3) / sample.pdf - 1.0).abs() < 1e-9,
                    "{name}: {} {sample:?}",
                    at(3)
                );
                model.eval(w, sample.direction, &mut f);
                for (c, f) in f.iter().enumerate() {
                    let weight = f * sample.direction.cos_theta().abs() / sample.pdf;
                    assert!(
                        (at(4 + c) - weight).abs() <= 1e-9 * weight,
                        "{name}: {}",
                        at(4 + c)
                    );
                }
                // In single precision a sample next to a choice (a part of a sum, the horizon) may fall beyond it.
                let s32 = DVec3::new(at32(0), at32(1), at32(2));
                if s32.is_finite() && (s32 - s).length() < 1e-3 {
                    // The cosine is a root of what x and y leave, so their rounding counts more at the horizon.
                    assert!((s32 - s).length() < 1e-6 / s.z.abs(), "{name}: {s32} {s}");
                    assert!(
                        // Masked weights vanish with the cosine, whose rounding then counts.
                        (at32(4) - at(4)).abs() <= (1e-4 + 2e-7 / s.z.abs()) * at(4),
                        "{name}: {} {}",
                        at32(4),
                        at(4)
                    );
                    assert!(
                        (at32(3) - at(3)).abs() <= 1e-3 * at(3),
                        "{name}: {} {}",
                        at32(3),
                        at(3)
                    );
                } else {
                    drawn -= 1;
                }
            }
            assert!(drawn > n / 2, "{name}: only {drawn} samples to compare");
        }
    }
}

fn sample_columns<T>(buffer: &mut [T], n: usize) -> SampleColumns<'_, T> {
    let mut rows = buffer.chunks_mut(n);
    let mut next = || rows.next().unwrap();
    SampleColumns {
        direction: [next(), next(), next()],
        pdf: next(),
        weight: rows.collect(),
    }
}

#[test]
fn vectors_that_are_not_unit_are_found() {
    let mut columns = columns(pairs().iter().map(|p| p.0), |v| v as f32);
    assert_eq!(each(&columns).first_not_unit(1e-5), None);
    columns[2][1234] += 0.01;
    columns[0][1500] = f32::NAN;
    assert_eq!(each(&columns).first_not_unit(1e-5), Some(1234));
    columns[2][1234] = f32::INFINITY;
    assert_eq!(each(&columns).first_not_unit(1e-5), Some(1234));
    assert_eq!(
        Directions::One([0.0, 0.0, 1.01_f64]).first_not_unit(1e-5),
        Some(0)
    );
    assert_eq!(Directions::One([0.0, 0.6, -0.8_f64]).first_not_unit(1e-5), None);
}

#[test]
fn numbers_outside_the_unit_interval_are_found() {
    let mut u: Vec<f32> = (0..100).map(|k| 0.01 * k as f32).collect();
    assert_eq!(first_not_uniform(&u), None);
    u[70] = 1.0;
    assert_eq!(first_not_uniform(&u), Some(1.0));
    u[30] = f32::NAN;
    assert!(first_not_uniform(&u).is_some_and(f32::is_nan));
}
