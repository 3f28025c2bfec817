//! Writing gonio raw.

use std::borrow::Borrow;
use std::io::Write;
use std::path::Path;

use gonio_scan::Scan;

use super::MAGIC;
use super::fields::{MM, RESERVED};
use crate::text::{degrees, scaled, write_number};
use crate::{IoError, write_atomic};

/// Writes the scans as records of one file, each with all its fields. What was read from a file in degrees comes back
/// bit for bit.
///
/// # Errors
/// No scan, a scan without readings, columns of unequal length, a free key that the format cannot carry, and refusals
/// of the operating system.
pub fn write<S: Borrow<Scan>>(path: &Path, scans: &[S]) -> Result<(), IoError> {
    if scans.is_empty() {
        return Err(IoError::format(path, None, "scans", "none", "at least one"));
    }
    for scan in scans {
        check(path, scan.borrow())?;
    }
    write_atomic(path, |out| write_to(out, scans))
}

fn check(path: &Path, scan: &Scan) -> Result<(), IoError> {
    let n = scan.len();
    let equal =
        scan.theta_s.len() == n && scan.phi_s.len() == n && scan.time.as_ref().is_none_or(|t| t.len() == n);
    if n == 0 || !equal {
        return Err(IoError::format(
            path,
            None,
            "readings",
            format!("{n} values"),
            "columns of one length, not empty",
        ));
    }
    for key in scan.meta.other.keys() {
        let plain =
            !key.is_empty() && !key.contains(|c: char| c.is_whitespace() || c.is_control() || c == ':');
        if !plain || RESERVED.contains(&key.as_str()) {
            let allowed = "a word without blanks and colons that has no meaning in gonio raw";
            return Err(IoError::format(
                path,
                None,
                "free header key",
                format!("{key:?}"),
                allowed,
            ));
        }
    }
    Ok(())
}

/// [`write`] to an open stream, unchecked.
///
/// # Errors
/// Refusals of the stream.
pub fn write_to<S: Borrow<Scan>>(out: &mut dyn Write, scans: &[S]) -> std::io::Result<()> {
    writeln!(out, "{MAGIC}")?;
    for scan in scans {
        record(out, scan.borrow())?;
    }
    Ok(())
}

fn record(out: &mut dyn Write, scan: &Scan) -> std::io::Result<()> {
    let meta = &scan.meta;
    writeln!(out, "#record")?;
    writeln!(out, "#kind: {}", scan.kind)?;
    writeln!(out, "#quantity: {}", scan.quantity)?;
    writeln!(out, "#channel: {}", scan.channel)?;
    number(out, "theta_i", Some(degrees(scan.incidence.theta)))?;
    number(out, "phi_i", Some(degrees(scan.incidence.phi)))?;
    text(out, "sample_name", meta.sample_name.as_deref())?;
    text(out, "instrument", meta.instrument.as_deref())?;
    text(out, "started", meta.started.as_deref())?;
    number(out, "distance_mm", meta.distance.map(|x| scaled(x, MM)))?;
    number(out, "beam_diameter_mm", meta.beam_diameter.map(|x| scaled(x, MM)))?;
    number(out, "receiver_solid_angle_sr", meta.receiver_solid_angle)?;
    number(out, "noise_readout", meta.noise_readout)?;
    number(out, "noise_relative", meta.noise_relative)?;
    number(out, "integration", meta.integration)?;
    number(out, "saturation", meta.saturation)?;
    for (key, value) in &meta.other {
        text(out, key, Some(value))?;
    }
    writeln!(out, "#readings: {}", scan.len())?;
    writeln!(
        out,
        "#columns: theta_s phi_s value{}",
        if scan.time.is_some() { " time_s" } else { "" }
    )?;
    for j in 0..scan.len() {
        write_number(out, degrees(scan.theta_s[j]))?;
        out.write_all(b" ")?;
        write_number(out, degrees(scan.phi_s[j]))?;
        out.write_all(b" ")?;
        write_number(out, scan.value[j])?;
        if let Some(time) = &scan.time {
            out.write_all(b" ")?;
            write_number(out, time[j])?;
        }
        out.write_all(b"\n")?;
    }
    Ok(())
}

fn number(out: &mut dyn Write, key: &str, value: Option<f64>) -> std::io::Result<()> {
    let Some(value) = value else { return Ok(()) };
    write!(out, "#{key}: ")?;
    write_number(out, value)?;
    out.write_all(b"\n")
}

/// A line of text; line ends and control characters inside it become blanks.
fn text(out: &mut dyn Write, key: &str, value: Option<&str>) -> std::io::Result<()> {
    let Some(value) = value else { return Ok(()) };
    let value: String = value
        .chars()
        .map(|c| if c.is_control() { ' ' } else { c })
        .collect();
    writeln!(out, "#{key}: {}", value.trim())
}
