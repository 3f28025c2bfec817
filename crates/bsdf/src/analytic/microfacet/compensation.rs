//! Light scattered between facets, given back as a broad lobe.

use std::f64::consts::PI;
use std::sync::Arc;

use gonio_geom::{DVec3, Direction};

use super::fresnel::Fresnel;
use super::quadrature::unit_interval;
use super::{Catalogued, Distribution, Isotropic, Reflection, Widths};
use crate::analytic::lambert::{cosine_density, cosine_direction};
use crate::analytic::{Analytic, Formula, ModelInfo};
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

/// The albedo of lossless facets by the cosine of incidence.
struct Escape {
    alpha: f64,
    /// At cosines `(k / LAST)^2`, closer where it varies more.
    albedo: Vec<f64>,
    mean: f64,
}

const LAST: usize = 96;

impl Escape {
    fn new<D: Distribution>(alpha: f64) -> Self {
        let widths = Isotropic::shape::<f64>(&[alpha]);
        let albedo = (0..=LAST)
            .map(|k| {
                let cosine = (k as f64 / LAST as f64).powi(2).max(1e-6);
                let w = [(1.0 - cosine * cosine).max(0.0).sqrt(), 0.0, cosine];
                let masking: f64 = D::masking::<Isotropic, f64>(&widths, w);
                D::visible_mean::<Isotropic>(&widths, w, |h| {
                    let s = -DVec3::from_array(w).reflect(DVec3::from_array(h));
                    if s.z <= 0.0 {
                        return 0.0;
                    }
                    // G_2 / G_1(w).
                    let visibility: f64 = D::visibility::<Isotropic, f64>(&widths, w, s.to_array());
                    4.0 * s.z * visibility / masking
                })
                .min(1.0)
            })
            .collect();
        let mut table = Escape {
            alpha,
            albedo,
            mean: 0.0,
        };
        table.mean = table.cosine_mean();
        table
    }

    fn at(&self, cosine: f64) -> f64 {
        let x = cosine.clamp(0.0, 1.0).sqrt() * LAST as f64;
        let k = (x as usize).min(LAST - 1);
        let t = x - k as f64;
        self.albedo[k] * (1.0 - t) + self.albedo[k + 1] * t
    }

    /// `2 integral E mu dmu`, exactly that of the interpolant, so that no light is lost to the table.
    fn cosine_mean(&self) -> f64 {
        // E is linear in x between nodes and mu = x^2: 4 integral E x^3 dx.
        let h = 1.0 / LAST as f64;
        let mut sum = 0.0;
        for k in 0..LAST {
            for (t, weight) in unit_interval() {
                let x = (k as f64 + t) * h;
                let e = self.albedo[k] * (1.0 - t) + self.albedo[k + 1] * t;
                sum += weight * h * 4.0 * e * x * x * x;
            }
        }
        sum
    }
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
                .find(|m| m.table.alpha == alpha)
                .map_or_else(|| Arc::new(Escape::new::<D>(alpha)), |m| m.table.clone());
            let shape = F::shape::<f64>(p);
            let fresnel: f64 = unit_interval()
                .map(|(mu, weight)| 2.0 * weight * mu * F::reflectance::<f64>(&shape, mu))
                .sum();
            let factor = fresnel * fresnel * table.mean / (1.0 - fresnel * (1.0 - table.mean));
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
        let all = 1.0 - m.table.mean;
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

/// A compensated model without its parameters. It is not in [`crate::analytic::families`]: its table depends on the
/// width, so that it has no derivatives for a fit.
#[derive(Clone, Copy, Debug)]
pub struct CompensatedFamily {
    /// Name in files and on the command line.
    pub name: &'static str,
    /// The model without compensation, which has the same parameters.
    pub single: &'static ModelInfo,
    build: Build,
}

impl CompensatedFamily {
    const fn new<D, F>(name: &'static str) -> Self
    where
        D: Distribution,
        F: Fresnel,
        Reflection<D, Isotropic, F>: Catalogued,
    {
        CompensatedFamily {
            name,
            single: <Reflection<D, Isotropic, F> as Formula>::INFO,
            build: |p| Ok(Box::new(Compensated::<D, F>::new(p)?)),
        }
    }

    /// The model with `parameters`, one list a channel.
    ///
    /// # Errors
    /// As [`Analytic::new`].
    pub fn model(&self, parameters: &[(Channel, Vec<f64>)]) -> Result<Box<dyn Bsdf>, BsdfError> {
        (self.build)(parameters)
    }
}

/// Every compensated model.
pub fn compensated() -> &'static [CompensatedFamily] {
    use super::{Beckmann, Conductor, Ggx, Schlick};
    const ALL: &[CompensatedFamily] = &[
        CompensatedFamily::new::<Ggx, Schlick>("ggx-compensated"),
        CompensatedFamily::new::<Beckmann, Schlick>("beckmann-compensated"),
        CompensatedFamily::new::<Ggx, Conductor>("ggx-conductor-compensated"),
        CompensatedFamily::new::<Beckmann, Conductor>("beckmann-conductor-compensated"),
    ];
    ALL
}
