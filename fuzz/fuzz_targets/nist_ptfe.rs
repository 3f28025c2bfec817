//! No content makes the reader panic: `cargo +nightly fuzz run nist_ptfe`.
#![no_main]

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| {
    let _ = gonio_io::nist_ptfe::parse(bytes, std::path::Path::new("fuzz"), &Default::default());
});
