//! Reading scene text.

use std::path::Path;
use std::str::FromStr;

use gonio_bsdf::{BsdfError, RadianceMaterial};

use super::words::{Next, Word, Words};
use super::{ALIAS, Body, Found, Item, OTHER_TYPES};
use crate::IoError;
use crate::error::{excerpt, read_bytes};

/// The items of a `.rad` file in order.
///
/// # Errors
/// [`IoError::File`] for what the operating system refuses; [`IoError::Format`] naming line and field for a command
/// (`!`), a type that RADIANCE does not have, a list of the wrong length, a word that is not UTF-8 or not the number it
/// should be, a parameter outside its range, an end of file inside an item.
pub fn read(path: &Path) -> Result<Vec<Item>, IoError> {
    read_from(path, &read_bytes(path)?)
}

/// [`read`] of text already in memory; `path` appears in errors.
///
/// # Errors
/// [`IoError::Format`] as for [`read`].
pub fn read_from(path: &Path, bytes: &[u8]) -> Result<Vec<Item>, IoError> {
    let mut items = Vec::new();
    scan(path, bytes, |found| match found {
        Found::Item(item) => {
            items.push(item);
            Ok(())
        }
        Found::Command { text, line } => Err(IoError::format(
            path,
            line,
            "command",
            excerpt(text.as_bytes()),
            "no line that starts with !: commands are not run; run it yourself and read what it prints",
        )),
    })?;
    Ok(items)
}

/// Hands every item and command of scene text to `on`, in order, and stops at its first error. Nothing is run.
///
/// # Errors
/// [`IoError::Format`] as for [`read`], commands apart, and what `on` returns.
pub fn scan<E: From<IoError>>(
    path: &Path,
    bytes: &[u8],
    mut on: impl FnMut(Found) -> Result<(), E>,
) -> Result<(), E> {
    let mut reader = Reader {
        path,
        words: Words::new(bytes),
    };
    loop {
        match reader.words.next() {
            Next::End => return Ok(()),
            Next::Command => {
                let line = reader.words.line();
                let text = reader.words.command();
                let text = String::from_utf8(text)
                    .map_err(|e| reader.fault(line, "command", excerpt(e.as_bytes()), "UTF-8 text"))?;
                on(Found::Command { text, line })?;
            }
            Next::Item => on(Found::Item(reader.item()?))?,
        }
    }
}

struct Reader<'a> {
    path: &'a Path,
    words: Words<'a>,
}

impl Reader<'_> {
    fn fault(&self, line: u64, field: &str, found: impl Into<String>, allowed: impl Into<String>) -> IoError {
        IoError::format(self.path, line, field, found, allowed)
    }

    fn text(&self, field: &str, word: Option<Word>, allowed: &str) -> Result<(String, u64), IoError> {
        let Some(word) = word else {
            return Err(self.fault(self.words.line(), field, "end of file", allowed));
        };
        match String::from_utf8(word.bytes) {
            Ok(text) => Ok((text, word.line)),
            Err(e) => Err(self.fault(word.line, field, excerpt(e.as_bytes()), "UTF-8 text")),
        }
    }

    fn name(&mut self, field: &str) -> Result<(String, u64), IoError> {
        let word = self.words.word();
        let (text, line) = self.text(field, word, "modifier type id and three argument lists")?;
        if text.is_empty() || text.contains(['\t', '\n', '\r']) {
            return Err(self.fault(
                line,
                field,
                excerpt(text.as_bytes()),
                "a name without tabs and line ends",
            ));
        }
        Ok((text, line))
    }

    fn value<T: FromStr>(&mut self, field: &str, allowed: &str) -> Result<(T, u64), IoError> {
        let word = self.words.value();
        let (text, line) = self.text(field, word, allowed)?;
        match text.parse() {
            Ok(value) => Ok((value, line)),
            Err(_) => Err(self.fault(line, field, excerpt(text.as_bytes()), allowed)),
        }
    }

    fn count(&mut self, field: &str) -> Result<usize, IoError> {
        Ok(self.value(field, "the number of arguments that follow")?.0)
    }

    fn item(&mut self) -> Result<Item, IoError> {
        let (modifier, line) = self.name("modifier")?;
        let (type_word, type_line) = self.name("type")?;
        let known = RadianceMaterial::TYPES.contains(&type_word.as_str());
        if !known && type_word != ALIAS && !OTHER_TYPES.contains(&type_word.as_str()) {
            let all = || RadianceMaterial::TYPES.iter().chain(&OTHER_TYPES).chain(&[ALIAS]);
            let names: Vec<&str> = all().copied().collect();
            let allowed = match nearest(&type_word, all().copied()) {
                Some(near) => format!("a type of RADIANCE, {near:?} perhaps"),
                None => format!("a type of RADIANCE: {}", names.join(", ")),
            };
            return Err(self.fault(type_line, "type", excerpt(type_word.as_bytes()), allowed));
        }
        let (id, _) = self.name("id")?;
        let body = if type_word == ALIAS {
            Body::Alias(self.name("alias")?.0)
        } else {
            self.arguments(type_word, line)?
        };
        Ok(Item {
            modifier,
            id,
            body,
            line,
        })
    }

    fn arguments(&mut self, type_word: String, line: u64) -> Result<Body, IoError> {
        let mut strings = Vec::new();
        for _ in 0..self.count("string arguments")? {
            let word = self.words.word();
            strings.push(self.text("string arguments", word, "as many words as counted")?.0);
        }
        let mut integers = Vec::new();
        for _ in 0..self.count("integer arguments")? {
            integers.push(
                self.value::<i64>("integer arguments", "as many integers as counted")?
                    .0,
            );
        }
        let (mut reals, mut lines) = (Vec::new(), Vec::new());
        for _ in 0..self.count("real arguments")? {
            let allowed = "as many finite numbers as counted";
            let (value, at) = self.value::<f64>("real arguments", allowed)?;
            if !value.is_finite() {
                return Err(self.fault(at, "real arguments", value.to_string(), allowed));
            }
            reals.push(value);
            lines.push(at);
        }
        let fields = RadianceMaterial::arguments_of(&type_word);
        if fields.is_some() && !integers.is_empty() {
            return Err(self.fault(line, "integer arguments", integers.len().to_string(), "0"));
        }
        match RadianceMaterial::from_arguments(&type_word, &strings, &reals) {
            Some(Ok(material)) => Ok(Body::Material(material)),
            Some(Err(BsdfError::Domain {
                field,
                found,
                allowed,
            })) => {
                let place = fields.and_then(|all| all.iter().position(|a| a.name == field));
                let at = place.and_then(|k| lines.get(k).copied());
                Err(self.fault(at.unwrap_or(line), field, found, allowed))
            }
            None => Ok(Body::Other {
                type_word,
                strings,
                integers,
                reals,
            }),
        }
    }
}

/// What `word` was meant to be, where it is near enough to one of `names`.
fn nearest<'a>(word: &str, names: impl Iterator<Item = &'a str>) -> Option<&'a str> {
    const NEAR: f64 = 0.8;
    let likeness = |name: &str| strsim::jaro_winkler(word, name);
    names
        .filter(|n| likeness(n) > NEAR)
        .max_by(|a, b| likeness(a).total_cmp(&likeness(b)))
}
