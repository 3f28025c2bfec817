//! What the line-oriented text formats share: header lines, and rows of numbers at the speed of memory.

mod angles;
mod fast;
mod number;
mod plain;
mod rows;
mod shape;
mod write;

use std::io::Read;
use std::path::Path;

pub(crate) use angles::Receivers;
pub(crate) use write::{degrees, scaled, write_number};

use crate::error::open;
use crate::{IoError, excerpt};
use fast::BEFORE;
use plain::AFTER;
use rows::{Reader, Stop};

/// Bytes read at a time; no line may be longer.
const CHUNK: usize = 1 << 18;

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

/// A text file that is read from front to back, a piece of whole lines at a time.
pub(crate) struct Text<'a> {
    source: Box<dyn Read + 'a>,
    /// Padding, then what was read, then padding: the padding lets `fast` look past the ends.
    buffer: Vec<u8>,
    reader: Reader,
    /// Next byte to look at.
    pos: usize,
    /// End of the whole lines in `buffer`.
    end: usize,
    /// End of what was read into `buffer`.
    filled: usize,
    /// Whether the source is exhausted.
    exhausted: bool,
    /// Bytes read so far, and of the whole file where that is known.
    read: u64,
    size: Option<u64>,
    /// Line at `pos`, from 1.
    pub(crate) line: u64,
    /// File named in errors.
    pub(crate) path: &'a Path,
}

impl<'a> Text<'a> {
    /// The text of an open file.
    ///
    /// # Errors
    /// A path that cannot be opened or is a directory, an empty file, UTF-16.
    pub(crate) fn open(path: &'a Path) -> Result<Self, IoError> {
        let (file, size) = open(path)?;
        Text::new(Box::new(file), Some(size), path)
    }

    /// The text of `bytes`; `path` is only named in errors.
    ///
    /// # Errors
    /// An empty file, UTF-16.
    pub(crate) fn of(bytes: &'a [u8], path: &'a Path) -> Result<Self, IoError> {
        Text::new(Box::new(bytes), Some(bytes.len() as u64), path)
    }

    fn new(source: Box<dyn Read + 'a>, size: Option<u64>, path: &'a Path) -> Result<Self, IoError> {
        let mut text = Text {
            source,
            buffer: vec![b'\n'; BEFORE + CHUNK + AFTER],
            reader: Reader::new(),
            pos: BEFORE,
            end: BEFORE,
            filled: BEFORE,
            exhausted: false,
            read: 0,
            size,
            line: 1,
            path,
        };
        text.refill()?;
        let start = &text.buffer[BEFORE..text.filled];
        if start.is_empty() {
            return Err(IoError::format(
                path,
                None,
                "file",
                "0 bytes",
                "a header and readings",
            ));
        }
        if start.starts_with(b"\xff\xfe") || start.starts_with(b"\xfe\xff") {
            return Err(text.fault(
                "encoding",
                "UTF-16",
                "UTF-8 or Latin-1; save the file as plain text",
            ));
        }
        if start.starts_with(b"\xef\xbb\xbf") {
            text.pos += 3;
        }
        Ok(text)
    }

    /// Reads the next piece once everything up to `end` is used; false at the end of the file.
    fn refill(&mut self) -> Result<bool, IoError> {
        if self.pos < self.end {
            return Ok(true);
        }
        // what follows the last whole line moves to the front
        self.buffer.copy_within(self.end..self.filled, BEFORE);
        self.filled -= self.end - BEFORE;
        self.pos = BEFORE;
        while !self.exhausted && self.filled < BEFORE + CHUNK {
            match self.source.read(&mut self.buffer[self.filled..BEFORE + CHUNK]) {
                Ok(0) => self.exhausted = true,
                Ok(n) => {
                    self.filled += n;
                    self.read += n as u64;
                }
                Err(e) if e.kind() == std::io::ErrorKind::Interrupted => {}
                Err(e) => return Err(IoError::file(self.path, e)),
            }
        }
        let content = &self.buffer[BEFORE..self.filled];
        self.end = if self.exhausted {
            self.filled
        } else if let Some(last) = content.iter().rposition(|&b| b == b'\n') {
            BEFORE + last + 1
        } else {
            let found = format!(
                "a line of more than {CHUNK} bytes, beginning {}",
                excerpt(content)
            );
            return Err(self.fault("line", found, "lines of readings"));
        };
        Ok(self.pos < self.end)
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
    ///
    /// # Errors
    /// Refusals of the operating system, an endless line.
    pub(crate) fn at_end(&mut self) -> Result<bool, IoError> {
        while self.refill()? {
            match self.buffer[self.pos] {
                b'\n' => self.line += 1,
                b' ' | b'\t' | b'\r' => {}
                _ => return Ok(false),
            }
            self.pos += 1;
        }
        Ok(true)
    }

    /// Whether the last line ends with a line end; to be asked at the end.
    pub(crate) fn ends_with_newline(&self) -> bool {
        self.buffer[self.end - 1] == b'\n'
    }

    /// The next header line; `None` where the next line that is not blank does not start with `#`.
    ///
    /// # Errors
    /// Control characters (a binary file), an endless line, refusals of the operating system.
    pub(crate) fn header_line(&mut self) -> Result<Option<HeaderLine>, IoError> {
        if self.at_end()? || self.buffer[self.pos] != b'#' {
            return Ok(None);
        }
        let rest = &self.buffer[self.pos + 1..self.end];
        let length = rest.iter().position(|&b| b == b'\n').unwrap_or(rest.len());
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
        let ended = usize::from(length < rest.len());
        self.pos += 1 + length + ended;
        self.line += ended as u64;
        Ok(Some(line))
    }

    /// Rough number of rows from here on, from the length of the next ones; never more than the bytes can hold.
    pub(crate) fn expected_rows(&self, columns: usize) -> usize {
        let rest = &self.buffer[self.pos..self.end];
        let ahead = rest.len() as u64 + self.size.map_or(0, |size| size.saturating_sub(self.read));
        let head = &rest[..rest.len().min(1 << 14)];
        let lines = head.iter().filter(|&&b| b == b'\n').count();
        if lines == 0 {
            return 1;
        }
        let guess = ahead as f64 / head.len() as f64 * lines as f64 * 1.03;
        (guess as usize + 16).min(ahead as usize / (2 * columns) + 1)
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
        mut sink: impl FnMut(&[f64; N]) -> Result<(), Fault>,
    ) -> Result<(), IoError> {
        while self.refill()? {
            let (pos, line, done) =
                self.reader
                    .piece(&self.buffer, self.pos, self.end, self.line, &names, &mut sink);
            self.pos = pos;
            self.line = line;
            match done {
                Ok(Stop::Piece) => {}
                Ok(Stop::Header) => break,
                Err(f) => return Err(self.fault(f.field, f.found, f.allowed)),
            }
        }
        Ok(())
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

/// UTF-8 where it is valid, Latin-1 otherwise (older instrument software writes it).
pub(crate) fn decode(bytes: &[u8]) -> String {
    std::str::from_utf8(bytes).map_or_else(|_| bytes.iter().map(|&b| char::from(b)).collect(), str::to_string)
}
