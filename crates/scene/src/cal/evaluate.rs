//! Values of expressions. Arguments of functions are evaluated when they are first used, in the frame of the caller, and
//! at most once a call; variables at most once an evaluation, for the first 64 of a file's.

use std::cell::Cell;
use std::sync::atomic::{AtomicU64, Ordering};

use super::builtin::Builtin;
use super::resolve::{Definitions, Node};
use super::{CalError, MAX_DEPTH, MAX_STEPS, MAX_UNENDING, Point};

/// Variables, and arguments of a call, whose values are kept.
const KEPT_VARIABLES: usize = 64;
const KEPT_ARGUMENTS: usize = 8;

/// Why an evaluation ends early; small, as every step may return it.
#[derive(Debug, Clone, Copy)]
enum Stop {
    Depth,
    Work,
    Missing(usize),
    NotAFunction {
        line: usize,
        parameter: usize,
    },
    /// Only for nodes that the check of the expression refuses.
    Unchecked,
}

/// A call on its way.
struct Frame<'f, 'a> {
    arguments: &'a [Node],
    known: Cell<u8>,
    values: [Cell<f64>; KEPT_ARGUMENTS],
    caller: Option<&'f Frame<'f, 'a>>,
}

struct Run<'a> {
    definitions: &'a Definitions,
    point: &'a Point,
    reals: &'a [f64],
    known: Cell<u64>,
    values: [Cell<f64>; KEPT_VARIABLES],
    steps: Cell<u32>,
    depth: Cell<u32>,
}

pub(super) fn value(
    definitions: &Definitions,
    node: &Node,
    point: &Point,
    reals: &[f64],
) -> Result<f64, CalError> {
    let run = Run {
        definitions,
        point,
        reals,
        known: Cell::new(0),
        values: [const { Cell::new(0.0) }; KEPT_VARIABLES],
        steps: Cell::new(0),
        depth: Cell::new(0),
    };
    let file = || definitions.file.clone();
    let unending = &definitions.counters.unending;
    let found = if unending.load(Ordering::Relaxed) < MAX_UNENDING {
        run.value(node, None)
    } else {
        Err(Stop::Work)
    };
    if matches!(found, Err(Stop::Work)) {
        unending.fetch_add(1, Ordering::Relaxed);
    }
    match found {
        Ok(value) => Ok(run.finite(value, &definitions.counters.domains)),
        Err(Stop::Depth | Stop::Unchecked) => Err(CalError::Depth {
            file: file(),
            limit: MAX_DEPTH,
        }),
        Err(Stop::Work) => Err(CalError::Work {
            file: file(),
            limit: MAX_STEPS,
        }),
        Err(Stop::Missing(asked)) => Err(CalError::MissingArgument {
            file: file(),
            asked,
            given: reals.len(),
        }),
        Err(Stop::NotAFunction { line, parameter }) => Err(CalError::NotAFunction {
            file: file(),
            line,
            parameter: parameter + 1,
        }),
    }
}

impl<'a> Run<'a> {
    /// The value, or 0 and a count where it is not finite.
    fn finite(&self, value: f64, counter: &AtomicU64) -> f64 {
        if value.is_finite() {
            return value;
        }
        counter.fetch_add(1, Ordering::Relaxed);
        0.0
    }

    fn value(&self, node: &'a Node, frame: Option<&Frame<'_, 'a>>) -> Result<f64, Stop> {
        match node {
            Node::Number(value) => return Ok(*value),
            Node::Ray(ray) => return Ok(ray.of(self.point)),
            _ => {}
        }
        self.steps.set(self.steps.get() + 1);
        if self.steps.get() > MAX_STEPS {
            return Err(Stop::Work);
        }
        if self.depth.get() >= MAX_DEPTH {
            return Err(Stop::Depth);
        }
        self.depth.set(self.depth.get() + 1);
        let value = self.inner(node, frame)?;
        self.depth.set(self.depth.get() - 1);
        Ok(value)
    }

    fn inner(&self, node: &'a Node, frame: Option<&Frame<'_, 'a>>) -> Result<f64, Stop> {
        match node {
            Node::Number(value) => Ok(*value),
            Node::Ray(ray) => Ok(ray.of(self.point)),
            Node::Variable(n) => self.variable(*n),
            Node::Argument(n) => frame.map_or(Err(Stop::Unchecked), |frame| self.argument(*n, frame)),
            Node::Negative(inner) => Ok(-self.value(inner, frame)?),
            Node::Sum(first, rest) => {
                let mut sum = self.value(first, frame)?;
                for (less, term) in rest {
                    let x = self.value(term, frame)?;
                    sum += if *less { -x } else { x };
                }
                Ok(sum)
            }
            Node::Product(first, rest) => {
                let mut product = self.value(first, frame)?;
                for (over, factor) in rest {
                    let x = self.value(factor, frame)?;
                    product = match (*over, x == 0.0) {
                        (false, _) => product * x,
                        (true, false) => product / x,
                        (true, true) => self.finite(f64::INFINITY, &self.definitions.counters.divisions),
                    };
                }
                Ok(product)
            }
            Node::Power(base, exponent) => {
                let power = self.value(base, frame)?.powf(self.value(exponent, frame)?);
                Ok(self.finite(power, &self.definitions.counters.powers))
            }
            Node::Call(n, arguments, _) => self.call(*n, arguments, frame),
            Node::Builtin(builtin, arguments, _) => self.builtin(*builtin, arguments, frame),
            Node::CallArgument(n, arguments, line) => self.call_argument(*n, arguments, *line, frame),
            Node::Function(..) | Node::Library(..) | Node::Undefined(..) => Err(Stop::Unchecked),
        }
    }

    fn variable(&self, n: usize) -> Result<f64, Stop> {
        let body = &self.definitions.variables[n];
        let n = n.wrapping_sub(self.definitions.first_own);
        if n >= KEPT_VARIABLES {
            return self.value(body, None);
        }
        if self.known.get() >> n & 1 == 0 {
            self.values[n].set(self.value(body, None)?);
            self.known.set(self.known.get() | 1 << n);
        }
        Ok(self.values[n].get())
    }

    fn argument(&self, n: usize, frame: &Frame<'_, 'a>) -> Result<f64, Stop> {
        let kept = n < KEPT_ARGUMENTS;
        if kept && frame.known.get() >> n & 1 == 1 {
            return Ok(frame.values[n].get());
        }
        let node = frame.arguments.get(n).ok_or(Stop::Unchecked)?;
        let value = self.value(node, frame.caller)?;
        if kept {
            frame.values[n].set(value);
            frame.known.set(frame.known.get() | 1 << n);
        }
        Ok(value)
    }

    #[inline(never)]
    fn call(&self, n: usize, arguments: &'a [Node], caller: Option<&Frame<'_, 'a>>) -> Result<f64, Stop> {
        let frame = Frame {
            arguments,
            known: Cell::new(0),
            values: [const { Cell::new(0.0) }; KEPT_ARGUMENTS],
            caller,
        };
        self.value(&self.definitions.functions[n].body, Some(&frame))
    }

    /// Calls what is passed for a parameter: a function by its name, or in turn a parameter of the caller.
    fn call_argument(
        &self,
        parameter: usize,
        arguments: &'a [Node],
        line: usize,
        frame: Option<&Frame<'_, 'a>>,
    ) -> Result<f64, Stop> {
        let wrong = Stop::NotAFunction { line, parameter };
        let (mut n, mut scope) = (parameter, frame);
        loop {
            let around = scope.ok_or(wrong)?;
            match around.arguments.get(n).ok_or(wrong)? {
                Node::Argument(next) => (n, scope) = (*next, around.caller),
                Node::Function(n, _) if self.definitions.functions[*n].parameters <= arguments.len() => {
                    return self.call(*n, arguments, frame);
                }
                Node::Library(builtin, _) if builtin.needed() <= arguments.len() => {
                    return self.builtin(*builtin, arguments, frame);
                }
                _ => return Err(wrong),
            }
        }
    }

    #[inline(never)]
    fn builtin(
        &self,
        builtin: Builtin,
        arguments: &'a [Node],
        frame: Option<&Frame<'_, 'a>>,
    ) -> Result<f64, Stop> {
        let at = |n: usize| self.value(&arguments[n], frame);
        let domains = &self.definitions.counters.domains;
        match builtin {
            Builtin::If => at(if at(0)? > 0.0 { 1 } else { 2 }),
            Builtin::Select => {
                let chosen = at(0)?;
                match (chosen + 0.5).trunc() {
                    n if chosen < -0.5 || n >= arguments.len() as f64 => Ok(self.finite(f64::NAN, domains)),
                    0.0 => Ok((arguments.len() - 1) as f64),
                    n => at(n as usize),
                }
            }
            Builtin::Min => (1..arguments.len()).try_fold(at(0)?, |least, n| Ok(least.min(at(n)?))),
            Builtin::Max => (1..arguments.len()).try_fold(at(0)?, |most, n| Ok(most.max(at(n)?))),
            Builtin::Arg => match (at(0)? + 0.5) as usize {
                0 => Ok(self.reals.len() as f64),
                n => self.reals.get(n - 1).copied().ok_or(Stop::Missing(n)),
            },
            _ => {
                let mut x = [0.0; 5];
                for (n, x) in x.iter_mut().enumerate().take(builtin.needed()) {
                    *x = at(n)?;
                }
                Ok(self.finite(builtin.value(x), domains))
            }
        }
    }
}
