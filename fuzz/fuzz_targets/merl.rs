//! No content makes the reader panic: `cargo +nightly fuzz run merl`.
#![no_main]

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| {
    let _ = gonio_io::merl::parse(bytes, std::path::Path::new("fuzz"));
});
