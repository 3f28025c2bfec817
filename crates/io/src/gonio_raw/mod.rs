//! gonio raw: the project's own text format for the readings of an instrument (docs/formats/gonio-raw.md).
//!
//! ```text
//! #gonio raw 1
//! #instrument: name            fields before the first #record hold for every record
//! #record
//! #kind: sample                fields after #record hold for this record
//! #quantity: signal
//! #channel: photopic
//! #theta_i: 30
//! #phi_i: 0
//! #readings: 2
//! #columns: theta_s phi_s value
//! 0 0 1.25
//! 10 180 3.5
//! ```

mod fields;
mod write;

use std::path::Path;

use gonio_scan::Scan;

use crate::text::{Fault, Receivers, Text};
use crate::{IoError, ReadOptions, column};
use fields::{Columns, Fields};
pub use write::{write, write_to};

/// First line of every file.
pub const MAGIC: &str = "#gonio raw 1";

/// Reads every record of the file.
///
/// # Errors
/// [`IoError`] for everything the format does not allow, and for options that contradict the file.
pub fn read(path: &Path, options: &ReadOptions) -> Result<Vec<Scan>, IoError> {
    from_text(Text::open(path)?, options)
}

/// [`read`] of content in memory; `path` is named in errors and kept as the source.
///
/// # Errors
/// As [`read`].
pub fn parse(bytes: &[u8], path: &Path, options: &ReadOptions) -> Result<Vec<Scan>, IoError> {
    from_text(Text::of(bytes, path)?, options)
}

fn from_text(mut text: Text<'_>, options: &ReadOptions) -> Result<Vec<Scan>, IoError> {
    let path = text.path;
    let first = text.header_line()?;
    if !first.is_some_and(|h| h.key == "gonio" && h.value == "raw 1") {
        return Err(IoError::format(path, 1, "first line", "something else", MAGIC));
    }
    let mut common = Fields::default();
    let mut scans = Vec::new();
    // fields of the record that is being read; None before the first #record
    let mut record: Option<Fields> = None;
    while let Some(h) = text.header_line()? {
        match h.key.as_str() {
            "record" => {
                if record.is_some() {
                    return Err(IoError::format(
                        path,
                        h.line,
                        "record",
                        "#record",
                        "#columns of the record before it",
                    ));
                }
                record = Some(common.clone());
            }
            "columns" => {
                let fields = match record.take() {
                    Some(fields) => fields,
                    None if scans.is_empty() => std::mem::take(&mut common),
                    None => {
                        let allowed = "#record before the fields of a further record";
                        return Err(IoError::format(path, h.line, "#columns", h.value, allowed));
                    }
                };
                let columns = Columns::parse(&h, path)?;
                scans.push(readings(&mut text, fields, columns, options)?);
            }
            _ if record.is_none() && !scans.is_empty() => {
                let found = format!("#{}", h.key);
                return Err(IoError::format(
                    path,
                    h.line,
                    "header",
                    found,
                    "#record after readings",
                ));
            }
            _ => record.as_mut().unwrap_or(&mut common).set(&h, path)?,
        }
    }
    if !text.at_end()? {
        return Err(text.fault(
            "header",
            "a line that does not start with #",
            "header lines up to #columns",
        ));
    }
    if record.is_some() || scans.is_empty() {
        return Err(text.missing(
            "#columns",
            "theta_s phi_s value, or theta_s phi_s value time_s; is the file truncated?",
        ));
    }
    Ok(scans)
}

fn readings(
    text: &mut Text<'_>,
    fields: Fields,
    columns: Columns,
    options: &ReadOptions,
) -> Result<Scan, IoError> {
    let rows = fields
        .readings
        .map_or_else(|| text.expected_rows(3), |n| n.min(text.expected_rows(3)));
    let mut receivers = Receivers::new(rows, 0.0);
    let mut value = column(rows);
    let mut time = None;
    let header_line = text.line.saturating_sub(1);
    match columns {
        Columns::Three => text.rows(["theta_s", "phi_s", "value"], |&[theta, phi, v]| {
            receivers.push(theta, phi)?;
            finite("value", v)?;
            value.push(v);
            Ok(())
        })?,
        Columns::WithTime => {
            let mut times = column(rows);
            text.rows(["theta_s", "phi_s", "value", "time_s"], |&[theta, phi, v, t]| {
                receivers.push(theta, phi)?;
                finite("value", v)?;
                finite("time_s", t)?;
                value.push(v);
                times.push(t);
                Ok(())
            })?;
            time = Some(times);
        }
    }
    fields.into_scan(text.path, header_line, receivers, value, time, options)
}

#[inline(always)]
fn finite(name: &'static str, v: f64) -> Result<(), Fault> {
    if v.is_infinite() {
        Err(Fault::new(name, format!("{v}"), "a finite number or nan"))
    } else {
        Ok(())
    }
}

#[cfg(test)]
mod tests;
