//! Evaluations a second of the data-driven model: `cargo run --release -p gonio-build --example eval_speed`.

#![allow(clippy::print_stdout, reason = "an example talks to its user")]

use std::error::Error;
use std::f64::consts::PI;
use std::hint::black_box;
use std::time::Instant;

use gonio_bsdf::analytic::{Spectrum, WardGmd};
use gonio_bsdf::{Bsdf, Channel};
use gonio_build::{BuildOptions, DataDriven};
use gonio_geom::{Angles, Direction};
use gonio_scan::{Flags, Measurement, Slice};

/// Points of the sphere's upper half, evenly spread.
fn spiral(n: usize) -> impl Iterator<Item = Direction> {
    let golden = PI * (1.0 + 5f64.sqrt());
    (0..n).map(move |k| {
        let z = 1.0 - (k as f64 + 0.5) / n as f64;
        Direction::from_spherical(z.acos(), golden * k as f64)
    })
}

fn slice(truth: &dyn Bsdf, theta_i: f64, phi_i: f64, readings: usize) -> Slice {
    let incidence = Angles::from_degrees(theta_i, phi_i);
    let directions: Vec<Direction> = spiral(readings).filter(|d| d.cos_theta() > 0.05).collect();
    let dsf: Vec<f64> = directions
        .iter()
        .map(|&ws| truth.eval_first(incidence.direction(), ws) * ws.cos_theta())
        .collect();
    Slice {
        incidence,
        channel: Channel::Photopic,
        theta_s: directions.iter().map(|d| d.theta()).collect(),
        phi_s: directions.iter().map(|d| d.phi()).collect(),
        u_dsf: dsf.iter().map(|d| 0.01 * d + 2e-4).collect(),
        omega: vec![0.0; dsf.len()],
        flags: vec![Flags::NONE; dsf.len()],
        dsf,
        u_common: 0.0,
        integrals: Vec::new(),
    }
}

fn main() -> Result<(), Box<dyn Error>> {
    let truth = WardGmd::isotropic(&Spectrum::photopic("rho", 0.6)?, 0.15)?;
    let polar: Vec<(f64, f64)> = (0..8).map(|k| (10.0 * f64::from(k), 180.0)).collect();
    let mut full = vec![(0.0, 0.0)];
    full.extend((0..24).map(|k| (20.0 * f64::from(1 + k % 3), 45.0 * f64::from(k / 3))));
    let queries: Vec<Direction> = spiral(1000).collect();
    for (name, incidences, readings) in [
        ("isotropic, 8 incidences", &polar, 50_000),
        ("anisotropic, 25 incidences", &full, 20_000),
    ] {
        let slices = incidences
            .iter()
            .map(|&(t, p)| slice(&truth, t, p, readings))
            .collect();
        let measurement = Measurement {
            slices,
            ..Measurement::default()
        };
        let options = BuildOptions {
            symmetry: if incidences.len() > 8 {
                gonio_build::SymmetryChoice::Anisotropic
            } else {
                gonio_build::SymmetryChoice::Auto
            },
            ..BuildOptions::default()
        };
        let start = Instant::now();
        let model = DataDriven::build(&measurement, &options)?;
        let seconds = start.elapsed().as_secs_f64();
        println!("{name}, {readings} readings each: built in {seconds:.2} s");
        let start = Instant::now();
        for &wi in &queries {
            for &ws in &queries {
                black_box(model.eval_first(wi, ws));
            }
        }
        let each = start.elapsed().as_secs_f64() / (queries.len() * queries.len()) as f64;
        println!("  {:.3} us an evaluation, one thread", 1e6 * each);
    }
    Ok(())
}
