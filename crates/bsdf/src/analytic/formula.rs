//! A model as one formula; everything else is derived from it.

use gonio_geom::Direction;

use super::{ModelInfo, Pair, Real};

/// A scattering model written once, for every number type: evaluation, vectorised evaluation, derivatives, sampling
/// and the registry entry follow from it.
///
/// A formula sees pairs with `wi.z > 0`. For light from the back the caller mirrors the pair in the sample plane and
/// prepares the parameters with [`Formula::behind`], unless both sides are alike. The caller keeps it from directions
/// on the horizon and on the side it does not scatter to; there it may return anything.
pub trait Formula: Send + Sync + 'static {
    /// The model as data.
    const INFO: &'static ModelInfo;

    /// What can be prepared from the parameters alone.
    type Shape<R: Real>: Copy + Send + Sync;

    /// Prepares parameters `p`, in the order of [`ModelInfo::parameters`].
    fn shape<R: Real>(p: &[R]) -> Self::Shape<R>;

    /// Whether the two sides of the sample differ; [`Formula::behind`] then says how.
    const SIDED: bool = false;

    /// The prepared parameters as light from the back sees them.
    fn behind<R: Real>(shape: &Self::Shape<R>) -> Self::Shape<R> {
        *shape
    }

    /// Refractive index behind the sample over that in front of it; 1 for a sample in air. Transmission is reciprocal
    /// in `f / n_s^2`, `n_s` the index on the side of `ws`.
    fn index_ratio(_p: &[f64]) -> f64 {
        1.0
    }

    /// `f` in 1/sr. Mark it `#[inline(always)]`: loops over readings vectorise it.
    fn bsdf<R: Real>(shape: &Self::Shape<R>, pair: &Pair<R::Plain>) -> R;

    /// Density per unit solid angle with which [`Formula::sample`] returns `s`, given `w` with `w.z > 0`; 0 where it
    /// never does.
    fn pdf(shape: &Self::Shape<f64>, w: Direction, s: Direction) -> f64;

    /// Samples the other direction given `w` with `w.z > 0` and `u` in `[0, 1)^3`; `None` is a failed sample.
    fn sample(shape: &Self::Shape<f64>, w: Direction, u: [f64; 3]) -> Option<Direction>;

    /// Whether the model with parameters `p` depends on `phi_s - phi_i` only.
    fn isotropic(_p: &[f64]) -> bool {
        true
    }

    /// Whether samples count as [`crate::Lobe::Diffuse`]; otherwise they are glossy.
    const DIFFUSE: bool = false;

    /// Whether [`Formula::sample_lanes`] is there; otherwise batches are sampled one by one.
    const SAMPLES_LANES: bool = false;

    /// [`Formula::sample`] and its [`Formula::pdf`] without branches: the same direction from the same `u`. A failed
    /// sample has density 0 and any direction. Mark it `#[inline(always)]`.
    fn sample_lanes<R: Real<Plain = R>>(_shape: &Self::Shape<R>, w: [R; 3], _u: [R; 3]) -> ([R; 3], R) {
        (w, R::constant(0.0))
    }
}
