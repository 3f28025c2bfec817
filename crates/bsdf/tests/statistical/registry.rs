//! Every registered model, over its parameters and incidences.

use std::sync::{Arc, LazyLock};

use gonio_bsdf::analytic::{Parametric, Sum, family, models, retro_lobes};
use gonio_bsdf::compact::{BaseLobe, CompactPart, Frame, IdealPart, Quantised, Symmetry};
use gonio_bsdf::{Bsdf, Channel, Compact, FourComponents, RadianceMaterial};
use gonio_geom::{Component, Side};
use rayon::prelude::*;

use crate::chi_square::sidak;
use crate::common::{BACK, FRONT, build, incidence, settings, wanted};
use crate::trial::{Trial, run};

/// Rate at which all comparisons of a kind together raise a false alarm, were the seeds drawn anew.
const FALSE_ALARM: f64 = 1e-3;
/// Samples a case in the tests that always run.
const SAMPLES: u64 = 500_000;

/// The number of samples that `GONIO_SAMPLES` names, else `default`.
fn samples_or(default: u64) -> u64 {
    std::env::var("GONIO_SAMPLES").map_or(default, |n| n.parse().unwrap())
}

/// A model under test with all its settings.
struct Subject {
    name: &'static str,
    settings: Vec<(String, Arc<dyn Bsdf>)>,
}

struct Case {
    name: &'static str,
    setting: String,
    model: Arc<dyn Bsdf>,
    theta: f64,
}

impl Case {
    fn of(subject: &Subject, setting: usize, theta: f64) -> Self {
        let (label, model) = &subject.settings[setting];
        Case {
            name: subject.name,
            setting: label.clone(),
            model: model.clone(),
            theta,
        }
    }

    fn label(&self) -> String {
        format!("{} with {} at {} degrees", self.name, self.setting, self.theta)
    }

    fn trial(&self, samples: u64) -> Trial {
        let (model, label) = (self.model.as_ref(), self.label());
        run(
            model,
            |w, u| model.sample(w, u),
            incidence(self.theta),
            &label,
            samples,
        )
    }
}

/// Radiance materials with a density: sums with parts of their own, ideal parts and a first channel of zero.
fn radiance() -> Subject {
    let oval = "0.8 0.6 0 .";
    let settings = [
        ("plastic", "", &[0.0, 0.4, 0.8, 0.3, 0.1][..]),
        ("plastic", "", &[0.6, 0.4, 0.8, 0.05, 0.0]),
        ("metal", "", &[0.6, 0.4, 0.8, 0.7, 0.0]),
        ("trans", "", &[0.9, 0.4, 0.8, 0.1, 0.2, 0.6, 0.7]),
        ("trans", "", &[0.9, 0.4, 0.8, 0.1, 0.0, 0.6, 0.7]),
        ("metal2", oval, &[0.6, 0.4, 0.8, 0.7, 0.05, 0.3]),
        ("trans2", oval, &[0.9, 0.4, 0.8, 0.1, 0.3, 0.06, 0.6, 0.9]),
        ("ashik2", oval, &[0.3, 0.4, 0.8, 0.2, 0.3, 0.4, 400.0, 10.0]),
        ("ashik2", oval, &[0.0, 0.4, 0.8, 0.5, 0.3, 0.4, 3.0, 2000.0]),
    ];
    let model = |(word, strings, reals): (&str, &str, &[f64])| {
        let strings: Vec<String> = strings.split_whitespace().map(String::from).collect();
        let material = RadianceMaterial::from_arguments(word, &strings, reals)
            .unwrap()
            .unwrap();
        (format!("{word} {reals:?}"), Arc::from(material.bsdf().unwrap()))
    };
    Subject {
        name: "radiance",
        settings: settings.into_iter().map(model).collect(),
    }
}

/// Compact models: both components, isotropic and not, a lobe about the incidence, light that passes straight through,
/// ratios between 1/e and e.
fn compact() -> Subject {
    let settings = [
        Symmetry::Isotropic,
        Symmetry::Quadrilateral,
        Symmetry::HalfTurn,
        Symmetry::Anisotropic,
    ]
    .map(|symmetry| {
        let isotropic = symmetry.is_isotropic();
        let mut parts = FourComponents::default();
        for (side, component) in FourComponents::<()>::KEYS {
            let frame = Frame {
                symmetry,
                width: if isotropic { [0.1; 2] } else { [0.1, 0.3] },
                phi_x: if isotropic { 0.0 } else { 0.7 },
                shape: [8, if isotropic { 1 } else { 5 }, 12, 9],
            };
            let values: Vec<f64> = (0..frame.len()).map(|k| (0.37 * k as f64).sin()).collect();
            let (diffuse, lobe) = match (component, isotropic) {
                (Component::Reflection, true) => ("lambert", ("ggx", vec![0.5, 0.1])),
                (Component::Reflection, false) => {
                    ("lambert", ("ward-gmd-anisotropic", vec![0.3, 0.1, 0.3, 0.7]))
                }
                (Component::Transmission, _) => (
                    "lambert-transmission",
                    ("bounded-transmission-lobe", vec![0.2, 0.15]),
                ),
            };
            let mut lobes = vec![(diffuse, vec![0.1], 0.1), (lobe.0, lobe.1, 0.25)];
            if symmetry == Symmetry::HalfTurn && component == Component::Reflection {
                lobes.push(("round-retro-lobe", vec![0.1, 0.2], 0.1));
            }
            let base = lobes.into_iter().map(|(model, p, weight)| BaseLobe {
                model: model.into(),
                parameters: vec![p],
                weight,
            });
            let part = CompactPart {
                base: base.collect(),
                frame,
                table: Quantised::of(&frame, &values, 8).unwrap(),
            };
            parts.set(side, component, Some(part));
        }
        let mut ideal = FourComponents::default();
        if symmetry == Symmetry::HalfTurn {
            let shares = IdealPart {
                symmetry,
                phi_x: 0.2,
                shape: [2, 3],
                shares: vec![0.3, 0.2, 0.3, 0.1, 0.0, 0.1],
            };
            ideal.set(Side::Front, Component::Transmission, Some(shares));
        }
        let model = Compact::with_ideal(vec![Channel::Photopic], parts, ideal, false).unwrap();
        (symmetry.name().to_owned(), Arc::new(model) as Arc<dyn Bsdf>)
    });
    Subject {
        name: "compact",
        settings: settings.into(),
    }
}

/// The registered models, lobes of bases, a sum of four of them, Radiance materials and compact models.
fn subjects() -> Vec<Subject> {
    let retro = retro_lobes().map(|lobe| lobe as &dyn Parametric);
    let registered = models().chain(retro).map(|model| Subject {
        name: model.info().name,
        settings: settings(model.info())
            .iter()
            .map(|s| (s.label.clone(), Arc::from(build(model, s))))
            .collect(),
    });
    let part = |name: &str, values: &[f64]| {
        let parameters = [(Channel::Photopic, values.to_vec())];
        family(name).unwrap().model(&parameters).unwrap()
    };
    let sum = Sum::new(vec![
        part("lambert", &[0.2]),
        part("ward-gmd", &[0.05, 0.2]),
        part("lambert-transmission", &[0.1]),
        part("bounded-transmission-lobe", &[0.5, 0.15]),
    ]);
    let sum = Subject {
        name: "sum",
        settings: vec![("four parts".into(), Arc::new(sum.unwrap()))],
    };
    registered
        .chain([sum, radiance(), compact()])
        .filter(|s| wanted(s.name))
        .collect()
}

fn thetas() -> impl Iterator<Item = f64> {
    FRONT.into_iter().chain(BACK)
}

/// Every setting at every incidence.
fn all_cases() -> Vec<Case> {
    let mut cases = Vec::new();
    for subject in subjects() {
        for theta in thetas() {
            cases.extend((0..subject.settings.len()).map(|k| Case::of(&subject, k, theta)));
        }
    }
    cases
}

/// Every incidence with one setting each, in turn.
fn some_cases() -> Vec<Case> {
    let mut cases = Vec::new();
    for subject in subjects() {
        let n = subject.settings.len();
        cases.extend(
            thetas()
                .enumerate()
                .map(|(k, theta)| Case::of(&subject, (5 * k + 1) % n, theta)),
        );
    }
    cases
}

static TRIALS: LazyLock<Vec<(String, Trial)>> = LazyLock::new(|| {
    let samples = samples_or(SAMPLES);
    some_cases()
        .par_iter()
        .map(|case| (case.label(), case.trial(samples)))
        .collect()
});

fn improbable(p: impl Fn(&Trial) -> f64, say: impl Fn(&Trial) -> String) -> Vec<String> {
    let least = sidak(FALSE_ALARM, TRIALS.len());
    TRIALS
        .iter()
        .filter(|(_, t)| p(t).is_nan() || p(t) < least)
        .map(|(label, t)| format!("{label}: p = {:.1e}, {}", p(t), say(t)))
        .collect()
}

#[test]
fn samples_follow_the_density_by_chi_square() {
    let failed = improbable(
        |t| t.chi_square.p,
        |t| {
            format!(
                "{:?}, mass {} +- {:.0e}, {} samples",
                t.chi_square, t.mass, t.mass_error, t.samples
            )
        },
    );
    assert!(failed.is_empty(), "{}", failed.join("\n"));
}

#[test]
fn the_density_integrates_to_the_share_of_samples_that_succeed() {
    let failed = improbable(
        |t| t.p_accepted,
        |t| format!("mass {} +- {:.0e}", t.mass, t.mass_error),
    );
    assert!(failed.is_empty(), "{}", failed.join("\n"));
    for (label, t) in TRIALS.iter() {
        assert!(
            t.mass < 1.0 + 1e-6,
            "{label}: the density integrates to {}",
            t.mass
        );
    }
}

#[test]
fn the_mean_weight_is_the_albedo_by_t_test() {
    let failed = improbable(
        |t| t.p_mean,
        |t| format!("mean {} +- {:.1e}, albedo {}", t.mean, t.standard_error, t.albedo),
    );
    assert!(failed.is_empty(), "{}", failed.join("\n"));
}

/// The cases of the tests above at ten million samples each; only when asked for.
#[test]
#[ignore = "a quarter of an hour; `make validate` runs it"]
fn some_cases_at_ten_million_samples() {
    report(&some_cases(), samples_or(10_000_000));
}

/// Every setting at every incidence at a million samples; only when asked for.
#[test]
#[ignore = "a quarter of an hour; `make validate` runs it"]
fn the_whole_grid_at_a_million_samples() {
    report(&all_cases(), samples_or(1_000_000));
}

/// Judges the cases and writes one line each to the file that `GONIO_SAMPLERS` names.
fn report(cases: &[Case], samples: u64) {
    let least = sidak(FALSE_ALARM, cases.len());
    let rows: Vec<(bool, String)> = cases
        .par_iter()
        .map(|case| {
            let t = case.trial(samples);
            let good = [t.chi_square.p, t.p_accepted, t.p_mean]
                .iter()
                .all(|p| *p >= least);
            let row = format!(
                "{}\t{}\t{}\t{}\t{:e}\t{}\t{:e}\t{:e}\t{}\t{}\t{:e}\t{:e}",
                case.name,
                case.setting,
                case.theta,
                t.chi_square.degrees,
                t.chi_square.p,
                t.mass,
                t.mass_error,
                t.p_accepted,
                t.albedo,
                t.mean,
                t.standard_error,
                t.p_mean,
            );
            (good && t.mass < 1.0 + 1e-6, row)
        })
        .collect();
    if let Ok(path) = std::env::var("GONIO_SAMPLERS") {
        let lines: Vec<&str> = rows.iter().map(|(_, row)| row.as_str()).collect();
        std::fs::write(path, lines.join("\n") + "\n").unwrap();
    }
    let failed: Vec<&str> = rows
        .iter()
        .filter(|(good, _)| !good)
        .map(|(_, r)| r.as_str())
        .collect();
    assert!(failed.is_empty(), "below p = {least:.1e}:\n{}", failed.join("\n"));
}
