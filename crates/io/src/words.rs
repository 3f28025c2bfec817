//! Text formats whose numbers follow one another over any number of lines.

use std::path::Path;

use crate::{IoError, excerpt};

type Lines<'a> = std::iter::Enumerate<std::slice::Split<'a, u8, fn(&u8) -> bool>>;

/// The words of a text with their lines. Lines that begin with `#` are comments and passed over.
pub(crate) struct Words<'a> {
    lines: Lines<'a>,
    /// What is left of the line of number `line`.
    rest: &'a [u8],
    line: u64,
    path: &'a Path,
    comments: Vec<&'a [u8]>,
}

fn line_feed(byte: &u8) -> bool {
    *byte == b'\n'
}

fn carriage_return(byte: &u8) -> bool {
    *byte == b'\r'
}

impl<'a> Words<'a> {
    /// The words of `bytes`; `path` is named in errors.
    pub(crate) fn new(bytes: &'a [u8], path: &'a Path) -> Self {
        let bytes = bytes.strip_prefix(b"\xef\xbb\xbf").unwrap_or(bytes);
        // a carriage return before a line feed is a blank; alone it ends the line
        let end: fn(&u8) -> bool = if bytes.contains(&b'\n') {
            line_feed
        } else {
            carriage_return
        };
        Words {
            lines: bytes.split(end).enumerate(),
            rest: &[],
            line: 0,
            path,
            comments: Vec::new(),
        }
    }

    /// A fault at the line reached.
    pub(crate) fn fault(&self, field: &str, found: impl Into<String>, allowed: impl Into<String>) -> IoError {
        IoError::format(self.path, self.line.max(1), field, found, allowed)
    }

    /// The comments passed over so far, without their mark.
    pub(crate) fn comments(&self) -> &[&'a [u8]] {
        &self.comments
    }

    /// The next word without taking it; `None` at the end.
    pub(crate) fn peek(&mut self) -> Option<&'a [u8]> {
        loop {
            self.rest = self.rest.trim_ascii_start();
            if !self.rest.is_empty() {
                let end = self.rest.iter().position(u8::is_ascii_whitespace);
                return Some(&self.rest[..end.unwrap_or(self.rest.len())]);
            }
            let (k, line) = self.lines.next()?;
            self.line = k as u64 + 1;
            match line.strip_prefix(b"#") {
                Some(comment) => self.comments.push(comment),
                None => self.rest = line,
            }
        }
    }

    /// The next word.
    pub(crate) fn next(&mut self) -> Option<&'a [u8]> {
        let word = self.peek()?;
        self.rest = &self.rest[word.len()..];
        Some(word)
    }

    /// Whether the next word is `word`, in any case of letters; takes it then.
    pub(crate) fn takes(&mut self, word: &str) -> bool {
        let found = self
            .peek()
            .is_some_and(|w| w.eq_ignore_ascii_case(word.as_bytes()));
        if found {
            self.next();
        }
        found
    }

    /// The next word, one of `allowed` in any case of letters, by its index.
    pub(crate) fn one_of(&mut self, field: &str, allowed: &[&str]) -> Result<usize, IoError> {
        let word = self.needed(field, &allowed.join(", "))?;
        allowed
            .iter()
            .position(|a| word.eq_ignore_ascii_case(a.as_bytes()))
            .ok_or_else(|| self.fault(field, excerpt(word), allowed.join(", ")))
    }

    fn needed(&mut self, field: &str, allowed: &str) -> Result<&'a [u8], IoError> {
        self.next().ok_or_else(|| {
            let allowed = format!("{allowed}; is the file cut short?");
            self.fault(field, "the end of the file", allowed)
        })
    }

    /// The next word, a finite number.
    pub(crate) fn number(&mut self, field: &str) -> Result<f64, IoError> {
        let word = self.needed(field, "a number")?;
        let value = std::str::from_utf8(word).ok().and_then(|w| w.parse::<f64>().ok());
        match value {
            Some(x) if x.is_finite() => Ok(x),
            _ => Err(self.fault(field, excerpt(word), "a finite number with a decimal point")),
        }
    }

    /// The next word, a number of things between 1 and `most`.
    pub(crate) fn count(&mut self, field: &str, most: usize) -> Result<usize, IoError> {
        let x = self.number(field)?;
        if x.fract() == 0.0 && x >= 1.0 && x <= most as f64 {
            Ok(x as usize)
        } else {
            Err(self.fault(field, x.to_string(), format!("a number from 1 to {most}")))
        }
    }

    /// `n` numbers.
    pub(crate) fn numbers(&mut self, field: &str, n: usize) -> Result<Vec<f64>, IoError> {
        // grown as they come: `n` is only what the file says
        (0..n).map(|_| self.number(field)).collect()
    }

    /// `n` ascending numbers within `low..=high`.
    pub(crate) fn ascending(
        &mut self,
        field: &str,
        n: usize,
        low: f64,
        high: f64,
    ) -> Result<Vec<f64>, IoError> {
        let mut out: Vec<f64> = Vec::new();
        for _ in 0..n {
            let x = self.number(field)?;
            let fits = (low..=high).contains(&x) && out.last().is_none_or(|last| *last < x);
            if !fits {
                let allowed = format!("{n} ascending numbers from {low} to {high}");
                return Err(self.fault(field, x.to_string(), allowed));
            }
            out.push(x);
        }
        Ok(out)
    }

    /// The line after the current one, trimmed; what is left of the current one is passed over.
    pub(crate) fn next_line(&mut self, field: &str) -> Result<&'a [u8], IoError> {
        self.rest = &[];
        match self.lines.next() {
            Some((k, line)) => {
                self.line = k as u64 + 1;
                Ok(line.trim_ascii())
            }
            None => Err(self.fault(field, "the end of the file", "a line; is the file cut short?")),
        }
    }
}
