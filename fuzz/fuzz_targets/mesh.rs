//! No content makes the readers of meshes panic or hang: `cargo +nightly fuzz run mesh`.
#![no_main]

use std::path::Path;

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| {
    if let Some((kind, bytes)) = bytes.split_first() {
        let name = ["a.obj", "a.ply", "a.stl", "a.gltf", "a.glb"][usize::from(*kind) % 5];
        let _ = gonio_scene::mesh::read_from(Path::new(name), bytes);
    }
});
