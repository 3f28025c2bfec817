//! No content makes the reader panic: `cargo +nightly fuzz run radiance_material`.
#![no_main]

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| {
    let path = std::path::Path::new("fuzz");
    if let Ok(items) = gonio_io::radiance_material::read_from(path, bytes) {
        let _ = gonio_io::radiance_material::materials(path, &items);
    }
});
