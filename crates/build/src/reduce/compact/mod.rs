//! Reduction to the compact model: lobes of the registry times a quantised table of ratios.

mod base;
mod ideal;
mod plan;
mod samples;
mod solve;
mod source;
mod table;
#[cfg(test)]
mod tests;
#[cfg(test)]
mod tests_lobes;

use gonio_bsdf::compact::{CompactPart, Frame, Symmetry};
use gonio_bsdf::{Bsdf, BsdfError, Compact, FourComponents};
use gonio_geom::{Component, Side};

use super::{OneChannel, largest_albedo};
use base::Base;
use plan::{Wanted, plan};
use samples::{Samples, draw};
use source::{Pair, Source, View};
use table::{Tabulated, tabulated};

/// Bytes of a table for one channel of a component where none are given: isotropic, others.
const MOST_BYTES: [usize; 2] = [16_000, 400_000];
/// Share of the target that the loss of unequal mirror images may take.
const SYMMETRY_SHARE: f64 = 0.2;
/// Share of an error above the target that the loss of unequal mirror images may take, where a table of a higher symmetry is
/// tried for the bytes that it saves.
const SYMMETRY_GAIN: f64 = 0.4;
/// Bits of a node that the first plan reckons with.
const FIRST_BITS: f64 = 3.0;
/// Ratio of the errors with and without quantisation between which bytes are spent well: below it more nodes in coarser steps
/// are tried, above it fewer.
const BALANCE: [f64; 2] = [1.15, 1.35];
/// Samples that tell the error.
const JUDGES: usize = 60_000;
/// Rounds of planning at most.
const ROUNDS: usize = 4;

/// How to reduce a model to the compact one.
#[derive(Clone, Debug, PartialEq)]
pub struct CompactOptions {
    /// Numbers of the model's channels; `None` takes all.
    pub channels: Option<Vec<usize>>,
    /// Components to keep; `None` keeps every component that scatters.
    pub components: Option<Vec<(Side, Component)>>,
    /// Relative L1 error, mean over incidences, at which a table is fine enough; `[1e-4, 1]`.
    pub target: f64,
    /// Most bytes of the table of a channel and component as stored; `None` is 16 000 for isotropic models and 400 000 for
    /// others.
    pub max_bytes: Option<usize>,
    /// Bits of a value, 8 or 16, the range of every incidence divided evenly; `None` takes the step that gives the least error
    /// within the bytes.
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
    /// Relative L1 error of each channel, mean over incidences, at points that the table was not fitted to. Incidences beyond
    /// 75 degrees count less, as `cos(theta_i) / cos(75 deg)`.
    pub error: FourComponents<Vec<f64>>,
    /// Largest difference of the share of light that does not spread from that of the model, any channel.
    pub ideal_error: FourComponents<f64>,
    /// [`largest_albedo`] of it.
    pub max_albedo: f64,
}

/// Reduces `model`: fits lobes to it, chooses coordinates and nodes by the interpolation errors that they leave, fits the
/// nodes to the model between them, and quantises them. Light that is mirrored or passes straight through ([`Bsdf::delta`]) is
/// kept apart, as shares over the incidence.
///
/// # Errors
/// [`BsdfError::Domain`] for a channel the model does not have, no component that scatters, an ideal part that bends light,
/// or a target, number of bytes or bits out of range.
pub fn to_compact(model: &dyn Bsdf, options: &CompactOptions) -> Result<CompactReduction, BsdfError> {
    let channels = options
        .channels
        .clone()
        .unwrap_or_else(|| (0..model.channels().len()).collect());
    check(options)?;
    for &channel in &channels {
        OneChannel::with_ideal(model, channel)?;
    }
    let view = View::new(model, channels);
    let (mut parts, mut errors) = (FourComponents::default(), FourComponents::default());
    let (mut ideals, mut ideal_error) = (FourComponents::default(), FourComponents::default());
    let mut found = 0;
    for (side, component) in FourComponents::<()>::KEYS {
        let asked = options
            .components
            .as_ref()
            .map(|list| list.contains(&(side, component)));
        if asked == Some(false) {
            continue;
        }
        let ideal = ideal::ideal(&view, side, component, options.target)?;
        let scatters = (0..view.channels().len()).any(|index| {
            let one = OneChannel { model: &view, index };
            one.scatters(side, component)
        });
        found += usize::from(scatters || ideal.is_some());
        if scatters {
            let (part, error) = reduce(&Source::new(&view, side, component), options)?;
            parts.set(side, component, Some(part));
            errors.set(side, component, Some(error));
        }
        if let Some((part, error)) = ideal {
            ideals.set(side, component, Some(part));
            ideal_error.set(side, component, Some(error));
        }
    }
    if found == 0 {
        return Err(BsdfError::Domain {
            field: "components",
            found: "none that scatters".into(),
            allowed: "at least one".into(),
        });
    }
    let of = |conserves: bool| {
        Compact::with_ideal(view.channels().to_vec(), parts.clone(), ideals.clone(), conserves)
    };
    let max_albedo = largest_albedo(&of(false)?).value;
    Ok(CompactReduction {
        model: of(max_albedo <= 1.0 + 1e-3)?,
        error: errors,
        ideal_error,
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
    let axes = axes(base.phi_x);
    let (symmetry, phi_x) = source.find_symmetry(&axes, SYMMETRY_SHARE * options.target);
    let (part, errors) = within(source, &mut base, symmetry, phi_x, options)?;
    let found = largest(&errors);
    if found > options.target {
        // A symmetry that costs less than the bytes that it saves.
        let (higher, phi_x) = source.find_symmetry(&axes, SYMMETRY_GAIN * found);
        if higher != symmetry {
            let other = within(source, &mut base, higher, phi_x, options)?;
            if largest(&other.1) < found {
                return Ok(other);
            }
        }
    }
    Ok((part, errors))
}

/// The best table of a symmetry within the bytes.
fn within(
    source: &Source<'_>,
    base: &mut Base,
    symmetry: Symmetry,
    phi_x: f64,
    options: &CompactOptions,
) -> Result<(CompactPart, Vec<f64>), BsdfError> {
    let even = source.averaged(symmetry, phi_x);
    let most = options
        .max_bytes
        .unwrap_or(MOST_BYTES[usize::from(!symmetry.is_isotropic())]);
    let mut bytes_per_node = options.bits.map_or(FIRST_BITS, f64::from) / 8.0;
    let mut target = options.target;
    let mut best: Option<(Frame, Tabulated)> = None;
    let mut tried = Vec::new();
    for _ in 0..ROUNDS {
        let wanted = Wanted {
            target,
            nodes: (most as f64 / bytes_per_node) as usize,
        };
        let frame = plan(&even, base, symmetry, phi_x, wanted);
        if tried.contains(&frame) {
            break;
        }
        tried.push(frame);
        let judges = draw(source, base, &frame, 1 << 24, JUDGES);
        weigh(base, source, &judges);
        let found = tabulated(&even, base, &frame, &judges, options, most)?;
        let (error, bytes) = (found.error(), found.bytes);
        let quantised = error / found.unquantised.max(1e-9);
        let fits = bytes <= most;
        let better = best.as_ref().is_none_or(|(_, known)| {
            let known_fits = known.bytes <= most;
            if fits != known_fits {
                fits
            } else if fits {
                error < known.error()
            } else {
                bytes < known.bytes
            }
        });
        if better {
            best = Some((frame, found));
        }
        if !fits {
            bytes_per_node *= 1.1 * bytes as f64 / most as f64;
        } else if error <= options.target {
            break;
        } else if frame.len() as f64 * bytes_per_node * 5.0 < most as f64 * 4.0 {
            // the plan took its errors for smaller than they are
            target *= (0.8 * options.target / error).min(0.8);
        } else if options.bits.is_some() {
            break;
        } else if quantised > BALANCE[1] {
            bytes_per_node *= 1.25;
        } else if quantised < BALANCE[0] {
            bytes_per_node *= 0.75;
        } else {
            break;
        }
    }
    let (frame, found) = best
        .filter(|b| b.1.bytes <= most)
        .ok_or_else(|| BsdfError::Domain {
            field: "max_bytes",
            found: most.to_string(),
            allowed: "enough for a table of the model".into(),
        })?;
    let part = CompactPart {
        base: base.lobes.clone(),
        frame,
        table: found.table,
    };
    Ok((part, found.errors))
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
