//! The list of fit models: Radiance's materials, and a diffuse part with each lobe of the registry.

use gonio_bsdf::analytic::{Family, Role, Scatters, families, family};

use crate::{FitError, FitModel, Parameter, Part, Product};

/// A parameter of a recipe.
struct Ingredient {
    name: &'static str,
    role: Role,
    per_channel: bool,
    default: f64,
    meaning: &'static str,
}

const fn ingredient(
    name: &'static str,
    role: Role,
    per_channel: bool,
    default: f64,
    meaning: &'static str,
) -> Ingredient {
    Ingredient {
        name,
        role,
        per_channel,
        default,
        meaning,
    }
}

const COLOR: Ingredient = ingredient("color", Role::Amplitude, true, 0.5, "colour of the material");
const SPECULARITY: Ingredient = ingredient(
    "specularity",
    Role::Amplitude,
    false,
    0.05,
    "share that is reflected in the lobe",
);
const TRANS: Ingredient = ingredient(
    "trans",
    Role::Amplitude,
    false,
    0.5,
    "share of the rest that is transmitted",
);
const TSPEC: Ingredient = ingredient(
    "tspec",
    Role::Amplitude,
    false,
    0.2,
    "share of the transmitted light that stays in the lobe",
);
const ALPHA: Ingredient = ingredient(
    "alpha",
    Role::Width,
    false,
    0.1,
    "rms slope times sqrt 2; Radiance's roughness",
);
const ALPHA_X: Ingredient = ingredient("alpha_x", Role::Width, false, 0.1, "width along x");
const ALPHA_Y: Ingredient = ingredient("alpha_y", Role::Width, false, 0.1, "width along y");
const PHI_X: Ingredient = ingredient("phi_x", Role::Angle, false, 0.0, "azimuth of the lobe's x axis");

/// A fit model as data: parameters, and the parameters of each part as products of them.
struct Recipe {
    name: &'static str,
    title: &'static str,
    parameters: &'static [Ingredient],
    parts: &'static [(&'static str, &'static [&'static str])],
}

/// Radiance's rough materials \[Radiance\]: the lobe of plastic and trans is uncoloured, that of metal coloured; rough
/// lobes know no Fresnel reflection.
const RECIPES: &[Recipe] = &[
    Recipe {
        name: "plastic",
        title: "Radiance plastic",
        parameters: &[COLOR, SPECULARITY, ALPHA],
        parts: &[
            ("lambert", &["color*(1-specularity)"]),
            ("ward-gmd", &["specularity", "alpha"]),
        ],
    },
    Recipe {
        name: "metal",
        title: "Radiance metal",
        parameters: &[COLOR, SPECULARITY, ALPHA],
        parts: &[
            ("lambert", &["color*(1-specularity)"]),
            ("ward-gmd", &["color*specularity", "alpha"]),
        ],
    },
    Recipe {
        name: "trans",
        title: "Radiance trans",
        parameters: &[COLOR, SPECULARITY, TRANS, TSPEC, ALPHA],
        parts: &[
            ("lambert", &["color*(1-specularity)*(1-trans)"]),
            ("ward-gmd", &["specularity", "alpha"]),
            ("lambert-transmission", &["color*(1-specularity)*trans*(1-tspec)"]),
            (
                "transmission-lobe",
                &["color*(1-specularity)*trans*tspec", "alpha"],
            ),
        ],
    },
    Recipe {
        name: "plastic2",
        title: "Radiance plastic2",
        parameters: &[COLOR, SPECULARITY, ALPHA_X, ALPHA_Y, PHI_X],
        parts: &[
            ("lambert", &["color*(1-specularity)"]),
            (
                "ward-gmd-anisotropic",
                &["specularity", "alpha_x", "alpha_y", "phi_x"],
            ),
        ],
    },
    Recipe {
        name: "metal2",
        title: "Radiance metal2",
        parameters: &[COLOR, SPECULARITY, ALPHA_X, ALPHA_Y, PHI_X],
        parts: &[
            ("lambert", &["color*(1-specularity)"]),
            (
                "ward-gmd-anisotropic",
                &["color*specularity", "alpha_x", "alpha_y", "phi_x"],
            ),
        ],
    },
    Recipe {
        name: "trans2",
        title: "Radiance trans2",
        parameters: &[COLOR, SPECULARITY, TRANS, TSPEC, ALPHA_X, ALPHA_Y, PHI_X],
        parts: &[
            ("lambert", &["color*(1-specularity)*(1-trans)"]),
            (
                "ward-gmd-anisotropic",
                &["specularity", "alpha_x", "alpha_y", "phi_x"],
            ),
            ("lambert-transmission", &["color*(1-specularity)*trans*(1-tspec)"]),
            (
                "transmission-lobe-anisotropic",
                &["color*(1-specularity)*trans*tspec", "alpha_x", "alpha_y", "phi_x"],
            ),
        ],
    },
];

/// Models that stand for themselves; a diffuse part beside them would be the same again.
const ALONE: &[&str] = &["lambert", "lambert-transmission", "oren-nayar"];

/// The range and unit of an ingredient come from the family whose parameter it is.
fn prepare(recipe: &Recipe) -> Result<FitModel, FitError> {
    let names: Vec<&str> = recipe.parameters.iter().map(|p| p.name).collect();
    let mut parts = Vec::new();
    for (name, values) in recipe.parts {
        let family = family(name)?;
        let found: Option<Vec<Product>> = values.iter().map(|v| Product::parse(v, &names)).collect();
        match found {
            Some(values) if values.len() == family.info().parameters.len() => {
                parts.push(Part { family, values })
            }
            _ => {
                return Err(FitError::Model {
                    found: format!("{}: part {name} with {values:?}", recipe.name),
                    allowed: "one product a parameter of the part".into(),
                });
            }
        }
    }
    let parameters = recipe
        .parameters
        .iter()
        .enumerate()
        .map(|(k, p)| {
            let own = parts.iter().find_map(|part: &Part| {
                let at = part.values.iter().position(|v| *v == Product::of(k))?;
                Some(&part.info().parameters[at])
            });
            Parameter {
                name: p.name.into(),
                unit: own.map_or("1", |o| o.unit).into(),
                low: own.map_or(0.0, |o| o.low),
                high: own.map_or(1.0, |o| o.high),
                default: p.default,
                role: p.role,
                per_channel: p.per_channel,
                meaning: p.meaning.into(),
            }
        })
        .collect();
    Ok(FitModel {
        name: recipe.name.into(),
        title: recipe.title.into(),
        parameters,
        parts,
    })
}

/// A lobe with the diffuse part of its component, or the model alone where it brings its own.
fn with_diffuse(lobe: &'static dyn Family) -> Result<FitModel, FitError> {
    let info = lobe.info();
    let amplitudes = info
        .parameters
        .iter()
        .filter(|p| p.role == Role::Amplitude)
        .count();
    if ALONE.contains(&info.name) || amplitudes > 1 {
        return Ok(FitModel::sum_of(info.name, info.title, &[lobe]));
    }
    let mut parts: Vec<&'static dyn Family> = Vec::new();
    if info.scatters != Scatters::Transmission {
        parts.push(family("lambert")?);
    }
    if info.scatters != Scatters::Reflection {
        parts.push(family("lambert-transmission")?);
    }
    parts.push(lobe);
    Ok(FitModel::sum_of(
        info.name,
        &format!("diffuse + {}", info.title),
        &parts,
    ))
}

/// Every fit model: Radiance's materials, then one a family of the registry.
///
/// # Errors
/// [`FitError`] when a recipe names a family that is not in the registry.
pub fn fit_models() -> Result<Vec<FitModel>, FitError> {
    let mut models = Vec::new();
    for recipe in RECIPES {
        models.push(prepare(recipe)?);
    }
    for family in families() {
        if RECIPES.iter().all(|r| r.name != family.info().name) {
            models.push(with_diffuse(*family)?);
        }
    }
    Ok(models)
}

/// The fit model called `name`: one of [`fit_models`], or families joined by `+`, such as `lambert+ggx+ggx`.
///
/// # Errors
/// [`FitError::Model`] that lists the names there are.
pub fn fit_model(name: &str) -> Result<FitModel, FitError> {
    let wanted = name.trim().to_ascii_lowercase();
    let models = fit_models()?;
    if let Some(model) = models.iter().find(|m| m.name == wanted) {
        return Ok(model.clone());
    }
    if wanted.contains('+') {
        let mut parts = Vec::new();
        for part in wanted.split('+').map(str::trim) {
            parts.push(family(part)?);
        }
        return Ok(FitModel::sum_of(&wanted, &wanted, &parts));
    }
    Err(FitError::Model {
        found: format!("{name:?}"),
        allowed: format!(
            "{}, or a sum such as lambert+ward-gmd+ward-gmd",
            models
                .iter()
                .map(|m| m.name.as_str())
                .collect::<Vec<_>>()
                .join(", ")
        ),
    })
}
