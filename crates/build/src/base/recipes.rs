//! The analytic sums that are tried as a base.

use gonio_bsdf::BsdfError;
use gonio_bsdf::analytic::{Family, Of, family};
use gonio_fit::FitModel;
use gonio_geom::Component;

use super::Moves;
use super::diffuse::Coated;
use super::retro::RetroLobe;

static COATED: Of<Coated, 1> = Of::NEW;
static RETRO: Of<RetroLobe, 2> = Of::NEW;

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

/// `recipe` with a lobe about the direction of incidence.
pub(crate) fn with_retro(recipe: &Recipe) -> Recipe {
    let mut parts = recipe.parts();
    parts.push((&RETRO, Moves::Retro));
    Recipe::new(&parts)
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
