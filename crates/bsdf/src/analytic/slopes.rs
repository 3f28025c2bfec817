//! Gaussian facet slopes: the density and the sampler that the Ward lobes share.

use std::f64::consts::PI;

use gonio_geom::{DVec3, Direction};

use super::Real;

/// An elliptic Gaussian of facet slopes with its axes turned by `phi_x`.
#[derive(Clone, Copy, Debug)]
pub struct GaussianSlopes<R> {
    /// Width along the lobe's x axis.
    pub alpha_x: R,
    /// Width along its y axis.
    pub alpha_y: R,
    /// `1 / (pi alpha_x alpha_y)`.
    pub norm: R,
    inverse: (R, R),
    axis: (R, R),
}

impl<R: Real> GaussianSlopes<R> {
    /// Widths `alpha_x`, `alpha_y` and the azimuth of x in radians.
    #[inline(always)]
    pub fn new(alpha_x: R, alpha_y: R, phi_x: R) -> Self {
        let (sin, cos) = phi_x.sin_cos();
        GaussianSlopes {
            alpha_x,
            alpha_y,
            norm: (alpha_x * alpha_y * PI).recip(),
            inverse: (alpha_x.recip(), alpha_y.recip()),
            axis: (cos, sin),
        }
    }

    /// The same width in every azimuth.
    #[inline(always)]
    pub fn isotropic(alpha: R) -> Self {
        GaussianSlopes {
            alpha_x: alpha,
            alpha_y: alpha,
            norm: (alpha.squared() * PI).recip(),
            inverse: (alpha.recip(), alpha.recip()),
            axis: (R::constant(1.0), R::constant(0.0)),
        }
    }

    /// `e / (pi alpha_x alpha_y)`, `e = exp(-((h_x/alpha_x)^2 + (h_y/alpha_y)^2) / h_z^2)`, for `h` of any length.
    #[inline(always)]
    pub fn density(&self, h: [R::Plain; 3]) -> R {
        let (c, s) = self.axis;
        let x = (c.times(h[0]) + s.times(h[1])) * self.inverse.0;
        let y = (c.times(h[1]) - s.times(h[0])) * self.inverse.1;
        let steepness = (x.squared() + y.squared()).times((h[2] * h[2]).recip());
        (-steepness).exp() * self.norm
    }
}

impl<R: Real<Plain = R>> GaussianSlopes<R> {
    /// A facet normal of the distribution, not normalised, `z = 1` [Walter2005, eq. 6 and 7].
    #[inline(always)]
    pub fn normal_lanes(&self, u: [R; 3]) -> [R; 3] {
        // Slopes of a Gaussian: radius sqrt(-ln(1-u)) and an even azimuth, stretched by the two widths.
        let zero = R::constant(0.0);
        let r = (-(R::constant(1.0) - u[0]).ln()).max(zero).sqrt();
        let (sin, cos) = (u[1] * (2.0 * PI)).sin_cos();
        let (x, y) = (self.alpha_x * r * cos, self.alpha_y * r * sin);
        let (c, s) = self.axis;
        [c * x - s * y, s * x + c * y, R::constant(1.0)]
    }

    /// `w` mirrored in a sampled facet, with its density [Walter2005, eq. 9]; 0 when the facet faces away or the mirrored
    /// direction goes below.
    #[inline(always)]
    pub fn mirrored_lanes(&self, w: [R; 3], u: [R; 3]) -> ([R; 3], R) {
        let h = self.normal_lanes(u);
        let (s, facing) = mirror_lanes(w, h);
        let sum = [w[0] + s[0], w[1] + s[1], w[2] + s[2]];
        let pdf = R::select(facing.min(s[2]), self.density_about(sum), R::constant(0.0));
        (s, pdf)
    }

    /// Density of the mirrored direction `s` of `w` when the facet normal is a sampled one, for `h = w + s` with
    /// `h.z > 0`: `e / (4 pi alpha_x alpha_y cos^3(h) (w.h))` [Walter2005, eq. 9].
    #[inline(always)]
    fn density_about(&self, h: [R; 3]) -> R {
        // w.h = |h| / 2 and cos(h) = h.z / |h| for the h that is not normalised.
        let length2 = h[0] * h[0] + h[1] * h[1] + h[2] * h[2];
        self.density(h) * length2 / (h[2] * h[2] * h[2] * 2.0)
    }
}

impl GaussianSlopes<f64> {
    /// A facet normal of the distribution, `z > 0` [Walter2005, eq. 6 and 7].
    pub fn sample(&self, u: [f64; 3]) -> DVec3 {
        DVec3::from_array(self.normal_lanes(u)).normalize()
    }

    /// Density of the mirrored direction `s` of `w` when the facet normal is drawn by [`GaussianSlopes::sample`]
    /// [Walter2005, eq. 9].
    pub fn mirrored_density(&self, w: Direction, s: Direction) -> f64 {
        let h = w.vec() + s.vec();
        if h.z <= 0.0 {
            return 0.0;
        }
        self.density_about(h.to_array())
    }
}

/// `w` mirrored in a facet of normal `h` (of any length), and the cosine between the two times that length.
#[inline(always)]
pub(super) fn mirror_lanes<R: Real<Plain = R>>(w: [R; 3], h: [R; 3]) -> ([R; 3], R) {
    let facing = w[0] * h[0] + w[1] * h[1] + w[2] * h[2];
    let factor = facing * 2.0 / (h[0] * h[0] + h[1] * h[1] + h[2] * h[2]);
    (
        [h[0] * factor - w[0], h[1] * factor - w[1], h[2] * factor - w[2]],
        facing,
    )
}

/// `w` mirrored in a facet of normal `h`; `None` when the facet faces away or the mirrored direction goes below.
pub(super) fn mirrored(w: Direction, h: DVec3) -> Option<Direction> {
    let facing = w.vec().dot(h);
    if facing <= 0.0 {
        return None;
    }
    Direction::new(2.0 * facing * h - w.vec()).filter(|s| s.cos_theta() > 0.0)
}
