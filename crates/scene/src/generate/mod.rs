//! The commands that scene files may name: `!xform`, `!genbox`, `!gensky`, `!gendaylit`, run here and never by a shell.

mod gendaylit;
mod gensky;
#[cfg(test)]
mod tests;
mod words;

pub use gendaylit::gendaylit;
pub use gensky::gensky;
pub use words::GenerateError;
