//! No content makes the reader panic: `cargo +nightly fuzz run radiance_xml`.
#![no_main]

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| {
    let channel = gonio_bsdf::Channel::Photopic;
    let _ = gonio_io::radiance_xml::read_from(bytes, std::path::Path::new("fuzz"), channel);
});
