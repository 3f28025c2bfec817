//! What a fit found.

use gonio_bsdf::{Bsdf, Channel};
use gonio_geom::{Angles, Component};

use crate::metric::{Loss, Metric};
use crate::{Estimate, Exclusion, FitError, FitModel, LargestAlbedo, SphereComparison, Weights};

/// Something to know before the parameters are used.
#[derive(Clone, Debug, PartialEq)]
pub struct Warning {
    /// Name of the kind of warning, for programs.
    pub code: &'static str,
    /// What was found and what to do about it.
    pub text: String,
}

/// How well the model describes the readings of one slice and component.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SliceResidual {
    /// Position of the slice in the measurement.
    pub slice: usize,
    /// Direction of incidence.
    pub incidence: Angles,
    /// Channel.
    pub channel: Channel,
    /// Component.
    pub component: Component,
    /// Readings that took part.
    pub readings: usize,
    /// Median squared residual over its expectation for the stated noise: one where the noise explains everything.
    pub chi2: f64,
    /// `sum |prediction - dsf| omega / sum |dsf| omega`.
    pub relative_l1: f64,
    /// `sum (prediction - dsf) omega / sum |dsf| omega`.
    pub bias: f64,
    /// Highest prediction over the highest reading.
    pub peak_ratio: f64,
}

/// The minimum in another metric.
#[derive(Clone, Debug, PartialEq)]
pub struct OtherMetric {
    /// The metric.
    pub metric: Metric,
    /// Values in the order of [`Fit::estimates`].
    pub values: Vec<f64>,
}

/// A fitted model with everything that is known about it.
#[derive(Clone, Debug)]
pub struct Fit {
    /// The model.
    pub model: FitModel,
    /// The measure that was minimised.
    pub metric: Metric,
    /// Loss of the residuals of chi-square.
    pub loss: Loss,
    /// Where the weights of chi-square come from.
    pub weights: Weights,
    /// Channels, in the order of the parameters.
    pub channels: Vec<Channel>,
    /// The parameters; those of several channels follow one another.
    pub estimates: Vec<Estimate>,
    /// Covariance of the estimates, row after row.
    pub covariance: Vec<f64>,
    /// Correlation of the estimates, row after row; zero for those without uncertainty.
    pub correlation: Vec<f64>,
    /// Minima in other metrics.
    pub other_metrics: Vec<OtherMetric>,
    /// Readings that took part.
    pub readings: usize,
    /// Readings that did not, and why.
    pub excluded: Vec<Exclusion>,
    /// Blocks of readings that count as independent in model selection: cells of a slice with readings.
    pub blocks: usize,
    /// Cost at the minimum.
    pub cost: f64,
    /// Mean squared residual in units of the stated uncertainty, robust against outliers; `None` for metrics without
    /// unit.
    pub dispersion: Option<f64>,
    /// Factor by which correlated residuals raise the variances, at least one.
    pub design_effect: f64,
    /// Corrected information criterion of Akaike with as many observations as `blocks`; lower is better. Differences
    /// between models fitted to the same readings in the same metric count, nothing else.
    pub aicc: f64,
    /// Evaluations of the normal equations over all readings.
    pub evaluations: usize,
    /// Whether the search ended at a minimum.
    pub converged: bool,
    /// How well each slice is described.
    pub residuals: Vec<SliceResidual>,
    /// Predicted DSF, as the instrument sees it, of every reading of every slice of the measurement; NaN where a
    /// reading did not take part.
    pub predicted: Vec<Vec<f64>>,
    /// The largest directional albedo at the measured incidences; `None` where the model refuses its parameters.
    pub albedo: Option<LargestAlbedo>,
    /// Readings of an integrating sphere that took part, beside what the model says.
    pub sphere: Vec<SphereComparison>,
    /// What to know before the parameters are used.
    pub warnings: Vec<Warning>,
}

impl Fit {
    /// The parameters of each channel, in the order of the model's.
    pub fn parameters(&self) -> Vec<(Channel, Vec<f64>)> {
        let values: Vec<f64> = self.estimates.iter().map(|e| e.value).collect();
        self.parameters_with(&values)
    }

    /// The same with other values of the estimates, in their order.
    pub(crate) fn parameters_with(&self, values: &[f64]) -> Vec<(Channel, Vec<f64>)> {
        let of = |name: &str, channel: Channel| {
            let at = self
                .estimates
                .iter()
                .position(|e| e.name == name && e.channel.is_none_or(|c| c == channel))?;
            values.get(at).copied()
        };
        self.channels
            .iter()
            .map(|&channel| {
                let values = self
                    .model
                    .parameters
                    .iter()
                    .map(|p| of(&p.name, channel).unwrap_or(p.default))
                    .collect();
                (channel, values)
            })
            .collect()
    }

    /// The estimate of the parameter `name` in `channel`.
    pub fn estimate(&self, name: &str, channel: Channel) -> Option<&Estimate> {
        self.estimates
            .iter()
            .find(|e| e.name == name && e.channel.is_none_or(|c| c == channel))
    }

    /// The fitted scattering model.
    ///
    /// # Errors
    /// [`FitError::Bsdf`] when a part refuses its parameters.
    pub fn bsdf(&self) -> Result<Box<dyn Bsdf>, FitError> {
        self.model.bsdf(&self.parameters())
    }

    /// Whether there is a warning of this kind.
    pub fn warns(&self, code: &str) -> bool {
        self.warnings.iter().any(|w| w.code == code)
    }
}
