//! How often 95 % intervals hold the truth: random parameters of each model, measured with noise and a beam of finite
//! width, then fitted.
//!
//! `cargo run --release -p gonio-fit --example coverage -- [models] [cases] [beam fwhm, deg]`, models joined by commas or `all`.

#[path = "../tests/common/mod.rs"]
mod common;

use std::io::Write;

use common::{Campaign, measure, random_parameters, rng};
use gonio_bsdf::Channel;
use gonio_fit::{FitOptions, Kind, fit, fit_model, fit_models};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let arguments: Vec<String> = std::env::args().collect();
    let wanted = arguments.get(1).map_or("all", String::as_str);
    let cases: u64 = arguments.get(2).map_or(Ok(200), |n| n.parse())?;
    let beam: f64 = arguments.get(3).map_or(Ok(0.5), |n| n.parse())?;
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
