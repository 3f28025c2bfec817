//! Fitting a base to a few readings of every slice.

use std::f64::consts::PI;

use gonio_bsdf::Channel;
use gonio_bsdf::analytic::Role;
use gonio_fit::{FitOptions, Metric, Selection, fit};
use gonio_geom::{Component, DVec3, Direction};
use gonio_scan::{Flags, Measurement, Slice};

use super::{Base, Expansion, Fitted, Recipe};

/// Readings that the search for a starting point looks at; fewer where the base is fitted again.
const START_READINGS: usize = 600;
const START_AGAIN: usize = 250;

/// Every so manyth reading takes part where a base is fitted again.
const AGAIN: usize = 2;

/// Readings that say how densely the peak of a slice was read.
const HIGHEST: usize = 40;

/// Least width of a lobe over the distance of the readings about the peak. A narrower one hides between readings.
const LEAST_WIDTH: f64 = 0.7;

/// The floor of a base in units of the mean BSDF of its slices.
const FLOOR: f64 = 1e-4;

/// Largest share of light that the parts of a base may scatter before readings are scaled down.
const LARGEST: f64 = 0.95;

/// Readings picked from one incidence, each with the solid angle it stands for.
#[derive(Clone, Debug, Default)]
pub(crate) struct Picked {
    pub(crate) direction: Vec<DVec3>,
    /// BSDF, 1/sr.
    pub(crate) bsdf: Vec<f64>,
    /// Independent standard uncertainty of `bsdf`; 0 when unknown.
    pub(crate) sigma: Vec<f64>,
    /// Solid angle, sr, over the probability of being picked.
    pub(crate) omega: Vec<f64>,
}

impl Picked {
    /// About `most` of the readings, picked evenly along their order with a probability in proportion to `importance`
    /// (not negative); sums over solid angle keep their expectation.
    pub(crate) fn new(
        readings: usize,
        most: usize,
        reading: impl Fn(usize) -> (DVec3, f64, f64, f64),
        importance: impl Fn(f64, f64) -> f64,
    ) -> Self {
        let weights: Vec<f64> = (0..readings)
            .map(|j| {
                let (d, f, _, omega) = reading(j);
                omega.max(0.0) * importance(f.max(0.0), d.z)
            })
            .collect();
        let total: f64 = weights.iter().sum();
        let mut out = Picked::default();
        let mut sum = 0.5;
        for (j, w) in weights.iter().enumerate() {
            let p = if total > 0.0 {
                (most as f64 * w / total).min(1.0)
            } else {
                0.0
            };
            sum += p;
            if sum >= 1.0 && p > 0.0 {
                sum -= 1.0;
                let (d, f, u, omega) = reading(j);
                out.direction.push(d);
                out.bsdf.push(f);
                out.sigma.push(u);
                out.omega.push(omega / p);
            }
        }
        out
    }

    pub(crate) fn len(&self) -> usize {
        self.bsdf.len()
    }

    /// Typical distance of the readings where the BSDF is highest, radians: the square root of the solid angle of a reading,
    /// the median over the highest [`HIGHEST`]. `None` for too few.
    pub(crate) fn peak_spacing(bsdf: &[f64], omega: &[f64]) -> Option<f64> {
        let mut order: Vec<usize> = (0..bsdf.len()).filter(|&j| omega[j] > 0.0).collect();
        if order.len() < 2 * HIGHEST {
            return None;
        }
        order.select_nth_unstable_by(HIGHEST, |&a, &b| bsdf[b].total_cmp(&bsdf[a]));
        let mut highest: Vec<f64> = order[..HIGHEST].iter().map(|&j| omega[j]).collect();
        highest.sort_unstable_by(f64::total_cmp);
        Some(highest[HIGHEST / 2].sqrt())
    }

    /// Integral of the DSF.
    pub(crate) fn albedo(&self) -> f64 {
        (0..self.len())
            .map(|j| self.omega[j] * self.bsdf[j] * self.direction[j].z)
            .sum()
    }
}

/// The readings a base is fitted to: one entry an incidence.
pub(crate) struct Fitting {
    component: Component,
    /// Distance of the readings about the peaks, radians: the least one of all slices; 0 when unknown.
    spacing: f64,
    scale: f64,
    floor: f64,
    incidences: Vec<DVec3>,
    readings: Vec<Picked>,
    slices: Vec<Slice>,
}

impl Fitting {
    /// Readings of `component` in the local frame.
    pub(crate) fn new(
        component: Component,
        incidences: Vec<DVec3>,
        readings: Vec<Picked>,
        spacing: f64,
    ) -> Self {
        let albedo = readings.iter().map(Picked::albedo).fold(0.0, f64::max);
        let scale = (albedo / LARGEST).max(1.0);
        let slices = incidences
            .iter()
            .zip(&readings)
            .map(|(&i, r)| slice(component, i, r, scale))
            .collect();
        Fitting {
            component,
            spacing,
            scale,
            floor: (FLOOR * albedo / PI).max(f64::MIN_POSITIVE),
            incidences,
            readings,
            slices,
        }
    }

    /// The base of `recipe` that describes the incidences for which `keep` holds best (cube roots of the DSF over
    /// solid angle [ForesFerwerdaGu2012]); `None` when it cannot be fitted. The search begins at `known` where that is given.
    pub(crate) fn fit(
        &self,
        recipe: &Recipe,
        known: Option<&[f64]>,
        keep: impl Fn(usize) -> bool,
    ) -> Option<Base> {
        let all = (0..self.slices.len()).all(&keep);
        let measurement = Measurement {
            slices: (0..self.slices.len())
                .filter(|&k| keep(k))
                .map(|k| {
                    if all {
                        self.slices[k].clone()
                    } else {
                        thinned(&self.slices[k])
                    }
                })
                .collect(),
            ..Measurement::default()
        };
        let options = FitOptions {
            metric: Metric::CubeRoot,
            selection: Selection {
                max_theta_s: 88f64.to_radians(),
                ..Selection::default()
            },
            signature: false,
            compare: Vec::new(),
            profile: false,
            warnings: false,
            start_readings: if all { START_READINGS } else { START_AGAIN },
            start: known.map(|values| vec![values.to_vec()]),
            ..FitOptions::default()
        };
        // Slopes of facets are half as wide as what they scatter into.
        let share = match self.component {
            Component::Reflection => 0.5,
            Component::Transmission => 1.0,
        };
        let mut model = recipe.model.clone();
        for parameter in model.parameters.iter_mut().filter(|p| p.role == Role::Width) {
            let least = LEAST_WIDTH * share * self.spacing;
            parameter.low = parameter.low.max(least).min(0.5 * parameter.high);
        }
        let found = fit(&measurement, &model, &options).ok()?;
        let (channel, values) = found.parameters().into_iter().next()?;
        let mut parts = Vec::with_capacity(recipe.moves.len());
        for (k, &moves) in recipe.moves.iter().enumerate() {
            let (family, values) = (recipe.model.parts[k].family, recipe.model.part_values(k, &values));
            parts.push(Fitted {
                model: family.model(&[(channel, values.clone())]).ok()?,
                family,
                values,
                moves,
            });
        }
        Some(Base {
            name: recipe.model.name.clone(),
            probabilities: super::drawing::probabilities(&parts),
            parts,
            component: self.component,
            scale: self.scale,
            floor: self.floor,
            expansion: None,
        })
    }

    /// The reciprocal expansion up to `order` of the incidences for which `keep` holds; `None` when they do not determine it.
    pub(crate) fn expansion(&self, order: usize, keep: impl Fn(usize) -> bool) -> Option<Base> {
        let readings = (0..self.incidences.len()).filter(|&k| keep(k)).flat_map(|k| {
            let (i, r) = (self.incidences[k], &self.readings[k]);
            (0..r.len()).map(move |j| (i, r.direction[j], r.bsdf[j], r.omega[j] * r.direction[j].z))
        });
        let expansion = Expansion::fit(order, readings)?;
        Some(Base {
            name: format!("Zernike expansion of order {}", expansion.order),
            parts: Vec::new(),
            probabilities: Vec::new(),
            component: self.component,
            scale: self.scale,
            floor: self.floor,
            expansion: Some(expansion),
        })
    }

    /// Relative L1 difference of `base` from the readings of the incidences for which `keep` holds.
    pub(crate) fn error(&self, base: &Base, keep: impl Fn(usize) -> bool) -> f64 {
        let (mut apart, mut size) = (0.0, 0.0);
        for k in (0..self.incidences.len()).filter(|&k| keep(k)) {
            let r = &self.readings[k];
            let predicted = base.eval_all(self.incidences[k], r.direction.iter().copied());
            for (j, f) in predicted.into_iter().enumerate() {
                let w = r.omega[j] * r.direction[j].z;
                apart += w * (f - r.bsdf[j]).abs();
                size += w * r.bsdf[j].abs();
            }
        }
        apart / size.max(f64::MIN_POSITIVE)
    }
}

/// The picked readings as the fit takes them.
fn slice(component: Component, i: DVec3, r: &Picked, scale: f64) -> Slice {
    let angles: Vec<(f64, f64)> = r
        .direction
        .iter()
        .map(|&d| {
            let d = Direction::from_unit(d);
            let d = if component == Component::Transmission {
                d.flipped()
            } else {
                d
            };
            (d.theta(), d.phi())
        })
        .collect();
    let of = |values: &[f64]| -> Vec<f64> {
        values
            .iter()
            .zip(&r.direction)
            .map(|(v, d)| v * d.z / scale)
            .collect()
    };
    Slice {
        incidence: Direction::from_unit(i).angles(),
        channel: Channel::Photopic,
        theta_s: angles.iter().map(|a| a.0).collect(),
        phi_s: angles.iter().map(|a| a.1).collect(),
        dsf: of(&r.bsdf),
        u_dsf: of(&r.sigma),
        omega: r.omega.clone(),
        flags: vec![Flags::NONE; r.len()],
        u_common: 0.0,
        integrals: Vec::new(),
    }
}

/// Every [`AGAIN`]th reading.
fn thinned(slice: &Slice) -> Slice {
    fn of<T: Copy>(column: &[T]) -> Vec<T> {
        column.iter().step_by(AGAIN).copied().collect()
    }
    Slice {
        theta_s: of(&slice.theta_s),
        phi_s: of(&slice.phi_s),
        dsf: of(&slice.dsf),
        u_dsf: of(&slice.u_dsf),
        omega: of(&slice.omega),
        flags: of(&slice.flags),
        integrals: Vec::new(),
        ..*slice
    }
}
