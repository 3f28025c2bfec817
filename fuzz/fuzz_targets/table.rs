//! No content makes the reader panic: `cargo +nightly fuzz run table`.
#![no_main]

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| {
    let options = gonio_io::ReadOptions {
        quantity: Some("bsdf".parse().expect("a quantity")),
        channel: Some("photopic".parse().expect("a channel")),
        ..Default::default()
    };
    let _ = gonio_io::table::parse(bytes, std::path::Path::new("fuzz"), &options);
});
