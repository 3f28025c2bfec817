//! Pairs a second of every family, values and gradients. Run with --release.
#![allow(clippy::print_stdout, clippy::expect_used)]
use gonio_bsdf::Channel;
use gonio_bsdf::analytic::{Pairs, families};
use gonio_bsdf::batch::{Directions, SampleColumns};
use gonio_geom::Direction;
use std::time::Instant;
fn main() {
    let n = 100_000;
    let mut pairs = Pairs::with_capacity(Direction::from_degrees(40.0, 10.0), n as usize);
    for k in 0..n {
        let t = f64::from(k) / f64::from(n);
        pairs.push(Direction::from_degrees(179.0 * t, 7919.0 * t));
    }
    let n = pairs.len();
    for f in families() {
        let p = f.info().defaults();
        let (mut v, mut g) = (vec![0.0; n], vec![0.0; n * p.len()]);
        let t = Instant::now();
        for _ in 0..20 {
            f.dsf(&p, pairs.view(0..n), &mut v);
        }
        let a = t.elapsed().as_secs_f64() / 20.0;
        let t = Instant::now();
        for _ in 0..20 {
            f.dsf_and_gradient(&p, pairs.view(0..n), &mut v, &mut g);
        }
        let b = t.elapsed().as_secs_f64() / 20.0;
        println!(
            "{:28} {:8.1} M/s values {:8.1} M/s with {} derivatives",
            f.info().name,
            n as f64 / a / 1e6,
            n as f64 / b / 1e6,
            p.len()
        );
    }
    batches();
}

/// The same in single precision from a fixed incidence, one channel and three, and samples.
fn batches() {
    let n = 100_000;
    let directions: Vec<[f32; 3]> = (0..n)
        .map(|k| {
            let t = k as f64 / n as f64;
            let d = Direction::from_degrees(179.0 * t, 7919.0 * t).vec();
            [d.x as f32, d.y as f32, d.z as f32]
        })
        .collect();
    let column = |k: usize| -> Vec<f32> { directions.iter().map(|d| d[k]).collect() };
    let columns = [column(0), column(1), column(2)];
    let ws = columns.each_ref().map(|c| &c[..]);
    let u: Vec<Vec<f32>> = [12.9898, 78.233, 37.719]
        .iter()
        .map(|a| (0..n).map(|k| (f64::from(k) * a).fract() as f32).collect())
        .collect();
    let u = [&u[0][..], &u[1], &u[2]];
    let w = Direction::from_degrees(30.0, 10.0).vec();
    let wi = Directions::One([w.x as f32, w.y as f32, w.z as f32]);
    let n = n as usize;
    for family in families() {
        let mut p = family.info().defaults();
        let mut rgb = Vec::new();
        for c in [Channel::Red, Channel::Green, Channel::Blue] {
            p[0] *= 0.9;
            rgb.push((c, p.clone()));
        }
        let mut rates = Vec::new();
        for channels in [1, 3] {
            let model = family.model(&rgb[..channels]).expect("allowed parameters");
            let mut f = vec![0.0; n * channels];
            let mut rows: Vec<&mut [f32]> = f.chunks_mut(n).collect();
            let t = Instant::now();
            for _ in 0..20 {
                model.eval_f32(wi, Directions::Each(ws), &mut rows);
            }
            rates.push(20.0 * n as f64 / t.elapsed().as_secs_f64() / 1e6);
            let mut s = vec![0.0; n * 4];
            let mut columns = s.chunks_mut(n);
            let mut next = || columns.next().expect("four columns");
            let mut out = SampleColumns {
                direction: [next(), next(), next()],
                weight: f.chunks_mut(n).collect(),
                pdf: next(),
            };
            let t = Instant::now();
            model.sample_f32(wi, u, &mut out);
            let runs = if t.elapsed().as_secs_f64() > 5e-3 { 2 } else { 20 };
            let t = Instant::now();
            for _ in 0..runs {
                model.sample_f32(wi, u, &mut out);
            }
            rates.push(runs as f64 * n as f64 / t.elapsed().as_secs_f64() / 1e6);
        }
        println!(
            "{:28} {:8.1} M/s f32 {:8.1} M/s rgb  samples {:8.1} M/s {:8.1} M/s rgb",
            family.info().name,
            rates[0],
            rates[2],
            rates[1],
            rates[3]
        );
    }
}
