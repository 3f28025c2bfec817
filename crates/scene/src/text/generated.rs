//! What generators have in common: items, numbers, functions of their words.

use gonio_io::radiance_material::{Body, Item};

use glam::DVec3;

use crate::cal::{Point, Program};

/// What is wrong, and what is allowed.
pub(super) type Wrong = (String, &'static str);

/// Items of one generator, at most.
pub(super) const MOST: usize = 1 << 20;

pub(super) fn shape(material: &str, type_word: &str, id: &str, reals: Vec<f64>) -> Item {
    Item {
        modifier: material.into(),
        id: id.into(),
        body: Body::Other {
            type_word: type_word.into(),
            strings: vec![],
            integers: vec![],
            reals,
        },
        line: 0,
    }
}

pub(super) fn polygon(material: &str, id: &str, points: &[DVec3]) -> Item {
    let reals = points.iter().flat_map(|p| p.to_array()).collect();
    shape(material, "polygon", id, reals)
}

/// The finite number that a word is.
pub(super) fn number(
    word: Option<&String>,
    allowed: &'static str,
    fits: impl FnOnce(f64) -> bool,
) -> Result<f64, Wrong> {
    let value = word.and_then(|w| w.parse::<f64>().ok()).filter(|v| v.is_finite());
    match value {
        Some(v) if fits(v) => Ok(v),
        _ => Err((word.map_or("the end".into(), String::clone), allowed)),
    }
}

/// How many segments a word asks for.
pub(super) fn segments(word: Option<&String>) -> Result<usize, Wrong> {
    let whole = |v: f64| v.fract() == 0.0 && (1.0..=MOST as f64).contains(&v);
    Ok(number(word, "a number of segments, 1 to 1048576", whole)? as usize)
}

/// Formulas of parameters, on top of the definitions of `-e` and `-f`.
pub(super) struct Formulas {
    program: Program,
    count: usize,
}

impl Formulas {
    /// `formulas` of `parameters` (`t`, or `s, t`).
    pub(super) fn new(definitions: &str, parameters: &str, formulas: &[&String]) -> Result<Self, Wrong> {
        let mut text = definitions.to_owned();
        for (k, formula) in formulas.iter().enumerate() {
            text.push_str(&format!("\ngenerated{k}({parameters}) = {formula};"));
        }
        let program = Program::parse(&text, "generator").map_err(wrong)?;
        Ok(Formulas {
            program,
            count: formulas.len(),
        })
    }

    /// The values at one place.
    pub(super) fn at<const N: usize>(&self, parameters: &[f64]) -> Result<[f64; N], Wrong> {
        let mut out = [0.0; N];
        for (k, slot) in out.iter_mut().enumerate().take(self.count) {
            let call = self.program.call(&format!("generated{k}"), parameters);
            *slot = call
                .and_then(|e| e.evaluate(&Point::default(), &[]))
                .map_err(wrong)?;
        }
        Ok(out)
    }
}

fn wrong(e: impl std::fmt::Display) -> Wrong {
    (e.to_string(), "formulas of .cal files")
}
