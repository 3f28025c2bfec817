//! The variables of the search, and how the parameters of every part follow from them.

use gonio_geom::Component;
use nalgebra::DMatrix;

use crate::FitModel;
use crate::model::Part;

/// One number that the search varies.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Variable {
    /// The parameter it stands for.
    pub(crate) parameter: usize,
    /// The channel it belongs to; `None`: all of them.
    pub(crate) channel: Option<usize>,
    /// Whether it is the logarithm of the parameter.
    pub(crate) log: bool,
    pub(crate) low: f64,
    pub(crate) high: f64,
}

impl Variable {
    pub(crate) fn value(&self, x: f64) -> f64 {
        if self.log { x.exp() } else { x }
    }

    pub(crate) fn of_value(&self, q: f64) -> f64 {
        if self.log { q.max(1e-300).ln() } else { q }
    }

    /// `dq / dx` at the value `q`.
    pub(crate) fn slope(&self, q: f64) -> f64 {
        if self.log { q } else { 1.0 }
    }
}

/// A model over some channels as a function of the variables.
#[derive(Clone, Debug)]
pub(crate) struct Chart<'a> {
    pub(crate) model: &'a FitModel,
    pub(crate) variables: Vec<Variable>,
    /// Variable of each channel and parameter.
    at: Vec<Vec<usize>>,
}

/// The parts that matter for one channel and component, at one point of the search.
#[derive(Clone, Debug)]
pub(crate) struct Local {
    /// Position in the model and parameters of each part.
    pub(crate) parts: Vec<(usize, Vec<f64>)>,
    /// Number of parameters of all parts together.
    pub(crate) columns: usize,
    /// Derivative of each of them by each variable.
    pub(crate) by_variable: DMatrix<f64>,
}

impl<'a> Chart<'a> {
    pub(crate) fn new(model: &'a FitModel, channels: usize) -> Self {
        let mut variables = Vec::new();
        let mut at = vec![Vec::new(); channels];
        for (parameter, p) in model.parameters.iter().enumerate() {
            let log = p.logarithmic();
            let of = |v: f64| if log { v.ln() } else { v };
            for (c, row) in at.iter_mut().enumerate() {
                if c == 0 || p.per_channel {
                    variables.push(Variable {
                        parameter,
                        channel: p.per_channel.then_some(c),
                        log,
                        low: of(p.low),
                        high: of(p.high),
                    });
                }
                row.push(variables.len() - 1);
            }
        }
        Chart { model, variables, at }
    }

    pub(crate) fn len(&self) -> usize {
        self.variables.len()
    }

    pub(crate) fn bounds(&self) -> (Vec<f64>, Vec<f64>) {
        self.variables.iter().map(|v| (v.low, v.high)).unzip()
    }

    /// The parameters of `channel`.
    pub(crate) fn parameters(&self, x: &[f64], channel: usize) -> Vec<f64> {
        self.at[channel]
            .iter()
            .map(|&v| self.variables[v].value(x[v]))
            .collect()
    }

    /// Ratio of the sines of incidence and of unscattered transmission in each channel: of the first part with an
    /// interface, 1 without one.
    pub(crate) fn index_ratios(&self, x: &[f64]) -> Vec<f64> {
        (0..self.at.len())
            .map(|channel| {
                let q = self.parameters(x, channel);
                let of = |part: &Part| {
                    let values: Vec<f64> = part.values.iter().map(|v| v.value(&q)).collect();
                    part.family.index_ratio(&values)
                };
                let mut ratios = self.model.parts.iter().map(of);
                ratios.find(|r| *r != 1.0).unwrap_or(1.0)
            })
            .collect()
    }

    /// Variables from the parameters of every channel; shared ones from the first.
    pub(crate) fn variables_of(&self, q: &[Vec<f64>]) -> Vec<f64> {
        self.variables
            .iter()
            .map(|v| v.of_value(q[v.channel.unwrap_or(0)][v.parameter]))
            .collect()
    }

    pub(crate) fn local(&self, x: &[f64], channel: usize, component: Component) -> Local {
        let q = self.parameters(x, channel);
        let mut parts = Vec::new();
        let mut rows: Vec<Vec<f64>> = Vec::new();
        for (k, part) in self.model.parts.iter().enumerate() {
            if !part.info().scatters.into(component) {
                continue;
            }
            parts.push((k, part.values.iter().map(|v| v.value(&q)).collect()));
            for product in &part.values {
                let mut row = vec![0.0; x.len()];
                for (parameter, &v) in self.at[channel].iter().enumerate() {
                    if product.uses(parameter) {
                        row[v] += product.derivative(&q, parameter) * self.variables[v].slope(q[parameter]);
                    }
                }
                rows.push(row);
            }
        }
        Local {
            parts,
            columns: rows.len(),
            by_variable: DMatrix::from_fn(rows.len(), x.len(), |a, b| rows[a][b]),
        }
    }
}
