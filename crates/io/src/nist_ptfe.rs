//! The NIST data on sintered PTFE [Germer2017]: BRDF and Mueller matrices at four wavelengths
//! (docs/formats/nist-ptfe.md).
//!
//! One comma-separated row a reading: wavelength in micrometres, incident and receiver angles in degrees, `f_r11` (the
//! BRDF for unpolarised light, 1/sr), fifteen Mueller elements divided by `f_r11`. Incident polar angles are negative,
//! which puts the source at the opposite azimuth; the mirror direction is then at `phi_i + 180` as everywhere in gonio.

use std::path::Path;

use gonio_bsdf::{Channel, Quantity};
use gonio_scan::{Scan, ScanKind, ScanMeta};

use crate::grouping::{Key, Scans, angles};
use crate::table::Rows;
use crate::{IoError, ReadOptions, read_bytes};

/// First column names, by which the format is recognised.
pub const MAGIC: &str = "lambda,thetai,phi,thetar,phir,f_r11";

/// Columns of a row.
const COLUMNS: usize = 21;
const F_R11: usize = 5;

/// Normalised Mueller matrices of the readings of one scan, in the order of its readings; `m[0][0]` is 1.
pub type MuellerMatrices = Vec<[[f64; 4]; 4]>;

/// Reads the unpolarised BRDF: one scan a wavelength and incidence. The Mueller columns are checked and dropped; see
/// [`read_mueller`].
///
/// # Errors
/// [`IoError`] for rows that are no such rows, and options that contradict the file.
pub fn read(path: &Path, options: &ReadOptions) -> Result<Vec<Scan>, IoError> {
    parse(&read_bytes(path)?, path, options)
}

/// [`read`] of content in memory.
///
/// # Errors
/// As [`read`].
pub fn parse(bytes: &[u8], path: &Path, options: &ReadOptions) -> Result<Vec<Scan>, IoError> {
    parse_with(bytes, path, options, |_, _| {})
}

/// The scans of [`read`] with the normalised Mueller matrix of each reading.
///
/// # Errors
/// As [`read`].
pub fn read_mueller(path: &Path, options: &ReadOptions) -> Result<Vec<(Scan, MuellerMatrices)>, IoError> {
    let mut matrices: Vec<MuellerMatrices> = Vec::new();
    let scans = parse_with(&read_bytes(path)?, path, options, |place, elements| {
        matrices.resize(matrices.len().max(place + 1), Vec::new());
        let element = |k: usize| if k == 0 { 1.0 } else { elements[k - 1] };
        matrices[place].push(std::array::from_fn(|i| {
            std::array::from_fn(|j| element(4 * i + j))
        }));
    })?;
    Ok(scans.into_iter().zip(matrices).collect())
}

fn parse_with(
    bytes: &[u8],
    path: &Path,
    options: &ReadOptions,
    mut mueller: impl FnMut(usize, &[f64; 15]),
) -> Result<Vec<Scan>, IoError> {
    let mut rows = Rows::new(bytes, path)?;
    if rows.header.len() != COLUMNS || !rows.header.join(",").starts_with(MAGIC) {
        let allowed = format!("{MAGIC} and 15 Mueller columns");
        return Err(IoError::format(
            path,
            1,
            "header row",
            format!("{} columns", rows.header.len()),
            allowed,
        ));
    }
    if let Some(stated) = options.quantity.filter(|&q| q != Quantity::Bsdf) {
        return Err(IoError::format(
            path,
            1,
            "quantity",
            format!("bsdf in the file, {stated} stated"),
            "the same",
        ));
    }
    let mut scans = Scans::default();
    while let Some(row) = rows.next()? {
        let mut numbers = [0.0; COLUMNS];
        for (k, x) in numbers.iter_mut().enumerate() {
            *x = row.number(k, COLUMN_NAMES[k])?;
        }
        let [micrometres, theta_i, phi_i, theta_s, phi_s, ..] = numbers;
        if !(0.1..=100.0).contains(&micrometres) {
            return Err(row.fault("lambda", micrometres.to_string(), "0.1 to 100 micrometres"));
        }
        // rounded to a picometre, so that 0.351 micrometres are 351 nm
        let channel = Channel::Wavelength((micrometres * 1e6).round() / 1e3);
        let key = Key {
            kind: options.kind.unwrap_or(ScanKind::Sample),
            quantity: Quantity::Bsdf,
            channel,
            incidence: angles(&row, ["thetai", "phi"], theta_i, phi_i)?,
        };
        let receiver = angles(&row, ["thetar", "phir"], theta_s, phi_s)?;
        let place = scans.push(key, receiver, numbers[F_R11], None);
        let mut elements = [0.0; 15];
        elements.copy_from_slice(&numbers[F_R11 + 1..]);
        mueller(place, &elements);
    }
    let meta = ScanMeta {
        sample_name: Some("sintered PTFE".into()),
        source: Some(path.display().to_string()),
        ..ScanMeta::default()
    };
    let scans = scans.finish(path, &meta)?;
    match options.channel {
        None => Ok(scans),
        Some(wanted) => {
            let chosen: Vec<Scan> = scans.into_iter().filter(|s| s.channel == wanted).collect();
            if chosen.is_empty() {
                return Err(IoError::format(
                    path,
                    None,
                    "channel",
                    wanted.to_string(),
                    "a wavelength of the file",
                ));
            }
            Ok(chosen)
        }
    }
}

const COLUMN_NAMES: [&str; COLUMNS] = [
    "lambda", "thetai", "phi", "thetar", "phir", "f_r11", "m12", "m13", "m14", "m21", "m22", "m23", "m24",
    "m31", "m32", "m33", "m34", "m41", "m42", "m43", "m44",
];

#[cfg(test)]
mod tests;
