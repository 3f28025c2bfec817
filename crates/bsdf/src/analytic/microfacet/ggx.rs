//! The GGX (Trowbridge-Reitz) distribution of facet normals.

use std::f64::consts::PI;

use crate::analytic::Real;

use super::{Distribution, Widths};

/// `D = 1 / (pi alpha_x alpha_y ((h_x/alpha_x)^2 + (h_y/alpha_y)^2 + h_z^2)^2)`, `Lambda = (sqrt(1 + 1/a^2) - 1) / 2`
/// with `a = cos / sqrt((alpha_x v_x)^2 + (alpha_y v_y)^2)` [Walter2007, eq. 33 and 34; Heitz2014, eq. 85 and 86 for two
/// widths].
#[derive(Clone, Copy, Debug)]
pub struct Ggx;

/// `|cos| sqrt(1 + 1/a^2)`: the length of `v` stretched by the widths.
#[inline(always)]
fn reach<W: Widths, R: Real>(widths: &W::Shape<R>, v: [R::Plain; 3]) -> R {
    W::stretched(widths, v).plus(v[2] * v[2]).sqrt()
}

impl Distribution for Ggx {
    #[inline(always)]
    fn slopes<R: Real>(q: R) -> R {
        (q + 1.0).squared().recip()
    }

    /// `(|h|^2 / ((h_x/alpha_x)^2 + (h_y/alpha_y)^2 + h_z^2))^2 / (pi alpha_x alpha_y)`: one division.
    #[inline(always)]
    fn density<W: Widths, R: Real>(widths: &W::Shape<R>, h: [R::Plain; 3]) -> R {
        let z2 = h[2] * h[2];
        let length2 = h[0] * h[0] + h[1] * h[1] + z2;
        let squeezed = W::squeezed(widths, h).plus(z2);
        W::norm(widths) * squeezed.recip().times(length2).squared()
    }

    #[inline(always)]
    fn masking<W: Widths, R: Real>(widths: &W::Shape<R>, v: [R::Plain; 3]) -> R {
        reach::<W, R>(widths, v).plus(v[2].abs()).recip() * 2.0
    }

    #[inline(always)]
    fn visibility<W: Widths, R: Real>(widths: &W::Shape<R>, wi: [R::Plain; 3], ws: [R::Plain; 3]) -> R {
        let (ci, cs) = (wi[2].abs(), ws[2].abs());
        let sum = reach::<W, R>(widths, wi).times(cs) + reach::<W, R>(widths, ws).times(ci);
        sum.recip() * 0.5
    }

    fn visible_normal<W: Widths>(widths: &W::Shape<f64>, w: [f64; 3], u: [f64; 2]) -> [f64; 3] {
        Ggx::visible_normal_lanes::<W, f64>(widths, w, u)
    }

    const LANES: bool = true;

    /// By spherical caps [DupuyBenyoub2023, listing 3].
    #[inline(always)]
    fn visible_normal_lanes<W: Widths, R: Real<Plain = R>>(
        widths: &W::Shape<R>,
        w: [R; 3],
        u: [R; 2],
    ) -> [R; 3] {
        let v = W::stretch(widths, w);
        let r = (v[0] * v[0] + v[1] * v[1] + v[2] * v[2]).sqrt().recip();
        let v = [v[0] * r, v[1] * r, v[2] * r];
        // A point of the cap of the unit sphere that is seen from v, evenly: z in (-v_z, 1]. Written so that neither
        // z + v_z nor 1 - z^2 cancels, and that small u, which make steep facets, count with all their digits.
        let rise = v[2] + 1.0;
        let height = u[1] * rise;
        let sine = ((R::constant(1.0) - u[1]) * rise * (height + 1.0 - v[2])).sqrt();
        let (s, c) = (u[0] * (2.0 * PI)).sin_cos();
        W::unstretch(widths, [sine * c + v[0], sine * s + v[1], height])
    }
}
