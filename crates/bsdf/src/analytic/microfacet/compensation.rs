//! Light scattered between facets, given back as a broad lobe.

use std::f64::consts::PI;
use std::sync::Arc;

use gonio_geom::Direction;

use super::escape::Escape;
use super::fresnel::Fresnel;
use super::quadrature::unit_interval;
use super::{Catalogued, Distribution, Isotropic, Reflection};
use crate::analytic::lambert::{cosine_density, cosine_direction};
use crate::analytic::{Analytic, Formula, ModelInfo, Parametric};
use crate::{Bsdf, BsdfError, Channel, Lobe, Properties, Sample};

/// Facets of one width that reflect, with a second lobe for light that other facets scatter on [KullaConty2017]:
///
/// `f + C (1 - E(wi)) (1 - E(ws)) / (pi (1 - E_mean))`, `C = F_mean^2 E_mean / (1 - F_mean (1 - E_mean))`,
///
/// `E` the albedo of facets that reflect all light, `E_mean` and `F_mean` cosine-weighted means. Facets that reflect
/// all light then lose none; the sum stays reciprocal. `E` is tabulated when the model is made.
pub struct Compensated<D, F>
where
    D: Distribution,
    F: Fresnel,
    Reflection<D, Isotropic, F>: Catalogued,
{
    single: Analytic<Reflection<D, Isotropic, F>>,
    /// One a channel; channels of the same width share the table.
    multiple: Vec<Multiple>,
}

/// The second lobe of one channel.
#[derive(Clone)]
struct Multiple {
    table: Arc<Escape>,
    /// `C`.
    factor: f64,
    /// `F_mean`.
    fresnel: f64,
}

impl<D, F> Compensated<D, F>
where
    D: Distribution,
    F: Fresnel,
    Reflection<D, Isotropic, F>: Catalogued,
{
    /// The model with `parameters`, one list a channel, those of the model without compensation.
    ///
    /// # Errors
    /// As [`Analytic::new`].
    pub fn new(parameters: &[(Channel, Vec<f64>)]) -> Result<Self, BsdfError> {
        let single = Analytic::new(parameters)?;
        let mut multiple: Vec<Multiple> = Vec::with_capacity(parameters.len());
        for (_, p) in parameters {
            let alpha = p[F::N];
            let table = multiple
                .iter()
                .find(|m| m.table.alpha() == alpha)
                .map_or_else(|| Arc::new(Escape::new::<D>(alpha)), |m| m.table.clone());
            let shape = F::shape::<f64>(p);
            let fresnel: f64 = unit_interval()
                .map(|(mu, weight)| 2.0 * weight * mu * F::reflectance::<f64>(&shape, mu))
                .sum();
            let factor = fresnel * fresnel * table.mean() / (1.0 - fresnel * (1.0 - table.mean()));
            multiple.push(Multiple {
                table,
                factor,
                fresnel,
            });
        }
        Ok(Compensated { single, multiple })
    }

    /// The second lobe; 0 unless both directions are on one side.
    fn second(m: &Multiple, wi: Direction, ws: Direction) -> f64 {
        if wi.cos_theta() * ws.cos_theta() <= 0.0 {
            return 0.0;
        }
        let lost = |d: Direction| 1.0 - m.table.at(d.cos_theta().abs());
        let all = 1.0 - m.table.mean();
        if all <= 0.0 {
            return 0.0;
        }
        m.factor * lost(wi) * lost(ws) / (PI * all)
    }

    /// Share of samples that go to the second lobe: about its share of the light.
    fn share(&self, w: Direction) -> f64 {
        let m = &self.multiple[0];
        let e = m.table.at(w.cos_theta().abs());
        let (first, second) = (m.fresnel * e, m.factor * (1.0 - e));
        if second > 0.0 {
            second / (first + second)
        } else {
            0.0
        }
    }
}

impl<D, F> Bsdf for Compensated<D, F>
where
    D: Distribution,
    F: Fresnel,
    Reflection<D, Isotropic, F>: Catalogued,
{
    fn channels(&self) -> &[Channel] {
        self.single.channels()
    }

    fn properties(&self) -> Properties {
        self.single.properties()
    }

    fn eval(&self, wi: Direction, ws: Direction, f: &mut [f64]) {
        self.single.eval(wi, ws, f);
        for (f, m) in f.iter_mut().zip(&self.multiple) {
            *f += Self::second(m, wi, ws);
        }
    }

    fn eval_first(&self, wi: Direction, ws: Direction) -> f64 {
        self.single.eval_first(wi, ws) + Self::second(&self.multiple[0], wi, ws)
    }

    fn pdf(&self, w: Direction, sampled: Direction) -> f64 {
        if w.cos_theta() * sampled.cos_theta() <= 0.0 {
            return 0.0;
        }
        let share = self.share(w);
        let upward = if w.cos_theta() < 0.0 {
            sampled.flipped()
        } else {
            sampled
        };
        (1.0 - share) * self.single.pdf(w, sampled) + share * cosine_density(upward)
    }

    fn sample(&self, w: Direction, u: [f64; 3]) -> Option<Sample> {
        if w.cos_theta() == 0.0 {
            return None;
        }
        let (direction, lobe) = if u[2] < self.share(w) {
            let d = cosine_direction(u)?;
            let d = if w.cos_theta() < 0.0 { d.flipped() } else { d };
            (d, Lobe::Diffuse)
        } else {
            (self.single.sample(w, u)?.direction, Lobe::Glossy)
        };
        let pdf = self.pdf(w, direction);
        let weight = self.eval_first(w, direction) * direction.cos_theta().abs() / pdf;
        (pdf > 0.0 && weight.is_finite()).then_some(Sample {
            direction,
            weight,
            pdf,
            lobe,
        })
    }
}

/// Makes a model of its parameters.
type Build = fn(&[(Channel, Vec<f64>)]) -> Result<Box<dyn Bsdf>, BsdfError>;

/// A compensated model without its parameters. Its table depends on the width, so that it has no derivatives for a fit.
#[derive(Clone, Copy, Debug)]
pub struct CompensatedFamily {
    info: ModelInfo,
    /// The model without compensation, which has the same parameters.
    pub single: &'static ModelInfo,
    build: Build,
}

impl CompensatedFamily {
    const fn new<D, F>(name: &'static str, title: &'static str, source: &'static str) -> Self
    where
        D: Distribution,
        F: Fresnel,
        Reflection<D, Isotropic, F>: Catalogued,
    {
        let single = <Reflection<D, Isotropic, F> as Formula>::INFO;
        CompensatedFamily {
            info: ModelInfo {
                name,
                title,
                source,
                scatters: single.scatters,
                parameters: single.parameters,
                breaks: single.breaks,
            },
            single,
            build: |p| Ok(Box::new(Compensated::<D, F>::new(p)?)),
        }
    }
}

impl Parametric for &'static CompensatedFamily {
    fn info(&self) -> &'static ModelInfo {
        &self.info
    }

    fn model(&self, parameters: &[(Channel, Vec<f64>)]) -> Result<Box<dyn Bsdf>, BsdfError> {
        (self.build)(parameters)
    }
}

/// Every compensated model.
pub fn compensated() -> &'static [&'static CompensatedFamily] {
    use super::{Beckmann, Conductor, Ggx, Schlick};
    // A static, not a constant, which would be compiled anew in each crate that asks for it.
    static ALL: &[&CompensatedFamily] = &[
        &CompensatedFamily::new::<Ggx, Schlick>(
            "ggx-compensated",
            "GGX microfacets, compensated for multiple scattering",
            "KullaConty2017; Walter2007, eq. 20, 33 and 34; Schlick1994",
        ),
        &CompensatedFamily::new::<Beckmann, Schlick>(
            "beckmann-compensated",
            "Beckmann microfacets, compensated for multiple scattering",
            "KullaConty2017; Walter2007, eq. 20, 25 and 26; Schlick1994",
        ),
        &CompensatedFamily::new::<Ggx, Conductor>(
            "ggx-conductor-compensated",
            "GGX microfacets of a conductor, compensated for multiple scattering",
            "KullaConty2017; Walter2007, eq. 20, 33 and 34; BornWolf1999",
        ),
        &CompensatedFamily::new::<Beckmann, Conductor>(
            "beckmann-conductor-compensated",
            "Beckmann microfacets of a conductor, compensated for multiple scattering",
            "KullaConty2017; Walter2007, eq. 20, 25 and 26; BornWolf1999",
        ),
    ];
    ALL
}
