//! Which format a file has, by its content.

use std::fmt;
use std::io::Read;
use std::path::Path;
use std::str::FromStr;

use gonio_scan::Scan;

use crate::error::open;
use crate::{IoError, ReadOptions, excerpt, gonio_raw, mountain};

/// A format of readings.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Format {
    /// pab-opto Mountain text.
    Mountain,
    /// gonio's own raw text.
    GonioRaw,
}

impl Format {
    /// Every format with the name the command line and Python use.
    pub const NAMES: [(Format, &'static str); 2] =
        [(Format::Mountain, "mountain"), (Format::GonioRaw, "gonio-raw")];

    /// Name used on the command line and in Python.
    pub fn name(self) -> &'static str {
        Self::NAMES
            .iter()
            .find(|(f, _)| *f == self)
            .map_or("", |(_, name)| name)
    }
}

impl fmt::Display for Format {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}

/// A name that is no format.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[error("format: found {0:?}, allowed {list}", list = names())]
pub struct UnknownFormat(pub String);

fn names() -> String {
    Format::NAMES.map(|(_, name)| name).join(", ")
}

impl FromStr for Format {
    type Err = UnknownFormat;
    fn from_str(s: &str) -> Result<Self, Self::Err> {
        Format::NAMES
            .into_iter()
            .find(|(_, name)| name.eq_ignore_ascii_case(s))
            .map(|(f, _)| f)
            .ok_or_else(|| UnknownFormat(s.into()))
    }
}

/// How far into a file its format is looked for, in bytes.
const WINDOW: usize = 1 << 16;

/// The format of `bytes`; `path` is named in errors.
///
/// # Errors
/// Content that belongs to no format gonio reads as readings.
pub fn detect(bytes: &[u8], path: &Path) -> Result<Format, IoError> {
    let head = &bytes[..bytes.len().min(WINDOW)];
    let head = head.strip_prefix(b"\xef\xbb\xbf").unwrap_or(head);
    let unknown = |found: String, allowed: &str| Err(IoError::format(path, None, "file", found, allowed));
    if head.is_empty() {
        return unknown("0 bytes".into(), "a file with readings");
    }
    if head.starts_with(gonio_raw::MAGIC.as_bytes()) {
        return Ok(Format::GonioRaw);
    }
    let mut header = head.split(|&b| b == b'\n').map_while(|l| l.strip_prefix(b"#"));
    const KEYS: [&[u8]; 3] = [b"format", b"intheta", b"incident_angle"];
    if header.any(|l| KEYS.iter().any(|k| l.starts_with(k))) {
        return Ok(Format::Mountain);
    }
    unknown(
        format!("content that no format matches, beginning {}", excerpt(head)),
        &format!("{}; state the format of a table, and its columns", names()),
    )
}

/// Reads the records of a file in the stated format, or in the one its content shows.
///
/// # Errors
/// Everything the reader of that format refuses, and content that no format matches.
pub fn read_any(path: &Path, options: &ReadOptions) -> Result<Vec<Scan>, IoError> {
    let format = match options.format {
        Some(format) => format,
        None => {
            let mut head = Vec::with_capacity(WINDOW);
            let refused = |e| IoError::file(path, e);
            open(path)?
                .0
                .take(WINDOW as u64)
                .read_to_end(&mut head)
                .map_err(refused)?;
            detect(&head, path)?
        }
    };
    match format {
        Format::Mountain => mountain::read(path, options),
        Format::GonioRaw => gonio_raw::read(path, options),
    }
}

/// [`read_any`] of content in memory.
///
/// # Errors
/// As [`read_any`].
pub fn parse_any(bytes: &[u8], path: &Path, options: &ReadOptions) -> Result<Vec<Scan>, IoError> {
    match options.format.map_or_else(|| detect(bytes, path), Ok)? {
        Format::Mountain => mountain::parse(bytes, path, options),
        Format::GonioRaw => gonio_raw::parse(bytes, path, options),
    }
}
