//! Scene files and the commands in them, as one list of items.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use gonio_io::radiance_material::{self, Found, Item, scan};
use gonio_io::{IoError, excerpt, read_bytes};

use super::command::stages;
use super::files::Files;
use super::genbox::genbox;
use super::generators;
use super::transform::Change;
use super::xform::Xform;
use crate::error::{Place, SceneError};
use crate::generate;

/// An item and where it stands: of a generated one, its command.
#[derive(Clone, Debug)]
pub struct Entry {
    /// The item, transformed.
    pub item: Item,
    /// Where.
    pub place: Place,
}

/// Files inside files, at most.
const DEEPEST: usize = 32;
/// Items that commands make, at most: what arrays in arrays could ask for has a bound in memory (some 2 GB).
const MOST_ITEMS: usize = 1 << 22;

/// All items of `path`, commands carried out.
///
/// # Errors
/// [`SceneError::Text`] for files that cannot be read, text that is no scene, commands that gonio does not know, files
/// that include themselves.
pub fn read(path: &Path, files: &Files) -> Result<Vec<Entry>, SceneError> {
    let mut expansion = Expansion {
        files,
        open: Vec::new(),
    };
    let mut out = Vec::new();
    expansion.file(path, None, &mut out)?;
    Ok(out)
}

/// [`read`] of text already in memory; `path` appears in errors, and files are found as beside it.
///
/// # Errors
/// As [`read`].
pub fn read_from(path: &Path, bytes: &[u8], files: &Files) -> Result<Vec<Entry>, SceneError> {
    let mut expansion = Expansion {
        files,
        open: Vec::new(),
    };
    let file: Arc<Path> = path.into();
    let mut out = Vec::new();
    scan(path, bytes, |found| expansion.found(found, &file, &mut out))?;
    Ok(out)
}

/// What a file is that is often taken for scene text, and what goes in its place.
fn otherwise(bytes: &[u8]) -> Option<(&'static str, &'static str)> {
    let head = &bytes[..bytes.len().min(4096)];
    let has = |word: &[u8]| head.windows(word.len()).any(|w| w == word);
    if head.trim_ascii_start().starts_with(b"<") {
        Some((
            "XML",
            "scene text; a BSDF is a material in it (BSDF, aBSDF), or shown by itself (render --preview)",
        ))
    } else if head.starts_with(b"#?") && has(b"FORMAT=Radiance_octree") {
        Some(("an octree", "the scene text it was made from"))
    } else if head.starts_with(b"#?") && has(b"FORMAT=32-bit_") {
        Some((
            "a picture",
            "scene text; a picture is a pattern in it (colorpict)",
        ))
    } else {
        None
    }
}

struct Expansion<'a> {
    files: &'a Files,
    /// Files that are being read, one inside the other.
    open: Vec<PathBuf>,
}

impl Expansion<'_> {
    fn file(&mut self, path: &Path, from: Option<&Place>, out: &mut Vec<Entry>) -> Result<(), SceneError> {
        let own = path.canonicalize().map_err(|e| IoError::file(path, e))?;
        if let Some(place) = from {
            let found = || format!("{:?}", path.display().to_string());
            if self.open.contains(&own) {
                return Err(place.fault("file", found(), "a file that does not include itself"));
            }
            if self.open.len() >= DEEPEST {
                return Err(place.fault(
                    "file",
                    found(),
                    format!("at most {DEEPEST} files inside each other"),
                ));
            }
        }
        let bytes = read_bytes(path)?;
        let file: Arc<Path> = path.into();
        if let Some((found, allowed)) = otherwise(&bytes) {
            let place = Place { file, line: 1 };
            return Err(place.fault("file", found, allowed));
        }
        self.open.push(own);
        let done = scan(path, &bytes, |found| self.found(found, &file, out));
        self.open.pop();
        done
    }

    fn found(&mut self, found: Found, file: &Arc<Path>, out: &mut Vec<Entry>) -> Result<(), SceneError> {
        let place = |line| Place {
            file: file.clone(),
            line,
        };
        match found {
            Found::Item(item) => {
                let place = place(item.line);
                out.push(Entry { item, place });
                Ok(())
            }
            Found::Command { text, line } => {
                let place = place(line);
                let made = self.command(&text, &place)?;
                out.extend(made);
                bounded(out.len(), &place)
            }
        }
    }

    fn command(&mut self, text: &str, place: &Place) -> Result<Vec<Entry>, SceneError> {
        let wrong = |(found, allowed): (String, &'static str)| place.fault("command", found, allowed);
        let mut made: Option<Vec<Entry>> = None;
        for words in stages(text.strip_prefix('!').unwrap_or(text)).map_err(wrong)? {
            let (name, words) = (words[0].as_str(), &words[1..]);
            let at_place = |items: Vec<Item>| -> Vec<Entry> {
                let at = |item| Entry {
                    item,
                    place: place.clone(),
                };
                items.into_iter().map(at).collect()
            };
            let next = match name {
                "xform" => self.xform(words, made.take(), place)?,
                _ if made.is_some() => {
                    return Err(place.fault("command", format!("{name:?}"), "xform after |"));
                }
                "genbox" => at_place(genbox(words).map_err(wrong)?),
                "genprism" => at_place(generators::genprism(words).map_err(wrong)?),
                "genblinds" => at_place(generators::genblinds(words).map_err(wrong)?),
                "genrev" | "genworm" | "gensurf" => {
                    let (words, definitions) = self.definitions(words, place)?;
                    let made = match name {
                        "genrev" => generators::genrev(&words, &definitions),
                        "genworm" => generators::genworm(&words, &definitions),
                        _ => generators::gensurf(&words, &definitions),
                    };
                    at_place(made.map_err(wrong)?)
                }
                "gensky" | "gendaylit" => {
                    let words: Vec<&str> = words.iter().map(String::as_str).collect();
                    let text = match name {
                        "gensky" => generate::gensky(&words),
                        _ => generate::gendaylit(&words),
                    };
                    let text = text.map_err(|e| e.at(place))?;
                    at_place(radiance_material::read_from(&place.file, text.as_bytes())?)
                }
                _ => {
                    return Err(place.fault(
                        "command",
                        excerpt(text.as_bytes()),
                        "xform, genbox, genprism, genblinds, genrev, genworm, gensurf, gensky, gendaylit: no other command \
                         is run; run it yourself and include what it prints",
                    ));
                }
            };
            made = Some(next);
        }
        Ok(made.unwrap_or_default())
    }

    /// The words without `-e formula` and `-f file`, and the definitions of these.
    fn definitions(&self, words: &[String], place: &Place) -> Result<(Vec<String>, String), SceneError> {
        let (mut rest, mut text) = (Vec::new(), String::new());
        let mut words = words.iter();
        while let Some(word) = words.next() {
            match (word.as_str(), words.as_slice().first()) {
                ("-e", Some(formula)) => {
                    text.push_str(formula);
                    text.push_str(";\n");
                    words.next();
                }
                ("-f", Some(name)) => {
                    let path = self.files.find(name, place)?;
                    text.push_str(&String::from_utf8_lossy(&read_bytes(&path)?));
                    text.push_str(";\n");
                    words.next();
                }
                _ => rest.push(word.clone()),
            }
        }
        Ok((rest, text))
    }

    /// One list of words for each line of the files of options (`-f`) in `words`, the line in place of the file.
    fn invocations(&self, words: Vec<String>, place: &Place) -> Result<Vec<Vec<String>>, SceneError> {
        const MOST: usize = 1 << 16;
        let mut done = Vec::new();
        // Lists with what is left of their depth; the last one is the next.
        let mut open = vec![(words, 8)];
        while let Some((words, depth)) = open.pop() {
            let Some(k) = words.iter().position(|w| w == "-f") else {
                done.push(words);
                continue;
            };
            let Some(name) = words.get(k + 1) else {
                return Err(place.fault("xform", "-f", "-f and a file of options"));
            };
            if depth == 0 || open.len() + done.len() > MOST {
                let allowed = format!("files of options 8 inside each other, {MOST} lines in all");
                return Err(place.fault("xform", format!("-f {name:?}"), allowed));
            }
            let path = self.files.find(name, place)?;
            let text = String::from_utf8_lossy(&read_bytes(&path)?).into_owned();
            let first = open.len();
            for (number, line) in text.lines().enumerate() {
                if line.trim().is_empty() || line.trim_start().starts_with('#') {
                    continue;
                }
                let wrong = |(found, allowed)| {
                    IoError::format(&path, number as u64 + 1, "options of xform", found, allowed)
                };
                let mut stages = stages(line).map_err(wrong)?;
                let (true, Some(line)) = (stages.len() == 1, stages.pop()) else {
                    return Err(wrong(("|".into(), "options alone")).into());
                };
                let named = matches!(line[0].as_str(), "xform" | "!xform");
                let line = &line[usize::from(named)..];
                open.push(([&words[..k], line, &words[k + 2..]].concat(), depth - 1));
            }
            open[first..].reverse();
        }
        Ok(done)
    }

    /// `given` is what comes through a pipe.
    fn xform(
        &mut self,
        words: &[String],
        given: Option<Vec<Entry>>,
        place: &Place,
    ) -> Result<Vec<Entry>, SceneError> {
        if words.iter().any(|w| w == "-f") {
            let mut all = Vec::new();
            for words in self.invocations(words.to_vec(), place)? {
                all.extend(self.xform(&words, given.clone(), place)?);
                bounded(all.len(), place)?;
            }
            return Ok(all);
        }
        copies(words, place)?;
        // The words that stand for files, the same in every copy of an array.
        let mut changes = Vec::new();
        let rest = arrays(words.to_vec(), &mut changes, place, 0)?;
        let given = match (given, &words[words.len() - rest..]) {
            (Some(given), []) => given,
            (Some(_), [file, ..]) => {
                return Err(place.fault("xform", format!("{file:?}"), "no file after |"));
            }
            (None, []) => return Err(place.fault("xform", "no file", "a file to transform")),
            (None, names) => {
                let mut read = Vec::new();
                for name in names {
                    let path = self.files.find(name, place)?;
                    self.file(&path, Some(place), &mut read)?;
                }
                read
            }
        };
        bounded(given.len().saturating_mul(changes.len()), place)?;
        let mut out = Vec::with_capacity(given.len() * changes.len());
        for change in &changes {
            for entry in &given {
                let mut entry = entry.clone();
                change.apply(&mut entry.item, &entry.place)?;
                out.push(entry);
            }
        }
        Ok(out)
    }
}

/// How many copies all arrays make together.
fn copies(words: &[String], place: &Place) -> Result<(), SceneError> {
    let counts = words.windows(2).filter(|w| w[0] == "-a");
    let each = counts.map(|w| w[1].parse::<usize>().unwrap_or(1));
    bounded(each.fold(1, usize::saturating_mul), place)
}

fn bounded(items: usize, place: &Place) -> Result<(), SceneError> {
    if items <= MOST_ITEMS {
        return Ok(());
    }
    Err(place.fault(
        "command",
        format!("{items} items"),
        format!("at most {MOST_ITEMS}: a mesh holds more for less"),
    ))
}

/// One change for each copy that the arrays (`-a`) of `words` make, the last array fastest; how many words follow the
/// options.
fn arrays(
    mut words: Vec<String>,
    changes: &mut Vec<Change>,
    place: &Place,
    depth: usize,
) -> Result<usize, SceneError> {
    const MOST: usize = 1 << 20;
    let Some(k) = words.iter().position(|w| w == "-a") else {
        let (change, rest) = change(&words, place)?;
        changes.push(change);
        return Ok(rest);
    };
    let word = words.get(k + 1).cloned().unwrap_or_default();
    let count = word.parse::<usize>().ok().filter(|n| (1..=MOST).contains(n));
    let (Some(count), true) = (count, depth < 8) else {
        return Err(place.fault(
            "xform",
            format!("-a {word}"),
            "-a and how many copies, 1 to 1048576, 8 deep",
        ));
    };
    words[k] = "-i".into();
    let mut rest = 0;
    for n in 0..count {
        words[k + 1] = n.to_string();
        rest = arrays(words.clone(), changes, place, depth + 1)?;
        bounded(changes.len(), place)?;
    }
    Ok(rest)
}

/// The change of words without arrays, and how many words follow its options.
fn change(words: &[String], place: &Place) -> Result<(Change, usize), SceneError> {
    let (mut modifier, mut prefix, mut invert) = (None, None::<String>, false);
    let mut at = 0;
    loop {
        match (words.get(at).map(String::as_str), words.get(at + 1)) {
            (Some("-m"), Some(name)) => {
                modifier.get_or_insert_with(|| name.clone());
                at += 2;
            }
            (Some("-n"), Some(name)) => {
                prefix = Some(prefix.map_or_else(|| name.clone(), |p| format!("{p}.{name}")));
                at += 2;
            }
            (Some("-c" | "-e"), _) => at += 1,
            (Some("-I"), _) => {
                invert = !invert;
                at += 1;
            }
            _ => break,
        }
    }
    let (xform, used) =
        Xform::parse(&words[at..]).map_err(|(found, allowed)| place.fault("xform", found, allowed))?;
    Ok((
        Change {
            xform,
            words: words[at..at + used].to_vec(),
            modifier,
            prefix,
            invert,
        },
        words.len() - at - used,
    ))
}
