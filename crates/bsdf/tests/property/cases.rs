//! What the laws are tested on.

use std::sync::LazyLock;

use gonio_bsdf::analytic::{Parametric, Sum, family};
use gonio_bsdf::{Bsdf, Channel, RadianceMaterial};
use gonio_geom::Direction;
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64Mcg;

use crate::common::{AZIMUTH, build, chosen, settings};

/// A model with parameters, and what it is called in a message.
pub(crate) struct Case {
    pub(crate) label: String,
    pub(crate) model: Box<dyn Bsdf>,
    /// Scale of the narrowest width, for directions near a peak.
    pub(crate) width: f64,
}

/// Every registered model, sum and Radiance material.
pub(crate) fn everything() -> impl Iterator<Item = &'static Case> {
    registered().iter().chain(sums()).chain(materials())
}

/// Every analytic model with every setting.
pub(crate) fn registered() -> &'static [Case] {
    static CASES: LazyLock<Vec<Case>> = LazyLock::new(make_registered);
    &CASES
}

fn make_registered() -> Vec<Case> {
    let mut cases = Vec::new();
    for f in chosen() {
        for setting in settings(f.info()) {
            cases.push(Case {
                label: format!("{} with {}", f.info().name, setting.label),
                model: build(f, &setting),
                width: narrowest(f, &setting.values),
            });
        }
    }
    cases
}

/// The least width among `values`; 1 where the model has none.
pub(crate) fn narrowest(f: &dyn Parametric, values: &[f64]) -> f64 {
    let widths = f.info().parameters.iter().zip(values);
    widths
        .filter(|(p, _)| p.role == gonio_bsdf::analytic::Role::Width)
        .fold(1.0, |least, (_, &v)| v.min(least))
}

/// Sums of models: two parts, both components, three channels, many lobes, one part alone.
pub(crate) fn sums() -> &'static [Case] {
    static CASES: LazyLock<Vec<Case>> = LazyLock::new(make_sums);
    &CASES
}

fn make_sums() -> Vec<Case> {
    let photopic = |name: &str, p: &[f64]| model(name, &[(Channel::Photopic, p.to_vec())]);
    let colours = |name: &str, red: &[f64], green: &[f64], blue: &[f64]| {
        model(
            name,
            &[
                (Channel::Red, red.to_vec()),
                (Channel::Green, green.to_vec()),
                (Channel::Blue, blue.to_vec()),
            ],
        )
    };
    type Parts = Vec<Box<dyn Bsdf>>;
    let list: Vec<(&str, f64, Parts)> = vec![
        (
            "diffuse and gloss",
            0.05,
            vec![photopic("lambert", &[0.5]), photopic("ward-gmd", &[0.1, 0.05])],
        ),
        (
            "translucent",
            0.08,
            vec![
                photopic("lambert", &[0.2]),
                photopic("ward-gmd-anisotropic", &[0.05, 0.08, 0.3, 0.4]),
                photopic("lambert-transmission", &[0.2]),
                photopic("bounded-transmission-lobe", &[0.4, 0.15]),
            ],
        ),
        (
            "three colours, a lobe that is black in the first",
            0.02,
            vec![
                colours("lambert", &[0.4], &[0.2], &[0.0]),
                colours("ward-gmd", &[0.0, 0.1], &[0.1, 0.1], &[0.3, 0.2]),
                colours("abg", &[0.05, 0.02, 2.0], &[0.05, 0.02, 2.0], &[0.05, 0.02, 1.5]),
            ],
        ),
        (
            "six lobes",
            0.01,
            vec![
                photopic("lambert", &[0.2]),
                photopic("ward-gmd", &[0.1, 0.01]),
                photopic("ward-gmd", &[0.1, 0.03]),
                photopic("ward-gmd", &[0.1, 0.1]),
                photopic("harvey-shack", &[0.1, 0.01, 1.5]),
                photopic("ward-gmd", &[0.1, 0.3]),
            ],
        ),
        ("one part", 0.2, vec![photopic("ward-gmd", &[0.9, 0.2])]),
        (
            "more than all of the light",
            0.2,
            vec![photopic("lambert", &[0.9]), photopic("ward-gmd", &[0.9, 0.2])],
        ),
    ];
    list.into_iter()
        .map(|(label, width, parts)| Case {
            label: label.to_owned(),
            model: Box::new(Sum::new(parts).unwrap()),
            width,
        })
        .collect()
}

/// Radiance materials of every type: with lobes, with ideal parts, with both.
pub(crate) fn materials() -> &'static [Case] {
    static CASES: LazyLock<Vec<Case>> = LazyLock::new(make_materials);
    &CASES
}

fn make_materials() -> Vec<Case> {
    let list: [(&str, &str, &[f64], f64); 16] = [
        ("plastic", "", &[0.0, 0.4, 0.8, 0.05, 0.1], 0.1),
        ("plastic", "", &[0.2, 0.4, 0.8, 0.05, 0.0], 1.0),
        ("plastic", "", &[0.2, 0.4, 0.8, 0.01, 0.0], 1.0),
        ("metal", "", &[0.9, 0.6, 0.2, 0.8, 0.02], 0.02),
        ("metal", "", &[0.9, 0.6, 0.2, 0.8, 0.0], 1.0),
        ("trans", "", &[0.9, 0.8, 0.7, 0.05, 0.2, 0.6, 0.5], 0.2),
        ("trans", "", &[0.9, 0.8, 0.7, 0.05, 0.0, 0.6, 0.5], 1.0),
        ("trans", "", &[1.0, 1.0, 1.0, 0.05, 0.0, 1.0, 1.0], 1.0),
        ("plastic2", "1 1 0 .", &[0.5, 0.4, 0.3, 0.1, 0.1, 0.3], 0.1),
        ("metal2", "0 0 1 .", &[0.5, 0.4, 0.3, 0.9, 0.1, 0.3], 0.1),
        (
            "trans2",
            "0 1 0 .",
            &[0.5, 0.4, 0.3, 0.1, 0.1, 0.3, 0.8, 0.9],
            0.1,
        ),
        (
            "ashik2",
            "1 0 0 .",
            &[0.3, 0.2, 0.1, 0.1, 0.2, 0.3, 50.0, 200.0],
            0.1,
        ),
        ("glass", "", &[0.96, 0.9, 0.5], 1.0),
        ("mirror", "", &[0.9, 0.8, 0.7], 1.0),
        ("dielectric", "", &[1.0, 1.0, 1.0, 1.5, 0.0], 1.0),
        ("dielectric", "", &[1.0, 1.0, 1.0, 0.75, 0.0], 1.0),
    ];
    list.into_iter()
        .map(|(word, strings, reals, width)| {
            let strings: Vec<String> = strings.split_whitespace().map(String::from).collect();
            let material = RadianceMaterial::from_arguments(word, &strings, reals)
                .unwrap()
                .unwrap();
            Case {
                label: format!("{word} {reals:?}"),
                model: material.bsdf().unwrap(),
                width,
            }
        })
        .collect()
}

/// The model called `name`.
pub(crate) fn model(name: &str, parameters: &[(Channel, Vec<f64>)]) -> Box<dyn Bsdf> {
    family(name).unwrap().model(parameters).unwrap()
}

/// Directions of incidence for `model`, one azimuth if it is isotropic, else three.
pub(crate) fn incidences(model: &dyn Bsdf, thetas: &[f64]) -> Vec<Direction> {
    let azimuths: &[f64] = if model.properties().isotropic {
        &[0.0]
    } else {
        &[0.0, 45.0, 90.0]
    };
    thetas
        .iter()
        .flat_map(|&t| {
            azimuths
                .iter()
                .map(move |a| Direction::from_degrees(t, AZIMUTH + a))
        })
        .collect()
}

/// Pairs all over both hemispheres, and pairs near the mirror and the unbent direction on the scale of `width`.
pub(crate) fn pairs(width: f64, seed: u64, count: usize) -> Vec<(Direction, Direction)> {
    let mut rng = Pcg64Mcg::seed_from_u64(seed);
    let mut anywhere = || {
        let z: f64 = rng.random_range(-0.999..0.999);
        let d = Direction::from_spherical(z.acos(), rng.random_range(0.0..std::f64::consts::TAU));
        let step: [f64; 3] = std::array::from_fn(|_| rng.random_range(-1.0..1.0) * 4.0 * width);
        (d, step)
    };
    let mut pairs = Vec::with_capacity(count);
    while pairs.len() < count {
        let ((wi, _), (ws, step)) = (anywhere(), anywhere());
        let near = |d: Direction| Direction::new(d.vec() + gonio_geom::DVec3::from_array(step)).unwrap_or(d);
        pairs.extend([(wi, ws), (wi, near(wi.mirror())), (wi, near(wi.through()))]);
    }
    pairs
}
