//! No content makes the reader of scenes panic or hang: `cargo +nightly fuzz run radiance_scene`.
#![no_main]

use gonio_scene::assemble::assemble;
use gonio_scene::text::{Files, read_from};

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| {
    let files = Files::default();
    if let Ok(entries) = read_from(std::path::Path::new("fuzz"), bytes, &files) {
        let _ = assemble(entries, &files);
    }
});
