//! A table that is fitted and quantised: as few bytes as the target takes, or as good as the bytes allow.

use gonio_bsdf::BsdfError;
use gonio_bsdf::compact::{Coded, FRAME_BYTES, Frame, Quantised};

use super::CompactOptions;
use super::base::Base;
use super::largest;
use super::samples::{Samples, draw};
use super::solve::{Grid, error, light, logs, nodes, refine};
use super::source::{Pair, Source};

/// Samples per node.
const PER_NODE: usize = 30;
/// Samples at most; tables of so many nodes that there are fewer than [`PER_NODE`] each still have two.
const SAMPLES: usize = 1_500_000;
/// Steps of the logarithm that are tried: from the coarsest on, each finer than the one before, down to the finest; then
/// between the last one that fits and the first that does not.
const COARSEST: f64 = 0.1;
const FINER: f64 = 0.7;
const FINEST: f64 = 0.004;
const BISECTIONS: usize = 3;
/// Half a step is the slack of a node with this light, that of the mean node being 1, and of the peak of an incidence; nodes
/// with less, which are as far below the peak, have more.
const LIT: f64 = 0.5;
/// Most slack of a node, in logarithms.
const MOST_SLACK: f64 = 1.5;
/// Share of the error that a finer step must take away for another to be tried.
const WORTH: f64 = 0.01;

/// A quantised table.
pub(super) struct Tabulated {
    pub(super) table: Quantised,
    /// Relative L1 error of each channel.
    pub(super) errors: Vec<f64>,
    /// Largest error before it was quantised.
    pub(super) unquantised: f64,
    /// Bytes of the largest channel.
    pub(super) bytes: usize,
}

impl Tabulated {
    pub(super) fn error(&self) -> f64 {
        largest(&self.errors)
    }
}

/// The values of a table, and the slack of each node in half steps.
struct Values {
    values: Vec<f64>,
    slack: Vec<f64>,
}

/// The fitted and quantised table of `frame`, judged at `judges`.
pub(super) fn tabulated(
    source: &Source<'_>,
    base: &Base,
    frame: &Frame,
    judges: &Samples,
    options: &CompactOptions,
    most: usize,
) -> Result<Tabulated, BsdfError> {
    let grid = Grid::new(frame);
    let count = (PER_NODE * frame.len()).min(SAMPLES.max(2 * frame.len()));
    let fitted = fitted(source, base, frame, count);
    let judged = |values: &[f64]| -> Vec<f64> {
        values
            .chunks(frame.len())
            .zip(&judges.columns)
            .map(|(values, column)| error(&grid, judges, column, values))
            .collect()
    };
    let unquantised = largest(&judged(&fitted.values));
    let done = |table: Quantised| {
        let coded = table.coded(frame);
        Tabulated {
            errors: judged(&table.values(frame)),
            unquantised,
            bytes: FRAME_BYTES + coded.iter().map(Coded::len).max().unwrap_or(0),
            table,
        }
    };
    if let Some(bits) = options.bits {
        return Ok(done(Quantised::of(frame, &fitted.values, bits)?));
    }
    let quantised = |step: f64| -> Result<Tabulated, BsdfError> {
        let slack: Vec<f64> = fitted
            .slack
            .iter()
            .map(|s| (0.5 * step * s).min(MOST_SLACK))
            .collect();
        Ok(done(Quantised::near(frame, &fitted.values, step, &slack)?))
    };
    let mut best: Option<Tabulated> = None;
    let mut above = COARSEST;
    let mut step = COARSEST;
    while step > FINEST {
        let found = quantised(step)?;
        if found.bytes > most && best.is_some() {
            // between the last step that fitted and this one
            for _ in 0..BISECTIONS {
                let between = (above * step).sqrt();
                let found = quantised(between)?;
                if found.bytes > most {
                    step = between;
                } else {
                    above = between;
                    if best.as_ref().is_none_or(|b| found.error() < b.error()) {
                        best = Some(found);
                    }
                }
            }
            break;
        }
        let (error, known) = (
            found.error(),
            best.as_ref().map_or(f64::INFINITY, Tabulated::error),
        );
        if error < known {
            best = Some(found);
        }
        if error <= options.target || error > (1.0 - WORTH) * known {
            break;
        }
        (above, step) = (step, step * FINER);
    }
    best.ok_or_else(|| BsdfError::Domain {
        field: "model",
        found: "no table".into(),
        allowed: "a model that scatters".into(),
    })
}

fn fitted(source: &Source<'_>, base: &Base, frame: &Frame, count: usize) -> Values {
    let grid = Grid::new(frame);
    let pairs = nodes(frame);
    let mut values = logs(source, base, &pairs);
    let peaks = peak_shares(&source.many(&pairs), &pairs, frame, source.channels());
    let samples = draw(source, base, frame, 1, count);
    let mut slack = Vec::with_capacity(values.len());
    let channels = values.chunks_mut(frame.len()).zip(&samples.columns);
    for ((values, column), peaks) in channels.zip(&peaks) {
        refine(&grid, &samples, column, values);
        let light = light(&grid, &samples, column, frame.len());
        let counts = light.iter().zip(peaks).map(|(l, p)| (l / LIT).max(*p));
        slack.extend(counts.map(|c| 1.0 / c.clamp(1e-6, 1.0)));
    }
    Values { values, slack }
}

/// `f cos theta_s` at each node as a share of the largest at its incidence, one list a channel; `f` is `[node][channel]`.
fn peak_shares(f: &[f64], pairs: &[Pair], frame: &Frame, channels: usize) -> Vec<Vec<f64>> {
    let plane = frame.shape[2] * frame.shape[3];
    (0..channels)
        .map(|c| {
            let mut dsf: Vec<f64> = pairs
                .iter()
                .enumerate()
                .map(|(k, pair)| f[k * channels + c] * pair.1.cos_theta())
                .collect();
            for row in dsf.chunks_mut(plane) {
                let most = row.iter().copied().fold(f64::MIN_POSITIVE, f64::max);
                row.iter_mut().for_each(|v| *v /= most);
            }
            dsf
        })
        .collect()
}
