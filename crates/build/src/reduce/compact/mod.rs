//! Reduction to the compact model: lobes of the registry times a quantised table of ratios.

mod base;
mod plan;
mod samples;
mod solve;
mod source;
#[cfg(test)]
mod tests;

use gonio_bsdf::compact::{CompactPart, Frame, Quantised};
use gonio_bsdf::{Bsdf, BsdfError, Compact, FourComponents};
use gonio_geom::{Component, Side};

use super::{OneChannel, largest_albedo};
use base::Base;
use plan::{Wanted, plan};
use samples::{Samples, draw};
use solve::{Grid, at_nodes, error, refine};
use source::{Pair, Source, View};

/// Bytes of a table for one channel of a component where none are given: isotropic, others.
const MOST_BYTES: [usize; 2] = [14_000, 380_000];
/// Share of the target that the loss of unequal mirror images may take.
const SYMMETRY_SHARE: f64 = 0.2;
/// Samples per node.
const PER_NODE: usize = 5;
/// Samples that tell the error.
const JUDGES: usize = 60_000;
/// Rounds of planning at most.
const ROUNDS: usize = 3;

/// How to reduce a model to the compact one.
#[derive(Clone, Debug, PartialEq)]
pub struct CompactOptions {
    /// Numbers of the model's channels; `None` takes all.
    pub channels: Option<Vec<usize>>,
    /// Components to keep; `None` keeps every component that scatters.
    pub components: Option<Vec<(Side, Component)>>,
    /// Relative L1 error, mean over incidences, at which a table is fine enough; `[1e-4, 1]`.
    pub target: f64,
    /// Most bytes of the table of a channel and component; `None` is 14 000 for isotropic models and 380 000 for others.
    pub max_bytes: Option<usize>,
    /// Bits of a value, 8 or 16; `None` takes 16 where 8 miss the target and the bytes suffice.
    pub bits: Option<u32>,
}

impl Default for CompactOptions {
    /// All channels and components, 0.5 %.
    fn default() -> Self {
        CompactOptions {
            channels: None,
            components: None,
            target: 0.005,
            max_bytes: None,
            bits: None,
        }
    }
}

/// A compact model with what the reduction found.
pub struct CompactReduction {
    /// The model.
    pub model: Compact,
    /// Relative L1 error of each channel, mean over incidences up to 89 degrees, at points that the table was not fitted to.
    pub error: FourComponents<Vec<f64>>,
    /// [`largest_albedo`] of it.
    pub max_albedo: f64,
}

/// Reduces `model`: fits lobes to it, chooses coordinates and nodes by the interpolation errors that they leave, fits the
/// nodes to the model between them, and quantises them.
///
/// # Errors
/// [`BsdfError::Domain`] for a channel the model does not have, no component that scatters, an ideal part
/// ([`Bsdf::delta`]), or a target, number of bytes or bits out of range.
pub fn to_compact(model: &dyn Bsdf, options: &CompactOptions) -> Result<CompactReduction, BsdfError> {
    let channels = options
        .channels
        .clone()
        .unwrap_or_else(|| (0..model.channels().len()).collect());
    check(options)?;
    let mut components = None;
    for &channel in &channels {
        let one = OneChannel::new(model, channel)?;
        if components.is_none() {
            components = Some(one.components(options.components.as_deref())?);
        }
    }
    let view = View::new(model, channels);
    let mut parts = FourComponents::default();
    let mut errors = FourComponents::default();
    for (side, component) in components.unwrap_or_default() {
        let (part, error) = reduce(&Source::new(&view, side, component), options)?;
        parts.set(side, component, Some(part));
        errors.set(side, component, Some(error));
    }
    let made = Compact::new(view.channels().to_vec(), parts.clone(), false)?;
    let max_albedo = largest_albedo(&made).value;
    Ok(CompactReduction {
        model: Compact::new(view.channels().to_vec(), parts, max_albedo <= 1.0 + 1e-3)?,
        error: errors,
        max_albedo,
    })
}

fn check(options: &CompactOptions) -> Result<(), BsdfError> {
    let domain = |field, found: String, allowed: &str| {
        Err(BsdfError::Domain {
            field,
            found,
            allowed: allowed.into(),
        })
    };
    if options.channels.as_ref().is_some_and(Vec::is_empty) {
        return domain("channels", "none".into(), "at least one");
    }
    if !(1e-4..=1.0).contains(&options.target) {
        return domain("target", options.target.to_string(), "0.0001 to 1");
    }
    if let Some(bytes) = options.max_bytes.filter(|b| !(500..=1 << 28).contains(b)) {
        return domain("max_bytes", bytes.to_string(), "500 to 268435456");
    }
    match options.bits {
        None | Some(8 | 16) => Ok(()),
        Some(other) => domain("bits", other.to_string(), "8 or 16"),
    }
}

/// One component and the error of each channel.
fn reduce(source: &Source<'_>, options: &CompactOptions) -> Result<(CompactPart, Vec<f64>), BsdfError> {
    let mut base = Base::fitted(source)?;
    let (symmetry, phi_x) = source.find_symmetry(&axes(base.phi_x), SYMMETRY_SHARE * options.target);
    let source = source.averaged(symmetry, phi_x);
    let isotropic = symmetry.is_isotropic();
    let most = options.max_bytes.unwrap_or(MOST_BYTES[usize::from(!isotropic)]);
    let bytes = options.bits.unwrap_or(8) as usize / 8;
    let mut target = options.target;
    let mut best: Option<(CompactPart, Vec<f64>)> = None;
    for _ in 0..ROUNDS {
        // 8 bytes of offset and step an incidence, of which there are at most 40
        let wanted = Wanted {
            target,
            nodes: most.saturating_sub(320).max(100) / bytes,
        };
        let frame = plan(&source, &base, symmetry, phi_x, wanted);
        let judges = draw(&source, &base, &frame, 1 << 24, JUDGES);
        weigh(&mut base, &source, &judges);
        let (table, errors) = tabulated(&source, &base, &frame, &judges, options, most)?;
        let part = CompactPart {
            base: base.lobes.clone(),
            frame,
            table,
        };
        let found = largest(&errors);
        if best.as_ref().is_none_or(|(_, known)| found < largest(known)) {
            best = Some((part, errors));
        }
        if found <= options.target || frame.len() * bytes * 5 > most * 4 {
            break;
        }
        target *= (0.8 * options.target / found).min(0.8);
    }
    best.ok_or_else(|| BsdfError::Domain {
        field: "model",
        found: "no table".into(),
        allowed: "a model that scatters".into(),
    })
}

/// Azimuths that may be mirror planes: that of the lobe and those of the sample.
fn axes(phi_x: f64) -> Vec<f64> {
    if phi_x == 0.0 { vec![0.0] } else { vec![phi_x, 0.0] }
}

fn largest(errors: &[f64]) -> f64 {
    errors.iter().copied().fold(0.0, f64::max)
}

/// Draws lobes by the light they stand for.
fn weigh(base: &mut Base, source: &Source<'_>, samples: &Samples) {
    let some: Vec<(Pair, f64)> = samples
        .pairs
        .iter()
        .copied()
        .zip(samples.light.iter().copied())
        .step_by(10)
        .collect();
    base.weigh(source, &some, samples.albedo);
}

/// The fitted and quantised table, and the error of each channel.
fn tabulated(
    source: &Source<'_>,
    base: &Base,
    frame: &Frame,
    judges: &Samples,
    options: &CompactOptions,
    most: usize,
) -> Result<(Quantised, Vec<f64>), BsdfError> {
    let grid = Grid::new(frame);
    let mut values = at_nodes(source, base, frame);
    let samples = draw(source, base, frame, 1, PER_NODE * frame.len());
    for (values, column) in values.chunks_mut(frame.len()).zip(&samples.columns) {
        refine(&grid, &samples, column, values);
    }
    let quantised = |bits: u32| -> Result<(Quantised, Vec<f64>), BsdfError> {
        let table = Quantised::of(frame, &values, bits)?;
        let restored = table.values(frame);
        let errors = restored
            .chunks(frame.len())
            .zip(&judges.columns)
            .map(|(values, column)| error(&grid, judges, column, values))
            .collect();
        Ok((table, errors))
    };
    let (table, errors) = quantised(options.bits.unwrap_or(8))?;
    if options.bits.is_none() && largest(&errors) > options.target && 2 * frame.len() + 320 <= most {
        let finer = quantised(16)?;
        if largest(&finer.1) < 0.85 * largest(&errors) {
            return Ok(finer);
        }
    }
    Ok((table, errors))
}
