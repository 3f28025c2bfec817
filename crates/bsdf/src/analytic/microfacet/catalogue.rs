//! The microfacet models that the registry lists, by name.

use super::super::{Formula, ModelInfo, ParameterInfo, Role, Scatters};
use super::{Beckmann, Conductor, Elliptic, Ggx, Interface, Isotropic, Reflection, Schlick};

/// A combination that has a name.
pub trait Catalogued {
    /// The model as data.
    const ENTRY: &'static ModelInfo;
}

const F0: ParameterInfo = ParameterInfo::amplitude(
    "f0",
    0.04,
    "reflectance of a facet at normal incidence, which rises to 1 at grazing incidence after Schlick",
);
const ALPHA: ParameterInfo = ParameterInfo::width("alpha", "width of the distribution of facet slopes");
const ALPHA_X: ParameterInfo =
    ParameterInfo::width("alpha_x", "width of the distribution of facet slopes along x");
const ALPHA_Y: ParameterInfo =
    ParameterInfo::width("alpha_y", "width of the distribution of facet slopes along y");
const PHI_X: ParameterInfo = ParameterInfo::axis();

const fn index(
    name: &'static str,
    low: f64,
    high: f64,
    default: f64,
    meaning: &'static str,
) -> ParameterInfo {
    ParameterInfo {
        name,
        unit: "1",
        low,
        high,
        default,
        role: Role::Index,
        meaning,
    }
}

const ETA: ParameterInfo = index("eta", 0.01, 10.0, 0.96, "real part of the refractive index");
const K: ParameterInfo = index("k", 0.0, 20.0, 6.69, "imaginary part of the refractive index");
const RATIO: ParameterInfo = index(
    "eta",
    1.05,
    4.0,
    1.5,
    "refractive index behind the sample over that in front of it",
);

macro_rules! entry {
    ($alias:ident = $model:ty, $name:literal, $title:literal, $source:literal, $scatters:ident, [$($p:expr),*]) => {
        #[doc = concat!($title, ", `", $name, "` in the registry.")]
        pub type $alias = $model;

        impl Catalogued for $model {
            const ENTRY: &'static ModelInfo = {
                static INFO: ModelInfo = ModelInfo {
                    name: $name,
                    title: $title,
                    source: $source,
                    scatters: Scatters::$scatters,
                    parameters: &[$($p),*],
                    breaks: &[],
                };
                &INFO
            };
        }
        const _: fn() = || {
            fn is_a_formula<F: Formula>() {}
            is_a_formula::<$model>();
        };
    };
}

entry!(GgxSchlick = Reflection<Ggx, Isotropic, Schlick>, "ggx", "GGX microfacets",
    "Walter2007, eq. 20, 33 and 34; Schlick1994", Reflection, [F0, ALPHA]);
entry!(GgxSchlickAnisotropic = Reflection<Ggx, Elliptic, Schlick>, "ggx-anisotropic", "GGX microfacets, two widths",
    "Walter2007, eq. 20; Heitz2014, eq. 85 and 86; Schlick1994", Reflection, [F0, ALPHA_X, ALPHA_Y, PHI_X]);
entry!(BeckmannSchlick = Reflection<Beckmann, Isotropic, Schlick>, "beckmann", "Beckmann microfacets",
    "Walter2007, eq. 20, 25 and 26; Schlick1994", Reflection, [F0, ALPHA]);
entry!(BeckmannSchlickAnisotropic = Reflection<Beckmann, Elliptic, Schlick>, "beckmann-anisotropic",
    "Beckmann microfacets, two widths",
    "Walter2007, eq. 20; Heitz2014, eq. 68 and 80; Schlick1994", Reflection, [F0, ALPHA_X, ALPHA_Y, PHI_X]);
entry!(GgxConductor = Reflection<Ggx, Isotropic, Conductor>, "ggx-conductor", "GGX microfacets of a conductor",
    "Walter2007, eq. 20, 33 and 34; BornWolf1999", Reflection, [ETA, K, ALPHA]);
entry!(GgxConductorAnisotropic = Reflection<Ggx, Elliptic, Conductor>, "ggx-conductor-anisotropic",
    "GGX microfacets of a conductor, two widths",
    "Walter2007, eq. 20; Heitz2014, eq. 85 and 86; BornWolf1999", Reflection, [ETA, K, ALPHA_X, ALPHA_Y, PHI_X]);
entry!(BeckmannConductor = Reflection<Beckmann, Isotropic, Conductor>, "beckmann-conductor",
    "Beckmann microfacets of a conductor",
    "Walter2007, eq. 20, 25 and 26; BornWolf1999", Reflection, [ETA, K, ALPHA]);
entry!(BeckmannConductorAnisotropic = Reflection<Beckmann, Elliptic, Conductor>, "beckmann-conductor-anisotropic",
    "Beckmann microfacets of a conductor, two widths",
    "Walter2007, eq. 20; Heitz2014, eq. 68 and 80; BornWolf1999", Reflection, [ETA, K, ALPHA_X, ALPHA_Y, PHI_X]);
entry!(GgxDielectric = Interface<Ggx, Isotropic>, "ggx-dielectric", "rough dielectric interface, GGX",
    "Walter2007, eq. 20 to 22, 33 and 34", Both, [RATIO, ALPHA]);
entry!(GgxDielectricAnisotropic = Interface<Ggx, Elliptic>, "ggx-dielectric-anisotropic",
    "rough dielectric interface, GGX, two widths",
    "Walter2007, eq. 20 to 22; Heitz2014, eq. 85 and 86", Both, [RATIO, ALPHA_X, ALPHA_Y, PHI_X]);
entry!(BeckmannDielectric = Interface<Beckmann, Isotropic>, "beckmann-dielectric",
    "rough dielectric interface, Beckmann",
    "Walter2007, eq. 20 to 22, 25 and 26", Both, [RATIO, ALPHA]);
entry!(BeckmannDielectricAnisotropic = Interface<Beckmann, Elliptic>, "beckmann-dielectric-anisotropic",
    "rough dielectric interface, Beckmann, two widths",
    "Walter2007, eq. 20 to 22; Heitz2014, eq. 68 and 80", Both, [RATIO, ALPHA_X, ALPHA_Y, PHI_X]);
