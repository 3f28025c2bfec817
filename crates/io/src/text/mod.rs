//! What the line-oriented text formats share: header lines, and rows of numbers at the speed of memory.

mod angles;
mod number;
mod write;

use std::path::Path;

pub(crate) use angles::Receivers;
pub(crate) use write::{degrees, scaled, write_number};

use crate::{IoError, excerpt};
use number::{MAX_LENGTH, number};

/// Longest header line, in bytes.
const MAX_HEADER_LINE: usize = 1 << 16;

/// A header line `#key: value` or `#key value`.
#[derive(Debug, Clone)]
pub(crate) struct HeaderLine {
    /// Line of the file, from 1.
    pub(crate) line: u64,
    /// What follows `#` directly, up to a blank or colon.
    pub(crate) key: String,
    /// The rest, trimmed.
    pub(crate) value: String,
}

/// A text file that is read from front to back.
pub(crate) struct Text<'a> {
    bytes: &'a [u8],
    pos: usize,
    /// Line at `pos`, from 1.
    pub(crate) line: u64,
    /// File named in errors.
    pub(crate) path: &'a Path,
}

impl<'a> Text<'a> {
    /// The text of `bytes`; `path` is only named in errors.
    ///
    /// # Errors
    /// An empty file, and UTF-16.
    pub(crate) fn new(bytes: &'a [u8], path: &'a Path) -> Result<Self, IoError> {
        let bytes = bytes.strip_prefix(b"\xef\xbb\xbf").unwrap_or(bytes);
        let text = Text {
            bytes,
            pos: 0,
            line: 1,
            path,
        };
        if bytes.is_empty() {
            return Err(IoError::format(
                path,
                None,
                "file",
                "0 bytes",
                "a header and readings",
            ));
        }
        if bytes.starts_with(b"\xff\xfe") || bytes.starts_with(b"\xfe\xff") {
            return Err(text.fault(
                "encoding",
                "UTF-16",
                "UTF-8 or Latin-1; save the file as plain text",
            ));
        }
        Ok(text)
    }

    /// A fault on the current line.
    pub(crate) fn fault(
        &self,
        field: impl Into<String>,
        found: impl Into<String>,
        allowed: impl Into<String>,
    ) -> IoError {
        IoError::format(self.path, self.line, field, found, allowed)
    }

    /// A fault without a line.
    pub(crate) fn missing(&self, field: impl Into<String>, allowed: impl Into<String>) -> IoError {
        IoError::format(self.path, None, field, "nothing", allowed)
    }

    /// Whether everything was read. Blank lines are passed over first.
    pub(crate) fn at_end(&mut self) -> bool {
        while let Some(b) = self.bytes.get(self.pos) {
            match b {
                b'\n' => self.line += 1,
                b' ' | b'\t' | b'\r' => {}
                _ => return false,
            }
            self.pos += 1;
        }
        true
    }

    /// Whether the last line ends with a line end.
    pub(crate) fn ends_with_newline(&self) -> bool {
        self.bytes.last() == Some(&b'\n')
    }

    /// The next header line; `None` where the next line that is not blank does not start with `#`.
    ///
    /// # Errors
    /// Control characters (a binary file) and lines longer than 65536 bytes.
    pub(crate) fn header_line(&mut self) -> Result<Option<HeaderLine>, IoError> {
        if self.at_end() || self.bytes[self.pos] != b'#' {
            return Ok(None);
        }
        let rest = &self.bytes[self.pos + 1..];
        let window = &rest[..rest.len().min(MAX_HEADER_LINE)];
        let length = match window.iter().position(|&b| b == b'\n') {
            Some(n) => n,
            None if window.len() == rest.len() => rest.len(),
            None => {
                return Err(self.fault(
                    "header",
                    format!("a line of more than {MAX_HEADER_LINE} bytes"),
                    "shorter lines",
                ));
            }
        };
        let raw = &rest[..length];
        if raw.iter().any(|&b| b < b' ' && b != b'\t' && b != b'\r') {
            return Err(self.fault("header", excerpt(raw), "text without control characters"));
        }
        let text = decode(raw);
        let cut = text.find([' ', '\t', ':', '\r']).unwrap_or(text.len());
        let (key, value) = text.split_at(cut);
        let value = value.trim();
        let value = value.strip_prefix(':').unwrap_or(value).trim();
        let line = HeaderLine {
            line: self.line,
            key: key.to_string(),
            value: value.to_string(),
        };
        self.pos += 1 + length + usize::from(length < rest.len());
        self.line += u64::from(length < rest.len());
        Ok(Some(line))
    }

    /// Rough number of rows from here on, from the length of the first ones; never more than the bytes can hold.
    pub(crate) fn expected_rows(&self, columns: usize) -> usize {
        let rest = &self.bytes[self.pos..];
        let head = &rest[..rest.len().min(1 << 14)];
        let lines = head.iter().filter(|&&b| b == b'\n').count();
        if lines == 0 {
            return 1;
        }
        let guess = rest.len() as f64 / head.len() as f64 * lines as f64 * 1.03;
        (guess as usize + 16).min(rest.len() / (2 * columns) + 1)
    }

    /// Hands every row of exactly `N` numbers to `sink`, up to the end or a line that starts with `#`. Blank lines
    /// are passed over. `sink` returns a fault as (field, found, allowed).
    ///
    /// # Errors
    /// A number that is none, missing or extra columns, what `sink` refuses; all with their line.
    #[inline(always)]
    pub(crate) fn rows<const N: usize>(
        &mut self,
        names: [&'static str; N],
        mut sink: impl FnMut([f64; N]) -> Result<(), Fault>,
    ) -> Result<(), IoError> {
        let bytes = self.bytes;
        let mut pos = self.pos;
        let mut line = self.line;
        let done = 'rows: loop {
            let mut row = [0.0; N];
            for (column, x) in row.iter_mut().enumerate() {
                while matches!(bytes.get(pos), Some(b' ' | b'\t')) {
                    pos += 1;
                }
                match bytes.get(pos) {
                    Some(b'0'..=b'9' | b'-' | b'.') => {}
                    None if column == 0 => break 'rows Ok(()),
                    Some(b'#') if column == 0 => break 'rows Ok(()),
                    Some(b'\r') if column == 0 && bytes.get(pos + 1) == Some(&b'\n') => {
                        pos += 2;
                        line += 1;
                        continue 'rows;
                    }
                    Some(b'\n') if column == 0 => {
                        pos += 1;
                        line += 1;
                        continue 'rows;
                    }
                    None | Some(b'\r' | b'\n') => break 'rows Err(too_few(&names, column)),
                    _ => {}
                }
                match number(bytes, pos) {
                    Ok((value, end)) => {
                        *x = value;
                        pos = end;
                    }
                    Err(end) => break 'rows Err(no_number(&bytes[pos..end], names[column])),
                }
            }
            match bytes.get(pos) {
                Some(b'\n') => pos += 1,
                other => {
                    let mut end = pos;
                    if other.is_some() {
                        while matches!(bytes.get(end), Some(b' ' | b'\t' | b'\r')) {
                            end += 1;
                        }
                    }
                    match bytes.get(end) {
                        None => pos = end,
                        Some(b'\n') => pos = end + 1,
                        Some(_) => break Err(too_many(&names, &bytes[end..])),
                    }
                }
            }
            if let Err(fault) = sink(row) {
                break Err(fault);
            }
            line += 1;
        };
        self.pos = pos;
        self.line = line;
        done.map_err(|f| self.fault(f.field, f.found, f.allowed))
    }
}

/// What is wrong with a row.
#[derive(Debug)]
pub(crate) struct Fault {
    pub(crate) field: String,
    pub(crate) found: String,
    pub(crate) allowed: String,
}

impl Fault {
    /// A value outside its range.
    #[cold]
    pub(crate) fn new(
        field: impl Into<String>,
        found: impl Into<String>,
        allowed: impl Into<String>,
    ) -> Self {
        Fault {
            field: field.into(),
            found: found.into(),
            allowed: allowed.into(),
        }
    }
}

#[cold]
fn no_number(found: &[u8], name: &str) -> Fault {
    let found = if found.len() > MAX_LENGTH {
        format!(
            "{} without a blank for more than {MAX_LENGTH} bytes",
            excerpt(found)
        )
    } else {
        excerpt(found)
    };
    Fault::new(name, found, "a decimal number or nan")
}

#[cold]
fn too_few<const N: usize>(names: &[&'static str; N], columns: usize) -> Fault {
    let found = if columns == 1 {
        "1 column".into()
    } else {
        format!("{columns} columns")
    };
    Fault::new(
        "row",
        found,
        format!("{N} columns ({}); is the file truncated?", names.join(", ")),
    )
}

#[cold]
fn too_many<const N: usize>(names: &[&'static str; N], extra: &[u8]) -> Fault {
    let end = extra
        .iter()
        .take(MAX_LENGTH)
        .position(|&b| b == b'\n' || b == b'\r');
    let extra = &extra[..end.unwrap_or(extra.len().min(MAX_LENGTH))];
    Fault::new(
        "row",
        format!("{} after {N} columns", excerpt(extra)),
        format!("{N} columns ({})", names.join(", ")),
    )
}

/// UTF-8 where it is valid, Latin-1 otherwise (older instrument software writes it).
pub(crate) fn decode(bytes: &[u8]) -> String {
    std::str::from_utf8(bytes).map_or_else(|_| bytes.iter().map(|&b| char::from(b)).collect(), str::to_string)
}
