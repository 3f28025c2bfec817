//! Hemispherical integrals of scattered readings with their quadrature uncertainty.

mod peaks;
mod profile;
mod stencil;

use glam::DVec3;

use crate::delaunay::Delaunay;
use crate::weights::{Cell, Diagram, WeightsError, for_each_group, unified};
use crate::{Direction, Side};
use profile::Profile;
use stencil::Stencil;

/// An integral cannot be computed.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum IntegralError {
    /// Directions without weights.
    #[error(transparent)]
    Weights(#[from] WeightsError),
    /// Arrays of different length.
    #[error("{field}: found {found} values, allowed {expected}, one a direction")]
    Length {
        /// Name of the array.
        field: &'static str,
        /// Its length.
        found: usize,
        /// Number of directions.
        expected: usize,
    },
    /// No reading that may be used.
    #[error("no usable reading above the grazing limit among {found} directions")]
    NothingUsable {
        /// Number of directions.
        found: usize,
    },
    /// A usable reading or its uncertainty that is not a finite number.
    #[error("{field}[{index}]: found {value}, allowed a finite number")]
    NotFinite {
        /// Name of the array.
        field: &'static str,
        /// Index of the reading.
        index: usize,
        /// What was found.
        value: f64,
    },
}

/// Choices of [`hemisphere_integral`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct IntegralOptions {
    /// The direction of incidence, on either side. With it, gaps are filled along the lobe's own profile; without it,
    /// with the level of the readings at their rim (and a larger uncertainty).
    pub wi: Option<Direction>,
    /// How far from a reading (radians) its cell counts as measured. `None`: twice the reach of the typical (by solid
    /// angle) cell, between 1° and 8°.
    pub reach: Option<f64>,
    /// Readings with a polar angle to the side's normal above this (radians) are not used: `dsf / cos θ` says nothing
    /// there.
    pub grazing: f64,
}

impl Default for IntegralOptions {
    fn default() -> Self {
        IntegralOptions {
            wi: None,
            reach: None,
            grazing: 89.5f64.to_radians(),
        }
    }
}

/// An integral `∫ dsf dω` over one hemisphere and what is known of its error. Uncertainties are standard
/// uncertainties in the unit of `value`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct HemisphereIntegral {
    /// The integral, extrapolated part included: directional-hemispherical reflectance or transmittance.
    pub value: f64,
    /// The part from directions farther from every reading than the reach.
    pub extrapolated: f64,
    /// From the noise of the readings (`sigma`, independent from reading to reading).
    pub u_noise: f64,
    /// From having readings at these directions only: quadrature and extrapolation.
    pub u_quadrature: f64,
    /// The share of `u_quadrature` that comes from the extrapolated part.
    pub u_extrapolated: f64,
    /// The share of `u_quadrature` that comes from peaks narrower than the readings about them can tell.
    pub u_peaks: f64,
    /// Solid angle within reach of a reading, sr (of 2π).
    pub measured_omega: f64,
    /// The reach that was used, radians.
    pub reach: f64,
    /// The same integral by the rules of order 0 (`Σ Ω⊥ f`), 1 (with gradient) and 2 (the one in `value`).
    pub by_order: [f64; 3],
}

/// `∫ dsf dω` over the hemisphere `side` from readings at scattered `points`.
///
/// - `points`: unit vectors on `side`; `dsf`: 1/sr, one a point; `sigma`: standard uncertainty of each `dsf` from noise
///   (`None`: `u_noise` is 0); `usable`: readings to use (`None`: all). Values of unusable readings are not looked at.
/// - The rule is exact for a Lambertian; for others it integrates, over each Voronoi cell, `|cos θ|` times a quadratic
///   through the reading fitted to its Delaunay neighbours. Readings of equal direction (within 2e-6 rad) are averaged.
/// - Parts of cells beyond [`IntegralOptions::reach`] are filled by the profile of the lobe (see
///   [`IntegralOptions::wi`]) and reported as `extrapolated`.
/// - `u_quadrature` is built from the differences between the rules of order 0, 1 and 2, between ways to extrapolate,
///   and from how few readings stand on the peaks; docs/validation/weights.md tests that it covers.
///
/// # Errors
/// [`IntegralError`] for arrays of unequal length, nothing usable, a usable value that is not finite, or directions
/// that [`crate::weights::hemisphere_cells`] refuses.
pub fn hemisphere_integral(
    points: &[DVec3],
    dsf: &[f64],
    sigma: Option<&[f64]>,
    usable: Option<&[bool]>,
    side: Side,
    options: &IntegralOptions,
) -> Result<HemisphereIntegral, IntegralError> {
    let n = points.len();
    check_length("dsf", Some(dsf.len()), n)?;
    check_length("sigma", sigma.map(<[f64]>::len), n)?;
    check_length("usable", usable.map(<[bool]>::len), n)?;
    let lowest = options.grazing.cos();
    let used = |i: usize| usable.is_none_or(|u| u[i]) && points[i].z * side.sign() > lowest;
    for i in (0..n).filter(|&i| used(i)) {
        check_finite("dsf", i, dsf[i])?;
        if let Some(sigma) = sigma {
            check_finite("sigma", i, sigma[i])?;
        }
    }
    let kept: Option<Vec<u32>> =
        (!(0..n).all(used)).then(|| (0..n as u32).filter(|&i| used(i as usize)).collect());
    let kept_points: Vec<DVec3>;
    let points = match &kept {
        None => points,
        Some(kept) => {
            kept_points = kept.iter().map(|&i| points[i as usize]).collect();
            &kept_points
        }
    };
    if points.is_empty() {
        return Err(IntegralError::NothingUsable { found: n });
    }
    let points = &*unified(points);
    let original = |i: usize| kept.as_ref().map_or(i, |k| k[i] as usize);
    let delaunay = Delaunay::new(points, side).map_err(WeightsError::from)?;
    let diagram = Diagram::new(points, &delaunay);
    let mut f: Vec<f64> = (0..points.len())
        .map(|i| dsf[original(i)] / points[i].z.abs())
        .collect();
    let variance = sigma.map(|sigma| {
        let mut variance: Vec<f64> = (0..points.len())
            .map(|i| (sigma[original(i)] / points[i].z).powi(2))
            .collect();
        average_copies(&mut variance, diagram.copies(), 2);
        variance
    });
    average_copies(&mut f, diagram.copies(), 1);

    let reach = options
        .reach
        .unwrap_or_else(|| typical_reach(&diagram, points.len()));
    let sums = near_sums(&diagram, &f, reach);
    let wi = options.wi.map(|wi| {
        let v = wi.vec();
        DVec3::new(v.x, v.y, v.z.abs())
    });
    let far = far_sums(&diagram, &f, &sums, wi);
    let by_order = sums.by_order.map(|s| s + far.value);
    let u_rule = rule_uncertainty(by_order);
    let u_peaks = peaks::unresolved(&diagram, &f, variance.as_deref(), &sums.weights, by_order[2]);
    Ok(HemisphereIntegral {
        value: by_order[2],
        extrapolated: far.value,
        u_noise: variance.map_or(0.0, |v| {
            let sum: f64 = sums.weights.iter().zip(&v).map(|(w, v)| w * w * v).sum();
            sum.sqrt()
        }),
        u_quadrature: u_rule.hypot(far.u).hypot(u_peaks),
        u_extrapolated: far.u,
        u_peaks,
        measured_omega: sums.omega,
        reach,
        by_order,
    })
}

/// Standard uncertainty of the rule of order 2 from the steps between the orders.
fn rule_uncertainty(by_order: [f64; 3]) -> f64 {
    let first = (by_order[1] - by_order[0]).abs();
    let second = (by_order[2] - by_order[1]).abs();
    (second * SECOND_STEP).hypot(first * FIRST_STEP)
}

/// Shares of the steps between the rules of order 1 and 2, and 0 and 1, in the uncertainty of order 2. Chosen on the
/// benchmark of docs/validation/weights.md so that twice the uncertainty covers at least 95 % of its cases.
const SECOND_STEP: f64 = 0.75;
const FIRST_STEP: f64 = 0.15;

fn check_length(field: &'static str, found: Option<usize>, expected: usize) -> Result<(), IntegralError> {
    match found {
        Some(found) if found != expected => Err(IntegralError::Length {
            field,
            found,
            expected,
        }),
        _ => Ok(()),
    }
}

fn check_finite(field: &'static str, index: usize, value: f64) -> Result<(), IntegralError> {
    if value.is_finite() {
        Ok(())
    } else {
        Err(IntegralError::NotFinite { field, index, value })
    }
}

/// Gives every point with copies the sum over the group divided by `count^power`.
fn average_copies(values: &mut [f64], copies: &[(u32, u32)], power: i32) {
    for_each_group(copies, |point, group| {
        let sum: f64 = group.iter().map(|&(_, c)| values[c as usize]).sum();
        values[point] = (values[point] + sum) / ((group.len() + 1) as f64).powi(power);
    });
}

/// Twice the median reach of the cells, weighted by solid angle; from about 20,000 of them.
fn typical_reach(diagram: &Diagram<'_>, n: usize) -> f64 {
    let stride = n.div_ceil(20_000);
    let mut cell = Cell::default();
    let mut reaches = Vec::with_capacity(n / stride + 1);
    for i in (0..n).step_by(stride) {
        if diagram.cell(i, &mut cell) {
            reaches.push((cell.reach(diagram.point(i)), cell.omega()));
        }
    }
    reaches.sort_by(|a, b| a.0.total_cmp(&b.0));
    let half = 0.5 * reaches.iter().map(|r| r.1).sum::<f64>();
    let mut sum = 0.0;
    let median = reaches.iter().find(|r| {
        sum += r.1;
        sum >= half
    });
    (2.0 * median.map_or(0.0, |r| r.0)).clamp(1f64.to_radians(), 8f64.to_radians())
}

/// Sums over the measured parts of the cells.
struct NearSums {
    by_order: [f64; 3],
    omega: f64,
    /// `∂ value / ∂ f`, far nodes counted with their reading.
    weights: Vec<f64>,
    /// Nodes beyond reach: reading, direction (front frame), projected solid angle; grouped by reading.
    far: Vec<(u32, DVec3, f64)>,
}

fn near_sums(diagram: &Diagram<'_>, f: &[f64], reach: f64) -> NearSums {
    let mut sums = NearSums {
        by_order: [0.0; 3],
        omega: 0.0,
        weights: vec![0.0; f.len()],
        far: Vec::new(),
    };
    let mut cell = Cell::default();
    let mut stencil = Stencil::default();
    for (i, &value) in f.iter().enumerate() {
        if !diagram.cell(i, &mut cell) {
            continue;
        }
        // Nothing was measured between this reading and the horizon: a cell of ordinary size would end after half the
        // reach, and second derivatives from one side only would be carried outwards.
        let outermost = cell.at_horizon();
        let limit = if outermost { 0.5 * reach } else { reach };
        stencil.build(diagram, i, &cell, limit, outermost);
        sums.omega += stencil.measured_omega;
        let (mut linear, mut quadratic, mut own) = (0.0, 0.0, stencil.measured);
        for (k, &j) in cell.neighbours.iter().enumerate() {
            let step = f[j as usize] - value;
            linear += stencil.linear[k] * step;
            quadratic += stencil.quadratic[k] * step;
            own -= stencil.quadratic[k];
            sums.weights[j as usize] += stencil.quadratic[k];
        }
        for &(node, w) in &stencil.far {
            own += w;
            sums.far.push((i as u32, node, w));
        }
        sums.weights[i] += own;
        let plain = value * stencil.measured;
        for (s, c) in sums.by_order.iter_mut().zip([0.0, linear, quadratic]) {
            *s += plain + c;
        }
    }
    sums
}

/// The extrapolated part and its uncertainty.
struct FarSums {
    value: f64,
    u: f64,
}

/// Bounds of the ratio between readings at the rim of a gap and the profile there.
const RATIO: std::ops::RangeInclusive<f64> = 0.25..=4.0;

fn far_sums(diagram: &Diagram<'_>, f: &[f64], near: &NearSums, wi: Option<DVec3>) -> FarSums {
    let profile = wi.map(|wi| {
        let readings = (0..f.len()).map(|i| (diagram.point(i), f[i], near.weights[i].max(0.0)));
        Profile::new(wi, readings)
    });
    let mut cell = Cell::default();
    // by profile with normaliser, by profile without, by the level of the rim
    let mut sums = [0.0; 3];
    for group in near.far.chunk_by(|a, b| a.0 == b.0) {
        let i = group[0].0 as usize;
        diagram.cell(i, &mut cell);
        let rim = || std::iter::once(i).chain(cell.neighbours.iter().map(|&j| j as usize));
        let count = (cell.neighbours.len() + 1) as f64;
        let level = rim().map(|j| f[j]).sum::<f64>() / count;
        let Some(profile) = &profile else {
            let w: f64 = group.iter().map(|g| g.2).sum();
            for s in &mut sums {
                *s += w * level;
            }
            continue;
        };
        let (mut normalised, mut plain) = (0.0, 0.0);
        for j in rim() {
            let shape = profile.at(diagram.point(j));
            normalised += shape.normalised / count;
            plain += shape.plain / count;
        }
        let ratio = |model: f64| {
            if model > 0.0 {
                (level / model).clamp(*RATIO.start(), *RATIO.end())
            } else {
                1.0
            }
        };
        let (by_normalised, by_plain) = (ratio(normalised), ratio(plain));
        for &(_, node, w) in group {
            let shape = profile.at(node);
            sums[0] += w * shape.normalised * by_normalised;
            sums[1] += w * shape.plain * by_plain;
            sums[2] += w * level;
        }
    }
    let shape = SHAPE_STEP * (sums[0] - sums[1]);
    let constant = LEVEL_STEP * (sums[0] - sums[2]);
    let least = if profile.is_some() { LEAST } else { LEAST_BLIND };
    FarSums {
        value: sums[0],
        u: shape.hypot(constant).hypot(least * sums[0]),
    }
}

/// Shares of the differences between ways to extrapolate, and of the extrapolated part itself (with and without a known
/// direction of incidence), in its uncertainty. Chosen as the shares of the rules.
const SHAPE_STEP: f64 = 0.5;
const LEVEL_STEP: f64 = 0.2;
const LEAST: f64 = 0.1;
const LEAST_BLIND: f64 = 0.4;

#[cfg(test)]
mod tests;
