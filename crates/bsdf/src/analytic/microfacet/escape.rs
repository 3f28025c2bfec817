//! The share of light that leaves a surface of lossless facets after one reflection.

use std::f64::consts::FRAC_PI_2;

use super::quadrature::unit_interval;
use super::{Distribution, Isotropic, Widths};

/// That share by the cosine of incidence, tabulated for one width.
///
/// Nowhere below the true share, so that what [`super::Compensated`] gives back is never more than was lost.
pub(super) struct Escape {
    alpha: f64,
    /// At cosines `alpha sinh^2(k step)`: closer towards grazing incidence and below `alpha`, where it varies most.
    share: Vec<f64>,
    step: f64,
    mean: f64,
}

/// Number of intervals of the table.
const INTERVALS: usize = 96;

impl Escape {
    /// The table for facets of width `alpha`.
    pub(super) fn new<D: Distribution>(alpha: f64) -> Self {
        let step = (1.0 / alpha).sqrt().asinh() / INTERVALS as f64;
        let at = |k: f64| escaping::<D>(alpha, (alpha * (k * step).sinh().powi(2)).min(1.0));
        let nodes: Vec<f64> = (0..=INTERVALS).map(|k| at(k as f64)).collect();
        // Where the share is concave a chord runs below it: both ends rise by what is missing in the middle, with a
        // tenth more for what the middle does not show.
        let mut share = nodes.clone();
        for k in 0..INTERVALS {
            let missing = 1.1 * (at(k as f64 + 0.5) - 0.5 * (nodes[k] + nodes[k + 1])).max(0.0);
            for end in [k, k + 1] {
                share[end] = share[end].max(nodes[end] + missing).min(1.0);
            }
        }
        let mut table = Escape {
            alpha,
            share,
            step,
            mean: 0.0,
        };
        table.mean = table.cosine_mean();
        table
    }

    /// The width.
    pub(super) fn alpha(&self) -> f64 {
        self.alpha
    }

    /// The share at `cosine`, from 0 to 1.
    pub(super) fn at(&self, cosine: f64) -> f64 {
        let x = (cosine.clamp(0.0, 1.0) / self.alpha).sqrt().asinh() / self.step;
        let k = (x as usize).min(INTERVALS - 1);
        self.between(k, x - k as f64)
    }

    /// The mean over all incidences, weighted by the cosine.
    pub(super) fn mean(&self) -> f64 {
        self.mean
    }

    fn between(&self, k: usize, t: f64) -> f64 {
        self.share[k] * (1.0 - t) + self.share[k + 1] * t
    }

    /// `2 integral E mu dmu`, that of the interpolant, so that no light is lost to the table.
    fn cosine_mean(&self) -> f64 {
        let mut sum = 0.0;
        for k in 0..INTERVALS {
            for (t, weight) in unit_interval() {
                let x = (k as f64 + t) * self.step;
                sum += weight * self.between(k, t) * x.sinh().powi(3) * x.cosh();
            }
        }
        4.0 * self.alpha * self.alpha * self.step * sum
    }
}

/// The share at `cosine` by quadrature over the slopes of facets.
///
/// A slope of size `r` and azimuth `phi` from the plane of incidence reflects upward when
/// `r < cos phi tan + sqrt(1 + cos^2 phi tan^2)`, `tan` that of the incidence: a disk about `tan` that holds the origin.
/// `E = integral P(r) G_2 (1 + r cos phi tan) r dr dphi` over it, `P` the density of slopes.
fn escaping<D: Distribution>(alpha: f64, cosine: f64) -> f64 {
    let widths = Isotropic::shape::<f64>(&[alpha]);
    let cosine = cosine.max(1e-6);
    let sine = (1.0 - cosine * cosine).max(0.0).sqrt();
    let tan = sine / cosine;
    let w = [sine, 0.0, cosine];
    let mut sum = 0.0;
    // Seen at grazing incidence, facets at right angles to the plane of incidence turn from visible to hidden: nodes
    // crowd there, on both sides.
    for (side, (t, weight)) in [1.0, -1.0]
        .into_iter()
        .flat_map(|s| unit_interval().map(move |n| (s, n)))
    {
        let off = FRAC_PI_2 * t * t;
        let (c, s) = (side * off.sin(), off.cos());
        let across = c * tan;
        let farthest = if across > 0.0 {
            across + across.hypot(1.0)
        } else {
            1.0 / (across.hypot(1.0) - across)
        };
        // r = alpha sinh z.
        let last = (farthest / alpha).min(D::REACH).asinh();
        for (u, share) in unit_interval() {
            let z = u * last;
            let rho = z.sinh();
            let r = alpha * rho;
            let (x, y) = (r * c, r * s);
            // The mirrored direction: 2 (w.h) h / |h|^2 - w with h = (x, y, 1).
            let dot = 2.0 * (sine * x + cosine) / (1.0 + r * r);
            let out = [dot * x - sine, dot * y, dot - cosine];
            if out[2] <= 0.0 {
                continue;
            }
            let visibility: f64 = D::visibility::<Isotropic, f64>(&widths, w, out);
            let masking = 4.0 * visibility * cosine * out[2];
            let density = 2.0 * rho * D::slopes(rho * rho) * z.cosh() * last;
            sum += weight * t * share * density * masking * (1.0 + r * c * tan);
        }
    }
    // Each side: (1 / 2 pi) twice over the angle, off = (pi / 2) t^2, d off = pi t dt.
    sum
}

#[cfg(test)]
mod tests {
    use gonio_geom::{Component, Direction};

    use super::*;
    use crate::analytic::family;
    use crate::analytic::microfacet::{Beckmann, Ggx};
    use crate::{Channel, directional_albedo};

    fn check<D: Distribution>(name: &str) {
        for alpha in [0.005, 0.02, 0.1, 0.3, 0.6, 1.0] {
            let facets = family(name)
                .unwrap()
                .model(&[(Channel::Photopic, vec![1.0, alpha])])
                .unwrap();
            let table = Escape::new::<D>(alpha);
            for degrees in [0.0, 17.0, 43.0, 61.0, 77.0, 84.0, 88.5, 89.7] {
                let w = Direction::from_degrees(degrees, 0.0);
                let exact = directional_albedo(facets.as_ref(), w, Component::Reflection, 0);
                let quadrature = escaping::<D>(alpha, w.cos_theta());
                assert!(
                    (quadrature - exact).abs() < 1e-6,
                    "{name} {alpha}, {degrees} degrees: {quadrature} {exact}"
                );
                let above = table.at(w.cos_theta()) - exact;
                assert!(
                    (-1e-6..1e-3).contains(&above),
                    "{name} {alpha}, {degrees} degrees: {above:e} above"
                );
            }
        }
    }

    #[test]
    fn the_share_is_the_albedo_of_lossless_facets_and_the_table_nowhere_below_it() {
        check::<Ggx>("ggx");
        check::<Beckmann>("beckmann");
    }
}
