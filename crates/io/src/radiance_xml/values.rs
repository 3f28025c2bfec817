//! Number lists into matrices and trees.

use gonio_bsdf::BsdfError;
use gonio_bsdf::klems::{KlemsBasis, KlemsMatrix};
use gonio_bsdf::tensor_tree::{Rank, Tree, TreeBuilder};

use super::stream::{Stop, Token};
use crate::excerpt;

/// `IncidentDataStructure`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Structure {
    /// A text row is an exit patch.
    Columns,
    /// A text row is an incident patch.
    Rows,
    Tree(Rank),
}

impl Structure {
    pub(super) const ALLOWED: &'static str = "Columns, Rows, TensorTree3, TensorTree4";

    pub(super) fn of(text: &str) -> Option<Self> {
        match text.to_ascii_lowercase().as_str() {
            "columns" => Some(Structure::Columns),
            "rows" => Some(Structure::Rows),
            "tensortree3" => Some(Structure::Tree(Rank::Three)),
            "tensortree4" => Some(Structure::Tree(Rank::Four)),
            _ => None,
        }
    }
}

fn fault(field: &'static str, found: impl Into<String>, allowed: impl Into<String>) -> Stop {
    Stop::Fault {
        field,
        found: found.into(),
        allowed: allowed.into(),
    }
}

fn model(e: BsdfError) -> Stop {
    let BsdfError::Domain {
        field,
        found,
        allowed,
    } = e;
    fault(field, found, allowed)
}

fn value(text: &[u8]) -> Result<f32, Stop> {
    std::str::from_utf8(text)
        .ok()
        .and_then(|t| t.parse::<f32>().ok())
        .filter(|v| v.is_finite() && *v >= 0.0)
        .map(|v| v + 0.0) // a file's -0 becomes 0
        .ok_or_else(|| {
            fault(
                "ScatteringData",
                excerpt(text),
                "a finite number that is not negative",
            )
        })
}

/// Collects a matrix.
#[derive(Debug)]
pub(super) struct MatrixValues {
    incident: KlemsBasis,
    exit: KlemsBasis,
    rows_are_incident: bool,
    values: Vec<f32>,
}

impl MatrixValues {
    pub(super) fn new(structure: Structure, column: KlemsBasis, row: KlemsBasis) -> Self {
        let rows_are_incident = structure == Structure::Rows;
        let (incident, exit) = if rows_are_incident {
            (row, column)
        } else {
            (column, row)
        };
        MatrixValues {
            incident,
            exit,
            rows_are_incident,
            values: Vec::new(),
        }
    }

    fn wanted(&self) -> usize {
        self.incident.len() * self.exit.len()
    }

    pub(super) fn push(&mut self, token: Token<'_>) -> Result<(), Stop> {
        let Token::Number(text) = token else {
            return Err(fault("ScatteringData", "a brace", "numbers only in a matrix"));
        };
        if self.values.len() == self.wanted() {
            return Err(fault(
                "ScatteringData",
                "one more value",
                format!("{} values for the angle bases", self.wanted()),
            ));
        }
        self.values.push(value(text)?);
        Ok(())
    }

    pub(super) fn finish(self) -> Result<KlemsMatrix, Stop> {
        if self.values.len() != self.wanted() {
            return Err(fault(
                "ScatteringData",
                format!("{} values", self.values.len()),
                format!("{} values for the angle bases", self.wanted()),
            ));
        }
        let values = if self.rows_are_incident {
            let (ni, no) = (self.incident.len(), self.exit.len());
            (0..ni * no)
                .map(|k| self.values[(k % ni) * no + k / ni])
                .collect()
        } else {
            self.values
        };
        KlemsMatrix::new(self.incident, self.exit, values).map_err(model)
    }
}

/// Collects a tree.
#[derive(Debug)]
pub(super) struct TreeValues {
    builder: TreeBuilder,
    /// A brace is open and nothing has followed it yet.
    fresh: bool,
    block: Vec<f32>,
}

impl TreeValues {
    pub(super) fn new(rank: Rank) -> Self {
        TreeValues {
            builder: TreeBuilder::new(rank),
            fresh: false,
            block: Vec::new(),
        }
    }

    pub(super) fn push(&mut self, token: Token<'_>) -> Result<(), Stop> {
        match token {
            Token::Open => {
                if !self.block.is_empty() {
                    return Err(fault(
                        "ScatteringData",
                        "a brace among values",
                        "either values or branches",
                    ));
                }
                if self.fresh {
                    self.builder.branch().map_err(model)?;
                }
                self.fresh = true;
            }
            Token::Number(text) => {
                if !self.fresh {
                    return Err(fault(
                        "ScatteringData",
                        excerpt(text),
                        "values inside braces of their own",
                    ));
                }
                self.block.push(value(text)?);
            }
            Token::Close => {
                if self.fresh {
                    self.builder.block(&self.block).map_err(model)?;
                    self.block.clear();
                    self.fresh = false;
                } else {
                    self.builder.end().map_err(model)?;
                }
            }
        }
        Ok(())
    }

    pub(super) fn finish(self) -> Result<Tree, Stop> {
        if self.fresh {
            return Err(fault(
                "ScatteringData",
                "an open brace at the end",
                "matching braces",
            ));
        }
        self.builder.finish().map_err(model)
    }
}
