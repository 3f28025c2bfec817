//! The figures of docs/fit.md and docs/validation/fit.md.
//!
//! `cargo run --release -p gonio-fit --example figures -- coverage [models] [cases] [beam fwhm, deg]`: how often 95 % intervals
//! hold the truth, for random parameters of each model (joined by commas, or `all`), measured with noise and a beam of finite width.
//!
//! `cargo run --release -p gonio-fit --example figures -- speed [readings]`: CPU time of a joint fit with five parameters.

#[path = "../tests/measured/common.rs"]
mod common;

use std::error::Error;
use std::io::Write;

use common::{Campaign, measure, random_parameters, rng};
use gonio_bsdf::Channel;
use gonio_fit::{FitOptions, Kind, Weights, fit, fit_model, fit_models};

fn main() -> Result<(), Box<dyn Error>> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let at = |k: usize| arguments.get(k).map(String::as_str);
    match at(0) {
        Some("coverage") => coverage(
            at(1).unwrap_or("all"),
            at(2).map_or(Ok(200), str::parse)?,
            at(3).map_or(Ok(0.5), str::parse)?,
        ),
        Some("speed") => speed(at(1).map_or(Ok(1e6), str::parse)?),
        _ => Err("expected coverage or speed".into()),
    }
}

fn coverage(wanted: &str, cases: u64, beam: f64) -> Result<(), Box<dyn Error>> {
    let names: Vec<String> = if wanted == "all" {
        fit_models()?.into_iter().map(|m| m.name).collect()
    } else {
        wanted.split(',').map(str::to_owned).collect()
    };
    let mut out = std::io::stdout();
    writeln!(
        out,
        "model, parameter, cases, inside 95 %, rms of (found - truth) / u, limits, dispersion, s/fit"
    )?;
    for name in names {
        let model = fit_model(&name)?;
        let campaign = Campaign {
            noise: (0.01, 2e-4),
            u_common: 0.01,
            beam: (beam > 0.0).then_some(beam),
            ..Campaign::default()
        };
        let mut inside = vec![0_usize; model.parameters.len()];
        let mut limits = vec![0_usize; model.parameters.len()];
        let mut squares = vec![0.0; model.parameters.len()];
        let (mut seconds, mut failed, mut dispersion) = (0.0, 0, 0.0);
        for seed in 0..cases {
            let mut rng = rng(1000 + seed);
            let truth = random_parameters(&model, &[Channel::Photopic], &mut rng);
            let measurement = measure(&model, &truth, &campaign, &mut rng);
            let options = FitOptions {
                compare: Vec::new(),
                ..FitOptions::default()
            };
            let begin = std::time::Instant::now();
            let found = fit(&measurement, &model, &options);
            seconds += begin.elapsed().as_secs_f64();
            let Ok(found) = found else {
                failed += 1;
                continue;
            };
            dispersion += found.dispersion.unwrap_or(0.0);
            for (k, p) in model.parameters.iter().enumerate() {
                let t = truth[0].1[k];
                if let Some(e) = found.estimate(&p.name, Channel::Photopic) {
                    inside[k] += usize::from(e.low <= t && t <= e.high);
                    limits[k] += usize::from(e.kind != Kind::Value);
                    let z = (e.value - t) / e.u;
                    squares[k] += z * z;
                    if z.abs() > 5.0 {
                        writeln!(
                            out,
                            "  {name} seed {seed}: {} {t} found {} u {} {:?}",
                            p.name, e.value, e.u, e.kind
                        )?;
                    }
                }
            }
        }
        let done = (cases - failed).max(1) as f64;
        for (k, p) in model.parameters.iter().enumerate() {
            writeln!(
                out,
                "{name}, {}, {done}, {:.1} %, {:.2}, {}, {:.3}, {:.3}",
                p.name,
                100.0 * inside[k] as f64 / done,
                (squares[k] / done).sqrt(),
                limits[k],
                dispersion / done,
                seconds / cases as f64
            )?;
        }
        if failed > 0 {
            writeln!(out, "{name}: {failed} fits failed")?;
        }
    }
    Ok(())
}

/// Processor time of this process in seconds (Linux), in ticks of 10 ms.
fn cpu() -> f64 {
    let stat = std::fs::read_to_string("/proc/self/stat").unwrap_or_default();
    let fields: Vec<f64> = stat
        .rsplit(')')
        .next()
        .map(|rest| rest.split_whitespace().filter_map(|f| f.parse().ok()).collect())
        .unwrap_or_default();
    // The state letter is no number: utime and stime are the 11th and 12th that are.
    fields
        .get(10)
        .zip(fields.get(11))
        .map_or(f64::NAN, |(u, s)| 0.01 * (u + s))
}

fn speed(readings: f64) -> Result<(), Box<dyn Error>> {
    let model = fit_model("lambert+ward-gmd+ward-gmd")?;
    let pitch = (180.0 / std::f64::consts::PI) * (std::f64::consts::TAU * 4.0 / (0.93 * readings)).sqrt();
    let campaign = Campaign {
        noise: (0.01, 2e-4),
        pitch: (pitch, pitch),
        ..Campaign::default()
    };
    let truth = [(Channel::Photopic, vec![0.3, 0.05, 0.06, 0.1, 0.25])];
    let measurement = measure(&model, &truth, &campaign, &mut rng(1));
    let mut out = std::io::stdout();
    for weights in [Weights::Stated, Weights::Predicted] {
        let options = FitOptions {
            compare: Vec::new(),
            weights,
            ..FitOptions::default()
        };
        let begin = (cpu(), std::time::Instant::now());
        let found = fit(&measurement, &model, &options)?;
        writeln!(
            out,
            "{weights:?}: {} readings, {} evaluations, {:.2} CPU s, {:.2} s",
            found.readings,
            found.evaluations,
            cpu() - begin.0,
            begin.1.elapsed().as_secs_f64()
        )?;
        for e in &found.estimates {
            writeln!(out, "  {} = {:.6} u {:.1e}", e.name, e.value, e.u)?;
        }
    }
    Ok(())
}
