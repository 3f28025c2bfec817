//! The transmission lobe of Radiance's trans2, of two widths.

use std::f64::consts::PI;

use gonio_geom::{DVec3, Direction};

use super::{Exemption, Formula, Law, ModelInfo, Pair, ParameterInfo, Real, Scatters, Witness};

/// [`TransmissionLobe`](super::TransmissionLobe) of two widths whose x axis lies at azimuth `phi_x`:
///
/// `f = tau exp(-|d|^2 / alpha_d^2) / (pi alpha_x alpha_y sqrt(cos_i cos_s))`, `d = wi + ws`, the way from the unbent
/// direction to `ws`; `1/alpha_d^2 = (cos(psi)/alpha_x)^2 + (sin(psi)/alpha_y)^2` with `psi` the azimuth of `d` from the
/// lobe's x axis [Radiance, rt/aniso.c].
///
/// The azimuth is that of `d` seen along the normal, so that oblique incidence stretches the wide axis over more of the
/// lobe: the transmittance at normal incidence is below `tau`, and off it above or below by up to a half.
#[derive(Clone, Copy, Debug)]
pub struct AnisotropicTransmissionLobe;

static INFO: ModelInfo = ModelInfo {
    name: "transmission-lobe-anisotropic",
    title: "Gaussian transmission lobe, two widths",
    source: "Radiance",
    scatters: Scatters::Transmission,
    parameters: &[
        ParameterInfo::amplitude("tau", 0.5, "transmitted share"),
        ParameterInfo::width(
            "alpha_x",
            "1/e half width in the scattered direction along x, radians when small",
        ),
        ParameterInfo::width(
            "alpha_y",
            "1/e half width in the scattered direction along y, radians when small",
        ),
        ParameterInfo::axis(),
    ],
    breaks: &[Exemption {
        law: Law::Energy,
        amount: "transmittance 1.16 tau at 45 degrees and 1.45 tau at 75 for alpha_x = .1 in the plane of incidence, alpha_y = .3",
        witness: Witness {
            parameters: &[1.0, 0.1, 0.3, 0.0],
            theta_i: 75.0,
            theta_s: 0.0,
            measured: 1.45,
        },
    }],
};

/// Prepared parameters.
#[derive(Clone, Copy, Debug)]
pub struct Shape<R> {
    alpha: (R, R),
    inverse_square: (R, R),
    peak: R,
    axis: (R, R),
}

impl Formula for AnisotropicTransmissionLobe {
    const INFO: &'static ModelInfo = &INFO;
    type Shape<R: Real> = Shape<R>;

    #[inline(always)]
    fn shape<R: Real>(p: &[R]) -> Shape<R> {
        let (sin, cos) = p[3].sin_cos();
        Shape {
            alpha: (p[1], p[2]),
            inverse_square: (p[1].squared().recip(), p[2].squared().recip()),
            peak: p[0] / (p[1] * p[2] * PI),
            axis: (cos, sin),
        }
    }

    #[inline(always)]
    fn bsdf<R: Real>(shape: &Shape<R>, pair: &Pair<R::Plain>) -> R {
        let d = pair.sum();
        let (c, s) = shape.axis;
        let x = c.times(d[0]) + s.times(d[1]);
        let y = c.times(d[1]) - s.times(d[0]);
        let flat = d[0] * d[0] + d[1] * d[1];
        // |d|^2 / (d_x^2 + d_y^2); d vanishes at the unbent direction, where the sum it multiplies does too.
        let slant = (flat + d[2] * d[2]) / (flat + 1e-200);
        let (ci, cs) = pair.cosines();
        let e = (x.squared() * shape.inverse_square.0 + y.squared() * shape.inverse_square.1).times(slant);
        ((-e).exp() * shape.peak).times((ci * cs).sqrt().recip())
    }

    fn pdf(shape: &Shape<f64>, w: Direction, s: Direction) -> f64 {
        if s.cos_theta() >= 0.0 {
            return 0.0;
        }
        let frame = Frame::new(w);
        let (a, b) = (s.vec().dot(frame.e1), s.vec().dot(frame.e2));
        let r = a.hypot(b);
        let turn = if r > 0.0 { (a / r, b / r) } else { (1.0, 0.0) };
        // 1 - cos of the angle to the unbent direction, without its loss of digits.
        let d = 0.5 * (w.vec() + s.vec()).length_squared();
        let own = frame.turn_density(shape, turn) * fall_density(d, frame.width(shape, turn));
        let wide = fall_density(d, shape.alpha.0.max(shape.alpha.1)) / (2.0 * PI);
        (1.0 - WIDE) * own + WIDE * wide
    }

    fn sample(shape: &Shape<f64>, w: Direction, u: [f64; 3]) -> Option<Direction> {
        let frame = Frame::new(w);
        let (sin, cos) = (2.0 * PI * u[1]).sin_cos();
        let (turn, alpha) = if u[2] < WIDE {
            ((cos, sin), shape.alpha.0.max(shape.alpha.1))
        } else {
            let turn = frame.turn_to(shape, (cos, sin));
            (turn, frame.width(shape, turn))
        };
        let d = -0.5 * alpha * alpha * (1.0 - u[0] * full_sphere(alpha)).ln();
        let sin = (d * (2.0 - d)).max(0.0).sqrt();
        let v = sin * (turn.0 * frame.e1 + turn.1 * frame.e2) - (1.0 - d) * w.vec();
        Direction::new(v).filter(|s| s.cos_theta() < 0.0)
    }

    fn isotropic(p: &[f64]) -> bool {
        p[1] == p[2]
    }
}

/// Share of the samples drawn from a round lobe of the larger width: it bounds the weights far from the lobe's axis,
/// where the width of the direction leaving it and the width of `d` differ.
const WIDE: f64 = 0.1;

/// Integral of a Gaussian of width `alpha` over the whole sphere, in units of `pi alpha^2`.
fn full_sphere(alpha: f64) -> f64 {
    -(-4.0 / (alpha * alpha)).exp_m1()
}

/// Density of `d = 1 - cos(gamma)` in a Gaussian of width `alpha` about the axis.
fn fall_density(d: f64, alpha: f64) -> f64 {
    let a2 = alpha * alpha;
    (-2.0 * d / a2).exp() * 2.0 / (a2 * full_sphere(alpha))
}

/// Directions about the unbent one: `e1` in the plane of incidence, `e2` in the surface. A unit vector
/// `turn = (a, b)` means `a e1 + b e2`; its shadow on the surface is `a cos(theta) p + b q`.
struct Frame {
    e1: DVec3,
    e2: DVec3,
    /// Azimuth of `w` as a unit vector.
    p: (f64, f64),
    cos_theta: f64,
}

impl Frame {
    fn new(w: Direction) -> Self {
        let v = w.vec();
        let sin = v.x.hypot(v.y);
        let p = if sin > 1e-12 {
            (v.x / sin, v.y / sin)
        } else {
            (1.0, 0.0)
        };
        Frame {
            e1: DVec3::new(p.0 * v.z, p.1 * v.z, -sin),
            e2: DVec3::new(-p.1, p.0, 0.0),
            p,
            cos_theta: v.z.max(1e-3),
        }
    }

    /// The shadow of `turn` in the lobe's axes.
    fn shadow(&self, shape: &Shape<f64>, turn: (f64, f64)) -> (f64, f64) {
        let (a, b) = (turn.0 * self.cos_theta, turn.1);
        let (x, y) = (a * self.p.0 - b * self.p.1, a * self.p.1 + b * self.p.0);
        let (c, s) = shape.axis;
        (c * x + s * y, c * y - s * x)
    }

    /// `(x / alpha_x)^2 + (y / alpha_y)^2` of the shadow.
    fn ellipse(shape: &Shape<f64>, (x, y): (f64, f64)) -> f64 {
        x * x * shape.inverse_square.0 + y * y * shape.inverse_square.1
    }

    /// Width of the lobe towards `turn`, in the limit of small angles.
    fn width(&self, shape: &Shape<f64>, turn: (f64, f64)) -> f64 {
        let (x, y) = self.shadow(shape, turn);
        ((x * x + y * y) / Self::ellipse(shape, (x, y))).sqrt()
    }

    /// Density of the angle of `turn` when [`Frame::turn_to`] maps an even circle.
    fn turn_density(&self, shape: &Shape<f64>, turn: (f64, f64)) -> f64 {
        let ellipse = Self::ellipse(shape, self.shadow(shape, turn));
        self.cos_theta / (2.0 * PI * shape.alpha.0 * shape.alpha.1 * ellipse)
    }

    /// The turn whose shadow lies where the circle's point `(cos, sin)` goes when stretched by the two widths.
    fn turn_to(&self, shape: &Shape<f64>, (cos, sin): (f64, f64)) -> (f64, f64) {
        let (x, y) = (shape.alpha.0 * cos, shape.alpha.1 * sin);
        let (c, s) = shape.axis;
        let (x, y) = (c * x - s * y, s * x + c * y);
        let a = (x * self.p.0 + y * self.p.1) / self.cos_theta;
        let b = y * self.p.0 - x * self.p.1;
        let r = a.hypot(b);
        (a / r, b / r)
    }
}

#[cfg(test)]
mod tests {
    use gonio_geom::Component;

    use super::*;
    use crate::albedo::hemispherical_integral;
    use crate::analytic::{Analytic, Spectrum, TransmissionLobe};
    use crate::{Bsdf, directional_albedo};

    fn lobe(alpha_x: f64, alpha_y: f64, phi_x: f64) -> Analytic<AnisotropicTransmissionLobe> {
        Analytic::of(
            &Spectrum::photopic("tau", 1.0).unwrap(),
            &[alpha_x, alpha_y, phi_x],
        )
        .unwrap()
    }

    #[test]
    fn equal_widths_give_the_round_lobe() {
        let round =
            Analytic::<TransmissionLobe>::of(&Spectrum::photopic("tau", 1.0).unwrap(), &[0.2]).unwrap();
        let both = lobe(0.2, 0.2, 0.7);
        for theta in [0.0, 30.0, 80.0] {
            let wi = Direction::from_degrees(theta, 40.0);
            for (t, p) in [
                (180.0 - theta, 220.0),
                (170.0, 10.0),
                (130.0, 200.0),
                (95.0, 220.0),
            ] {
                let ws = Direction::from_degrees(t, p);
                let (f, g) = (round.eval_first(wi, ws), both.eval_first(wi, ws));
                assert!((f - g).abs() <= 1e-12 * f, "{theta} {t} {p}: {f} {g}");
            }
        }
    }

    #[test]
    fn the_density_integrates_to_the_share_of_samples_that_do_not_fail() {
        for (alpha_x, alpha_y, theta) in [(0.05, 0.3, 0.0), (0.3, 0.05, 60.0), (0.1, 0.2, 80.0)] {
            let model = lobe(alpha_x, alpha_y, 0.5);
            let wi = Direction::from_degrees(theta, 20.0);
            let integral =
                hemispherical_integral(wi, gonio_geom::Side::Back, |s| Bsdf::pdf(&model, wi, s)).value;
            let n = 200;
            let mut kept = 0;
            for i in 0..n {
                for j in 0..n {
                    for k in 0..10 {
                        let u = [i, j].map(|v| (f64::from(v) + 0.5) / f64::from(n));
                        let u = [u[0], u[1], (f64::from(k) + 0.5) / 10.0];
                        kept += usize::from(model.sample(wi, u).is_some());
                    }
                }
            }
            let share = kept as f64 / (10 * n * n) as f64;
            assert!((integral - share).abs() < 2e-3, "{theta}: {integral} {share}");
        }
    }

    #[test]
    fn the_transmittance_passes_one_as_the_exemption_says() {
        for (alpha_x, alpha_y, theta, transmittance) in [
            (0.1, 0.3, 0.0, 0.987),
            (0.1, 0.3, 45.0, 1.157),
            (0.1, 0.3, 75.0, 1.447),
            (0.3, 0.1, 75.0, 0.563),
        ] {
            let (model, wi) = (lobe(alpha_x, alpha_y, 0.0), Direction::from_degrees(theta, 0.0));
            let found = directional_albedo(&model, wi, Component::Transmission, 0);
            assert!((found - transmittance).abs() < 1e-3, "{theta}: {found}");
        }
    }
}
