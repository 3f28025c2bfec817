//! What a fit may be told.

use std::sync::atomic::AtomicBool;

use crate::metric::{Loss, Metric};
use crate::{Selection, SphereData, Weights};

/// Options of [`crate::fit`].
#[derive(Clone, Debug)]
pub struct FitOptions<'a> {
    /// What is minimised.
    pub metric: Metric,
    /// Loss of the residuals of chi-square.
    pub loss: Loss,
    /// Where the weights of chi-square come from.
    pub weights: Weights,
    /// Whether chi-square weighs readings by their solid angle too, so that a densely scanned peak does not rule.
    pub by_solid_angle: bool,
    /// Which readings take part.
    pub selection: Selection,
    /// Whether the beam profile of the measurement is folded into the model.
    pub signature: bool,
    /// Parameters held at a value, by name, in all channels: what a sphere or a profilometer knows better.
    pub fixed: Vec<(String, f64)>,
    /// Further metrics whose minima are found, for the spread between them.
    pub compare: Vec<Metric>,
    /// Whether intervals are taken from the profile of the cost where the quadratic ones are wrong.
    pub profile: bool,
    /// Whether the result is examined for warnings, by quadrature among others.
    pub warnings: bool,
    /// Readings that the search for a starting point looks at.
    pub start_readings: usize,
    /// Parameters to begin with, one list a channel in the order of [`crate::FitModel::parameters`], in place of that
    /// search: where nearly the same readings were fitted before.
    pub start: Option<Vec<Vec<f64>>>,
    /// Readings of an integrating sphere, which count as data as well.
    pub sphere: SphereData,
    /// Set it from another thread to stop.
    pub cancel: Option<&'a AtomicBool>,
}

impl Default for FitOptions<'_> {
    fn default() -> Self {
        FitOptions {
            metric: Metric::Chi2,
            loss: Loss::SoftL1,
            weights: Weights::Predicted,
            by_solid_angle: false,
            selection: Selection::default(),
            signature: true,
            fixed: Vec::new(),
            compare: vec![Metric::CubeRoot],
            profile: true,
            warnings: true,
            start_readings: 4000,
            start: None,
            sphere: SphereData::default(),
            cancel: None,
        }
    }
}
