//! Readings of an integrating sphere as data: beside those of a goniometer, or alone.
//!
//! A sphere reads what a model scatters in all, into the cone of a port, or beside that cone. Beside a goniometer the fit to its
//! readings is the prior: parameters with their covariance, the beam power that all readings share included, and the difference to
//! the minima in other metrics as a further standard uncertainty. The sphere's readings are then added by the extended Kalman
//! update, iterated for the curvature [BellCathey1993]. Alone they are fitted by least squares.

use std::fmt;

use gonio_bsdf::Channel;
use gonio_bsdf::cone::cone_integral;
use gonio_bsdf::directional_albedo;
use gonio_geom::{Angles, Component};
use nalgebra::{DMatrix, DVector};

use crate::chart::Chart;
use crate::normal::Normal;
use crate::result::Warning;
use crate::solver::LeastSquares;
use crate::{FitError, FitModel};

/// What of the scattered light a reading holds.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum SpherePart {
    /// All of it.
    Total,
    /// What goes into the cone of this half angle (radians) about the mirrored or unbent direction.
    Port(f64),
    /// All but that.
    Rest(f64),
}

impl fmt::Display for SpherePart {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            SpherePart::Total => write!(f, "total"),
            SpherePart::Port(half) => write!(f, "light within {:.3} deg", half.to_degrees()),
            SpherePart::Rest(half) => write!(f, "light beyond {:.3} deg", half.to_degrees()),
        }
    }
}

/// One reading.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SphereReading {
    /// Channel.
    pub channel: Channel,
    /// Incidence.
    pub incidence: Angles,
    /// Reflected or transmitted light.
    pub component: Component,
    /// What it holds.
    pub part: SpherePart,
    /// Reflectance or transmittance.
    pub value: f64,
}

/// Readings with their covariance.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct SphereData {
    /// The readings.
    pub readings: Vec<SphereReading>,
    /// Covariance, row after row.
    pub covariance: Vec<f64>,
}

impl SphereData {
    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.readings.is_empty()
    }

    /// The covariance, and that it is one.
    fn matrix(&self) -> Result<DMatrix<f64>, FitError> {
        let n = self.readings.len();
        let domain = |found: String| FitError::Domain {
            field: "sphere",
            found,
            allowed: "finite readings with a covariance that has an inverse: every uncertainty above 0, no two readings \
                      wholly correlated",
        };
        if self.covariance.len() != n * n {
            return Err(domain(format!(
                "{} numbers of covariance for {n} readings",
                self.covariance.len()
            )));
        }
        let matrix = DMatrix::from_row_slice(n, n, &self.covariance);
        if self.readings.iter().any(|r| !r.value.is_finite()) || matrix.clone().cholesky().is_none() {
            return Err(domain("readings or uncertainties that say nothing".into()));
        }
        Ok(matrix)
    }
}

/// A reading beside what the model says.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SphereComparison {
    /// The reading.
    pub reading: SphereReading,
    /// Its standard uncertainty.
    pub u: f64,
    /// What the model says with the sphere's readings.
    pub predicted: f64,
    /// What it says without them, and the standard uncertainty of that; `None` where there was nothing but the sphere.
    pub before: Option<(f64, f64)>,
}

/// Differences between reading and the fit without it, in combined standard uncertainties, from which on a warning says so.
const DISAGREES: f64 = 3.0;
/// Steps of the derivatives.
const STEP: f64 = 1e-3;
/// Iterations of the update at most, and the step in standard deviations that ends it.
const ROUNDS: usize = 30;
const SETTLED: f64 = 1e-4;

/// Readings and a model over the channels of a fit.
pub(crate) struct Sphere<'a> {
    chart: &'a Chart<'a>,
    data: &'a SphereData,
    noise: DMatrix<f64>,
    /// Channel of each reading.
    at: Vec<usize>,
    low: &'a [f64],
    high: &'a [f64],
}

impl<'a> Sphere<'a> {
    /// # Errors
    /// [`FitError`] for a channel that is not fitted, a cone out of its range, light that the model does not scatter, and a
    /// covariance that is none.
    pub(crate) fn new(
        chart: &'a Chart<'a>,
        channels: &[Channel],
        data: &'a SphereData,
        bounds: (&'a [f64], &'a [f64]),
    ) -> Result<Self, FitError> {
        let mut at = Vec::new();
        for reading in &data.readings {
            let known = channels.iter().position(|c| *c == reading.channel);
            at.push(known.ok_or_else(|| {
                FitError::Channel {
                    found: format!("{} of a sphere's reading", reading.channel),
                    allowed: channels
                        .iter()
                        .map(ToString::to_string)
                        .collect::<Vec<_>>()
                        .join(", "),
                }
            })?);
            if let SpherePart::Port(half) | SpherePart::Rest(half) = reading.part
                && !(half > 0.0 && half < std::f64::consts::FRAC_PI_2)
            {
                return Err(FitError::Domain {
                    field: "sphere.half_angle",
                    found: format!("{:.4} deg", half.to_degrees()),
                    allowed: "above 0 and below 90 deg",
                });
            }
            if !chart.model.scatters_into(reading.component) {
                return Err(FitError::Model {
                    found: format!(
                        "{}, and readings of a sphere in {}",
                        chart.model.name, reading.component
                    ),
                    allowed: format!("models of {}", reading.component),
                });
            }
        }
        Ok(Sphere {
            chart,
            data,
            noise: data.matrix()?,
            at,
            low: bounds.0,
            high: bounds.1,
        })
    }

    fn values(&self) -> DVector<f64> {
        DVector::from_iterator(self.at.len(), self.data.readings.iter().map(|r| r.value))
    }

    /// What the model at `x` lets the sphere read.
    pub(crate) fn predicted(&self, x: &[f64]) -> Result<DVector<f64>, FitError> {
        let mut models = Vec::new();
        let mut out = DVector::zeros(self.at.len());
        for (k, (reading, &channel)) in self.data.readings.iter().zip(&self.at).enumerate() {
            let known = models.iter().position(|(c, _)| *c == channel);
            let known = match known {
                Some(known) => known,
                None => {
                    let q = self.chart.parameters(x, channel);
                    models.push((channel, self.chart.model.bsdf(&[(reading.channel, q)])?));
                    models.len() - 1
                }
            };
            let model = models[known].1.as_ref();
            let wi = reading.incidence.direction();
            let total = || directional_albedo(model, wi, reading.component, 0);
            let port = |half| cone_integral(model, wi, reading.component, 0, half);
            out[k] = match reading.part {
                SpherePart::Total => total(),
                SpherePart::Port(half) => port(half),
                SpherePart::Rest(half) => total() - port(half),
            };
        }
        Ok(out)
    }

    /// Derivatives by the variables of `free`; zero by others.
    fn derivatives(&self, x: &[f64], free: &[bool]) -> Result<DMatrix<f64>, FitError> {
        let mut out = DMatrix::zeros(self.at.len(), x.len());
        for k in (0..x.len()).filter(|k| free[*k]) {
            let step = STEP * x[k].abs().clamp(0.01, 1.0);
            let (mut up, mut down) = (x.to_vec(), x.to_vec());
            up[k] = (x[k] + step).min(self.high[k]);
            down[k] = (x[k] - step).max(self.low[k]);
            if up[k] > down[k] {
                let slope = (self.predicted(&up)? - self.predicted(&down)?) / (up[k] - down[k]);
                out.set_column(k, &slope);
            }
        }
        Ok(out)
    }

    /// Moves `x` of covariance `prior` to where the sphere's readings count as well; returns the gain of the last round.
    ///
    /// `x' = x_0 + K (y - g(x) + G (x - x_0))`, `K = C G^T (G C G^T + R)^-1`, until `x` settles.
    pub(crate) fn combine(
        &self,
        x: &mut [f64],
        prior: &DMatrix<f64>,
        free: &[bool],
    ) -> Result<Update, FitError> {
        let start = DVector::from_column_slice(x);
        let before = self.predicted(x)?;
        let mut update = self.gain(x, prior, free)?;
        let u_before = (&update.slopes * prior * update.slopes.transpose()).diagonal();
        for _ in 0..ROUNDS {
            let now = DVector::from_column_slice(x);
            let rest = self.values() - self.predicted(x)? + &update.slopes * (&now - &start);
            let next = &start + &update.gain * rest;
            let mut moved = 0.0_f64;
            for k in (0..x.len()).filter(|k| free[*k]) {
                let to = next[k].clamp(self.low[k], self.high[k]);
                let u = prior[(k, k)].max(0.0).sqrt();
                if u > 0.0 {
                    moved = moved.max((to - x[k]).abs() / u);
                }
                x[k] = to;
            }
            if moved < SETTLED {
                break;
            }
            update = self.gain(x, prior, free)?;
        }
        update.before = before
            .iter()
            .zip(&u_before)
            .map(|(v, u)| (*v, u.max(0.0).sqrt()))
            .collect();
        Ok(update)
    }

    fn gain(&self, x: &[f64], prior: &DMatrix<f64>, free: &[bool]) -> Result<Update, FitError> {
        let slopes = self.derivatives(x, free)?;
        let cross = prior * slopes.transpose();
        let inner = &slopes * &cross + &self.noise;
        let inverse = inner.cholesky().map(|c| c.inverse()).ok_or(FitError::Domain {
            field: "sphere",
            found: "readings that do not go with this fit".into(),
            allowed: "readings of the sample that was measured",
        })?;
        Ok(Update {
            gain: cross * inverse,
            slopes,
            before: Vec::new(),
        })
    }

    /// Every reading beside the model at `x`.
    pub(crate) fn compared(
        &self,
        x: &[f64],
        before: Option<&[(f64, f64)]>,
    ) -> Result<Vec<SphereComparison>, FitError> {
        let predicted = self.predicted(x)?;
        let row = |(k, reading): (usize, &SphereReading)| SphereComparison {
            reading: *reading,
            u: self.noise[(k, k)].sqrt(),
            predicted: predicted[k],
            before: before.map(|b| b[k]),
        };
        Ok(self.data.readings.iter().enumerate().map(row).collect())
    }

    /// Standard uncertainties over covariance of the least squares at `x`; variables without influence stay out.
    pub(crate) fn alone(&self, x: &[f64], free: &[bool]) -> Result<(DMatrix<f64>, Vec<bool>), FitError> {
        let mut normal = Normal::new(x.len());
        self.add(x, free, &mut normal)?;
        let free: Vec<bool> = (0..x.len())
            .map(|k| free[k] && normal.matrix[(k, k)] > 0.0)
            .collect();
        let inverse = normal.inverse(&free);
        Ok(match inverse {
            Some(inverse) => (inverse, free),
            None => (DMatrix::zeros(x.len(), x.len()), vec![false; x.len()]),
        })
    }

    fn add(&self, x: &[f64], free: &[bool], out: &mut Normal) -> Result<(), FitError> {
        let rest = self.predicted(x)? - self.values();
        let slopes = self.derivatives(x, free)?;
        // Whitened by the Cholesky factor of the covariance.
        if let Some(factor) = self.noise.clone().cholesky() {
            let lower = factor.l();
            if let (Some(rest), Some(slopes)) = (
                lower.solve_lower_triangular(&rest),
                lower.solve_lower_triangular(&slopes),
            ) {
                for (k, r) in rest.iter().enumerate() {
                    let row: Vec<f64> = slopes.row(k).iter().copied().collect();
                    out.add_residual(*r, &row);
                }
            }
        }
        Ok(())
    }
}

/// An update by readings.
pub(crate) struct Update {
    /// Change of the variables by a change of the readings.
    pub(crate) gain: DMatrix<f64>,
    /// Derivatives of the readings by the variables.
    pub(crate) slopes: DMatrix<f64>,
    /// Prediction before the update and its standard uncertainty.
    pub(crate) before: Vec<(f64, f64)>,
}

impl Update {
    /// The covariance afterwards.
    pub(crate) fn posterior(&self, prior: &DMatrix<f64>) -> DMatrix<f64> {
        let after = prior - &self.gain * &self.slopes * prior;
        0.5 * (&after + after.transpose())
    }

    /// A change of the variables before the update, as far as it is left afterwards.
    pub(crate) fn left(&self, change: &DVector<f64>) -> DVector<f64> {
        change - &self.gain * (&self.slopes * change)
    }
}

/// The least squares of the sphere's readings alone.
pub(crate) struct Alone<'a> {
    pub(crate) sphere: &'a Sphere<'a>,
    pub(crate) free: Vec<bool>,
}

impl LeastSquares for Alone<'_> {
    fn len(&self) -> usize {
        self.free.len()
    }

    fn normal(&self, x: &[f64], out: &mut Normal) {
        if self.sphere.add(x, &self.free, out).is_err() {
            out.cost = f64::NAN;
        }
    }
}

/// Warnings of readings that the fit without them does not agree with.
pub(crate) fn disagreements(model: &FitModel, compared: &[SphereComparison]) -> Vec<Warning> {
    compared
        .iter()
        .filter_map(|c| {
            let (before, u) = c.before?;
            let apart = (c.reading.value - before) / u.hypot(c.u);
            (apart.abs() > DISAGREES).then(|| Warning {
                code: "sphere_disagrees",
                text: format!(
                    "the sphere reads {:.4} ± {:.4} (k = 1) for the {} at theta_i = {:.1} deg, {} fitted to the other \
                     readings says {before:.4} ± {u:.4}: {:.1} combined standard uncertainties apart. Check the beam \
                     power, the sphere's standard and the cone of its port, or fit another model",
                    c.reading.value,
                    c.u,
                    c.reading.part,
                    c.reading.incidence.theta.to_degrees(),
                    model.name,
                    apart.abs()
                ),
            })
        })
        .collect()
}
