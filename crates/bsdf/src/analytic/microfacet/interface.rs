//! A rough interface between two transparent media.

use std::marker::PhantomData;

use gonio_geom::{DVec3, Direction};

use crate::analytic::slopes::mirrored;
use crate::analytic::{Formula, ModelInfo, Pair, Real};

use super::fresnel::dielectric;
use super::reflection::mirrored_density;
use super::{Catalogued, Distribution, Widths};

/// Facets of a smooth interface that reflect and refract, `eta` the index behind the sample over that in front:
///
/// `f_r = F D G_2 / (4 cos_i cos_s)` and
/// `f_t = |wi.h| |ws.h| eta^2 (1 - F) D G_1(wi) G_1(ws) / (cos_i cos_s (wi.h + eta ws.h)^2)`
/// [Walter2007, eq. 20 and 21], light scattered once, with `1 / eta` for light from the back. Facets that would have to
/// be seen from behind do not transmit [Walter2007, eq. 34, the factor chi]. The masking of transmission is separable:
/// it keeps `G <= G_1` and thereby energy.
///
/// `f` is a ratio of radiance to irradiance, so that `f_t(wi, ws) / n_s^2 = f_t(ws, wi) / n_i^2`.
#[derive(Clone, Copy, Debug)]
pub struct Interface<D, W>(PhantomData<(D, W)>);

/// Prepared parameters.
#[derive(Clone, Copy, Debug)]
pub struct Shape<R, W> {
    /// Index of the far side over that of the side light comes from.
    eta: R,
    widths: W,
}

/// `f_t`; 0 where no visible facet refracts `wi` to `ws`.
#[inline(always)]
fn transmitted<D: Distribution, W: Widths, R: Real>(
    eta: R,
    widths: &W::Shape<R>,
    pair: &Pair<R::Plain>,
) -> R {
    // h = wi + eta ws, not normalised and of either sign: h.h = (wi.h + eta ws.h) |h|.
    let h: [R; 3] = std::array::from_fn(|k| eta.times(pair.ws[k]).plus(pair.wi[k]));
    let length2 = h[0].squared() + h[1].squared() + h[2].squared();
    let dot = pair.dot();
    let up = R::select(h[2].plain(), R::constant(1.0), R::constant(-1.0));
    let facing_i = eta.times(dot).plus(R::Plain::constant(1.0)) * up;
    let facing_s = -(eta.plus(dot) * up);
    let seen = facing_i.min(facing_s).plain();
    let inverse2 = length2.max(R::constant(1e-30)).recip();
    let fresnel = dielectric(eta, facing_i.abs() * inverse2.sqrt());
    let f = facing_i
        * facing_s
        * (inverse2 * eta).squared()
        * (-fresnel + 1.0)
        * D::density_by_parameters::<W, R>(widths, h)
        * D::masking::<W, R>(widths, pair.wi)
        * D::masking::<W, R>(widths, pair.ws);
    R::select(seen, f, R::constant(0.0))
}

#[inline(always)]
fn reflected<D: Distribution, W: Widths, R: Real>(eta: R, widths: &W::Shape<R>, pair: &Pair<R::Plain>) -> R {
    let h = pair.sum();
    let cosine = (h[0] * h[0] + h[1] * h[1] + h[2] * h[2]).sqrt() * 0.5;
    dielectric(eta, R::lift(cosine))
        * D::density::<W, R>(widths, h)
        * D::visibility::<W, R>(widths, pair.wi, pair.ws)
}

impl<D: Distribution, W: Widths> Formula for Interface<D, W>
where
    Self: Catalogued,
{
    const INFO: &'static ModelInfo = Self::ENTRY;
    const SIDED: bool = true;
    type Shape<R: Real> = Shape<R, W::Shape<R>>;

    #[inline(always)]
    fn shape<R: Real>(p: &[R]) -> Self::Shape<R> {
        Shape {
            eta: p[0],
            widths: W::shape(&p[1..]),
        }
    }

    #[inline(always)]
    fn behind<R: Real>(shape: &Self::Shape<R>) -> Self::Shape<R> {
        Shape {
            eta: shape.eta.recip(),
            ..*shape
        }
    }

    fn index_ratio(p: &[f64]) -> f64 {
        p[0]
    }

    #[inline(always)]
    fn bsdf<R: Real>(shape: &Self::Shape<R>, pair: &Pair<R::Plain>) -> R {
        R::select(
            pair.ws[2],
            reflected::<D, W, R>(shape.eta, &shape.widths, pair),
            transmitted::<D, W, R>(shape.eta, &shape.widths, pair),
        )
    }

    fn pdf(shape: &Self::Shape<f64>, w: Direction, s: Direction) -> f64 {
        let (eta, widths) = (shape.eta, &shape.widths);
        if s.cos_theta() > 0.0 {
            let cosine = 0.5 * (w.vec() + s.vec()).length();
            return dielectric(eta, cosine) * mirrored_density::<D, W>(widths, w, s);
        }
        // f_t without the masking of s, times its cosine.
        let pair = Pair::new(w, s);
        let masking: f64 = D::masking::<W, f64>(widths, pair.ws);
        transmitted::<D, W, f64>(eta, widths, &pair) / masking
    }

    /// Reflects or refracts `w` at a visible normal, by the share its Fresnel reflectance says: the weights
    /// `G_2 / G_1(w)` and `G_1(s)` are at most 1.
    fn sample(shape: &Self::Shape<f64>, w: Direction, u: [f64; 3]) -> Option<Direction> {
        let h = D::visible_normal::<W>(&shape.widths, w.vec().to_array(), [u[0], u[1]]);
        let h = DVec3::from_array(h).try_normalize()?;
        let cosine = w.vec().dot(h);
        if cosine <= 0.0 {
            return None;
        }
        if u[2] < dielectric(shape.eta, cosine) {
            return mirrored(w, h);
        }
        // [Walter2007, eq. 40], with the ratio of indices turned over.
        let ratio = 1.0 / shape.eta;
        let far2 = 1.0 - ratio * ratio * (1.0 - cosine * cosine);
        if far2 <= 0.0 {
            return None;
        }
        Direction::new((ratio * cosine - far2.sqrt()) * h - ratio * w.vec()).filter(|s| s.cos_theta() < 0.0)
    }

    fn isotropic(p: &[f64]) -> bool {
        W::isotropic(&p[1..])
    }
}
