//! The function language of RADIANCE (`.cal` files): definitions of variables and functions of what a ray meets.
//!
//! A [`Program`] is what one file defines, on top of the library every file may use; an [`Expression`] is one value of
//! it, its names looked up once, evaluated at a [`Point`] with the real arguments of a primitive. Evaluations are bounded
//! in depth and in steps, and never panic. Where RADIANCE warns and goes on with 0 (a division by zero, a function outside
//! its domain, an illegal power) the value is 0 and [`Program::faults`] counts it. Differences: a name that an expression
//! needs and nothing defines is refused when the expression is made, not when it is first met; numbered inputs and
//! outputs (`$1`), which rendering has no use for, may stand in a file, and only using an input is an error.
//!
//! ```
//! use gonio_scene::cal::{Point, Program};
//! let program = Program::parse("stripes = if(frac(Px) - .5, A1, A2);", "stripes.cal")?;
//! let at = Point { position: [2.75, 0.0, 0.0], ..Point::default() };
//! assert_eq!(program.expression("stripes")?.evaluate(&at, &[0.9, 0.1])?, 0.9);
//! # Ok::<(), gonio_scene::cal::CalError>(())
//! ```

mod builtin;
mod error;
mod evaluate;
mod lexer;
mod noise;
mod parse;
mod point;
mod resolve;
#[cfg(test)]
mod tests;

pub use error::CalError;
pub use point::Point;

use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};

use resolve::{Definitions, Node};

/// Levels of parentheses, comments or powers within one another.
const MAX_NESTING: usize = 100;
/// Levels of evaluation within one another: expressions, variables and calls count.
const MAX_DEPTH: u32 = 1000;
/// Steps of one evaluation: every number, name, operator and call counts.
const MAX_STEPS: u32 = 1_000_000;
/// Evaluations of a program that may meet that limit; after them none is tried, as each takes a hundredth of a second.
const MAX_UNENDING: u64 = 16;

/// What every file may use beside the functions of the language.
const LIBRARY: &str = include_str!("library.cal");

/// The text of a function file that comes with gonio, for scenes that name it: `skybright.cal` (what `gensky` writes) and
/// `perezlum.cal` (what `gendaylit` writes). None for other names.
pub fn shipped(name: &str) -> Option<&'static str> {
    match name {
        "skybright.cal" => Some(include_str!("skybright.cal")),
        "perezlum.cal" => Some(include_str!("perezlum.cal")),
        _ => None,
    }
}

/// How often an evaluation met what has no value, and went on with 0.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Faults {
    /// Divisions by zero.
    pub divisions: u64,
    /// Powers without a finite real value.
    pub powers: u64,
    /// Functions outside their domain or range, and results that are not finite.
    pub domains: u64,
}

#[derive(Debug, Default)]
struct Counters {
    /// Evaluations that took too many steps.
    unending: AtomicU64,
    divisions: AtomicU64,
    powers: AtomicU64,
    domains: AtomicU64,
}

/// The definitions of one function file. Cheap to clone; may be shared between threads.
#[derive(Debug, Clone)]
pub struct Program {
    definitions: Arc<Definitions>,
}

/// One value of a program. Cheap to clone; may be shared between threads.
#[derive(Debug, Clone)]
pub struct Expression {
    definitions: Arc<Definitions>,
    node: Arc<Node>,
}

impl Program {
    /// Reads a function file; `name` is what errors call it. An empty text gives the library alone.
    ///
    /// # Errors
    /// [`CalError::Syntax`] or [`CalError::Nesting`], with the line.
    pub fn parse(text: &str, name: &str) -> Result<Self, CalError> {
        let library = parse::definitions(LIBRARY, "the library")?;
        let own = parse::definitions(text, name)?;
        Ok(Program {
            definitions: Arc::new(Definitions::new(library, own, name)),
        })
    }

    /// Makes an expression of the program: the name of a variable of it, or any formula.
    ///
    /// # Errors
    /// As [`Program::parse`]; [`CalError::Undefined`] or [`CalError::TooFewArguments`] where it, or a definition that it
    /// needs, uses a name that is defined nowhere or calls a function with too few arguments.
    pub fn expression(&self, text: &str) -> Result<Expression, CalError> {
        let tree = parse::expression(text, &self.definitions.file)?;
        let node = self.definitions.outside(tree)?;
        Ok(Expression {
            definitions: self.definitions.clone(),
            node: Arc::new(node),
        })
    }

    /// Makes an expression that calls a function of the program with these numbers.
    ///
    /// # Errors
    /// As [`Program::expression`].
    pub fn call(&self, function: &str, arguments: &[f64]) -> Result<Expression, CalError> {
        let node = self.definitions.call(function, arguments)?;
        Ok(Expression {
            definitions: self.definitions.clone(),
            node: Arc::new(node),
        })
    }

    /// Value of an expression of this program; the same as [`Expression::evaluate`].
    ///
    /// # Errors
    /// As [`Expression::evaluate`].
    pub fn evaluate(
        &self,
        expression: &Expression,
        point: &Point,
        arguments: &[f64],
    ) -> Result<f64, CalError> {
        expression.evaluate(point, arguments)
    }

    /// What evaluations of this program met so far, in all threads.
    pub fn faults(&self) -> Faults {
        let counters = &self.definitions.counters;
        Faults {
            divisions: counters.divisions.load(Ordering::Relaxed),
            powers: counters.powers.load(Ordering::Relaxed),
            domains: counters.domains.load(Ordering::Relaxed),
        }
    }
}

impl Expression {
    /// The value at a point, with the real arguments of the primitive (`A1` is the first). Always finite.
    ///
    /// # Errors
    /// [`CalError::MissingArgument`], [`CalError::NotAFunction`], [`CalError::Depth`] or [`CalError::Work`]; that at once
    /// for all expressions of a program after 16 evaluations.
    pub fn evaluate(&self, point: &Point, arguments: &[f64]) -> Result<f64, CalError> {
        evaluate::value(&self.definitions, &self.node, point, arguments)
    }
}
