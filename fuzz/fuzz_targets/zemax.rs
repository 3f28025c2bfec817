//! No content makes the reader panic: `cargo +nightly fuzz run zemax`.
#![no_main]

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| {
    for channel in [None, Some("650nm".parse().expect("a channel"))] {
        let options = gonio_io::ReadOptions {
            channel,
            ..Default::default()
        };
        let _ = gonio_io::zemax::parse(bytes, std::path::Path::new("fuzz"), &options);
    }
});
