//! Tabular BSDF files of Zemax OpticStudio (`.bsdf`, docs/formats/zemax-bsdf.md).
//!
//! Words and numbers in lines: five keywords, four lists of angles in degrees, then for each spectral part, sample
//! rotation and angle of incidence a total integrated scatter and a row of BSDF values an azimuth. Azimuth and radial
//! angle count from the specular direction (BTDF: the unbent one).

mod frame;
mod read;
mod write;

pub use read::{parse, read};
pub use write::{Grid, Written, write};

/// Most angles in one list, and most values in a file.
const MOST_ANGLES: usize = 1 << 16;

const SYMMETRIES: [&str; 3] = ["PlaneSymmetrical", "ASymmetrical", "ASymmetrical4D"];
const SPECTRA: [&str; 2] = ["Monochrome", "XYZ"];
const SCATTER: [&str; 2] = ["BRDF", "BTDF"];

/// Whether the words of a file begin as this format does: `Source`, then another word, then `Symmetry`.
pub(crate) fn is_zemax(head: &[u8]) -> bool {
    let mut words = crate::words::Words::new(head, std::path::Path::new(""));
    words.takes("Source") && words.next().is_some() && words.takes("Symmetry")
}

#[cfg(test)]
mod tests;
