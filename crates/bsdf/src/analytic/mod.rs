//! Analytic scattering models, one a file. Each holds for both sides of the sample alike.
//!
//! A model is a [`Formula`], written once for every number type ([`Real`]); [`Analytic`] makes a `Bsdf` of it, [`Family`]
//! what the fit works with. [`families`] lists those, [`models`] also what has no derivatives.

pub mod abg;
pub mod ashikhmin_shirley;
pub mod family;
pub mod fast;
pub mod formula;
pub mod harvey_shack;
pub mod info;
pub mod lambert;
mod lanes;
pub mod microfacet;
pub mod model;
pub mod oren_nayar;
pub mod pair;
pub mod real;
pub mod registry;
pub mod retro;
mod shift_invariant;
pub mod slopes;
pub mod spectrum;
pub mod sum;
pub mod transmission_lobe;
pub mod transmission_lobe_anisotropic;
pub mod ward;
pub mod ward_gmd;

pub use abg::{Abg, AbgTransmission};
pub use ashikhmin_shirley::{AshikhminShirley, AshikhminShirleyIsotropic};
pub use family::{Family, Of, Parametric};
pub use fast::Fast;
pub use formula::Formula;
pub use harvey_shack::{HarveyShack, HarveyShackTransmission};
pub use info::{Exemption, Law, ModelInfo, ParameterInfo, Role, Scatters, Witness};
pub use lambert::{Lambert, LambertReflection, LambertTransmission};
pub use model::Analytic;
pub use oren_nayar::OrenNayar;
pub use pair::{Pair, Pairs, PairsView};
pub use real::{Dual, Real};
pub use registry::{families, family, model_named, models};
pub use retro::{RetroLobe, RoundRetroLobe, lobe_named, retro_lobes};
pub use spectrum::Spectrum;
pub use sum::Sum;
pub use transmission_lobe::{BoundedTransmissionLobe, TransmissionLobe};
pub use transmission_lobe_anisotropic::AnisotropicTransmissionLobe;
pub use ward::{Ward, WardDuer, WardDuerIsotropic, WardIsotropic};
pub use ward_gmd::{WardGmd, WardGmdIsotropic};

use crate::BsdfError;

/// `value` when it lies in `[low, high]` (both included), else the error that names `field`.
fn in_range(field: &'static str, value: f64, low: f64, high: f64) -> Result<f64, BsdfError> {
    if (low..=high).contains(&value) {
        Ok(value)
    } else {
        Err(BsdfError::Domain {
            field,
            found: value.to_string(),
            allowed: format!("{low} to {high}"),
        })
    }
}
