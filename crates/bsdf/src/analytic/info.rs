//! What a model says about itself, as data: the fit, the command line, reports and law tests read it.

use gonio_geom::Component;

/// A physical law that every model keeps unless its [`ModelInfo::breaks`] names it.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Law {
    /// `f(wi, ws) = f(ws, wi)`; for transmission with the sides swapped, divided by the squared indices.
    Reciprocity,
    /// Directional-hemispherical reflectance plus transmittance is at most 1.
    Energy,
}

/// A law that a model breaks by design.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Exemption {
    /// The law.
    pub law: Law,
    /// How far, as measured; the model's page in docs/models says the same.
    pub amount: &'static str,
    /// One case in which the break shows, which a test repeats.
    pub witness: Witness,
}

/// A case in which a law is broken. Light arrives at azimuth 0.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Witness {
    /// Parameters in the order of [`ModelInfo::parameters`].
    pub parameters: &'static [f64],
    /// Polar angle of incidence, degrees.
    pub theta_i: f64,
    /// Polar angle of the receiver at azimuth 180 degrees, degrees; any value for [`Law::Energy`].
    pub theta_s: f64,
    /// [`Law::Energy`]: the reflectance plus transmittance; [`Law::Reciprocity`]: how far `f(wi, ws)` and `f(ws, wi)`
    /// lie apart, as a share of the larger. Exact to one unit of its last digit.
    pub measured: f64,
}

/// What a parameter does, so that a fit knows how to start and a test how to vary it.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Role {
    /// The model is proportional to it (or affine in it); one value a channel.
    Amplitude,
    /// Width of a lobe; positive, best varied in its logarithm.
    Width,
    /// An azimuth, radians.
    Angle,
    /// Refractive index, real or imaginary part.
    Index,
    /// A dimensionless exponent or shape number.
    Exponent,
}

/// One parameter of a model.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ParameterInfo {
    /// Name as in docs/nomenclature.md.
    pub name: &'static str,
    /// Unit; `1` when it has none.
    pub unit: &'static str,
    /// Smallest value allowed.
    pub low: f64,
    /// Largest value allowed.
    pub high: f64,
    /// A sensible value to begin with.
    pub default: f64,
    /// What it does.
    pub role: Role,
    /// Its meaning in a phrase.
    pub meaning: &'static str,
}

/// Which components a model scatters into.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Scatters {
    /// Same side only.
    Reflection,
    /// Opposite side only.
    Transmission,
    /// Both.
    Both,
}

impl Scatters {
    /// Whether light goes into `component`.
    pub const fn into(self, component: Component) -> bool {
        matches!(
            (self, component),
            (Scatters::Both, _)
                | (Scatters::Reflection, Component::Reflection)
                | (Scatters::Transmission, Component::Transmission)
        )
    }
}

/// A model described.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ModelInfo {
    /// Name in files and on the command line, such as `ward-gmd`.
    pub name: &'static str,
    /// Name in sentences.
    pub title: &'static str,
    /// Keys of docs/references.bib, with equation numbers.
    pub source: &'static str,
    /// Components it scatters into.
    pub scatters: Scatters,
    /// Its parameters in order.
    pub parameters: &'static [ParameterInfo],
    /// Laws it breaks by design.
    pub breaks: &'static [Exemption],
}

impl ModelInfo {
    /// Whether the model keeps `law`.
    pub fn keeps(&self, law: Law) -> bool {
        self.breaks.iter().all(|b| b.law != law)
    }

    /// Position of the parameter `name`.
    pub fn position(&self, name: &str) -> Option<usize> {
        self.parameters.iter().position(|p| p.name == name)
    }

    /// The default of every parameter.
    pub fn defaults(&self) -> Vec<f64> {
        self.parameters.iter().map(|p| p.default).collect()
    }
}

impl ParameterInfo {
    /// An amplitude in `[0, 1]`.
    pub(super) const fn amplitude(name: &'static str, default: f64, meaning: &'static str) -> Self {
        ParameterInfo {
            name,
            unit: "1",
            low: 0.0,
            high: 1.0,
            default,
            role: Role::Amplitude,
            meaning,
        }
    }

    /// A lobe width in `[0.001, 1]`.
    pub(super) const fn width(name: &'static str, meaning: &'static str) -> Self {
        ParameterInfo {
            name,
            unit: "1",
            low: 1e-3,
            high: 1.0,
            default: 0.1,
            role: Role::Width,
            meaning,
        }
    }

    /// The azimuth of a lobe's x axis in `[-pi, pi]`.
    pub(super) const fn axis() -> Self {
        ParameterInfo {
            name: "phi_x",
            unit: "rad",
            low: -std::f64::consts::PI,
            high: std::f64::consts::PI,
            default: 0.0,
            role: Role::Angle,
            meaning: "azimuth of the lobe's x axis",
        }
    }
}
