//! RADIANCE's scattering interpolant representation (docs/formats/sir.md), as `pabopto2bsdf` writes it \[WardEtAl2014\], \[BonneelEtAl2011\].
//!
//! A text header, then big-endian binary: for every measured incidence a sum of Gaussian lobes, and for every edge
//! between neighbouring incidences a sparse matrix that says which share of a lobe moves to which. [`Interpolant`]
//! answers between the incidences by moving the lobes.

mod advect;
mod grid;
mod mesh;
mod model;
mod parse;
mod slice;

use std::path::Path;

use crate::IoError;
use crate::error::{open, read_bytes};

pub use model::Interpolant;

/// The first line of a file.
const MAGIC: &[u8] = b"#?RADIANCE";
/// What the header calls the format.
const FORMAT: &str = "BSDF_RBFmesh";
/// How far into a file the name of its format is looked for, in bytes.
const WINDOW: u64 = 1 << 16;

/// Whether the file begins as an interpolant does.
///
/// # Errors
/// [`IoError::File`] for refusals of the operating system.
pub fn is_sir(path: &Path) -> Result<bool, IoError> {
    use std::io::Read;
    let mut head = Vec::new();
    open(path)?
        .0
        .take(WINDOW)
        .read_to_end(&mut head)
        .map_err(|e| IoError::file(path, e))?;
    let mut lines = head.split(|b| *b == b'\n').take_while(|line| !line.is_empty());
    let named =
        |line: &[u8]| line.strip_prefix(b"FORMAT=").map(<[u8]>::trim_ascii) == Some(FORMAT.as_bytes());
    Ok(head.starts_with(MAGIC) && lines.any(named))
}

/// Reads an interpolant.
///
/// # Errors
/// [`IoError::File`] for refusals of the operating system, [`IoError::Format`] for what does not follow the format.
pub fn read(path: &Path) -> Result<Interpolant, IoError> {
    parse(&read_bytes(path)?, path)
}

/// [`read`] of content in memory; `path` is named in errors.
///
/// # Errors
/// As [`read`].
pub fn parse(bytes: &[u8], path: &Path) -> Result<Interpolant, IoError> {
    parse::parse(bytes, path)
}

#[cfg(test)]
mod tests;
