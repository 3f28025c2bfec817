//! The commands that scene files may name: `!xform`, `!genbox`, `!gensky`, `!gendaylit`, run here and never by a shell.

/// The text that `gensky` prints for `words`.
///
/// # Errors
/// Always: it is not made yet.
pub fn gensky(_words: &[&str]) -> Result<String, String> {
    Err("gensky, which gonio does not make yet".into())
}

/// The text that `gendaylit` prints for `words`.
///
/// # Errors
/// Always: it is not made yet.
pub fn gendaylit(_words: &[&str]) -> Result<String, String> {
    Err("gendaylit, which gonio does not make yet".into())
}
