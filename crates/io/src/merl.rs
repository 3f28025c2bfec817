//! Binary files of the MERL database of isotropic reflectances (docs/formats/merl.md) \[Matusik2003\].
//!
//! Little endian: the numbers of cells in theta_h, theta_d and phi_d as 32-bit integers (90, 90, 180), then red, green
//! and blue as doubles, phi_d fastest. A value times the scale of its colour is the BRDF in 1/sr; a negative one says
//! that there is none.

use std::path::Path;

use gonio_bsdf::half_difference::HalfDifference;
use gonio_bsdf::{Bsdf, BsdfError, Channel};

use crate::error::{open, read_bytes};
use crate::{IoError, column, write_atomic};

/// Cells in theta_h, theta_d and phi_d.
pub const SHAPE: [usize; 3] = [90, 90, 180];

/// The channels in the order of the file.
pub const CHANNELS: [Channel; 3] = [Channel::Red, Channel::Green, Channel::Blue];

/// 1/sr for a value of one in the file.
const SCALES: [f64; 3] = [1.0 / 1500.0, 1.15 / 1500.0, 1.66 / 1500.0];

/// What a cell without a value holds, in the file and in the table.
const EMPTY: f64 = -1.0;

const CELLS: usize = SHAPE[0] * SHAPE[1] * SHAPE[2];
const HEADER: usize = 12;
const SIZE: usize = HEADER + 8 * CELLS * CHANNELS.len();

/// The first bytes of every file of the database.
fn header() -> [u8; HEADER] {
    let mut bytes = [0; HEADER];
    for (four, n) in bytes.chunks_exact_mut(4).zip(SHAPE) {
        four.copy_from_slice(&(n as u32).to_le_bytes());
    }
    bytes
}

/// Whether the file begins as one of the database does; its length is left to [`read`].
///
/// # Errors
/// [`IoError::File`] for refusals of the operating system.
pub fn is_merl(path: &Path) -> Result<bool, IoError> {
    use std::io::Read;
    let mut head = Vec::with_capacity(HEADER);
    open(path)?
        .0
        .take(HEADER as u64)
        .read_to_end(&mut head)
        .map_err(|e| IoError::file(path, e))?;
    Ok(head == header())
}

/// Reads a file of the database.
///
/// # Errors
/// [`IoError::File`] for refusals of the operating system, [`IoError::Format`] for other numbers of cells, another
/// length, values that are not finite.
pub fn read(path: &Path) -> Result<HalfDifference, IoError> {
    parse(&read_bytes(path)?, path)
}

/// [`read`] of content in memory; `path` is named in errors.
///
/// # Errors
/// As [`read`].
pub fn parse(bytes: &[u8], path: &Path) -> Result<HalfDifference, IoError> {
    let wrong =
        |field: &str, found: String, allowed: String| Err(IoError::format(path, None, field, found, allowed));
    let Some((head, data)) = bytes.split_at_checked(HEADER) else {
        return wrong("file", format!("{} bytes", bytes.len()), format!("{SIZE} bytes"));
    };
    if head != header() {
        let (four, _) = head.as_chunks::<4>();
        let found: Vec<String> = four.iter().map(|b| i32::from_le_bytes(*b).to_string()).collect();
        return wrong(
            "numbers of cells",
            found.join(" x "),
            SHAPE.map(|n| n.to_string()).join(" x "),
        );
    }
    if bytes.len() != SIZE {
        let allowed = format!("{SIZE} bytes; is the file cut short?");
        return wrong("file", format!("{} bytes", bytes.len()), allowed);
    }
    let (eights, _) = data.as_chunks::<8>();
    let mut values = column(eights.len());
    for (k, bytes) in eights.iter().enumerate() {
        let value = f64::from_le_bytes(*bytes);
        values.push(if value < 0.0 {
            EMPTY
        } else {
            value * SCALES[k / CELLS]
        });
    }
    HalfDifference::new(SHAPE, CHANNELS.to_vec(), values).map_err(
        |BsdfError::Domain {
             field,
             found,
             allowed,
         }| IoError::format(path, None, field, found, allowed),
    )
}

/// Writes a table of 90 x 90 x 180 cells in red, green and blue; `HalfDifference::of` makes one of any isotropic model.
///
/// # Errors
/// [`IoError::Format`] for a table of another shape or other channels, refusals of the operating system.
pub fn write(path: &Path, table: &HalfDifference) -> Result<(), IoError> {
    if table.shape() != SHAPE {
        let found = format!("{:?}", table.shape());
        return Err(IoError::format(path, None, "shape", found, format!("{SHAPE:?}")));
    }
    if table.channels() != CHANNELS {
        let found: Vec<String> = table.channels().iter().map(ToString::to_string).collect();
        return Err(IoError::format(
            path,
            None,
            "channels",
            found.join(", "),
            "red, green, blue",
        ));
    }
    write_atomic(path, |out| {
        out.write_all(&header())?;
        for (c, scale) in SCALES.into_iter().enumerate() {
            for &v in table.values(c) {
                let value = if v < 0.0 { EMPTY } else { v / scale };
                out.write_all(&value.to_le_bytes())?;
            }
        }
        Ok(())
    })
}

#[cfg(test)]
mod tests;
