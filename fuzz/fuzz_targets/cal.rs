//! No content makes the parser or the evaluation panic or hang: `cargo +nightly fuzz run cal`.
#![no_main]

use gonio_scene::cal::{Point, Program};

libfuzzer_sys::fuzz_target!(|text: &str| {
    // The last line is an expression in the file that the lines before it are.
    let (file, wanted) = text.rsplit_once('\n').unwrap_or(("", text));
    if let Ok(program) = Program::parse(file, "fuzz.cal")
        && let Ok(expression) = program.expression(wanted)
        && let Ok(value) = expression.evaluate(&Point::default(), &[1.0, 0.5, -2.0])
    {
        assert!(value.is_finite());
    }
});
