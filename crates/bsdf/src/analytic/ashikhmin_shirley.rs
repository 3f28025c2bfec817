//! The anisotropic Phong model of Ashikhmin and Shirley: a glossy lobe with Fresnel reflection over a diffuse base.

use std::f64::consts::PI;

use gonio_geom::{DVec3, Direction};

use super::lambert::{cosine_density, cosine_direction};
use super::slopes::mirrored;
use super::{Formula, ModelInfo, Pair, ParameterInfo, Real, Scatters};

/// Lobe `f_s` plus diffuse base `f_d` [AshikhminShirley2000]:
///
/// `f_s = sqrt((n_x+1)(n_y+1)) / (8 pi) h_z^((n_x h_x^2 + n_y h_y^2) / (1 - h_z^2)) F(h.wi) / ((h.wi) max(cos_i, cos_s))`,
/// `F(c) = f0 + (1 - f0)(1 - c)^5`,
/// `f_d = 28 rho_d / (23 pi) (1 - f0) (1 - (1 - cos_i/2)^5) (1 - (1 - cos_s/2)^5)`.
///
/// The paper's exponents are given as widths, `n = 2 / alpha^2 - 1` ([`exponent`]), so that the peak of the half
/// vectors' density `(n + 1) / (2 pi)` is that of a Gaussian of slopes, `1 / (pi alpha^2)`.
#[derive(Clone, Copy, Debug)]
pub struct AshikhminShirley;

/// [`AshikhminShirley`] of one width in every azimuth.
#[derive(Clone, Copy, Debug)]
pub struct AshikhminShirleyIsotropic;

/// The paper's exponent `n = 2 / alpha^2 - 1` of a width `alpha` in `(0, sqrt 2]`.
pub fn exponent(alpha: f64) -> f64 {
    2.0 / (alpha * alpha) - 1.0
}

/// The width `alpha = sqrt(2 / (n + 1))` of the paper's exponent `n >= 0`.
pub fn width(exponent: f64) -> f64 {
    (2.0 / (exponent + 1.0)).sqrt()
}

const RHO_D: ParameterInfo = ParameterInfo::amplitude(
    "rho_d",
    0.5,
    "scale of the diffuse base; its albedo at normal incidence is 31/32 of rho_d (1 - f0)",
);
const F0: ParameterInfo = ParameterInfo::amplitude("f0", 0.05, "Fresnel reflectance at normal incidence");

static ANISOTROPIC: ModelInfo = ModelInfo {
    name: "ashikhmin-shirley-anisotropic",
    title: "Ashikhmin-Shirley, two widths",
    source: "AshikhminShirley2000",
    scatters: Scatters::Reflection,
    parameters: &[
        RHO_D,
        F0,
        ParameterInfo::width("alpha_x", "width along x, sqrt(2 / (n_u + 1))"),
        ParameterInfo::width("alpha_y", "width along y, sqrt(2 / (n_v + 1))"),
        ParameterInfo::axis(),
    ],
    breaks: &[],
};

static ISOTROPIC: ModelInfo = ModelInfo {
    name: "ashikhmin-shirley",
    title: "Ashikhmin-Shirley",
    source: "AshikhminShirley2000",
    scatters: Scatters::Reflection,
    parameters: &[
        RHO_D,
        F0,
        ParameterInfo::width("alpha", "width of the half vectors, sqrt(2 / (n + 1))"),
    ],
    breaks: &[],
};

/// Prepared parameters.
#[derive(Clone, Copy, Debug)]
pub struct Shape<R> {
    /// `28 rho_d (1 - f0) / (23 pi)`.
    base: R,
    f0: R,
    /// `1 / (pi alpha_x alpha_y)`, the peak density of half vectors.
    peak: R,
    /// The exponents.
    n: (R, R),
    /// Cosine and sine of the x axis' azimuth.
    axis: (R, R),
}

impl<R: Real> Shape<R> {
    #[inline(always)]
    fn new(rho_d: R, f0: R, alpha: (R, R), axis: (R, R)) -> Self {
        let n = |alpha: R| alpha.squared().recip() * 2.0 - 1.0;
        Shape {
            base: rho_d * (-f0 + 1.0) * (28.0 / (23.0 * PI)),
            f0,
            peak: (alpha.0 * alpha.1 * PI).recip(),
            n: (n(alpha.0), n(alpha.1)),
            axis,
        }
    }

    /// Density of half vectors per unit solid angle for `h` of any length:
    /// `h_z^(n_x cos^2 + n_y sin^2) / (pi alpha_x alpha_y)` with the azimuth of `h` from the x axis.
    #[inline(always)]
    fn density(&self, h: [R::Plain; 3]) -> R {
        let (c, s) = self.axis;
        let x = c.times(h[0]) + s.times(h[1]);
        let y = c.times(h[1]) - s.times(h[0]);
        let flat = h[0] * h[0] + h[1] * h[1];
        // ln(h_z) = -ln(1 + tan^2)/2; the azimuth has no weight where flat is 0, and 1e-30 vanishes elsewhere.
        let ln_z = (flat / (h[2] * h[2])).ln_1p() * -0.5;
        let power = (self.n.0 * x.squared() + self.n.1 * y.squared()).times(ln_z / (flat + 1e-30));
        power.exp() * self.peak
    }
}

#[inline(always)]
fn fifth<R: Real>(x: R) -> R {
    let square = x * x;
    square * square * x
}

#[inline(always)]
fn both<R: Real>(shape: &Shape<R>, pair: &Pair<R::Plain>) -> R {
    let h = pair.sum();
    let (ci, cs) = pair.cosines();
    // h.wi of the unit half vector is half the length of wi + ws.
    let cosine = (h[0] * h[0] + h[1] * h[1] + h[2] * h[2]).sqrt() * 0.5;
    let fresnel = shape.f0 + (-shape.f0 + 1.0).times(fifth(-cosine + 1.0));
    let lobe = (shape.density(h) * fresnel).times((cosine * ci.max(cs) * 4.0).recip());
    // 1 - (1 - x)^5, x = c / 2, multiplied out: nothing cancels at grazing.
    let fades = |c: R::Plain| {
        let x = c * 0.5;
        x * (x * (x * (x * (x - 5.0) + 10.0) - 10.0) + 5.0)
    };
    lobe + shape.base.times(fades(ci) * fades(cs))
}

/// How often the lobe is drawn rather than the base, for light from `w`: by the Fresnel reflectance at `w` against
/// `rho_d (1 - f0)`.
fn lobe_share(shape: &Shape<f64>, w: Direction) -> f64 {
    let lobe = shape.f0 + (1.0 - shape.f0) * fifth(1.0 - w.cos_theta());
    let base = shape.base * (23.0 * PI / 28.0);
    if lobe + base > 0.0 {
        (lobe / (lobe + base))
            .max(0.02)
            .min(if base > 0.0 { 0.98 } else { 1.0 })
    } else {
        1.0
    }
}

/// The density of [`draw`]; that of the lobe is [AshikhminShirley2000].
fn density(shape: &Shape<f64>, w: Direction, s: Direction) -> f64 {
    let share = lobe_share(shape, w);
    let h = w.vec() + s.vec();
    share * shape.density(h.to_array()) / (2.0 * h.length()) + (1.0 - share) * cosine_density(s)
}

/// The base by cosine, the lobe by its half vectors [AshikhminShirley2000], in every quadrant.
fn draw(shape: &Shape<f64>, w: Direction, u: [f64; 3]) -> Option<Direction> {
    if u[2] >= lobe_share(shape, w) {
        return cosine_direction(u);
    }
    let (sin, cos) = (2.0 * PI * u[0]).sin_cos();
    let stretched = ((shape.n.0 + 1.0).sqrt() * sin).atan2((shape.n.1 + 1.0).sqrt() * cos);
    let (y, x) = stretched.sin_cos();
    let power = shape.n.0 * x * x + shape.n.1 * y * y + 1.0;
    let ln_z = (1.0 - u[1]).ln() / power;
    let r = (-(2.0 * ln_z).exp_m1()).max(0.0).sqrt();
    let (c, s) = shape.axis;
    let h = DVec3::new((c * x - s * y) * r, (s * x + c * y) * r, ln_z.exp());
    mirrored(w, h)
}

macro_rules! formula {
    ($t:ty, $info:ident, $shape:expr) => {
        impl Formula for $t {
            const INFO: &'static ModelInfo = &$info;
            type Shape<R: Real> = Shape<R>;

            #[inline(always)]
            fn shape<R: Real>(p: &[R]) -> Shape<R> {
                let shape: fn(&[R]) -> Shape<R> = $shape;
                shape(p)
            }

            #[inline(always)]
            fn bsdf<R: Real>(shape: &Shape<R>, pair: &Pair<R::Plain>) -> R {
                both(shape, pair)
            }

            fn pdf(shape: &Shape<f64>, w: Direction, s: Direction) -> f64 {
                density(shape, w, s)
            }

            fn sample(shape: &Shape<f64>, w: Direction, u: [f64; 3]) -> Option<Direction> {
                draw(shape, w, u)
            }

            fn isotropic(p: &[f64]) -> bool {
                p.len() < 5 || p[2] == p[3]
            }
        }
    };
}
formula!(AshikhminShirley, ANISOTROPIC, |p| {
    let (sin, cos) = p[4].sin_cos();
    Shape::new(p[0], p[1], (p[2], p[3]), (cos, sin))
});
formula!(AshikhminShirleyIsotropic, ISOTROPIC, |p| {
    Shape::new(p[0], p[1], (p[2], p[2]), (R::constant(1.0), R::constant(0.0)))
});

#[cfg(test)]
mod tests {
    use super::super::Fast;
    use super::*;

    #[test]
    fn widths_and_exponents_are_inverse() {
        for n in [0.0, 1.0, 10.0, 1e3, 1e5] {
            assert!((exponent(width(n)) - n).abs() <= 1e-12 * (n + 1.0));
        }
    }

    #[test]
    fn the_lobe_is_the_papers_with_its_exponents() {
        let (n_u, n_v, f0) = (10.0_f64, 1000.0_f64, 0.2);
        let p = [0.0, f0, width(n_u), width(n_v), 0.3];
        let shape = <AshikhminShirley as Formula>::shape::<f64>(&p);
        for (ti, ts, phi) in [(30.0, 40.0, 170.0), (70.0, 60.0, 200.0), (5.0, 5.0, 90.0)] {
            let (wi, ws) = (
                Direction::from_degrees(ti, 10.0),
                Direction::from_degrees(ts, phi),
            );
            let h = (wi.vec() + ws.vec()).normalize();
            let u = DVec3::new(0.3f64.cos(), 0.3f64.sin(), 0.0);
            let (hu, hv) = (h.dot(u), h.dot(DVec3::Z.cross(u)));
            let c = h.dot(wi.vec());
            let fresnel = f0 + (1.0 - f0) * (1.0 - c).powi(5);
            let power = (n_u * hu * hu + n_v * hv * hv) / (1.0 - h.z * h.z);
            let want = ((n_u + 1.0) * (n_v + 1.0)).sqrt() / (8.0 * PI) * h.z.powf(power) * fresnel
                / (c * wi.cos_theta().max(ws.cos_theta()));
            let got = both(&shape, &Pair::new(wi, ws));
            assert!((got / want - 1.0).abs() < 1e-11, "{got} {want}");
        }
    }

    #[test]
    fn single_precision_keeps_the_digits_of_a_narrow_lobe() {
        let p = [0.0, 0.1, 0.002];
        let double = <AshikhminShirleyIsotropic as Formula>::shape::<f64>(&p);
        let single = p.map(|v| Fast(v as f32));
        let single = <AshikhminShirleyIsotropic as Formula>::shape::<Fast<f32>>(&single);
        for off in [0.0_f64, 1e-3, 2e-3, 4e-3] {
            // Directions that single precision holds exactly, off the normal by twice the facet.
            let x = f64::from(off as f32);
            let (wi, ws) = ([x, 0.0, 1.0], [x, 0.0, 1.0]);
            let want = both(&double, &Pair { wi, ws });
            let narrow = |v: [f64; 3]| v.map(|c| Fast(c as f32));
            let got = both(
                &single,
                &Pair {
                    wi: narrow(wi),
                    ws: narrow(ws),
                },
            );
            assert!(
                (f64::from(got.0) / want - 1.0).abs() < 2e-5,
                "{off}: {got:?} {want}"
            );
        }
    }
}
