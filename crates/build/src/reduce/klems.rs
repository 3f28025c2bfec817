//! Reduction to Klems matrices: averages over pairs of patches.

mod azimuth;
mod exit;
mod ideal;
mod incident;
mod rule;

use gonio_bsdf::klems::{Klems, KlemsBasis, KlemsMatrix};
use gonio_bsdf::{Bsdf, BsdfError, FourComponents};
use gonio_geom::{Component, Side};
use rayon::prelude::*;

use self::incident::Rows;
use super::OneChannel;

/// How to reduce a model to Klems matrices.
#[derive(Clone, Debug, PartialEq)]
pub struct KlemsOptions {
    /// Angle basis of incidence and exit.
    pub basis: KlemsBasis,
    /// Components to fill; `None` fills every component that scatters.
    pub components: Option<Vec<(Side, Component)>>,
    /// Number of the model's channel.
    pub channel: usize,
    /// A cell is halved while the mean deviation of its values, as a share of the directional albedo, is above this.
    /// What a cell is then wrong by is far less.
    pub tolerance: f64,
    /// Incidences across an incident patch, in each coordinate (isotropic models: four times as many in the polar
    /// angle alone).
    pub incident_points: usize,
    /// Scales incident patches whose directional albedo exceeds 1 back to 1, and reports them.
    pub cap_albedo: bool,
}

impl Default for KlemsOptions {
    /// The full basis, all components, tolerance 0.0001, 4 incidences across a patch, nothing rescaled.
    fn default() -> Self {
        KlemsOptions {
            basis: KlemsBasis::full(),
            components: None,
            channel: 0,
            tolerance: 0.0001,
            incident_points: 4,
            cap_albedo: false,
        }
    }
}

/// A Klems model with what the reduction found.
#[derive(Clone, Debug)]
pub struct KlemsReduction {
    /// The model.
    pub model: Klems,
    /// Greatest directional albedo (reflection and transmission of one side) over incident patches, before any
    /// capping. Above 1 the model gains energy there.
    pub max_albedo: f64,
    /// Incident patches that were scaled to albedo 1, with their albedo before; empty unless capping was asked for.
    pub capped: Vec<(Side, usize, f64)>,
    /// Number of evaluations of the model.
    pub evaluations: u64,
    /// Cells that were still rough at the finest size, over all incidences.
    pub unsettled: usize,
}

/// Averages `model` over all pairs of patches, weighted with the projected solid angle of both directions:
/// `f_oi = 1/(Lambda_o Lambda_i) integral integral f cos_i cos_s domega_i domega_s`, which keeps energy and
/// reciprocity [Klems1994].
///
/// Gauss-Legendre rules over incidence; over exit, cells of the patches that are halved where the model is rough and
/// about the mirror, unbent and retro directions. For isotropic models one incident patch stands for its ring. An ideal
/// part ([`Bsdf::delta`]) goes to the patches of its direction: RADIANCE's `aBSDF` takes it out of them again.
///
/// # Errors
/// [`BsdfError::Domain`] for a channel the model does not have, no component that scatters, or a tolerance or number of points out of range.
pub fn to_klems(model: &dyn Bsdf, options: &KlemsOptions) -> Result<KlemsReduction, BsdfError> {
    let one = OneChannel::with_ideal(model, options.channel)?;
    let positive = options.tolerance.is_finite() && options.tolerance > 0.0;
    if !positive || !(1..=64).contains(&options.incident_points) {
        return Err(BsdfError::Domain {
            field: "tolerance, incident_points",
            found: format!("{}, {}", options.tolerance, options.incident_points),
            allowed: "a positive tolerance, 1 to 64 points".into(),
        });
    }
    let components = one.components(options.components.as_deref())?;
    let basis = &options.basis;
    let n = basis.len();
    let mut evaluations = 0;
    let mut unsettled = 0;
    let mut filled = FourComponents::default();
    for (side, component) in components {
        let filling = Filling {
            one,
            options,
            side,
            to: component.scattered_side(side),
            component,
        };
        let rings: Vec<usize> = (0..basis.rings().len()).collect();
        let done: Vec<Rows> = rings.par_iter().map(|a| filling.ring(*a)).collect();
        let mut values = vec![0f32; n * n];
        for (i, row) in done.iter().flat_map(|r| &r.rows).enumerate() {
            for (o, mean) in row.iter().enumerate() {
                values[o * n + i] = *mean as f32;
            }
        }
        filling.add_ideal(&mut values);
        evaluations += done.iter().map(|r| r.evaluations).sum::<u64>();
        unsettled += done.iter().map(|r| r.unsettled).sum::<usize>();
        filled.set(side, component, Some(values));
    }
    finish(&one, options, &filled, evaluations, unsettled)
}

/// Albedos, capping, matrices.
fn finish(
    one: &OneChannel<'_>,
    options: &KlemsOptions,
    filled: &FourComponents<Vec<f32>>,
    evaluations: u64,
    unsettled: usize,
) -> Result<KlemsReduction, BsdfError> {
    let basis = &options.basis;
    let n = basis.len();
    let mut filled = filled.clone();
    let mut max_albedo = 0.0f64;
    let mut capped = Vec::new();
    for side in Side::BOTH {
        for i in 0..n {
            let albedo: f64 = [Component::Reflection, Component::Transmission]
                .iter()
                .filter_map(|c| filled.get(side, *c))
                .map(|v| {
                    (0..n)
                        .map(|o| f64::from(v[o * n + i]) * basis.lambda()[o])
                        .sum::<f64>()
                })
                .sum();
            max_albedo = max_albedo.max(albedo);
            if options.cap_albedo && albedo > 1.0 {
                capped.push((side, i, albedo));
                // single precision rounds up too: stay below by one part in ten million
                let scale = ((1.0 - 1e-7) / albedo) as f32;
                filled = filled.map(|s, _, v| {
                    let mut v = v.clone();
                    if s == side {
                        (0..n).for_each(|o| v[o * n + i] *= scale);
                    }
                    v
                });
            }
        }
    }
    let mut matrices = FourComponents::default();
    for (side, component, values) in filled.iter() {
        let m = KlemsMatrix::new(basis.clone(), basis.clone(), values.clone())?;
        matrices.set(side, component, Some(m));
    }
    Ok(KlemsReduction {
        model: Klems::new(one.channel(), matrices),
        max_albedo,
        capped,
        evaluations,
        unsettled,
    })
}

/// One component of a model on a basis.
struct Filling<'a> {
    one: OneChannel<'a>,
    options: &'a KlemsOptions,
    side: Side,
    to: Side,
    component: Component,
}
