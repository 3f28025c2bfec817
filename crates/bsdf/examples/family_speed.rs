//! Pairs a second of every family, values and gradients. Run with --release.
#![allow(clippy::print_stdout)]
use gonio_bsdf::analytic::{Pairs, families};
use gonio_geom::Direction;
use std::time::Instant;
fn main() {
    let mut pairs = Pairs::default();
    let n = 100_000;
    for k in 0..n {
        let t = f64::from(k) / f64::from(n);
        pairs.push(
            Direction::from_degrees(40.0, 10.0),
            Direction::from_degrees(179.0 * t, 7919.0 * t),
        );
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
}
