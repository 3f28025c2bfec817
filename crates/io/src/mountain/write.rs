//! Writing Mountain text.

use std::path::Path;

use gonio_bsdf::{Channel, Quantity};
use gonio_scan::Scan;

use crate::text::{degrees, write_number};
use crate::{IoError, write_atomic};

/// Writes one scan. Azimuths are written as they are, with `#upphi 90`, so that RADIANCE keeps them too. The format
/// has no word for a wavelength: it stands in the free key `#channel`, which RADIANCE passes over.
///
/// # Errors
/// A quantity the format cannot name (reflectance factor), a scan without readings, and refusals of the operating
/// system.
pub fn write(path: &Path, scan: &Scan) -> Result<(), IoError> {
    let unit;
    let quantity = match scan.quantity {
        Quantity::Bsdf => "BSDF",
        Quantity::Dsf => "DSF",
        Quantity::Signal => {
            unit = format!(
                "[{}]",
                scan.meta.other.get("unit").map_or("counts", String::as_str)
            );
            &unit
        }
        Quantity::ReflectanceFactor => {
            return Err(IoError::format(
                path,
                None,
                "quantity",
                scan.quantity.name(),
                "bsdf, dsf, signal",
            ));
        }
    };
    if scan.is_empty() {
        return Err(IoError::format(
            path,
            None,
            "readings",
            "nothing",
            "at least one reading",
        ));
    }
    write_atomic(path, |out| {
        if let Some(name) = &scan.meta.sample_name {
            writeln!(out, "#sample_name \"{}\"", one_line(name))?;
        }
        writeln!(out, "#format: theta phi {}", one_line(quantity))?;
        write!(out, "#incident_angle ")?;
        write_number(out, degrees(scan.incidence.theta))?;
        out.write_all(b" ")?;
        write_number(out, degrees(scan.incidence.phi))?;
        writeln!(out, "\n#upphi 90")?;
        match scan.channel {
            Channel::Photopic => writeln!(out, "#colorimetry: CIE-Y")?,
            other => writeln!(out, "#channel: {other}")?,
        }
        writeln!(out, "#datapoints_in_file {}", scan.len())?;
        for j in 0..scan.len() {
            write_number(out, degrees(scan.theta_s[j]))?;
            out.write_all(b"\t")?;
            write_number(out, degrees(scan.phi_s[j]))?;
            out.write_all(b"\t")?;
            write_number(out, scan.value[j])?;
            out.write_all(b"\n")?;
        }
        Ok(())
    })
}

/// `text` without line ends and other control characters.
fn one_line(text: &str) -> String {
    text.chars()
        .map(|c| if c.is_control() { ' ' } else { c })
        .collect()
}
