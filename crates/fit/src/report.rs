//! How well a model describes the readings.

use std::collections::BTreeMap;

use gonio_scan::Measurement;

use crate::data::FitData;
use crate::metric::Metric;
use crate::noise_law::median;
use crate::result::{Fit, SliceResidual};

/// Square of the median absolute value of a standard normal variable.
const MEDIAN_SQUARE: f64 = 0.454_936_423_119_572_8;

/// Mean squared residual, in units of the stated variance, below which values have no noise.
const NOISELESS: f64 = 1e-6;

/// Residuals of every slab; `predicted` has one list a block.
pub(crate) fn residuals(data: &FitData, predicted: &[Vec<f64>]) -> Vec<SliceResidual> {
    let mut by_slab: BTreeMap<usize, Vec<usize>> = BTreeMap::new();
    for (b, block) in data.blocks.iter().enumerate() {
        by_slab.entry(block.slab).or_default().push(b);
    }
    by_slab
        .into_iter()
        .map(|(s, blocks)| {
            let slab = &data.slabs[s];
            let (mut l1, mut bias, mut total) = (0.0, 0.0, 0.0);
            let (mut top, mut predicted_top) = (f64::NEG_INFINITY, f64::NEG_INFINITY);
            let mut squares = Vec::with_capacity(slab.y.len());
            for &b in &blocks {
                let block = &data.blocks[b];
                for (j, &p) in block.rows.clone().zip(&predicted[b]) {
                    let (y, w) = (slab.y[j], slab.omega[j]);
                    let r = p - y;
                    l1 += r.abs() * w;
                    bias += r * w;
                    total += y.abs() * w;
                    top = top.max(y);
                    predicted_top = predicted_top.max(p);
                    squares.push(r * r * slab.inverse_variance[j]);
                }
            }
            let scale = if total > 0.0 { 1.0 / total } else { f64::NAN };
            SliceResidual {
                slice: slab.slice,
                incidence: data.incidences[slab.incidence],
                channel: data.channels[slab.channel],
                component: slab.component,
                readings: slab.y.len(),
                chi2: median(squares.into_iter()) / MEDIAN_SQUARE,
                relative_l1: l1 * scale,
                bias: bias * scale,
                peak_ratio: predicted_top / top,
            }
        })
        .collect()
}

/// Predictions in the order of the measurement's slices and readings; NaN where a reading did not take part.
pub(crate) fn by_slice(measurement: &Measurement, data: &FitData, predicted: &[Vec<f64>]) -> Vec<Vec<f64>> {
    let mut out: Vec<Vec<f64>> = measurement
        .slices
        .iter()
        .map(|s| vec![f64::NAN; s.len()])
        .collect();
    for (block, values) in data.blocks.iter().zip(predicted) {
        let slab = &data.slabs[block.slab];
        for (&at, &value) in slab.position[block.rows.clone()].iter().zip(values) {
            out[slab.slice][at as usize] = value;
        }
    }
    out
}

/// Minus twice the logarithm of the likelihood a reading, up to a constant, at the minimum of `cost`:
/// `ln(2 cost / readings) + mean ln sigma^2`. The mean of the logarithms belongs to chi-square, whose standard deviations
/// follow the model: a prediction that is too high must not win by its large `sigma`.
pub(crate) fn level(metric: Metric, cost: f64, data: &FitData) -> f64 {
    let readings = data.len().max(1) as f64;
    let level = (2.0 * cost / readings).max(1e-300).ln();
    if metric != Metric::Chi2 {
        return level;
    }
    let weights = data.slabs.iter().flat_map(|s| &s.inverse_variance);
    level - weights.map(|v| v.ln()).sum::<f64>() / readings
}

/// Akaike's criterion, corrected for few observations \[HurvichTsai1989\], with as many observations as there are blocks:
/// `n level + 2 k + 2 k (k + 1) / (n - k - 1)` with [`level`].
pub(crate) fn aicc(fit: &Fit, data: &FitData) -> f64 {
    let n = fit.blocks as f64;
    let k = fit
        .estimates
        .iter()
        .filter(|e| matches!(e.kind, crate::Kind::Value | crate::Kind::UpperLimit))
        .count() as f64;
    if n <= k + 1.0 {
        return f64::INFINITY;
    }
    // Residuals a thousandth of the noise come from values without any; how far below it they end is chance.
    let least = match fit.metric {
        Metric::Chi2 => 0.5 * NOISELESS * data.len() as f64,
        _ => 0.0,
    };
    let level = level(fit.metric, fit.cost.max(least), data);
    n * level + 2.0 * k + 2.0 * k * (k + 1.0) / (n - k - 1.0)
}
