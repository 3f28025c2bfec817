//! Samples of data-driven models against their densities and albedos. Seeds are fixed: a verdict is the same on every run.

#![allow(
    clippy::unwrap_used,
    dead_code,
    reason = "helpers that are shared; a test that cannot set up its material has failed"
)]

#[path = "../../../bsdf/tests/statistical/chi_square.rs"]
mod chi_square;
#[path = "../models/common/mod.rs"]
mod common;
#[path = "../../../bsdf/tests/statistical/partition.rs"]
mod partition;
#[path = "../../../bsdf/tests/statistical/trial.rs"]
mod trial;

use std::sync::Arc;

use gonio_bsdf::analytic::{Sum, family};
use gonio_bsdf::{Bsdf, Channel};
use gonio_build::{BuildOptions, DataDriven, SideBySide, SymmetryChoice};
use gonio_geom::Component::{self, Reflection, Transmission};
use gonio_geom::Direction;
use rayon::prelude::*;

use chi_square::sidak;
use common::{Noise, measure, thinned};
use trial::run;

/// Rate at which all comparisons together raise a false alarm, were the seeds drawn anew.
const FALSE_ALARM: f64 = 1e-3;
const SAMPLES: u64 = 100_000;

fn sum(parts: &[(&str, &[f64])]) -> Sum {
    let part = |(name, values): &(&str, &[f64])| {
        let parameters = [(Channel::Photopic, values.to_vec())];
        family(name).unwrap().model(&parameters).unwrap()
    };
    Sum::new(parts.iter().map(part).collect()).unwrap()
}

fn built(truth: &dyn Bsdf, components: &[Component], incidences: &[(f64, f64)]) -> DataDriven {
    let mut measurement = measure(truth, incidences, components, 87.0, Noise(0.01, 2e-4));
    thinned(&mut measurement, 5);
    let symmetry = if incidences.iter().all(|i| i.1 == 0.0) {
        SymmetryChoice::Isotropic
    } else {
        SymmetryChoice::Auto
    };
    let options = BuildOptions {
        symmetry,
        ..BuildOptions::default()
    };
    DataDriven::build(&measurement, &options).unwrap()
}

#[test]
fn samples_of_data_driven_models_follow_their_density() {
    let line: Vec<(f64, f64)> = [10.0, 25.0, 40.0, 55.0, 70.0].map(|t| (t, 0.0)).to_vec();
    let mut grid = vec![(0.0, 0.0)];
    for theta in [25.0, 50.0, 70.0] {
        grid.extend([0.0, 30.0, 60.0, 90.0].map(|phi| (theta, phi)));
    }
    let gloss = sum(&[("lambert", &[0.3]), ("ward-gmd", &[0.4, 0.1])]);
    let brushed = sum(&[
        ("lambert", &[0.2]),
        ("ward-gmd-anisotropic", &[0.4, 0.1, 0.3, 0.0]),
    ]);
    let veil = sum(&[
        ("lambert", &[0.2]),
        ("lambert-transmission", &[0.1]),
        ("bounded-transmission-lobe", &[0.5, 0.15]),
    ]);
    let gloss = built(&gloss, &[Reflection], &line);
    let both: Arc<dyn Bsdf> = Arc::new(gloss.clone());
    let models: [(&str, Box<dyn Bsdf>); 4] = [
        ("gloss", Box::new(gloss)),
        ("brushed", Box::new(built(&brushed, &[Reflection], &grid))),
        ("veil", Box::new(built(&veil, &[Reflection, Transmission], &line))),
        ("side by side", Box::new(SideBySide::new(vec![both]).unwrap())),
    ];
    let cases: Vec<(&str, &dyn Bsdf, f64)> = models
        .iter()
        .flat_map(|(name, model)| [0.0, 33.0, 78.0].map(|theta| (*name, &**model, theta)))
        .collect();
    let least = sidak(FALSE_ALARM, 2 * cases.len());
    let failed: Vec<String> = cases
        .par_iter()
        .filter_map(|(name, model, theta)| {
            let label = format!("{name} at {theta} degrees");
            let w = Direction::from_degrees(*theta, 20.0);
            let t = run(*model, |w, u| model.sample(w, u), w, &label, SAMPLES);
            // A facet may send light below the surface: that sample fails.
            let whole = (t.mass - 1.0).abs() < 5e-4 || (t.mass < 1.0 && t.p_accepted > least);
            let mean = (t.mean - t.albedo).abs() < 4.0 * t.standard_error + 5e-3 * t.albedo;
            // Weights would spread by far more than their mean, were samples drawn by the cosine.
            let spread = t.standard_error * (SAMPLES as f64).sqrt() / t.mean;
            (!(t.chi_square.p > least && whole && mean && spread < 1.5)).then(|| {
                format!(
                    "{label}: {:?}, mass {} +- {:.0e}, mean {} +- {:.1e}, albedo {}, spread {spread}",
                    t.chi_square, t.mass, t.mass_error, t.mean, t.standard_error, t.albedo
                )
            })
        })
        .collect();
    assert!(failed.is_empty(), "below p = {least:.1e}:\n{}", failed.join("\n"));
    let dark = Direction::from_degrees(120.0, 0.0);
    for (name, model, _) in &cases {
        assert!(model.sample(dark, [0.3; 3]).is_none(), "{name} from below");
        assert_eq!(model.pdf(dark, dark), 0.0, "{name} from below");
    }
}
