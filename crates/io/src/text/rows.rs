//! Rows of numbers: plain ones in batches, ordinary ones alone, all others the careful way.

use super::Fault;
use super::fast::{self, BEFORE};
use super::number::{MAX_LENGTH, number};
use super::plain;
use super::shape::{COLUMNS, Shapes};
use crate::excerpt;

/// Why [`Reader::piece`] stopped.
pub(super) enum Stop {
    /// At the end of the piece.
    Piece,
    /// Before a line that starts with `#`.
    Header,
}

/// Rows that `plain` reads before they are handed on.
const BATCH: usize = 128;
/// Rows that are read one by one after a batch that held none, so that a file without plain rows is not tried in vain
/// at every one.
const REST: usize = 16;

/// What rows are read with.
pub(super) struct Reader {
    shapes: Shapes,
    batch: [plain::Lanes; BATCH],
}

impl Reader {
    pub(super) fn new() -> Self {
        Reader {
            shapes: Shapes::new(),
            batch: [plain::Lanes::default(); BATCH],
        }
    }

    /// The rows of one piece of whole lines, `buffer[pos..end]`; where and on which line it stopped. `BEFORE` bytes
    /// before `pos` and `AFTER` bytes after `end` are readable.
    #[inline(always)]
    pub(super) fn piece<const N: usize>(
        &mut self,
        buffer: &[u8],
        mut pos: usize,
        end: usize,
        mut line: u64,
        names: &[&'static str; N],
        sink: &mut impl FnMut(&[f64; N]) -> Result<(), Fault>,
    ) -> (usize, u64, Result<Stop, Fault>) {
        let mut row = [0.0; N];
        loop {
            let mut single = 1;
            if N == COLUMNS {
                let (count, next) = plain::rows(buffer, pos, end, &mut self.shapes, &mut self.batch);
                for numbers in &self.batch[..count] {
                    if let Some(Err(fault)) = numbers.first_chunk().map(&mut *sink) {
                        return (pos, line, Err(fault));
                    }
                    line += 1;
                }
                pos = next;
                if count == BATCH {
                    continue;
                }
                if count == 0 {
                    single = REST;
                }
            }
            for _ in 0..single {
                let window = buffer[pos - BEFORE..].first_chunk();
                let next = match window.and_then(|w| fast::row(w, &mut row)) {
                    Some(used) if pos + used <= end => pos + used,
                    _ => match careful_row(&buffer[..end], pos, names, &mut row) {
                        Ok(Line::Row(next)) => next,
                        Ok(Line::Blank(next)) => {
                            pos = next;
                            line += 1;
                            continue;
                        }
                        Ok(Line::Stop(stop)) => return (pos, line, Ok(stop)),
                        Err(fault) => return (pos, line, Err(fault)),
                    },
                };
                if let Err(fault) = sink(&row) {
                    return (pos, line, Err(fault));
                }
                pos = next;
                line += 1;
            }
        }
    }
}

/// What a line is, and where the next one starts.
enum Line {
    Row(usize),
    Blank(usize),
    Stop(Stop),
}

/// The line that starts at `pos`, whatever it holds.
#[inline(never)]
fn careful_row<const N: usize>(
    bytes: &[u8],
    mut pos: usize,
    names: &[&'static str; N],
    row: &mut [f64; N],
) -> Result<Line, Fault> {
    for (column, x) in row.iter_mut().enumerate() {
        while matches!(bytes.get(pos), Some(b' ' | b'\t')) {
            pos += 1;
        }
        match bytes.get(pos) {
            None if column == 0 => return Ok(Line::Stop(Stop::Piece)),
            Some(b'#') if column == 0 => return Ok(Line::Stop(Stop::Header)),
            Some(b'\r') if column == 0 && bytes.get(pos + 1) == Some(&b'\n') => {
                return Ok(Line::Blank(pos + 2));
            }
            Some(b'\n') if column == 0 => return Ok(Line::Blank(pos + 1)),
            None | Some(b'\r' | b'\n') => return Err(too_few(names, column)),
            _ => {}
        }
        match number(bytes, pos) {
            Ok((value, end)) => {
                *x = value;
                pos = end;
            }
            Err(end) => return Err(no_number(&bytes[pos..end], names[column])),
        }
    }
    while matches!(bytes.get(pos), Some(b' ' | b'\t' | b'\r')) {
        pos += 1;
    }
    match bytes.get(pos) {
        None => Ok(Line::Row(pos)),
        Some(b'\n') => Ok(Line::Row(pos + 1)),
        Some(_) => Err(too_many(names, &bytes[pos..])),
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
