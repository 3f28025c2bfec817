//! What is fitted: parts from the registry of analytic models, and how their parameters hang together.

use gonio_bsdf::analytic::{Family, ModelInfo, Role, Sum};
use gonio_bsdf::{Bsdf, Channel};
use gonio_geom::Component;

use crate::{FitError, Product};

/// One parameter of a fit.
#[derive(Clone, Debug, PartialEq)]
pub struct Parameter {
    /// Name as in docs/nomenclature.md; a number is added where two parts share one.
    pub name: String,
    /// Unit; `1` when it has none.
    pub unit: String,
    /// Smallest value allowed.
    pub low: f64,
    /// Largest value allowed.
    pub high: f64,
    /// Value a search begins with when the data say nothing.
    pub default: f64,
    /// What it does.
    pub role: Role,
    /// One value a channel, or one for all channels.
    pub per_channel: bool,
    /// Its meaning in a phrase.
    pub meaning: String,
}

impl Parameter {
    /// Whether the search runs over its logarithm: positive quantities that span decades.
    pub(crate) fn logarithmic(&self) -> bool {
        self.low > 0.0 && (self.role == Role::Width || self.high / self.low > 100.0)
    }
}

/// One analytic model of a sum.
#[derive(Clone)]
pub struct Part {
    /// The model from the registry.
    pub family: &'static dyn Family,
    /// Each of its parameters as a product of those of the fit.
    pub values: Vec<Product>,
}

impl Part {
    /// The model as data.
    pub fn info(&self) -> &'static ModelInfo {
        self.family.info()
    }
}

/// A model to fit: a sum of analytic models whose parameters are products of the parameters of the fit.
#[derive(Clone)]
pub struct FitModel {
    /// Name on the command line.
    pub name: String,
    /// Name in sentences.
    pub title: String,
    /// The parameters, in order.
    pub parameters: Vec<Parameter>,
    /// The parts.
    pub parts: Vec<Part>,
}

impl std::fmt::Debug for FitModel {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let names: Vec<_> = self.parameters.iter().map(|p| p.name.as_str()).collect();
        f.debug_struct("FitModel")
            .field("name", &self.name)
            .field("parameters", &names)
            .finish()
    }
}

impl FitModel {
    /// The sum of `families`, each parameter free: amplitudes and indices one a channel, the rest shared. A name that
    /// occurs twice gets the number of its part.
    pub fn sum_of(name: &str, title: &str, families: &[&'static dyn Family]) -> Self {
        let base = |family: &dyn Family, k: usize| -> String {
            let info = family.info();
            let own = info.parameters[k].name;
            match own {
                "rho" if matches!(info.name, "lambert" | "oren-nayar") => "kd".into(),
                "rho" => "ks".into(),
                "tau" if info.name == "lambert-transmission" => "td".into(),
                "tau" => "ts".into(),
                _ => own.into(),
            }
        };
        let all: Vec<String> = families
            .iter()
            .flat_map(|f| (0..f.info().parameters.len()).map(|k| base(*f, k)))
            .collect();
        let mut model = FitModel {
            name: name.into(),
            title: title.into(),
            parameters: Vec::new(),
            parts: Vec::new(),
        };
        for family in families {
            let mut values = Vec::new();
            for (k, info) in family.info().parameters.iter().enumerate() {
                let own = base(*family, k);
                let shared_name = all.iter().filter(|n| **n == own).count() > 1;
                values.push(Product::of(model.parameters.len()));
                model.parameters.push(Parameter {
                    name: if shared_name {
                        let before = model
                            .parameters
                            .iter()
                            .filter(|p| {
                                p.name
                                    .rsplit_once('_')
                                    .is_some_and(|(n, d)| n == own && d.parse::<u32>().is_ok())
                            })
                            .count();
                        format!("{own}_{}", before + 1)
                    } else {
                        own
                    },
                    unit: info.unit.into(),
                    low: info.low,
                    high: info.high,
                    default: info.default,
                    role: info.role,
                    per_channel: matches!(info.role, Role::Amplitude | Role::Index),
                    meaning: info.meaning.into(),
                });
            }
            model.parts.push(Part {
                family: *family,
                values,
            });
        }
        model
    }

    /// Whether some part scatters into `component`.
    pub fn scatters_into(&self, component: Component) -> bool {
        self.parts.iter().any(|p| p.info().scatters.into(component))
    }

    /// Position of the parameter `name`.
    pub fn position(&self, name: &str) -> Option<usize> {
        self.parameters.iter().position(|p| p.name == name)
    }

    /// Parameters of part `part` for the parameters `q` of one channel, within the part's own range (rounding aside).
    pub fn part_values(&self, part: usize, q: &[f64]) -> Vec<f64> {
        let part = &self.parts[part];
        part.values
            .iter()
            .zip(part.info().parameters)
            .map(|(v, info)| v.value(q).clamp(info.low, info.high))
            .collect()
    }

    /// The scattering model with parameters `q`, one list a channel in the order of [`FitModel::parameters`].
    ///
    /// # Errors
    /// [`FitError::Bsdf`] for parameters that a part refuses, no channel, or a channel given twice.
    pub fn bsdf(&self, q: &[(Channel, Vec<f64>)]) -> Result<Box<dyn Bsdf>, FitError> {
        let mut parts = Vec::with_capacity(self.parts.len());
        for k in 0..self.parts.len() {
            let values: Vec<_> = q.iter().map(|(c, q)| (*c, self.part_values(k, q))).collect();
            parts.push(self.parts[k].family.model(&values)?);
        }
        match (parts.pop(), parts.is_empty()) {
            (Some(only), true) => Ok(only),
            (Some(last), false) => {
                parts.push(last);
                Ok(Box::new(Sum::new(parts)?))
            }
            (None, _) => Ok(Box::new(Sum::new(parts)?)),
        }
    }

    /// The default of every parameter.
    pub fn defaults(&self) -> Vec<f64> {
        self.parameters.iter().map(|p| p.default).collect()
    }
}
