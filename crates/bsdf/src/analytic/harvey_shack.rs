//! The Harvey-Shack lobe of polished surfaces, in reflection and in transmission.

use std::f64::consts::PI;

use gonio_geom::Direction;

use super::shift_invariant::{
    Radial, density, draw, info, parameters, power_integral, power_integral_inverse, shift_squared,
};
use super::{Formula, ModelInfo, Pair, Real, Scatters};

/// The three-parameter model of a polished surface:
///
/// `f = b_0 (1 + (|beta - beta_0| / L)^2)^(-g/2)` [Harvey1976], with directions as in [`Abg`](super::Abg). Harvey's
/// slope is `S = -g` and his knee `L` is `roll_off`; `b_0` follows from `rho`, see [`peak`]. The albedo falls from
/// `rho` at normal incidence with `theta_i`.
#[derive(Clone, Copy, Debug)]
pub struct HarveyShack;

/// [`HarveyShack`] in transmission; `tau` is its directional-hemispherical transmittance at normal incidence.
#[derive(Clone, Copy, Debug)]
pub struct HarveyShackTransmission;

const MEANING: &str = "shift in direction cosines at which f is 2^(-g/2) of its peak, Harvey's L";

static REFLECTION: ModelInfo = info(
    "harvey-shack",
    "Harvey-Shack",
    "Harvey1976",
    Scatters::Reflection,
    &parameters("rho", "reflectance at normal incidence", MEANING),
);

static TRANSMISSION: ModelInfo = info(
    "harvey-shack-transmission",
    "Harvey-Shack, transmission",
    "Harvey1976",
    Scatters::Transmission,
    &parameters("tau", "transmittance at normal incidence", MEANING),
);

/// Harvey's `b_0` (1/sr) of a lobe with `rho`, `roll_off` and `g`.
pub fn peak(rho: f64, roll_off: f64, g: f64) -> f64 {
    rho / unit_integral(roll_off, g)
}

/// `rho` of a lobe with Harvey's `b_0` (1/sr), `roll_off` and `g`.
pub fn from_peak(b_0: f64, roll_off: f64, g: f64) -> f64 {
    b_0 * unit_integral(roll_off, g)
}

/// Integral of `(1 + (r/l)^2)^(-g/2)` over the unit disk: `pi l^2 ((1 + 1/l^2)^m - 1) / m`, `m = 1 - g/2`.
fn unit_integral<R: Real>(l: R, g: R) -> R {
    let square = l.squared();
    let ln_q = (square.recip() + 1.0).ln();
    square * power_integral(ln_q, -(g * 0.5) + 1.0) * PI
}

/// Prepared parameters.
#[derive(Clone, Copy, Debug)]
pub struct Shape<R> {
    peak: R,
    roll_off: R,
    /// `1 / roll_off^2`.
    inverse_square: R,
    g: R,
}

impl Radial for Shape<f64> {
    fn value(&self, r: f64) -> f64 {
        (r * r * self.inverse_square + 1.0).powf(-0.5 * self.g)
    }

    fn disk(&self, radius: f64) -> f64 {
        let ln_q = (radius * radius * self.inverse_square).ln_1p();
        0.5 * self.roll_off * self.roll_off * power_integral(ln_q, 1.0 - 0.5 * self.g)
    }

    fn radius(&self, v: f64) -> f64 {
        let ln_q = power_integral_inverse(2.0 * v * self.inverse_square, 1.0 - 0.5 * self.g);
        self.roll_off * ln_q.exp_m1().sqrt()
    }
}

macro_rules! formula {
    ($t:ty, $info:ident) => {
        impl Formula for $t {
            const INFO: &'static ModelInfo = &$info;
            type Shape<R: Real> = Shape<R>;

            #[inline(always)]
            fn shape<R: Real>(p: &[R]) -> Shape<R> {
                Shape {
                    peak: p[0] / unit_integral(p[1], p[2]),
                    roll_off: p[1],
                    inverse_square: p[1].squared().recip(),
                    g: p[2],
                }
            }

            #[inline(always)]
            fn bsdf<R: Real>(shape: &Shape<R>, pair: &Pair<R::Plain>) -> R {
                let ln_q = (shape.inverse_square.times(shift_squared(pair)) + 1.0).ln();
                (shape.g * ln_q * -0.5).exp() * shape.peak
            }

            fn pdf(shape: &Shape<f64>, w: Direction, s: Direction) -> f64 {
                density(shape, w, s)
            }

            fn sample(shape: &Shape<f64>, w: Direction, u: [f64; 3]) -> Option<Direction> {
                draw(shape, $info.scatters, w, u)
            }
        }
    };
}
formula!(HarveyShack, REFLECTION);
formula!(HarveyShackTransmission, TRANSMISSION);

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_lobe_has_harveys_peak_and_slope() {
        let (b_0, l, g) = (0.1, 0.01, 1.5);
        let rho = from_peak(b_0, l, g);
        assert!((peak(rho, l, g) / b_0 - 1.0).abs() < 1e-14);
        let shape = <HarveyShack as Formula>::shape::<f64>(&[rho, l, g]);
        let wi = Direction::from_degrees(30.0, 0.0);
        for ts in [30.0, 31.0, 45.0, 80.0] {
            let ws = Direction::from_degrees(ts, 180.0);
            let shift = (ts.to_radians().sin() - 0.5) / l;
            let want = b_0 * (1.0 + shift * shift).powf(-0.5 * g);
            let got = <HarveyShack as Formula>::bsdf::<f64>(&shape, &Pair::new(wi, ws));
            assert!((got / want - 1.0).abs() < 1e-12, "{got} {want}");
        }
        // g = 2, where the exponent m of the normaliser is 0: pi l^2 ln(1 + 1/l^2).
        let want = PI * l * l * (1.0 / (l * l)).ln_1p();
        assert!((unit_integral(l, 2.0) / want - 1.0).abs() < 1e-14);
    }
}
