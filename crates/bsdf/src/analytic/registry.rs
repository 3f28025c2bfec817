//! The list of every analytic model.

use super::microfacet::catalogue::{
    BeckmannConductor, BeckmannConductorAnisotropic, BeckmannDielectric, BeckmannDielectricAnisotropic,
    BeckmannSchlick, BeckmannSchlickAnisotropic, GgxConductor, GgxConductorAnisotropic, GgxDielectric,
    GgxDielectricAnisotropic, GgxSchlick, GgxSchlickAnisotropic,
};
use super::microfacet::compensated;
use super::{
    Abg, AbgTransmission, AnisotropicTransmissionLobe, AshikhminShirley, AshikhminShirleyIsotropic,
    BoundedTransmissionLobe, Family, HarveyShack, HarveyShackTransmission, LambertReflection,
    LambertTransmission, Of, OrenNayar, Parametric, TransmissionLobe, Ward, WardDuer, WardDuerIsotropic,
    WardGmd, WardGmdIsotropic, WardIsotropic,
};
use crate::BsdfError;

/// Every analytic model that has derivatives, which the fit runs over.
pub fn families() -> &'static [&'static dyn Family] {
    FAMILIES
}

/// A static, not a constant: a constant would be compiled anew in each crate that asks for it, all models with it.
static FAMILIES: &[&dyn Family] = &[
    &Of::<LambertReflection, 1>::NEW,
    &Of::<LambertTransmission, 1>::NEW,
    &Of::<OrenNayar, 2>::NEW,
    &Of::<WardIsotropic, 2>::NEW,
    &Of::<Ward, 4>::NEW,
    &Of::<WardDuerIsotropic, 2>::NEW,
    &Of::<WardDuer, 4>::NEW,
    &Of::<WardGmdIsotropic, 2>::NEW,
    &Of::<WardGmd, 4>::NEW,
    &Of::<TransmissionLobe, 2>::NEW,
    &Of::<BoundedTransmissionLobe, 2>::NEW,
    &Of::<AnisotropicTransmissionLobe, 4>::NEW,
    &Of::<AshikhminShirleyIsotropic, 3>::NEW,
    &Of::<AshikhminShirley, 5>::NEW,
    &Of::<GgxSchlick, 2>::NEW,
    &Of::<GgxSchlickAnisotropic, 4>::NEW,
    &Of::<BeckmannSchlick, 2>::NEW,
    &Of::<BeckmannSchlickAnisotropic, 4>::NEW,
    &Of::<GgxConductor, 3>::NEW,
    &Of::<GgxConductorAnisotropic, 5>::NEW,
    &Of::<BeckmannConductor, 3>::NEW,
    &Of::<BeckmannConductorAnisotropic, 5>::NEW,
    &Of::<GgxDielectric, 2>::NEW,
    &Of::<GgxDielectricAnisotropic, 4>::NEW,
    &Of::<BeckmannDielectric, 2>::NEW,
    &Of::<BeckmannDielectricAnisotropic, 4>::NEW,
    &Of::<Abg, 3>::NEW,
    &Of::<AbgTransmission, 3>::NEW,
    &Of::<HarveyShack, 3>::NEW,
    &Of::<HarveyShackTransmission, 3>::NEW,
];

/// Every analytic model: [`families`] and those that have no derivatives. The command line, the docs and every law test
/// run over this list.
pub fn models() -> impl Iterator<Item = &'static dyn Parametric> {
    let fitted = families().iter().map(|f| *f as &dyn Parametric);
    fitted.chain(compensated().iter().map(|c| c as &dyn Parametric))
}

/// The model called `name` among [`families`].
///
/// # Errors
/// [`BsdfError::Domain`] that lists the names there are.
pub fn family(name: &str) -> Result<&'static dyn Family, BsdfError> {
    let found = families().iter().copied().find(|f| f.info().name == name);
    found.ok_or_else(|| unknown(name, families().iter().map(|f| f.info().name)))
}

/// The model called `name` among [`models`].
///
/// # Errors
/// [`BsdfError::Domain`] that lists the names there are.
pub fn model_named(name: &str) -> Result<&'static dyn Parametric, BsdfError> {
    let found = models().find(|m| m.info().name == name);
    found.ok_or_else(|| unknown(name, models().map(|m| m.info().name)))
}

fn unknown(name: &str, known: impl Iterator<Item = &'static str>) -> BsdfError {
    BsdfError::Domain {
        field: "model",
        found: format!("{name:?}"),
        allowed: known.collect::<Vec<_>>().join(", "),
    }
}

#[cfg(test)]
mod tests {
    use std::collections::HashSet;

    use gonio_geom::Direction;

    use super::*;
    use crate::Channel;
    use crate::analytic::Pairs;

    fn pairs() -> Vec<Pairs> {
        (0..101)
            .map(|k| {
                let t = f64::from(k);
                let wi = Direction::from_degrees(7.0 + 1.63 * t, 3.0 * t);
                let mut pairs = Pairs::with_capacity(wi, 3);
                pairs.push(Direction::from_degrees(178.0 - 1.71 * t, 41.0 * t));
                // Near the mirror and the unbent direction, where narrow lobes are.
                let near = wi.rotated(std::f64::consts::PI + 0.003 * t);
                pairs.push(near);
                pairs.push(near.flipped());
                pairs
            })
            .collect()
    }

    #[test]
    fn names_are_unique_and_defaults_are_allowed() {
        let mut names = HashSet::new();
        for f in models() {
            let info = f.info();
            assert!(names.insert(info.name), "{} twice", info.name);
            assert!(
                f.model(&[(Channel::Photopic, info.defaults())]).is_ok(),
                "{}",
                info.name
            );
            assert!(!info.source.is_empty());
        }
        assert!(family("no such model").is_err() && model_named("no such model").is_err());
        assert!(family("ggx-compensated").is_err() && model_named("ggx-compensated").is_ok());
    }

    #[test]
    fn vectorised_values_agree_with_the_models_own() {
        let pairs = pairs();
        for f in families() {
            let p = f.info().defaults();
            let model = f.model(&[(Channel::Photopic, p.clone())]).unwrap();
            let mut lit = 0;
            for pairs in &pairs {
                let mut dsf = vec![f64::NAN; pairs.len()];
                f.dsf(&p, pairs.view(0..pairs.len()), &mut dsf);
                for (j, &got) in dsf.iter().enumerate() {
                    let ws = pairs.ws(j);
                    let want = model.eval_first(pairs.wi(), ws) * ws.cos_theta().abs();
                    assert!(
                        (got - want).abs() <= 1e-11 * want.max(1e-290), // below, exponentials may be 0
                        "{}: {got} {want}",
                        f.info().name
                    );
                    lit += usize::from(want > 0.0);
                }
            }
            assert!(lit > 50, "{}: only {lit} pairs scatter", f.info().name);
        }
    }

    #[test]
    fn gradients_agree_with_central_differences() {
        let pairs = pairs();
        let n: usize = pairs.iter().map(Pairs::len).sum();
        for f in families() {
            let infos = f.info().parameters;
            let p: Vec<f64> = infos
                .iter()
                .enumerate()
                .map(|(k, i)| i.default + 0.02 * (k + 1) as f64 * (i.high - i.default))
                .collect();
            let mut dsf = Vec::with_capacity(n);
            let mut rows = vec![Vec::with_capacity(n); p.len()];
            for pairs in &pairs {
                let mut some = vec![0.0; pairs.len()];
                let mut gradient = vec![0.0; pairs.len() * p.len()];
                f.dsf_and_gradient(&p, pairs.view(0..pairs.len()), &mut some, &mut gradient);
                dsf.extend(some);
                for (row, more) in rows.iter_mut().zip(gradient.chunks_exact(pairs.len())) {
                    row.extend_from_slice(more);
                }
            }
            for (k, row) in rows.iter().enumerate() {
                let h = 1e-6 * p[k].abs().max(1e-2);
                let at = |step: f64| {
                    let mut q = p.clone();
                    q[k] += step;
                    let values = |pairs: &Pairs| {
                        let mut some = vec![0.0; pairs.len()];
                        f.dsf(&q, pairs.view(0..pairs.len()), &mut some);
                        some
                    };
                    pairs.iter().flat_map(values).collect::<Vec<f64>>()
                };
                let (up, down) = (at(h), at(-h));
                let scale = row.iter().fold(0.0_f64, |m, d| m.max(d.abs()));
                // What rounding of the values themselves leaves in a difference quotient.
                let noise = 1e-14 * dsf.iter().fold(0.0_f64, |m, d| m.max(*d)) / h;
                for j in 0..n {
                    let numeric = (up[j] - down[j]) / (2.0 * h);
                    assert!(
                        (row[j] - numeric).abs() <= 1e-6 * scale + 1e-6 * numeric.abs() + noise,
                        "{} by {}: {} {numeric}",
                        f.info().name,
                        infos[k].name,
                        row[j]
                    );
                }
            }
        }
    }
}
