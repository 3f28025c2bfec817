//! No content makes the reader panic: `cargo +nightly fuzz run sir`.
#![no_main]

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| {
    let _ = gonio_io::sir::parse(bytes, std::path::Path::new("fuzz"));
});
