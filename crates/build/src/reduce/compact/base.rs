//! The base of a compact model: lobes of the registry fitted to the model.

use gonio_bsdf::Bsdf;
use gonio_bsdf::analytic::{Family, Role, Sum, lobe_named, retro_lobes};
use gonio_bsdf::compact::BaseLobe;
use gonio_fit::{FitModel, FitOptions, Metric, fit, fit_model};
use gonio_geom::{Angles, Component, Side};
use gonio_scan::tabulate::{Spacing, Tabulation, tabulate};
use rayon::prelude::*;

use gonio_bsdf::BsdfError;

use super::source::{Pair, Source};
use crate::base::Recipe;

/// Least diffuse part, as a share of the largest albedo seen: the ratio must stay bounded where no lobe is.
const LEAST_DIFFUSE: f64 = 0.02;
/// Share of the misfit that a further lobe must take away to be worth its time.
const LOBE_COST: f64 = 0.2;
/// Amplitude below which a lobe is left out.
const LEAST_LOBE: f64 = 1e-6;
/// Width of the half vector that stands for a model without a lobe.
const BROAD: f64 = 0.5;

/// Relative L1 misfit above which a second lobe with axes of its own, and a lobe about the incidence, are tried.
const MORE_ABOVE: f64 = 0.05;

/// A base that was fitted.
struct Attempt {
    model: FitModel,
    score: f64,
    misfit: f64,
    base: Base,
    /// One list of parameters a channel.
    q: Vec<Vec<f64>>,
}

/// The sum of `known` and one more lobe.
fn with_lobe(known: &FitModel, lobe: &'static dyn Family) -> FitModel {
    let mut families: Vec<&'static dyn Family> = known.parts.iter().map(|p| p.family).collect();
    families.push(lobe);
    let names: Vec<&str> = families.iter().map(|f| f.info().name).collect();
    let name = names.join("+");
    FitModel::sum_of(&name, &name, &families)
}

/// Where to look for the parameters of `model` when those without its last lobe are `known`: lists of one list a channel.
fn starts(model: &FitModel, known: &[Vec<f64>]) -> Vec<Vec<Vec<f64>>> {
    let recipe = Recipe {
        model: model.clone(),
        moves: Vec::new(),
    };
    let each: Vec<Vec<Vec<f64>>> = known.iter().map(|q| recipe.starts(q)).collect();
    let n = each.iter().map(Vec::len).min().unwrap_or(0);
    (0..n)
        .map(|k| each.iter().map(|starts| starts[k].clone()).collect())
        .collect()
}

/// Lobes with the widths of their half vectors.
pub(super) struct Base {
    pub(super) lobes: Vec<BaseLobe>,
    /// Width of the half vector along `phi_x` and across it, of the narrowest lobe.
    pub(super) width: [f64; 2],
    pub(super) phi_x: f64,
    sum: Sum,
}

impl Base {
    /// Fits a diffuse part and a lobe, or two lobes and one about the incidence where one leaves too much, to the model.
    ///
    /// # Errors
    /// [`BsdfError`] for what no measurement can be made of.
    pub(super) fn fitted(source: &Source<'_>) -> Result<Self, BsdfError> {
        let isotropic = source.view.properties().isotropic;
        let names: &[&str] = match (source.component, isotropic) {
            (Component::Reflection, true) => &[
                "lambert+ggx",
                "lambert+ward-gmd",
                "lambert+harvey-shack",
                "lambert+ward-gmd+ward-gmd",
                "lambert+ggx+ggx",
            ],
            (Component::Reflection, false) => &["lambert+ggx-anisotropic", "lambert+ward-gmd-anisotropic"],
            (Component::Transmission, true) => &["lambert-transmission+bounded-transmission-lobe"],
            (Component::Transmission, false) => &[
                "lambert-transmission+transmission-lobe-anisotropic",
                "lambert-transmission+bounded-transmission-lobe",
            ],
        };
        let azimuths: &[f64] = if isotropic {
            &[0.0]
        } else {
            &[0.0, 45.0, 90.0, 135.0]
        };
        let thetas: &[f64] = if isotropic {
            &[5.0, 20.0, 35.0, 50.0, 60.0, 70.0, 78.0]
        } else {
            &[5.0, 30.0, 50.0, 65.0, 75.0]
        };
        let theta = |t: f64| if source.side == Side::Back { 180.0 - t } else { t };
        let tabulation = Tabulation {
            incidences: thetas
                .iter()
                .flat_map(|t| azimuths.iter().map(move |p| Angles::from_degrees(theta(*t), *p)))
                .collect(),
            components: vec![source.component],
            spacing: Spacing {
                pitch: 6.0_f64.to_radians(),
                peak_pitch: 0.2_f64.to_radians(),
                growth: 0.2,
                ..Spacing::default()
            },
            ..Tabulation::default()
        };
        let diffuse = match source.component {
            Component::Reflection => "lambert",
            Component::Transmission => "lambert-transmission",
        };
        let measured = tabulate(source.view, &tabulation).map_err(|e| BsdfError::Domain {
            field: "model",
            found: e.to_string(),
            allowed: "a model that can be tabulated".into(),
        })?;
        let albedo = measured
            .slices
            .iter()
            .flat_map(|s| &s.integrals)
            .map(|i| i.value)
            .fold(0.0, f64::max);
        let floor = (LEAST_DIFFUSE * albedo).clamp(1e-4, 1.0);
        let options = FitOptions {
            metric: Metric::CubeRoot,
            compare: Vec::new(),
            profile: false,
            signature: false,
            start_readings: 1000,
            ..FitOptions::default()
        };
        let probes = probes();
        let attempt = |model: &FitModel, start: Option<Vec<Vec<f64>>>| {
            let options = FitOptions {
                start,
                ..options.clone()
            };
            let found = fit(&measured, model, &options).ok()?;
            let q: Vec<Vec<f64>> = found.parameters().into_iter().map(|p| p.1).collect();
            let base = Base::of(source, model, &q, floor).ok()?;
            let misfit = base.misfit(source, &probes);
            let cost = 1.0 + LOBE_COST * base.lobes.len() as f64;
            Some(Attempt {
                model: model.clone(),
                score: cost * misfit,
                misfit,
                base,
                q,
            })
        };
        let least = |a: &Attempt, b: &Attempt| a.score.total_cmp(&b.score);
        // One more lobe, from many places about those that are known.
        let grown = |known: &Attempt, lobe: &'static dyn Family| -> Vec<Attempt> {
            let model = with_lobe(&known.model, lobe);
            let starts = starts(&model, &known.q);
            starts
                .into_par_iter()
                .filter_map(|start| attempt(&model, Some(start)))
                .collect()
        };
        let mut best = names
            .par_iter()
            .filter_map(|name| attempt(&fit_model(name).ok()?, None))
            .min_by(least);
        let crossed = best.as_ref().filter(|b| !isotropic && b.misfit > MORE_ABOVE);
        if let Some((one, lobe)) = crossed.and_then(|b| Some((b, b.model.parts.last()?.family))) {
            let two = grown(one, lobe);
            best = best.into_iter().chain(two).min_by(least);
        }
        if source.component == Component::Reflection
            && let Some(without) = best.as_ref().filter(|b| b.misfit > MORE_ABOVE)
        {
            let with: Vec<Attempt> = retro_lobes()
                .into_iter()
                .flat_map(|lobe| grown(without, lobe))
                .collect();
            best = best.into_iter().chain(with).min_by(least);
        }
        match best {
            Some(found) => Ok(found.base),
            None => Base::alone(source, diffuse, albedo.clamp(floor, 1.0)),
        }
    }

    /// The lobes of a fitted sum.
    fn of(source: &Source<'_>, model: &FitModel, q: &[Vec<f64>], floor: f64) -> Result<Self, BsdfError> {
        let mut lobes = Vec::new();
        let (mut width, mut phi_x) = ([BROAD; 2], 0.0);
        for (k, part) in model.parts.iter().enumerate() {
            let info = part.info();
            let mut parameters: Vec<Vec<f64>> = q.iter().map(|q| model.part_values(k, q)).collect();
            let at = |role: Role| info.parameters.iter().position(|p| p.role == role);
            if let Some(amplitude) = at(Role::Amplitude) {
                if at(Role::Width).is_none() {
                    parameters
                        .iter_mut()
                        .for_each(|p| p[amplitude] = p[amplitude].max(floor));
                }
                if parameters.iter().all(|p| p[amplitude] < LEAST_LOBE) {
                    continue;
                }
            }
            let retro = retro_lobes().iter().any(|l| l.info().name == info.name);
            if let Some(first) = at(Role::Width).filter(|_| !retro) {
                let axes: Vec<f64> = (first..info.parameters.len())
                    .filter(|j| info.parameters[*j].role == Role::Width)
                    .map(|j| parameters[0][j] * half_vectors_share(source.component))
                    .collect();
                let own = [axes[0], *axes.last().unwrap_or(&axes[0])];
                if own[0] * own[1] < width[0] * width[1] {
                    width = own.map(|w| w.clamp(1e-3, BROAD));
                    phi_x = at(Role::Angle).map_or(0.0, |j| parameters[0][j]);
                }
            }
            lobes.push(BaseLobe {
                model: info.name.into(),
                parameters,
                weight: 1.0,
            });
        }
        Base::new(source, lobes, width, phi_x)
    }

    /// A diffuse part alone.
    fn alone(source: &Source<'_>, diffuse: &str, albedo: f64) -> Result<Self, BsdfError> {
        let lobe = BaseLobe {
            model: diffuse.into(),
            parameters: vec![vec![albedo]; source.channels()],
            weight: 1.0,
        };
        Base::new(source, vec![lobe], [BROAD; 2], 0.0)
    }

    fn new(
        source: &Source<'_>,
        lobes: Vec<BaseLobe>,
        width: [f64; 2],
        phi_x: f64,
    ) -> Result<Self, BsdfError> {
        let mut parts = Vec::new();
        for lobe in &lobes {
            let values: Vec<_> = source
                .view
                .channels()
                .iter()
                .copied()
                .zip(lobe.parameters.iter().cloned())
                .collect();
            parts.push((lobe_named(&lobe.model)?.model(&values)?, 1.0));
        }
        Ok(Base {
            sum: Sum::weighted(parts, true)?,
            lobes,
            width,
            phi_x,
        })
    }

    /// Values of every channel, for a pair on the front.
    pub(super) fn eval(&self, source: &Source<'_>, pair: Pair, f: &mut [f64]) {
        let (wi, ws) = source.placed(pair);
        self.sum.eval(wi, ws, f);
    }

    /// Values of many pairs, `[pair][channel]`.
    pub(super) fn many(&self, source: &Source<'_>, pairs: &[Pair]) -> Vec<f64> {
        let n = source.channels();
        let mut values = vec![0.0; n * pairs.len()];
        values
            .par_chunks_mut(n)
            .with_min_len(256)
            .zip(pairs)
            .for_each(|(f, pair)| self.eval(source, *pair, f));
        values
    }

    /// Relative L1 difference over weighted probes.
    fn misfit(&self, source: &Source<'_>, probes: &[(Pair, f64)]) -> f64 {
        let pairs: Vec<Pair> = probes.iter().map(|p| p.0).collect();
        let (f, b) = (source.many(&pairs), self.many(source, &pairs));
        let n = source.channels();
        let (mut difference, mut total) = (0.0, 0.0);
        for ((f, b), (_, weight)) in f.chunks(n).zip(b.chunks(n)).zip(probes) {
            for (f, b) in f.iter().zip(b) {
                difference += weight * (f - b).abs();
                total += weight * f;
            }
        }
        difference / total
    }

    /// Draws each lobe by the share of the model's light that it stands for; `light` is that of the whole part.
    pub(super) fn weigh(&mut self, source: &Source<'_>, samples: &[(Pair, f64)], light: f64) {
        let n = source.channels();
        let mut shares = vec![0.0; self.lobes.len()];
        let mut one = vec![0.0; n];
        for (pair, weight) in samples {
            let (wi, ws) = source.placed(*pair);
            let values: Vec<f64> = self
                .sum
                .parts()
                .iter()
                .map(|part| {
                    part.eval(wi, ws, &mut one);
                    one.iter().sum()
                })
                .collect();
            let sum: f64 = values.iter().sum();
            if sum > 0.0 {
                shares
                    .iter_mut()
                    .zip(&values)
                    .for_each(|(s, v)| *s += weight * v / sum);
            }
        }
        let total: f64 = shares.iter().sum();
        for (lobe, share) in self.lobes.iter_mut().zip(shares) {
            let share = if total > 0.0 { share / total } else { 1.0 };
            lobe.weight = share.max(0.1) * light.max(1e-6);
        }
    }
}

/// Width of the half vector per unit of a lobe's own width.
fn half_vectors_share(component: Component) -> f64 {
    match component {
        Component::Reflection => 1.0,
        // widths of transmission lobes are those of the scattered direction
        Component::Transmission => 0.5,
    }
}

/// Pairs over which a base is judged, with their solid angles times the cosine.
fn probes() -> Vec<(Pair, f64)> {
    let frame = gonio_bsdf::compact::Frame {
        symmetry: gonio_bsdf::compact::Symmetry::Anisotropic,
        width: [0.03; 2],
        phi_x: 0.0,
        shape: [2, 4, 2, 4],
    };
    (0..8000)
        .filter_map(|k| {
            let [a, b, c, d] = super::source::spread(k);
            let (wi, ws, solid_angle) = frame.pair([0.9 * a, 4.0 * b, c, 4.0 * d])?;
            Some(((wi, ws), solid_angle * ws.cos_theta()))
        })
        .collect()
}
