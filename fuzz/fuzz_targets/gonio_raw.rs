//! No content makes the reader panic: `cargo +nightly fuzz run gonio_raw`.
#![no_main]

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| {
    let _ = gonio_io::gonio_raw::parse(bytes, std::path::Path::new("fuzz"), &Default::default());
});
