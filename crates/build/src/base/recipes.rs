//! The analytic sums that are tried as a base.

use gonio_bsdf::BsdfError;
use gonio_bsdf::analytic::{Family, Of, Role, family, retro_lobes};
use gonio_fit::FitModel;
use gonio_geom::Component;

use super::Moves;
use super::diffuse::Coated;

static COATED: Of<Coated, 1> = Of::NEW;

/// Lobes about the mirror direction that stand beside the diffuse parts, for samples without an axis.
const ISOTROPIC: &[&[&str]] = &[
    &[],
    &["ward-gmd"],
    &["ggx"],
    &["ggx-dielectric"],
    &["beckmann-dielectric"],
    &["harvey-shack"],
    &["ward-gmd", "ward-gmd"],
    &["ggx", "ggx"],
];
/// The same for samples with axes.
const ANISOTROPIC: &[&[&str]] = &[
    &[],
    &["ward-gmd"],
    &["ward-gmd-anisotropic"],
    &["ggx-anisotropic"],
    &["ggx-dielectric-anisotropic"],
];
/// Two lobes, each with its own axes.
const TWO_AXES: &[&[&str]] = &[
    &["ward-gmd-anisotropic", "ward-gmd-anisotropic"],
    &["ggx-anisotropic", "ggx-anisotropic"],
];
/// Lobes about the through direction.
const THROUGH: &[&[&str]] = &[
    &[],
    &["bounded-transmission-lobe"],
    &["bounded-transmission-lobe", "bounded-transmission-lobe"],
    &["harvey-shack-transmission"],
    &["ggx-dielectric"],
];
/// The same for samples with an axis.
const THROUGH_ANISOTROPIC: &[&[&str]] = &[
    &[],
    &["bounded-transmission-lobe"],
    &["transmission-lobe-anisotropic"],
];
/// Two of them.
const THROUGH_TWO: &[&[&str]] = &[&["bounded-transmission-lobe", "bounded-transmission-lobe"]];

/// A base before it is fitted.
#[derive(Clone, Debug)]
pub(crate) struct Recipe {
    pub(crate) model: FitModel,
    pub(crate) moves: Vec<Moves>,
}

impl Recipe {
    fn new(parts: &[(&'static dyn Family, Moves)]) -> Self {
        let families: Vec<&'static dyn Family> = parts.iter().map(|p| p.0).collect();
        let names: Vec<&str> = families.iter().map(|f| f.info().name).collect();
        let name = names.join(" + ");
        Recipe {
            model: FitModel::sum_of(&name, &name, &families),
            moves: parts.iter().map(|p| p.1).collect(),
        }
    }

    fn parts(&self) -> Vec<(&'static dyn Family, Moves)> {
        let families = self.model.parts.iter().map(|p| p.family);
        families.zip(self.moves.iter().copied()).collect()
    }
}

/// The sums tried for `component`; with `more` those of two lobes, for samples with axes that one lobe does not describe.
///
/// # Errors
/// [`BsdfError`] when a name is not in the registry.
pub(crate) fn recipes(component: Component, isotropic: bool, more: bool) -> Result<Vec<Recipe>, BsdfError> {
    let (diffuse, lobes): (&[&'static dyn Family], _) = match (component, isotropic) {
        (Component::Reflection, true) => (&[family("lambert")?, &COATED], ISOTROPIC),
        (Component::Reflection, false) => (
            &[family("lambert")?, &COATED],
            if more { TWO_AXES } else { ANISOTROPIC },
        ),
        (Component::Transmission, true) => (&[family("lambert-transmission")?], THROUGH),
        (Component::Transmission, false) => (
            &[family("lambert-transmission")?],
            if more { THROUGH_TWO } else { THROUGH_ANISOTROPIC },
        ),
    };
    let mut all = Vec::new();
    for names in lobes {
        let mut parts: Vec<(&'static dyn Family, Moves)> = diffuse.iter().map(|f| (*f, Moves::Not)).collect();
        for name in *names {
            parts.push((family(name)?, Moves::Mirror));
        }
        all.push(Recipe::new(&parts));
    }
    Ok(all)
}

impl Recipe {
    /// Where to look for the parameters of this recipe when those of the same one without its last lobe are `known`: the
    /// new lobe beside the last one, turned, wider or narrower than it, or of a few widths where it is of another kind.
    pub(crate) fn starts(&self, known: &[f64]) -> Vec<Vec<f64>> {
        let Some((added, before)) = self.model.parts.split_last() else {
            return Vec::new();
        };
        let info = added.info();
        let last = before.last().map(|p| p.info()).filter(|l| l.name == info.name);
        let mut out = Vec::new();
        for (scale, turn) in SECOND {
            let mut values = known.to_vec();
            let first = values.len() - last.map_or(0, |l| l.parameters.len());
            for (k, parameter) in info.parameters.iter().enumerate() {
                let own = match last {
                    Some(_) => values[first + k],
                    None => parameter.default,
                };
                let value = match parameter.role {
                    Role::Amplitude => 0.5 * own,
                    Role::Width => scale * own,
                    Role::Angle => own + turn,
                    _ => own,
                };
                values.push(value.clamp(parameter.low, parameter.high));
            }
            if !out.contains(&values) {
                out.push(values);
            }
        }
        // One lobe that stands for two crossed ones lies between them, and is rounder than both.
        let angle = info.parameters.iter().position(|p| p.role == Role::Angle);
        if let (Some(last), Some(angle)) = (last, angle) {
            let n = last.parameters.len();
            let widths: Vec<usize> = (0..n)
                .filter(|&k| info.parameters[k].role == Role::Width)
                .collect();
            for turn in CROSSED {
                let mut values = known.to_vec();
                let first = values.len() - n;
                values.extend_from_within(first..);
                for (lobe, turn) in [(first, -turn), (first + n, turn)] {
                    for (k, parameter) in info.parameters.iter().enumerate() {
                        if parameter.role == Role::Amplitude {
                            values[lobe + k] *= 0.5;
                        }
                    }
                    if let [a, b] = widths[..] {
                        let (thin, long) = if values[lobe + a] < values[lobe + b] {
                            (a, b)
                        } else {
                            (b, a)
                        };
                        values[lobe + thin] /= LONGER;
                        values[lobe + long] *= LONGER;
                    }
                    values[lobe + angle] += turn;
                    for (value, parameter) in values[lobe..lobe + n].iter_mut().zip(info.parameters) {
                        *value = value.clamp(parameter.low, parameter.high);
                    }
                }
                out.push(values);
            }
        }
        out
    }
}

/// Angles of two crossed lobes on both sides of what one lobe finds, radians, and how much longer and thinner they are.
const CROSSED: [f64; 3] = [0.25, 0.5, 0.75];
const LONGER: f64 = 1.4;

/// Widths of a second lobe over those of the first, and the angle between their axes, radians.
const SECOND: [(f64, f64); 6] = [
    (1.6, 0.7),
    (0.6, 0.7),
    (1.6, -0.7),
    (0.6, -0.7),
    (3.0, 0.0),
    (0.3, 0.0),
];

/// `recipe` with a lobe about the direction of incidence, of either kind.
pub(crate) fn with_retro(recipe: &Recipe) -> [Recipe; 2] {
    retro_lobes().map(|kind| {
        let mut parts = recipe.parts();
        parts.push((kind, Moves::Retro));
        Recipe::new(&parts)
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_recipe_names_models_of_its_component() {
        for component in [Component::Reflection, Component::Transmission] {
            for (isotropic, more) in [(true, false), (false, false), (false, true)] {
                for recipe in recipes(component, isotropic, more).unwrap() {
                    assert!(
                        recipe
                            .model
                            .parts
                            .iter()
                            .all(|p| p.info().scatters.into(component))
                    );
                    assert_eq!(recipe.moves.len(), recipe.model.parts.len());
                }
            }
        }
    }
}
