//! Renders files of a scene: `room SIZE SAMPLES SEED VIEW OUT FILE…` writes radiances as single precision, red, green and blue,
//! row by row.
#![allow(clippy::print_stdout, clippy::unwrap_used, missing_docs)]

use std::path::PathBuf;
use std::sync::atomic::AtomicBool;

use gonio_scene::view;
use gonio_trace::camera::Camera;
use gonio_trace::path::Limits;
use gonio_trace::render::{Effort, Picture};
use gonio_trace::scene::Scene;

fn main() {
    let words: Vec<String> = std::env::args().skip(1).collect();
    let number = |k: usize| words[k].parse::<u32>().unwrap();
    let paths: Vec<PathBuf> = words[5..].iter().map(PathBuf::from).collect();
    let start = std::time::Instant::now();
    let loaded = gonio_scene::read(&paths, &[]).unwrap();
    let scene = Scene::new(loaded.parts).unwrap();
    println!("read {:.3} s", start.elapsed().as_secs_f64());
    let camera = Camera::new(view::read(&PathBuf::from(&words[3])).unwrap()).unwrap();
    let effort = Effort {
        samples: number(1),
        relative_error: None,
        limits: Limits {
            bounces: std::env::var("BOUNCES").map_or(64, |b| b.parse().unwrap()),
            ..Limits::default()
        },
        seed: u64::from(number(2)),
        share: std::env::var("ALONE").is_err(),
    };
    let size = number(0) as usize;
    let mut picture = Picture::new(size, size);
    let start = std::time::Instant::now();
    picture.render(&scene, &camera, &effort, &AtomicBool::new(false), &|_| {});
    let spent = start.elapsed().as_secs_f64();
    let count = size * size * number(1) as usize;
    println!("{:.3} s, {:.3} M/s", spent, count as f64 / spent / 1e6);
    let bytes: Vec<u8> = picture
        .pixels
        .iter()
        .flat_map(|p| p.mean())
        .flat_map(|x| (x as f32).to_le_bytes())
        .collect();
    std::fs::write(&words[4], bytes).unwrap();
}
