//! Scenes of RADIANCE text become what they say, and bad ones one clear error with file and line.
#![allow(clippy::unwrap_used, clippy::panic, clippy::excessive_precision, missing_docs)]

mod bad_files;
mod bad_input;
mod body;
mod function;
mod generate;
mod light;
mod looks;
mod measured;
mod pattern;
mod text;

use glam::Vec3;
use gonio_scene::{Loaded, read};
use gonio_trace::path::Limits;
use gonio_trace::sampler::Sampler;
use gonio_trace::scene::{Parts, Scene};

/// A scene of one file, in a folder of its own.
pub(crate) fn load(text: &str) -> Result<Loaded, String> {
    load_with(text, &[])
}

pub(crate) fn load_with(text: &str, more: &[(&str, &str)]) -> Result<Loaded, String> {
    let dir = tempfile::tempdir().unwrap();
    let file = dir.path().join("a.rad");
    std::fs::write(&file, text).unwrap();
    for (name, text) in more {
        std::fs::write(dir.path().join(name), text).unwrap();
    }
    let folder = format!("{}/", dir.path().display());
    read(&[file], &[]).map_err(|e| e.to_string().replace(&folder, ""))
}

pub(crate) fn parts(text: &str) -> Parts {
    parts_of(load(text))
}

pub(crate) fn parts_of(loaded: Result<Loaded, String>) -> Parts {
    match loaded {
        Ok(loaded) => {
            assert!(loaded.warnings.is_empty(), "{:?}", loaded.warnings);
            loaded.parts
        }
        Err(e) => panic!("{e}"),
    }
}

/// Mean radiance from a point towards another, and its standard error.
pub(crate) fn look(text: &str, from: Vec3, to: Vec3) -> (Vec3, f32) {
    look_at(parts(text), from, to)
}

pub(crate) fn look_at(parts: Parts, from: Vec3, to: Vec3) -> (Vec3, f32) {
    let scene = Scene::new(parts).unwrap();
    let limits = Limits::default();
    let (mut sum, mut square) = (Vec3::ZERO, 0.0);
    for pixel in 0..64 {
        let mut mean = Vec3::ZERO;
        for index in 0..256 {
            let mut sampler = Sampler::new(3, pixel, index);
            mean += scene.radiance(from, (to - from).normalize(), &limits, &mut sampler) / 256.0;
        }
        sum += mean / 64.0;
        square += mean.y * mean.y / 64.0;
    }
    (sum, ((square - sum.y * sum.y).max(0.0) / 63.0).sqrt())
}

/// Four standard errors and a thousandth for single precision and facets; false alarm 6e-5 a comparison.
#[track_caller]
pub(crate) fn close((found, error): (Vec3, f32), wanted: Vec3) {
    let off = (found - wanted).abs();
    let allowed = Vec3::splat(4.0 * error) + 1e-3 * wanted.abs();
    assert!(
        off.cmple(allowed + 1e-7).all(),
        "{found} +- {error}, wanted {wanted}"
    );
}

pub(crate) const WHITE: &str = "void plastic white 0 0 5 .5 .5 .5 0 0\n";
pub(crate) const FLOOR: &str =
    "void plastic white 0 0 5 .5 .5 .5 0 0\nwhite polygon f 0 0 12 -9 -9 0 9 -9 0 9 9 0 -9 9 0\n";
/// Above the floor, below what is tested at height 4.
pub(crate) const EYE: Vec3 = Vec3::new(0.0, 0.0, 3.0);
