//! No content makes the reader panic: `cargo +nightly fuzz run astm`.
#![no_main]

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| {
    let options = gonio_io::ReadOptions::default();
    let _ = gonio_io::astm::parse(bytes, std::path::Path::new("fuzz"), &options);
});
