//! What a distribution of facet normals answers.

use crate::analytic::Real;

use super::Widths;

/// A distribution of facet normals whose density depends on the slope in units of its widths, with the masking of
/// [Smith1967] that belongs to it.
pub trait Distribution: Copy + Send + Sync + std::fmt::Debug + 'static {
    /// Slope in units of the widths beyond which there are no facets in double precision.
    const REACH: f64 = f64::INFINITY;

    /// `pi alpha_x alpha_y` times the density of slopes at squared slope `q` in units of the widths; 1 at `q = 0`.
    fn slopes<R: Real>(q: R) -> R;

    /// `G_1(v) / |cos theta|` for `v` on either side, with the exact Smith masking
    /// `G_1 = 1 / (1 + Lambda)` [Walter2007, eq. 23; Heitz2014, eq. 43].
    fn masking<W: Widths, R: Real>(widths: &W::Shape<R>, v: [R::Plain; 3]) -> R;

    /// `G_2 / (4 cos_i cos_s)` for two directions of one side with the height-correlated masking
    /// `G_2 = 1 / (1 + Lambda_i + Lambda_s)` [Heitz2014, eq. 99].
    fn visibility<W: Widths, R: Real>(widths: &W::Shape<R>, wi: [R::Plain; 3], ws: [R::Plain; 3]) -> R;

    /// A facet normal with the density `G_1(w) D(h) (w.h) / cos_w` of those visible from `w` (`w.z > 0`), `u` in
    /// `[0, 1)`. Not normalised, `z >= 0`.
    fn visible_normal<W: Widths>(widths: &W::Shape<f64>, w: [f64; 3], u: [f64; 2]) -> [f64; 3];

    /// Whether [`Distribution::visible_normal_lanes`] is there.
    const LANES: bool = false;

    /// [`Distribution::visible_normal`] without branches.
    #[inline(always)]
    fn visible_normal_lanes<W: Widths, R: Real<Plain = R>>(
        _widths: &W::Shape<R>,
        w: [R; 3],
        _u: [R; 2],
    ) -> [R; 3] {
        w
    }

    /// The density `D` of normals per unit solid angle for `h` of any length, `h.z != 0` [Walter2007, eq. 25 and 33
    /// for one width].
    #[inline(always)]
    fn density<W: Widths, R: Real>(widths: &W::Shape<R>, h: [R::Plain; 3]) -> R {
        let cosine2 = h[2] * h[2];
        let inverse = cosine2.recip();
        let length2 = h[0] * h[0] + h[1] * h[1] + cosine2;
        let q = W::squeezed(widths, h).times(inverse);
        let jacobian = length2 * inverse;
        (Self::slopes(q) * W::norm(widths)).times(jacobian * jacobian)
    }

    /// [`Distribution::density`] for a normal that depends on the parameters; `h.z` above 1e-12 in size.
    #[inline(always)]
    fn density_by_parameters<W: Widths, R: Real>(widths: &W::Shape<R>, h: [R; 3]) -> R {
        let cosine2 = h[2].squared();
        let inverse = cosine2.max(R::constant(1e-24)).recip();
        let length2 = h[0].squared() + h[1].squared() + cosine2;
        let q = W::squeezed_by_parameters(widths, h) * inverse;
        Self::slopes(q) * W::norm(widths) * (length2 * inverse).squared()
    }
}

/// `v` of unit length.
pub(super) fn unit(v: [f64; 3]) -> [f64; 3] {
    let r = 1.0 / (v[0] * v[0] + v[1] * v[1] + v[2] * v[2]).sqrt();
    v.map(|c| c * r)
}
