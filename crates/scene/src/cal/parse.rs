//! Words to trees. The grammar, loosest first: sums, products, powers (grouping to the right), a sign, a primary. A sign
//! binds tighter than a power, as in RADIANCE: `-2^2` is 4.

use super::lexer::{Lexer, Token};
use super::{CalError, MAX_NESTING};

/// An expression whose names are not yet looked up.
#[derive(Debug, Clone, PartialEq)]
pub(super) enum Tree {
    Number(f64),
    Name(String, usize),
    /// A parameter of the function around, from 0.
    Argument(usize),
    Channel(usize),
    Negative(Box<Tree>),
    /// Terms; `true` marks those taken away.
    Sum(Box<Tree>, Vec<(bool, Tree)>),
    /// Factors; `true` marks those divided by.
    Product(Box<Tree>, Vec<(bool, Tree)>),
    Power(Box<Tree>, Box<Tree>),
    Call(String, Vec<Tree>, usize),
    CallArgument(usize, Vec<Tree>, usize),
}

/// `name = body` or `name(parameters) = body`; `constant` when written with a colon.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Definition {
    pub(super) name: String,
    /// None for a variable.
    pub(super) parameters: Option<Vec<String>>,
    pub(super) constant: bool,
    pub(super) body: Tree,
}

struct Parser<'t> {
    lexer: Lexer<'t>,
    next: Token,
    /// Line of `next`.
    line: usize,
    parameters: Vec<String>,
    depth: usize,
}

/// Every definition of a file, in its order; outputs (`$1 = …`) are read and left out.
pub(super) fn definitions(text: &str, file: &str) -> Result<Vec<Definition>, CalError> {
    let mut parser = Parser::new(text, file)?;
    let mut all = Vec::new();
    loop {
        match &parser.next {
            Token::End => return Ok(all),
            Token::Symbol(';') => parser.step()?,
            _ => {
                all.extend(parser.statement()?);
                if parser.next != Token::End {
                    parser.symbol(';', "an operator, or `;` after a definition")?;
                }
            }
        }
    }
}

/// One expression and nothing after it.
pub(super) fn expression(text: &str, file: &str) -> Result<Tree, CalError> {
    let mut parser = Parser::new(text, file)?;
    let tree = parser.sum()?;
    match parser.next {
        Token::End => Ok(tree),
        _ => parser.wrong("an operator or the end of the expression"),
    }
}

impl<'t> Parser<'t> {
    fn new(text: &'t str, file: &'t str) -> Result<Self, CalError> {
        let mut parser = Parser {
            lexer: Lexer::new(text, file),
            next: Token::End,
            line: 1,
            parameters: Vec::new(),
            depth: 0,
        };
        parser.step()?;
        Ok(parser)
    }

    fn step(&mut self) -> Result<(), CalError> {
        self.next = self.lexer.next()?;
        self.line = self.lexer.line;
        Ok(())
    }

    fn wrong<T>(&self, allowed: &'static str) -> Result<T, CalError> {
        self.lexer.wrong(self.next.describe(), allowed)
    }

    fn is(&self, symbols: &[char]) -> Option<char> {
        match self.next {
            Token::Symbol(c) if symbols.contains(&c) => Some(c),
            _ => None,
        }
    }

    fn symbol(&mut self, wanted: char, allowed: &'static str) -> Result<(), CalError> {
        if self.next != Token::Symbol(wanted) {
            return self.wrong(allowed);
        }
        self.step()
    }

    fn name(&mut self, allowed: &'static str) -> Result<String, CalError> {
        let Token::Name(name) = &self.next else {
            return self.wrong(allowed);
        };
        let name = name.clone();
        self.step()?;
        Ok(name)
    }

    fn statement(&mut self) -> Result<Option<Definition>, CalError> {
        if self.is(&['$']).is_some() {
            self.step()?;
            if !matches!(self.next, Token::Number(_)) {
                return self.wrong("the number of an output");
            }
            self.step()?;
            self.symbol('=', "`=`")?;
            self.sum()?;
            return Ok(None);
        }
        let name = self.name("a name to define, or `$`")?;
        let mut parameters = None;
        if self.is(&['(']).is_some() {
            let mut all = Vec::new();
            loop {
                self.step()?;
                if matches!(&self.next, Token::Name(name) if name.contains('`')) {
                    return self.wrong("the name of a parameter, without backquotes");
                }
                all.push(self.name("the name of a parameter")?);
                if self.is(&[',']).is_none() {
                    break;
                }
            }
            self.symbol(')', "`,` or `)`")?;
            parameters = Some(all);
        }
        let Some(kind) = self.is(&['=', ':']) else {
            return self.wrong("`=` or `:`");
        };
        self.step()?;
        self.parameters = parameters.clone().unwrap_or_default();
        let body = self.sum()?;
        self.parameters.clear();
        Ok(Some(Definition {
            name,
            parameters,
            constant: kind == ':',
            body,
        }))
    }

    fn sum(&mut self) -> Result<Tree, CalError> {
        self.depth += 1;
        if self.depth > MAX_NESTING {
            return Err(CalError::Nesting {
                file: self.lexer.file.into(),
                line: self.line,
                limit: MAX_NESTING,
            });
        }
        let first = self.product()?;
        let mut rest = Vec::new();
        while let Some(sign) = self.is(&['+', '-']) {
            self.step()?;
            rest.push((sign == '-', self.product()?));
        }
        self.depth -= 1;
        Ok(if rest.is_empty() {
            first
        } else {
            Tree::Sum(Box::new(first), rest)
        })
    }

    fn product(&mut self) -> Result<Tree, CalError> {
        let first = self.power()?;
        let mut rest = Vec::new();
        while let Some(sign) = self.is(&['*', '/']) {
            self.step()?;
            rest.push((sign == '/', self.power()?));
        }
        Ok(if rest.is_empty() {
            first
        } else {
            Tree::Product(Box::new(first), rest)
        })
    }

    fn power(&mut self) -> Result<Tree, CalError> {
        let mut all = vec![self.signed()?];
        while self.is(&['^']).is_some() {
            self.step()?;
            all.push(self.signed()?);
            if all.len() > MAX_NESTING {
                return Err(CalError::Nesting {
                    file: self.lexer.file.into(),
                    line: self.line,
                    limit: MAX_NESTING,
                });
            }
        }
        let folded = all
            .into_iter()
            .rev()
            .reduce(|exponent, base| Tree::Power(Box::new(base), Box::new(exponent)));
        Ok(folded.unwrap_or(Tree::Number(0.0)))
    }

    fn signed(&mut self) -> Result<Tree, CalError> {
        match self.is(&['+', '-']) {
            Some(sign) => {
                self.step()?;
                let tree = self.primary()?;
                Ok(match (sign, tree) {
                    ('+', tree) => tree,
                    (_, Tree::Number(value)) => Tree::Number(-value),
                    (_, tree) => Tree::Negative(Box::new(tree)),
                })
            }
            None => self.primary(),
        }
    }

    fn primary(&mut self) -> Result<Tree, CalError> {
        let line = self.line;
        match self.next.clone() {
            Token::Number(value) => {
                self.step()?;
                Ok(Tree::Number(value))
            }
            Token::Symbol('(') => {
                self.step()?;
                let tree = self.sum()?;
                self.symbol(')', "an operator or `)`")?;
                Ok(tree)
            }
            Token::Symbol('$') => {
                self.step()?;
                if !matches!(self.next, Token::Number(_)) {
                    return self.wrong("the number of an input");
                }
                self.step()?;
                Ok(Tree::Channel(line))
            }
            Token::Name(name) => {
                self.step()?;
                let parameter = self.parameters.iter().position(|p| *p == name);
                if self.is(&['(']).is_none() {
                    return Ok(parameter.map_or(Tree::Name(name, line), Tree::Argument));
                }
                let mut arguments = Vec::new();
                loop {
                    self.step()?;
                    arguments.push(self.sum()?);
                    if self.is(&[',']).is_none() {
                        break;
                    }
                }
                self.symbol(')', "an operator, `,` or `)`")?;
                Ok(match parameter {
                    Some(number) => Tree::CallArgument(number, arguments, line),
                    None => Tree::Call(name, arguments, line),
                })
            }
            _ => self.wrong("a number, a name or `(`"),
        }
    }
}
