//! Text files after ASTM E1392 as gonioreflectometers write them (`.astm`, docs/formats/astm.md).
//!
//! Header lines of a keyword and a value, `VARS` with the names of the columns, then rows: four angles in radians and
//! BRDF values, comma between them.

use std::path::Path;

use gonio_bsdf::{Channel, Quantity};
use gonio_geom::Angles;
use gonio_scan::{Scan, ScanKind, ScanMeta};

use crate::grouping::{Key, Scans};
use crate::mountain::radiance_rgb;
use crate::table::{Row, Rows};
use crate::text::decode;
use crate::{IoError, ReadOptions, excerpt, read_bytes};

/// The first columns.
const ANGLES: [&str; 4] = ["theta_i", "phi_i", "theta_s", "phi_s"];

/// Reads a file: one scan an incidence and channel.
///
/// # Errors
/// [`IoError`]: no `VARS`, other columns, rows of another width or number, angles that are no radians, values that are no
/// numbers, options that contradict the file.
pub fn read(path: &Path, options: &ReadOptions) -> Result<Vec<Scan>, IoError> {
    parse(&read_bytes(path)?, path, options)
}

/// [`read`] of content in memory; `path` is named in errors and kept as the source.
///
/// # Errors
/// As [`read`].
pub fn parse(bytes: &[u8], path: &Path, options: &ReadOptions) -> Result<Vec<Scan>, IoError> {
    let header = Header::read(bytes, path)?;
    if let Some(stated) = options.quantity.filter(|q| *q != Quantity::Bsdf) {
        let found = format!("bsdf in the file, {stated} stated");
        return Err(IoError::format(path, None, "quantity", found, "the same"));
    }
    let mut rows = Rows::after(header.lines, &bytes[header.table..], path)?;
    let columns = columns(&rows.header, path, header.lines + 1, options)?;
    let mut scans = Scans::default();
    let mut count = 0u64;
    while let Some(row) = rows.next()? {
        count += 1;
        let incidence = angles(&row, 0)?;
        let receiver = angles(&row, 2)?;
        let mut push = |channel, value| {
            let key = Key {
                kind: options.kind.unwrap_or(ScanKind::Sample),
                quantity: Quantity::Bsdf,
                channel,
                incidence,
            };
            scans.push(key, receiver, value, None);
        };
        match &columns {
            Columns::Xyz => {
                let xyz = [row.number(4, "X")?, row.number(5, "Y")?, row.number(6, "Z")?];
                let [r, g, b] = radiance_rgb(xyz);
                let channels = [Channel::Photopic, Channel::Red, Channel::Green, Channel::Blue];
                channels
                    .into_iter()
                    .zip([xyz[1], r, g, b])
                    .for_each(|(c, v)| push(c, v));
            }
            Columns::Channels(list) => {
                for (k, name, channel) in list {
                    push(*channel, row.number(*k, name)?);
                }
            }
        }
    }
    if let Some(stated) = header.points.filter(|n| *n != count) {
        let allowed = format!("NUM_POINTS, {stated}; is the file cut short?");
        return Err(IoError::format(path, None, "rows", count.to_string(), allowed));
    }
    let mut meta = header.meta;
    meta.source = Some(path.display().to_string());
    scans.finish(path, &meta)
}

/// Whether a file begins as this format does: lines of a keyword in capitals and a value, up to one of `VARS`.
pub(crate) fn is_astm(head: &[u8]) -> bool {
    for line in head.split(|b| *b == b'\n').map(<[u8]>::trim_ascii) {
        if line.starts_with(b"VARS ") {
            return line[5..].trim_ascii().starts_with(ANGLES[0].as_bytes());
        }
        let keyword = line.split(u8::is_ascii_whitespace).next().unwrap_or_default();
        let capitals = |b: &u8| b.is_ascii_uppercase() || b.is_ascii_digit() || *b == b'_';
        if !keyword.iter().all(capitals) {
            return false;
        }
    }
    false
}

/// What stands before the table.
struct Header {
    /// Where the names of the columns begin.
    table: usize,
    /// Lines before that of the names.
    lines: u64,
    /// Rows that the file announces.
    points: Option<u64>,
    meta: ScanMeta,
}

impl Header {
    fn read(bytes: &[u8], path: &Path) -> Result<Self, IoError> {
        let mut header = Header {
            table: 0,
            lines: 0,
            points: None,
            meta: ScanMeta::default(),
        };
        for line in bytes.split_inclusive(|b| *b == b'\n') {
            let text = line.trim_ascii();
            let end = text
                .iter()
                .position(u8::is_ascii_whitespace)
                .unwrap_or(text.len());
            let (keyword, value) = (&text[..end], text[end..].trim_ascii());
            if keyword == b"VARS" {
                // the names begin behind the keyword
                let start = line.iter().position(|b| *b == b'V').unwrap_or(0);
                header.table += start + b"VARS".len();
                return Ok(header);
            }
            header.lines += 1;
            header.table += line.len();
            let word = decode(value).trim_matches('"').to_owned();
            match keyword {
                b"" => {}
                b"NUM_POINTS" => match word.parse::<u64>() {
                    Ok(n) => header.points = Some(n),
                    Err(_) => {
                        let found = excerpt(value);
                        return Err(IoError::format(
                            path,
                            header.lines,
                            "NUM_POINTS",
                            found,
                            "a whole number",
                        ));
                    }
                },
                b"SAMPLE_NAME" if !word.is_empty() => header.meta.sample_name = Some(word),
                b"SYSTEM_NAME" if !word.is_empty() => header.meta.instrument = Some(word),
                _ => {
                    header.meta.other.insert(decode(keyword).to_lowercase(), word);
                }
            }
        }
        let allowed = format!("VARS {} and names of channels", ANGLES.join(","));
        Err(IoError::format(path, None, "VARS", "no such line", allowed))
    }
}

enum Columns {
    Xyz,
    /// Index, name, channel.
    Channels(Vec<(usize, String, Channel)>),
}

fn columns(names: &[String], path: &Path, line: u64, options: &ReadOptions) -> Result<Columns, IoError> {
    let wrong =
        |field: &str, found: String, allowed: &str| Err(IoError::format(path, line, field, found, allowed));
    if names.len() < 5 || names[..4] != ANGLES {
        return wrong(
            "VARS",
            names.join(","),
            "theta_i,phi_i,theta_s,phi_s and channels",
        );
    }
    let values: Vec<&str> = names[4..].iter().map(String::as_str).collect();
    if values == ["X", "Y", "Z"] {
        return match options.channel {
            None => Ok(Columns::Xyz),
            Some(c) => wrong("channel", format!("{c} for a file of XYZ"), "no channel"),
        };
    }
    let own = |name: &str| match name {
        "R" => Some(Channel::Red),
        "G" => Some(Channel::Green),
        "B" => Some(Channel::Blue),
        _ => name.parse().ok(),
    };
    let mut list = Vec::new();
    for (k, name) in values.iter().enumerate() {
        match (own(name), options.channel) {
            (Some(channel), stated) => {
                if stated.is_none_or(|s| s == channel) {
                    list.push((4 + k, (*name).to_owned(), channel));
                }
            }
            // one column whose name says nothing is what the user says it is
            (None, Some(stated)) if values.len() == 1 => list.push((4, (*name).to_owned(), stated)),
            (None, _) => {
                return wrong(
                    "VARS",
                    format!("{name:?}"),
                    "R, G, B, X, Y, Z, 532nm, or one column with a channel stated",
                );
            }
        }
    }
    if list.is_empty() {
        let found = options.channel.map_or(String::new(), |c| c.to_string());
        return wrong("channel", found, &format!("one of {}", values.join(", ")));
    }
    Ok(Columns::Channels(list))
}

/// The direction in columns `k` and `k + 1`.
fn angles(row: &Row<'_>, k: usize) -> Result<Angles, IoError> {
    use std::f64::consts::{PI, TAU};
    let (theta, phi) = (row.number(k, ANGLES[k])?, row.number(k + 1, ANGLES[k + 1])?);
    // single precision may round pi / 2 and pi up
    let slack = 1e-5;
    if !(-PI - slack..=PI + slack).contains(&theta) {
        return Err(row.fault(ANGLES[k], theta.to_string(), "radians, -pi to pi"));
    }
    if !(-TAU - slack..=2.0 * TAU + slack).contains(&phi) {
        return Err(row.fault(ANGLES[k + 1], phi.to_string(), "radians, -2 pi to 4 pi"));
    }
    Ok(Angles::canonical(theta, phi))
}

#[cfg(test)]
mod tests;
