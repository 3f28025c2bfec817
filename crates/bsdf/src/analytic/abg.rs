//! The ABg lobe of optical designers, in reflection and in transmission.

use gonio_geom::Direction;

use super::shift_invariant::{
    Radial, density, draw, info, parameters, power_integral, power_integral_inverse, shift_squared,
};
use super::{Formula, ModelInfo, Pair, Real, Scatters};

/// A lobe that depends on the shift in direction cosines alone:
///
/// `f = B / (A + |beta - beta_0|^g)` [Pfisterer2011], `beta` the part of `ws` in the sample plane,
/// `beta_0 = -` that of `wi`: the mirror direction in reflection, the unbent direction in transmission.
///
/// Its parameters here are `rho`, the directional-hemispherical reflectance at normal incidence (the total integrated
/// scatter), and `roll_off = A^(1/g)`, the shift at which `f` is half its peak; see [`coefficients`]. The same lobe
/// centred elsewhere covers less of the unit disk, so the albedo falls from `rho` with `theta_i` and never exceeds it.
#[derive(Clone, Copy, Debug)]
pub struct Abg;

/// [`Abg`] in transmission; `tau` is its directional-hemispherical transmittance at normal incidence.
#[derive(Clone, Copy, Debug)]
pub struct AbgTransmission;

const MEANING: &str = "shift in direction cosines at which f is half its peak, A^(1/g)";

static REFLECTION: ModelInfo = info(
    "abg",
    "ABg",
    "Pfisterer2011",
    Scatters::Reflection,
    &parameters("rho", "reflectance at normal incidence", MEANING),
);

static TRANSMISSION: ModelInfo = info(
    "abg-transmission",
    "ABg, transmission",
    "Pfisterer2011",
    Scatters::Transmission,
    &parameters("tau", "transmittance at normal incidence", MEANING),
);

/// `A` and `B` (1/sr, in units of `A`) of a lobe with `rho`, `roll_off`, `g`: `A = roll_off^g`, `B = A f(peak)`.
pub fn coefficients(rho: f64, roll_off: f64, g: f64) -> (f64, f64) {
    let a = roll_off.powf(g);
    (a, a * rho / unit_integral(roll_off, g))
}

/// `rho` and `roll_off` of a lobe with positive `A`, `B` and `g`.
pub fn from_coefficients(a: f64, b: f64, g: f64) -> (f64, f64) {
    let roll_off = a.powf(1.0 / g);
    (b / a * unit_integral(roll_off, g), roll_off)
}

/// Nodes and weights of the 10-point Gauss-Legendre rule on `[0, 1]`.
const GAUSS: [(f64, f64); 10] = [
    (0.013_046_735_741_414_14, 0.033_335_672_154_344_07),
    (0.067_468_316_655_507_75, 0.074_725_674_575_290_3),
    (0.160_295_215_850_487_8, 0.109_543_181_257_991_02),
    (0.283_302_302_935_376_4, 0.134_633_359_654_998_17),
    (0.425_562_830_509_184_4, 0.147_762_112_357_376_44),
    (0.574_437_169_490_815_6, 0.147_762_112_357_376_44),
    (0.716_697_697_064_623_6, 0.134_633_359_654_998_17),
    (0.839_704_784_149_512_2, 0.109_543_181_257_991_02),
    (0.932_531_683_344_492_2, 0.074_725_674_575_290_3),
    (0.986_953_264_258_585_9, 0.033_335_672_154_344_07),
];

/// Integral of `1 / (1 + (r/l)^g)` over the unit disk, `2 pi integral_0^1 r / (1 + (r/l)^g) dr`.
///
/// With `w = g ln(r/l)` it is `2 pi l^2/g` times the integral of `e^(2w/g) / (1 + e^w)` up to `-g ln l`. Below
/// `w = -36` the denominator is 1 in double precision, above it panels of Gauss-Legendre nodes at most 3 long hold
/// for poles at distance pi: within 1e-12 for `g` of 0.5 to 8.
fn unit_integral<R: Real>(l: R, g: R) -> R {
    const START: f64 = -36.0;
    const PANELS: usize = 36;
    let rate = g.recip() * 2.0;
    let panel = (-(g * l.ln()) - START) / PANELS as f64;
    let mut sum = (rate * START).exp() / rate;
    for k in 0..PANELS {
        let mut part = R::constant(0.0);
        for (x, weight) in GAUSS {
            let w = panel * (k as f64 + x) + START;
            part = part + (rate * w).exp() / (w.exp() + 1.0) * weight;
        }
        sum = sum + part * panel;
    }
    l.squared() * sum * rate * std::f64::consts::PI
}

/// Prepared parameters.
#[derive(Clone, Copy, Debug)]
pub struct Shape<R> {
    peak: R,
    roll_off: R,
    g: R,
    /// `g ln(roll_off)`.
    ln_a: R,
}

impl Shape<f64> {
    fn majorant(&self) -> Majorant {
        Majorant {
            roll_off: self.roll_off,
            g: self.g,
        }
    }
}

/// `min(1, (r/l)^-g)`: above the lobe, by a factor of 2 at most, and with an inverse in closed form.
struct Majorant {
    roll_off: f64,
    g: f64,
}

impl Radial for Majorant {
    fn value(&self, r: f64) -> f64 {
        (r / self.roll_off).powf(-self.g).min(1.0)
    }

    fn disk(&self, radius: f64) -> f64 {
        let x = radius / self.roll_off;
        let integral = if x < 1.0 {
            0.5 * x * x
        } else {
            0.5 + power_integral(x.ln(), 2.0 - self.g)
        };
        self.roll_off * self.roll_off * integral
    }

    fn radius(&self, v: f64) -> f64 {
        let v = v / (self.roll_off * self.roll_off);
        if v < 0.5 {
            self.roll_off * (2.0 * v).sqrt()
        } else {
            self.roll_off * power_integral_inverse(v - 0.5, 2.0 - self.g).exp()
        }
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
                    g: p[2],
                    ln_a: p[2] * p[1].ln(),
                }
            }

            #[inline(always)]
            fn bsdf<R: Real>(shape: &Shape<R>, pair: &Pair<R::Plain>) -> R {
                // 1e-60 keeps the logarithm finite at the peak.
                let ln_shift = (shift_squared(pair) + 1e-60).ln() * 0.5;
                shape.peak / ((shape.g.times(ln_shift) - shape.ln_a).exp() + 1.0)
            }

            fn pdf(shape: &Shape<f64>, w: Direction, s: Direction) -> f64 {
                density(&shape.majorant(), w, s)
            }

            fn sample(shape: &Shape<f64>, w: Direction, u: [f64; 3]) -> Option<Direction> {
                draw(&shape.majorant(), $info.scatters, w, u)
            }
        }
    };
}
formula!(Abg, REFLECTION);
formula!(AbgTransmission, TRANSMISSION);

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_normaliser_follows_closed_forms() {
        for l in [1e-3_f64, 0.01, 0.2, 1.0] {
            // g = 1, 2, 4: integrals of r/(1+r/l), r/(1+(r/l)^2), r/(1+(r/l)^4) over [0, 1].
            let closed = [
                (1.0, l - l * l * (1.0 / l).ln_1p()),
                (2.0, 0.5 * l * l * (1.0 / (l * l)).ln_1p()),
                (4.0, 0.5 * l * l * (1.0 / (l * l)).atan()),
            ];
            for (g, want) in closed {
                let got = unit_integral(l, g) / (2.0 * std::f64::consts::PI);
                assert!((got / want - 1.0).abs() < 1e-11, "{l} {g}: {got} {want}");
            }
            // The power of 1/2 with r = t^2: 2 t^3 / (1 + t/sqrt(l)), t up to 1.
            let c = l.sqrt();
            let want = 2.0 * c * (1.0 / 3.0 - c / 2.0 + c * c - c.powi(3) * (1.0 / c).ln_1p());
            let got = unit_integral(l, 0.5) / (2.0 * std::f64::consts::PI);
            assert!((got / want - 1.0).abs() < 1e-10, "{l}: {got} {want}");
        }
    }

    #[test]
    fn coefficients_of_designers_give_the_lobe_back() {
        let (a, b, g) = (0.0025, 0.001, 1.8);
        let (rho, roll_off) = from_coefficients(a, b, g);
        let back = coefficients(rho, roll_off, g);
        assert!((back.0 / a - 1.0).abs() < 1e-12 && (back.1 / b - 1.0).abs() < 1e-12);
        let shape = <Abg as Formula>::shape::<f64>(&[rho, roll_off, g]);
        for ts in [0.0, 3.0, 20.0, 70.0] {
            let (wi, ws) = (
                Direction::from_degrees(20.0, 0.0),
                Direction::from_degrees(ts, 160.0),
            );
            let shift = (wi.vec() + ws.vec()).truncate().length();
            let want = b / (a + shift.powf(g));
            let got = <Abg as Formula>::bsdf::<f64>(&shape, &Pair::new(wi, ws));
            assert!((got / want - 1.0).abs() < 1e-12, "{got} {want}");
        }
    }
}
