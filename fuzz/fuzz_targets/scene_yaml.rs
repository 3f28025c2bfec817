//! No content makes the reader of YAML scenes panic or hang: `cargo +nightly fuzz run scene_yaml`.
#![no_main]

use gonio_scene::assemble::assemble;
use gonio_scene::text::Files;
use gonio_scene::yaml;

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| {
    let files = Files::default();
    if let Ok(scene) = yaml::read_from(std::path::Path::new("fuzz.yaml"), bytes, &files) {
        let _ = assemble(scene.entries, &files);
    }
});
