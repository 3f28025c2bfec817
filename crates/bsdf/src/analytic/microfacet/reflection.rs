//! Facets that reflect.

use std::marker::PhantomData;

use gonio_geom::{DVec3, Direction};

use crate::analytic::slopes::{mirror_lanes, mirrored};
use crate::analytic::{Formula, ModelInfo, Pair, Real};

use super::{Catalogued, Distribution, Fresnel, Widths};

/// Mirror facets: `f = F D G_2 / (4 cos_i cos_s)` [Walter2007, eq. 20], light scattered once.
///
/// Parameters: those of the Fresnel reflectance `F`, then those of the widths.
#[derive(Clone, Copy, Debug)]
pub struct Reflection<D, W, F>(PhantomData<(D, W, F)>);

/// Prepared parameters.
#[derive(Clone, Copy, Debug)]
pub struct Shape<F, W> {
    /// Of the Fresnel reflectance.
    pub fresnel: F,
    /// Of the distribution.
    pub widths: W,
}

/// Density of the direction mirrored in a normal of [`Distribution::visible_normal`]: `G_1(w) D / (4 cos_w)`.
pub(super) fn mirrored_density<D: Distribution, W: Widths>(
    widths: &W::Shape<f64>,
    w: Direction,
    s: Direction,
) -> f64 {
    let h = w.vec() + s.vec();
    if s.cos_theta() <= 0.0 || h.z <= 0.0 {
        return 0.0;
    }
    let density: f64 = D::density::<W, f64>(widths, h.to_array());
    0.25 * D::masking::<W, f64>(widths, w.vec().to_array()) * density
}

impl<D: Distribution, W: Widths, F: Fresnel> Formula for Reflection<D, W, F>
where
    Self: Catalogued,
{
    const INFO: &'static ModelInfo = Self::ENTRY;
    type Shape<R: Real> = Shape<F::Shape<R>, W::Shape<R>>;

    #[inline(always)]
    fn shape<R: Real>(p: &[R]) -> Self::Shape<R> {
        Shape {
            fresnel: F::shape(p),
            widths: W::shape(&p[F::N..]),
        }
    }

    #[inline(always)]
    fn bsdf<R: Real>(shape: &Self::Shape<R>, pair: &Pair<R::Plain>) -> R {
        let h = pair.sum();
        // wi.h / |h| = |h| / 2.
        let cosine = (h[0] * h[0] + h[1] * h[1] + h[2] * h[2]).sqrt() * 0.5;
        F::reflectance::<R>(&shape.fresnel, cosine)
            * D::density::<W, R>(&shape.widths, h)
            * D::visibility::<W, R>(&shape.widths, pair.wi, pair.ws)
    }

    fn pdf(shape: &Self::Shape<f64>, w: Direction, s: Direction) -> f64 {
        mirrored_density::<D, W>(&shape.widths, w, s)
    }

    /// Mirrors `w` in a visible normal: the weight `F G_2 / G_1` is at most 1.
    fn sample(shape: &Self::Shape<f64>, w: Direction, u: [f64; 3]) -> Option<Direction> {
        let h = D::visible_normal::<W>(&shape.widths, w.vec().to_array(), [u[0], u[1]]);
        mirrored(w, DVec3::from_array(h).try_normalize()?)
    }

    const SAMPLES_LANES: bool = D::LANES;

    #[inline(always)]
    fn sample_lanes<R: Real<Plain = R>>(shape: &Self::Shape<R>, w: [R; 3], u: [R; 3]) -> ([R; 3], R) {
        let h = D::visible_normal_lanes::<W, R>(&shape.widths, w, [u[0], u[1]]);
        let (s, facing) = mirror_lanes(w, h);
        let density = D::density::<W, R>(&shape.widths, h) * D::masking::<W, R>(&shape.widths, w) * 0.25;
        (s, R::select(facing.min(s[2]), density, R::constant(0.0)))
    }

    fn isotropic(p: &[f64]) -> bool {
        W::isotropic(&p[F::N..])
    }
}
