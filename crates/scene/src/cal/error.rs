use thiserror::Error;

/// What is wrong with a function file or with an evaluation of it.
#[derive(Debug, Clone, PartialEq, Error)]
pub enum CalError {
    /// The text does not follow the grammar.
    #[error("{file}, line {line}: found {found}, where {allowed} is allowed")]
    Syntax {
        /// Name of the file.
        file: String,
        /// Line, from 1.
        line: usize,
        /// What stands there.
        found: String,
        /// What may stand there.
        allowed: &'static str,
    },
    /// Parentheses, powers or comments within one another beyond the limit.
    #[error("{file}, line {line}: nested deeper than {limit}")]
    Nesting {
        /// Name of the file.
        file: String,
        /// Line, from 1.
        line: usize,
        /// Levels allowed.
        limit: usize,
    },
    /// A name that an expression needs is defined nowhere, or not as what it is used as.
    #[error("{file}, line {line}: `{name}` is not a {wanted} of the file or of the library")]
    Undefined {
        /// Name of the file.
        file: String,
        /// Line, from 1.
        line: usize,
        /// The name.
        name: String,
        /// `variable` or `function`.
        wanted: &'static str,
    },
    /// A call with fewer arguments than the function has parameters.
    #[error("{file}, line {line}: `{name}` is given {found} arguments and needs {needed}")]
    TooFewArguments {
        /// Name of the file.
        file: String,
        /// Line, from 1.
        line: usize,
        /// The function.
        name: String,
        /// Arguments given.
        found: usize,
        /// Arguments needed.
        needed: usize,
    },
    /// `arg(n)` beyond the real arguments of the primitive.
    #[error("{file}: real argument {asked} is asked for, and the primitive has {given}")]
    MissingArgument {
        /// Name of the file.
        file: String,
        /// Number asked for, from 1.
        asked: usize,
        /// Real arguments given.
        given: usize,
    },
    /// A parameter is called, and what was passed for it is no function.
    #[error(
        "{file}, line {line}: what is passed for parameter {parameter} is called, and is not the name of a function of that many arguments"
    )]
    NotAFunction {
        /// Name of the file.
        file: String,
        /// Line of the call, from 1.
        line: usize,
        /// Number of the parameter, from 1.
        parameter: usize,
    },
    /// Definitions call one another beyond the limit.
    #[error("{file}: an evaluation nests deeper than {limit}; does a definition use itself without end?")]
    Depth {
        /// Name of the file.
        file: String,
        /// Levels allowed.
        limit: u32,
    },
    /// One evaluation takes more steps than the limit.
    #[error("{file}: an evaluation takes more than {limit} steps; does a definition use itself without end?")]
    Work {
        /// Name of the file.
        file: String,
        /// Steps allowed.
        limit: u32,
    },
}
