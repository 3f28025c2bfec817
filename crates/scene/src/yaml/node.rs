//! Fields of a YAML file with their line.

use std::path::Path;
use std::sync::Arc;

use gonio_io::IoError;
use saphyr::{LoadableYamlNode, MarkedYaml, Scalar, YamlData};

use crate::error::{Place, SceneError};

/// A value and the way to it.
#[derive(Clone)]
pub(super) struct Field<'a> {
    node: &'a MarkedYaml<'a>,
    /// Names of the fields it lies in, with dots.
    pub(super) name: String,
    file: Arc<Path>,
}

/// Characters of a file, at most.
const MOST: usize = 1 << 22;

/// Hands the whole of a file to `on`.
///
/// # Errors
/// [`SceneError::Text`] with the line for text that is no YAML, and what `on` returns.
pub(super) fn parse<T>(
    path: &Path,
    bytes: &[u8],
    on: impl FnOnce(Field<'_>) -> Result<T, SceneError>,
) -> Result<T, SceneError> {
    let wrong = |line: Option<u64>, found: String, allowed: &str| {
        SceneError::from(IoError::format(path, line, "YAML", found, allowed))
    };
    let text = std::str::from_utf8(bytes).map_err(|e| wrong(None, e.to_string(), "UTF-8 text"))?;
    if text.len() > MOST {
        return Err(wrong(
            None,
            format!("{} bytes", text.len()),
            "at most 4 MB: geometry stands in meshes",
        ));
    }
    if let Some(line) = too_deep(text) {
        return Err(wrong(
            Some(line),
            "fields deep within one another".into(),
            "a scene (docs/formats/scene-yaml.md)",
        ));
    }
    let documents = MarkedYaml::load_from_str(text)
        .map_err(|e| wrong(Some(e.marker().line() as u64), e.info().to_owned(), "YAML 1.2"))?;
    let [node] = documents.as_slice() else {
        let found = format!("{} documents", documents.len());
        return Err(wrong(Some(1), found, "one: a scene (docs/formats/scene-yaml.md)"));
    };
    on(Field {
        node,
        name: String::new(),
        file: path.into(),
    })
}

/// The first line that could lie deeper than any field of a scene: what reads and frees it calls itself.
fn too_deep(text: &str) -> Option<u64> {
    const DEEPEST: usize = 40;
    let mut open = 0_usize;
    for (number, line) in text.lines().enumerate() {
        let start = line.trim_start_matches([' ', '-', '?', ':', '\t']);
        let inside = line.len() - start.len();
        let mut deepest = open;
        for c in line.chars() {
            match c {
                '[' | '{' => open += 1,
                ']' | '}' => open = open.saturating_sub(1),
                _ => {}
            }
            deepest = deepest.max(open);
        }
        if inside > 2 * DEEPEST || deepest > DEEPEST {
            return Some(number as u64 + 1);
        }
    }
    None
}

impl<'a> Field<'a> {
    pub(super) fn place(&self) -> Place {
        Place {
            file: self.file.clone(),
            line: self.node.span.start.line() as u64,
        }
    }

    pub(super) fn fault(&self, found: impl Into<String>, allowed: impl Into<String>) -> SceneError {
        let name = if self.name.is_empty() { "scene" } else { &self.name };
        self.place().fault(name, found, allowed)
    }

    /// What stands there, in short.
    fn found(&self) -> String {
        match &self.node.data {
            YamlData::Value(Scalar::Null) => "nothing".into(),
            YamlData::Value(Scalar::Boolean(b)) => b.to_string(),
            YamlData::Value(Scalar::Integer(n)) => n.to_string(),
            YamlData::Value(Scalar::FloatingPoint(x)) => x.to_string(),
            YamlData::Value(Scalar::String(s)) => gonio_io::excerpt(s.as_bytes()),
            YamlData::Sequence(s) => format!("a list of {}", s.len()),
            YamlData::Mapping(m) => format!("{} fields", m.len()),
            _ => "a tag or an alias".into(),
        }
    }

    fn below(&self, node: &'a MarkedYaml<'a>, name: &str) -> Field<'a> {
        let name = match self.name.as_str() {
            "" => name.to_owned(),
            above => format!("{above}.{name}"),
        };
        Field {
            node,
            name,
            file: self.file.clone(),
        }
    }

    /// The fields of a mapping, in order.
    pub(super) fn fields(&self, allowed: &str) -> Result<Vec<(String, Field<'a>)>, SceneError> {
        let YamlData::Mapping(map) = &self.node.data else {
            return Err(self.fault(self.found(), allowed));
        };
        let mut out = Vec::with_capacity(map.len());
        for (key, node) in map {
            let name = match &key.data {
                YamlData::Value(Scalar::String(s)) => s.to_string(),
                YamlData::Value(Scalar::Integer(n)) => n.to_string(),
                _ => {
                    let key = self.below(key, "key");
                    return Err(key.fault(key.found(), "a name"));
                }
            };
            out.push((name.clone(), self.below(node, &name)));
        }
        Ok(out)
    }

    /// A mapping of these fields at most.
    pub(super) fn record(&self, known: &[&str]) -> Result<Record<'a>, SceneError> {
        let allowed = known.join(", ");
        let fields = self.fields(&allowed)?;
        if let Some((name, field)) = fields.iter().find(|(name, _)| !known.contains(&name.as_str())) {
            return Err(field.fault(format!("a field {name:?}"), allowed));
        }
        Ok(Record {
            field: self.clone(),
            fields,
        })
    }

    /// The entries of a list.
    pub(super) fn entries(&self, allowed: &str) -> Result<Vec<Field<'a>>, SceneError> {
        let YamlData::Sequence(list) = &self.node.data else {
            return Err(self.fault(self.found(), allowed));
        };
        let entry = |(k, node)| Field {
            name: format!("{}[{}]", self.name, k + 1),
            ..self.below(node, "")
        };
        Ok(list.iter().enumerate().map(entry).collect())
    }

    pub(super) fn is_text(&self) -> bool {
        matches!(&self.node.data, YamlData::Value(Scalar::String(_)))
    }

    pub(super) fn is_list(&self) -> bool {
        matches!(&self.node.data, YamlData::Sequence(_))
    }

    /// A text that is not empty; numbers count as text.
    pub(super) fn text(&self, allowed: &str) -> Result<String, SceneError> {
        match &self.node.data {
            YamlData::Value(Scalar::String(s)) if !s.trim().is_empty() => Ok(s.to_string()),
            YamlData::Value(Scalar::Integer(n)) => Ok(n.to_string()),
            YamlData::Value(Scalar::FloatingPoint(x)) => Ok(x.to_string()),
            _ => Err(self.fault(self.found(), allowed)),
        }
    }

    /// One of these words.
    pub(super) fn one_of<T: Copy>(&self, all: &[(&str, T)]) -> Result<T, SceneError> {
        let names: Vec<&str> = all.iter().map(|(name, _)| *name).collect();
        let text = self.text(&names.join(", "))?;
        let found = all.iter().find(|(name, _)| *name == text);
        found
            .map(|(_, value)| *value)
            .ok_or_else(|| self.fault(self.found(), names.join(", ")))
    }

    pub(super) fn truth(&self) -> Result<bool, SceneError> {
        match &self.node.data {
            YamlData::Value(Scalar::Boolean(b)) => Ok(*b),
            _ => Err(self.fault(self.found(), "true or false")),
        }
    }

    /// A finite number within a range.
    pub(super) fn number(&self, range: std::ops::RangeInclusive<f64>) -> Result<f64, SceneError> {
        let value = match &self.node.data {
            YamlData::Value(Scalar::Integer(n)) => Some(*n as f64),
            YamlData::Value(Scalar::FloatingPoint(x)) => Some(x.into_inner()),
            _ => None,
        };
        value.filter(|v| range.contains(v)).ok_or_else(|| {
            let (low, high) = (range.start(), range.end());
            self.fault(self.found(), format!("a number from {low} to {high}"))
        })
    }

    /// A list of finite numbers.
    pub(super) fn numbers(&self, allowed: &str) -> Result<Vec<f64>, SceneError> {
        let each = self.entries(allowed)?;
        each.iter().map(|f| f.number(f64::MIN..=f64::MAX)).collect()
    }

    /// Three finite numbers.
    pub(super) fn vector(&self) -> Result<[f64; 3], SceneError> {
        let numbers = self.numbers("three numbers")?;
        <[f64; 3]>::try_from(numbers).map_err(|n| self.fault(format!("{} numbers", n.len()), "three numbers"))
    }
}

/// A mapping of known fields.
pub(super) struct Record<'a> {
    pub(super) field: Field<'a>,
    pub(super) fields: Vec<(String, Field<'a>)>,
}

impl<'a> Record<'a> {
    pub(super) fn get(&self, name: &str) -> Option<&Field<'a>> {
        self.fields.iter().find(|(n, _)| n == name).map(|(_, f)| f)
    }

    pub(super) fn need(&self, name: &str) -> Result<&Field<'a>, SceneError> {
        let missing = || {
            self.field
                .fault(format!("no field {name:?}"), format!("{name}: …"))
        };
        self.get(name).ok_or_else(missing)
    }
}
