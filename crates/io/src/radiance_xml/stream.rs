//! A buffered reader that counts lines, and the number lists read from it without holding their text.

use std::io::{self, BufRead, Read};

/// Longest number, in bytes.
const LONGEST: usize = 64;

/// Counts the line feeds that pass.
#[derive(Debug)]
pub(super) struct Lines<R> {
    inner: R,
    line: u64,
}

impl<R> Lines<R> {
    pub(super) fn new(inner: R) -> Self {
        Lines { inner, line: 1 }
    }

    /// Line of the next byte, from 1.
    pub(super) fn line(&self) -> u64 {
        self.line
    }
}

impl<R: BufRead> Read for Lines<R> {
    fn read(&mut self, buf: &mut [u8]) -> io::Result<usize> {
        let n = {
            let available = self.fill_buf()?;
            let n = available.len().min(buf.len());
            buf[..n].copy_from_slice(&available[..n]);
            n
        };
        self.consume(n);
        Ok(n)
    }
}

impl<R: BufRead> BufRead for Lines<R> {
    fn fill_buf(&mut self) -> io::Result<&[u8]> {
        self.inner.fill_buf()
    }

    fn consume(&mut self, amount: usize) {
        if amount > 0
            && let Ok(passed) = self.inner.fill_buf()
        {
            let n = amount.min(passed.len());
            self.line += passed[..n].iter().filter(|b| **b == b'\n').count() as u64;
        }
        self.inner.consume(amount);
    }
}

/// A piece of a number list.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Token<'a> {
    Open,
    Close,
    Number(&'a [u8]),
}

/// Why a number list ended early.
#[derive(Debug)]
pub(super) enum Stop {
    Io(io::Error),
    /// A number of more than [`LONGEST`] bytes: its beginning.
    Long(Vec<u8>),
    /// What the caller found.
    Fault {
        found: String,
        allowed: String,
        field: &'static str,
    },
}

/// Hands the numbers and braces up to the next `<` to `visit`. White space and commas separate.
pub(super) fn tokens(
    input: &mut impl BufRead,
    mut visit: impl FnMut(Token<'_>) -> Result<(), Stop>,
) -> Result<(), Stop> {
    let mut carried: Vec<u8> = Vec::new();
    loop {
        let buffer = match input.fill_buf() {
            Err(e) if e.kind() == io::ErrorKind::Interrupted => continue,
            other => other.map_err(Stop::Io)?,
        };
        let end = buffer.iter().position(|b| *b == b'<');
        let chunk = &buffer[..end.unwrap_or(buffer.len())];
        let last = end.is_some() || buffer.is_empty();
        let mut start = 0;
        for (k, byte) in chunk.iter().enumerate() {
            if !matches!(byte, b' ' | b'\t' | b'\r' | b'\n' | b',' | b'{' | b'}') {
                continue;
            }
            if carried.is_empty() {
                if k > start {
                    number(&chunk[start..k], &mut visit)?;
                }
            } else {
                carried.extend_from_slice(&chunk[start..k]);
                number(&carried, &mut visit)?;
                carried.clear();
            }
            match byte {
                b'{' => visit(Token::Open)?,
                b'}' => visit(Token::Close)?,
                _ => {}
            }
            start = k + 1;
        }
        carried.extend_from_slice(&chunk[start..]);
        if carried.len() > LONGEST {
            return Err(Stop::Long(carried[..LONGEST].to_vec()));
        }
        let used = chunk.len();
        input.consume(used);
        if last {
            break;
        }
    }
    if carried.is_empty() {
        Ok(())
    } else {
        number(&carried, &mut visit)
    }
}

fn number(text: &[u8], visit: &mut impl FnMut(Token<'_>) -> Result<(), Stop>) -> Result<(), Stop> {
    if text.len() > LONGEST {
        return Err(Stop::Long(text[..LONGEST].to_vec()));
    }
    visit(Token::Number(text))
}

/// Passes over everything up to the next `<`.
pub(super) fn skip_text(input: &mut impl BufRead) -> io::Result<()> {
    loop {
        let buffer = match input.fill_buf() {
            Err(e) if e.kind() == io::ErrorKind::Interrupted => continue,
            other => other?,
        };
        let end = buffer.iter().position(|b| *b == b'<');
        let (used, last) = (end.unwrap_or(buffer.len()), end.is_some() || buffer.is_empty());
        input.consume(used);
        if last {
            return Ok(());
        }
    }
}
