//! Names to what they stand for, once, so that an evaluation looks nothing up.

use std::collections::{HashMap, HashSet};

use super::builtin::Builtin;
use super::parse::{Definition, Tree};
use super::point::Ray;
use super::{CalError, Counters};

/// An expression whose names are looked up.
#[derive(Debug, Clone)]
pub(super) enum Node {
    Number(f64),
    Ray(Ray),
    Variable(usize),
    Argument(usize),
    Negative(Box<Node>),
    Sum(Box<Node>, Box<[(bool, Node)]>),
    Product(Box<Node>, Box<[(bool, Node)]>),
    Power(Box<Node>, Box<Node>),
    Call(usize, Box<[Node]>, usize),
    Builtin(Builtin, Box<[Node]>, usize),
    /// A call of what is passed for a parameter.
    CallArgument(usize, Box<[Node]>, usize),
    /// The name of a function, as a function may be passed.
    Function(usize, usize),
    Library(Builtin, usize),
    /// A name that stands for nothing, and what it was used as.
    Undefined(Box<str>, &'static str, usize),
}

#[derive(Debug)]
pub(super) struct Function {
    pub(super) name: String,
    pub(super) parameters: usize,
    pub(super) body: Node,
}

#[derive(Debug)]
pub(super) struct Definitions {
    pub(super) file: String,
    pub(super) variables: Vec<Node>,
    pub(super) functions: Vec<Function>,
    pub(super) counters: Counters,
    /// Variables of the library stand before this one.
    pub(super) first_own: usize,
    scopes: [Scope; 2],
}

#[derive(Debug, Clone, Copy)]
enum Symbol {
    Variable(usize),
    Function(usize),
}

type Scope = HashMap<String, Symbol>;

/// Scopes in the order in which names are looked for.
const FILE: usize = 0;
const LIBRARY: usize = 1;

/// A name as it is looked up: without its marks, and the scopes where it may be.
fn scoped(name: &str, scope: usize) -> (&str, std::ops::RangeInclusive<usize>) {
    if let Some(local) = name.strip_prefix('`') {
        (local, scope..=scope)
    } else if let Some(global) = name.strip_suffix('`') {
        (global, LIBRARY..=LIBRARY)
    } else {
        (name, scope..=LIBRARY)
    }
}

impl Definitions {
    pub(super) fn new(library: Vec<Definition>, own: Vec<Definition>, file: &str) -> Self {
        let mut scopes = [Scope::new(), Scope::new()];
        let (mut variables, mut functions) = (0, 0);
        let all: Vec<_> = (library.into_iter().map(|d| (LIBRARY, d)))
            .chain(own.into_iter().map(|d| (FILE, d)))
            .collect();
        for (scope, definition) in &all {
            let count = if definition.parameters.is_some() {
                &mut functions
            } else {
                &mut variables
            };
            let symbol = if definition.parameters.is_some() {
                Symbol::Function
            } else {
                Symbol::Variable
            };
            // The last definition of a name is the one that holds.
            scopes[*scope].insert(scoped(&definition.name, *scope).0.into(), symbol(*count));
            *count += 1;
        }
        let mut definitions = Definitions {
            file: file.into(),
            variables: Vec::with_capacity(variables),
            functions: Vec::with_capacity(functions),
            counters: Counters::default(),
            first_own: all
                .iter()
                .filter(|(scope, d)| *scope == LIBRARY && d.parameters.is_none())
                .count(),
            scopes,
        };
        for (scope, definition) in all {
            let body = definitions.node(definition.body, scope);
            match definition.parameters {
                Some(parameters) => definitions.functions.push(Function {
                    name: definition.name,
                    parameters: parameters.len(),
                    body,
                }),
                None => definitions.variables.push(body),
            }
        }
        definitions
    }

    fn symbol(&self, name: &str, scope: usize) -> Option<Symbol> {
        let (name, mut scopes) = scoped(name, scope);
        scopes.find_map(|k| self.scopes[k].get(name).copied())
    }

    fn variable(&self, name: String, line: usize, scope: usize) -> Node {
        match self.symbol(&name, scope) {
            Some(Symbol::Variable(n)) => match self.variables.get(n) {
                // A number that is known already.
                Some(Node::Number(value)) => Node::Number(*value),
                _ => Node::Variable(n),
            },
            Some(Symbol::Function(n)) => Node::Function(n, line),
            None => {
                let bare = name.trim_matches('`');
                if let Some(ray) = Ray::named(bare) {
                    Node::Ray(ray)
                } else if let Some(builtin) = Builtin::named(bare) {
                    Node::Library(builtin, line)
                } else {
                    Node::Undefined(name.into(), "variable", line)
                }
            }
        }
    }

    fn nodes(&self, trees: Vec<Tree>, scope: usize) -> Box<[Node]> {
        trees.into_iter().map(|tree| self.node(tree, scope)).collect()
    }

    fn terms(&self, terms: Vec<(bool, Tree)>, scope: usize) -> Box<[(bool, Node)]> {
        terms
            .into_iter()
            .map(|(sign, tree)| (sign, self.node(tree, scope)))
            .collect()
    }

    fn node(&self, tree: Tree, scope: usize) -> Node {
        match tree {
            Tree::Number(value) => Node::Number(value),
            Tree::Name(name, line) => self.variable(name, line, scope),
            Tree::Argument(number) => Node::Argument(number),
            Tree::Channel(line) => Node::Undefined("$".into(), "variable", line),
            Tree::Negative(tree) => Node::Negative(Box::new(self.node(*tree, scope))),
            Tree::Sum(first, rest) => fold(Node::Sum(
                Box::new(self.node(*first, scope)),
                self.terms(rest, scope),
            )),
            Tree::Product(first, rest) => fold(Node::Product(
                Box::new(self.node(*first, scope)),
                self.terms(rest, scope),
            )),
            Tree::Power(base, exponent) => Node::Power(
                Box::new(self.node(*base, scope)),
                Box::new(self.node(*exponent, scope)),
            ),
            Tree::CallArgument(number, trees, line) => {
                Node::CallArgument(number, self.nodes(trees, scope), line)
            }
            Tree::Call(name, trees, line) => {
                let arguments = self.nodes(trees, scope);
                match (self.symbol(&name, scope), Builtin::named(name.trim_matches('`'))) {
                    (Some(Symbol::Function(n)), _) => Node::Call(n, arguments, line),
                    (_, Some(builtin)) => Node::Builtin(builtin, arguments, line),
                    _ => Node::Undefined(name.into(), "function", line),
                }
            }
        }
    }

    /// An expression from outside, in the scope of the file, all that it needs checked.
    pub(super) fn outside(&self, tree: Tree) -> Result<Node, CalError> {
        let node = self.node(tree, FILE);
        self.check(&node)?;
        Ok(node)
    }

    pub(super) fn call(&self, name: &str, arguments: &[f64]) -> Result<Node, CalError> {
        let numbers = arguments.iter().map(|value| Tree::Number(*value)).collect();
        self.outside(Tree::Call(name.into(), numbers, 1))
    }

    /// Follows what an expression needs; the first fault is the error.
    fn check(&self, node: &Node) -> Result<(), CalError> {
        let (mut variables, mut functions) = (HashSet::new(), HashSet::new());
        let mut waiting = vec![node];
        while let Some(node) = waiting.pop() {
            match node {
                Node::Number(_) | Node::Ray(_) | Node::Argument(_) => {}
                Node::Variable(n) => {
                    if variables.insert(*n) {
                        waiting.push(&self.variables[*n]);
                    }
                }
                Node::Negative(inner) => waiting.push(inner),
                Node::Sum(first, rest) | Node::Product(first, rest) => {
                    waiting.push(first);
                    waiting.extend(rest.iter().map(|(_, node)| node));
                }
                Node::Power(base, exponent) => waiting.extend([base.as_ref(), exponent]),
                Node::Call(n, arguments, line) => {
                    let function = &self.functions[*n];
                    self.enough(&function.name, arguments.len(), function.parameters, *line)?;
                    self.pass(arguments, &mut waiting, &mut functions);
                    if functions.insert(*n) {
                        waiting.push(&function.body);
                    }
                }
                Node::Builtin(builtin, arguments, line) => {
                    self.enough(builtin.name(), arguments.len(), builtin.needed(), *line)?;
                    waiting.extend(arguments);
                }
                Node::CallArgument(_, arguments, _) => self.pass(arguments, &mut waiting, &mut functions),
                Node::Function(n, line) => {
                    return self.undefined(&self.functions[*n].name, "variable", *line);
                }
                Node::Library(builtin, line) => return self.undefined(builtin.name(), "variable", *line),
                Node::Undefined(name, wanted, line) => return self.undefined(name, wanted, *line),
            }
        }
        Ok(())
    }

    /// Arguments of a call: names of functions may be among them.
    fn pass<'a>(
        &'a self,
        arguments: &'a [Node],
        waiting: &mut Vec<&'a Node>,
        functions: &mut HashSet<usize>,
    ) {
        for argument in arguments {
            match argument {
                Node::Library(..) => {}
                Node::Function(n, _) => {
                    if functions.insert(*n) {
                        waiting.push(&self.functions[*n].body);
                    }
                }
                _ => waiting.push(argument),
            }
        }
    }

    fn enough(&self, name: &str, found: usize, needed: usize, line: usize) -> Result<(), CalError> {
        if found >= needed {
            return Ok(());
        }
        Err(CalError::TooFewArguments {
            file: self.file.clone(),
            line,
            name: name.into(),
            found,
            needed,
        })
    }

    fn undefined(&self, name: &str, wanted: &'static str, line: usize) -> Result<(), CalError> {
        Err(CalError::Undefined {
            file: self.file.clone(),
            line,
            name: name.into(),
            wanted,
        })
    }
}

/// A sum or product of numbers is a number; where it is not finite it stays, for the evaluation to count.
fn fold(node: Node) -> Node {
    let (Node::Sum(first, rest) | Node::Product(first, rest)) = &node else {
        return node;
    };
    let Node::Number(mut value) = **first else {
        return node;
    };
    let product = matches!(node, Node::Product(..));
    for (inverse, term) in rest {
        let Node::Number(x) = *term else {
            return node;
        };
        match (product, inverse) {
            (false, false) => value += x,
            (false, true) => value -= x,
            (true, false) => value *= x,
            (true, true) if x == 0.0 => return node,
            (true, true) => value /= x,
        }
    }
    if value.is_finite() {
        Node::Number(value)
    } else {
        node
    }
}
