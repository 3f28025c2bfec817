//! Writing scene text.

use std::fmt::Write;
use std::path::Path;

use gonio_bsdf::{BsdfError, RadianceMaterial};

use super::{ALIAS, Body, Item, OTHER_TYPES};
use crate::{IoError, write_atomic};

/// Writes `items` under `comments` (one line each, without the `#`), whole or not at all.
///
/// # Errors
/// [`IoError::Format`] for what [`to_text`] refuses, [`IoError::File`] for what the operating system refuses.
pub fn write(path: &Path, items: &[Item], comments: &[String]) -> Result<(), IoError> {
    let text = to_text(items, comments).map_err(
        |BsdfError::Domain {
             field,
             found,
             allowed,
         }| IoError::format(path, None, field, found, allowed),
    )?;
    write_atomic(path, |w| w.write_all(text.as_bytes()))
}

/// The text of `items`; [`super::read_from`] gives the same items back, numbers to the last bit.
///
/// # Errors
/// [`BsdfError::Domain`] for a parameter outside its range, a type that RADIANCE does not have, a number that is not
/// finite, a name that is empty or holds a tab or the end of a line.
pub fn to_text(items: &[Item], comments: &[String]) -> Result<String, BsdfError> {
    let mut out = String::new();
    for line in comments.iter().flat_map(|c| c.lines()) {
        push(&mut out, format_args!("# {line}\n"));
    }
    for item in items {
        if !out.is_empty() {
            out.push('\n');
        }
        write_item(&mut out, item)?;
    }
    Ok(out)
}

/// Formatting into a `String` cannot fail.
fn push(out: &mut String, text: std::fmt::Arguments<'_>) {
    let _ = out.write_fmt(text);
}

fn write_item(out: &mut String, item: &Item) -> Result<(), BsdfError> {
    let type_word = match &item.body {
        Body::Material(m) => m.type_word(),
        Body::Alias(_) => ALIAS,
        Body::Other { type_word, .. } => known(type_word)?,
    };
    let (modifier, id) = (name("modifier", &item.modifier)?, name("id", &item.id)?);
    push(out, format_args!("{modifier} {type_word} {id}"));
    match &item.body {
        Body::Material(m) => {
            m.check()?;
            lists(out, &m.strings(), &[], &m.reals())
        }
        Body::Alias(of) => {
            push(out, format_args!(" {}\n", name("alias", of)?));
            Ok(())
        }
        Body::Other {
            strings,
            integers,
            reals,
            ..
        } => lists(out, strings, integers, reals),
    }
}

fn lists(out: &mut String, strings: &[String], integers: &[i64], reals: &[f64]) -> Result<(), BsdfError> {
    push(out, format_args!("\n{}", strings.len()));
    for s in strings {
        push(out, format_args!(" {}", quoted(s)));
    }
    push(out, format_args!("\n{}", integers.len()));
    for i in integers {
        push(out, format_args!(" {i}"));
    }
    push(out, format_args!("\n{}", reals.len()));
    let long = reals.len() > 12;
    for (k, &r) in reals.iter().enumerate() {
        if !r.is_finite() {
            return Err(domain("real arguments", r.to_string(), "finite numbers"));
        }
        out.push_str(if long && k % 3 == 0 { "\n    " } else { " " });
        // Shortest text that reads back as the same number; RADIANCE takes words of up to 63 characters.
        if r != 0.0 && !(1e-4..1e15).contains(&r.abs()) {
            push(out, format_args!("{r:e}"));
        } else {
            push(out, format_args!("{r}"));
        }
    }
    out.push('\n');
    Ok(())
}

fn known(type_word: &str) -> Result<&str, BsdfError> {
    if OTHER_TYPES.contains(&type_word) {
        return Ok(type_word);
    }
    let allowed = if RadianceMaterial::TYPES.contains(&type_word) {
        "a material in its own form"
    } else {
        "a type of RADIANCE"
    };
    Err(domain("type", format!("{type_word:?}"), allowed))
}

fn domain(field: &'static str, found: impl Into<String>, allowed: &str) -> BsdfError {
    BsdfError::Domain {
        field,
        found: found.into(),
        allowed: allowed.into(),
    }
}

fn name(field: &'static str, text: &str) -> Result<String, BsdfError> {
    if text.is_empty() || text.contains(['\t', '\n', '\r']) {
        return Err(domain(
            field,
            format!("{text:?}"),
            "a name without tabs and line ends",
        ));
    }
    Ok(quoted(text))
}

/// `text` as one word: in quotes where it holds white space, quotes or a first character that means something else.
fn quoted(text: &str) -> String {
    let plain = |c: char| !c.is_ascii_whitespace() && c != '\u{b}' && c != '"' && c != '\'';
    if !text.is_empty() && text.chars().all(plain) && !text.starts_with(['#', '!']) {
        return text.into();
    }
    // Stretches of either kind of quote, as in 'a "b" '"c's".
    let mut out = String::new();
    let mut open = None;
    for c in text.chars() {
        let quote = match (open, c) {
            (_, '"') => '\'',
            (_, '\'') | (None, _) => '"',
            (Some(q), _) => q,
        };
        if open != Some(quote) {
            out.extend(open);
            out.push(quote);
            open = Some(quote);
        }
        out.push(c);
    }
    match open {
        Some(q) => out.push(q),
        None => out.push_str("\"\""),
    }
    out
}
