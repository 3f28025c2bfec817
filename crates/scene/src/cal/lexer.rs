//! Text to words: names, numbers and single characters; comments and blanks fall away.

use super::{CalError, MAX_NESTING};

#[derive(Debug, Clone, PartialEq)]
pub(super) enum Token {
    Name(String),
    Number(f64),
    Symbol(char),
    End,
}

impl Token {
    pub(super) fn describe(&self) -> String {
        match self {
            Token::Name(name) => format!("`{name}`"),
            Token::Number(value) => format!("the number {value}"),
            Token::Symbol(c) => format!("`{}`", c.escape_default()),
            Token::End => "the end".into(),
        }
    }
}

pub(super) struct Lexer<'t> {
    rest: &'t str,
    pub(super) file: &'t str,
    pub(super) line: usize,
}

impl<'t> Lexer<'t> {
    pub(super) fn new(text: &'t str, file: &'t str) -> Self {
        Lexer {
            rest: text,
            file,
            line: 1,
        }
    }

    pub(super) fn wrong<T>(&self, found: String, allowed: &'static str) -> Result<T, CalError> {
        Err(CalError::Syntax {
            file: self.file.into(),
            line: self.line,
            found,
            allowed,
        })
    }

    fn peek(&self) -> Option<char> {
        self.rest.chars().next()
    }

    fn step(&mut self) -> Option<char> {
        let c = self.peek()?;
        self.rest = &self.rest[c.len_utf8()..];
        if c == '\n' {
            self.line += 1;
        }
        Some(c)
    }

    /// Takes the longest head whose characters pass.
    fn take(&mut self, pass: impl Fn(char) -> bool) -> &'t str {
        let end = self.rest.find(|c| !pass(c)).unwrap_or(self.rest.len());
        let (head, tail) = self.rest.split_at(end);
        self.rest = tail;
        head
    }

    /// Passes blanks and comments; comments nest.
    fn skip(&mut self) -> Result<(), CalError> {
        let mut open = 0;
        while let Some(c) = self.peek() {
            match c {
                '{' if open == MAX_NESTING => {
                    return Err(CalError::Nesting {
                        file: self.file.into(),
                        line: self.line,
                        limit: MAX_NESTING,
                    });
                }
                '{' => open += 1,
                '}' if open > 0 => open -= 1,
                _ if open > 0 || c.is_ascii_whitespace() || c == '\u{b}' => {}
                _ => break,
            }
            self.step();
        }
        if open > 0 {
            return self.wrong("the end within a comment".into(), "`}`");
        }
        Ok(())
    }

    pub(super) fn next(&mut self) -> Result<Token, CalError> {
        self.skip()?;
        match self.peek() {
            None => Ok(Token::End),
            Some(c) if c.is_ascii_alphabetic() || c == '`' => {
                let name = self.take(|c| c.is_ascii_alphanumeric() || matches!(c, '_' | '.' | '`'));
                Ok(Token::Name(name.into()))
            }
            Some(c) if c.is_ascii_digit() || c == '.' => self.number(),
            Some(c) => {
                self.step();
                Ok(Token::Symbol(c))
            }
        }
    }

    fn number(&mut self) -> Result<Token, CalError> {
        let start = self.rest;
        let whole = self.take(|c| c.is_ascii_digit());
        let mut fraction = "";
        if self.peek() == Some('.') {
            self.step();
            fraction = self.take(|c| c.is_ascii_digit());
        }
        if whole.is_empty() && fraction.is_empty() {
            return self.wrong("`.`".into(), "a digit beside a decimal point");
        }
        if matches!(self.peek(), Some('e' | 'E')) {
            self.step();
            if matches!(self.peek(), Some('+' | '-')) {
                self.step();
            }
            if self.take(|c| c.is_ascii_digit()).is_empty() {
                return self.wrong("an exponent without digits".into(), "a digit after `e`");
            }
        }
        let text = &start[..start.len() - self.rest.len()];
        match text.parse::<f64>() {
            Ok(value) if value.is_finite() => Ok(Token::Number(value)),
            _ => self.wrong(format!("`{text}`"), "a number below 1.8e308"),
        }
    }
}
