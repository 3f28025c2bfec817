//! What the lobes share that depend on the shift in direction cosines alone.

use std::f64::consts::PI;

use gonio_geom::{Component, DVec3, Direction};

use super::{ModelInfo, Pair, ParameterInfo, Real, Role, Scatters};

/// `|beta - beta_0|^2`: `beta` is `ws` in the sample plane, `beta_0 = -wi` there, the mirror and the unbent direction.
#[inline(always)]
pub(super) fn shift_squared<R: Real>(pair: &Pair<R>) -> R {
    let (x, y) = (pair.wi[0] + pair.ws[0], pair.wi[1] + pair.ws[1]);
    x * x + y * y
}

/// Amplitude, roll-off and exponent.
pub(super) const fn parameters(
    name: &'static str,
    amplitude: &'static str,
    roll_off: &'static str,
) -> [ParameterInfo; 3] {
    [
        ParameterInfo::amplitude(name, 0.1, amplitude),
        ParameterInfo {
            name: "roll_off",
            unit: "1",
            low: 1e-4,
            high: 1.0,
            default: 0.05,
            role: Role::Width,
            meaning: roll_off,
        },
        ParameterInfo {
            name: "g",
            unit: "1",
            low: 0.5,
            high: 8.0,
            default: 2.3,
            role: Role::Exponent,
            meaning: "power of the shift with which f falls far from the peak",
        },
    ]
}

/// `(x^m - 1) / m` from `ln x`, which is `ln x` at `m = 0`: the integral of `t^(m-1)` from 1 to `x`.
#[inline(always)]
pub(super) fn power_integral<R: Real>(ln_x: R, m: R) -> R {
    let y = m * ln_x;
    // The quotient loses digits near 0, where seven terms of its series hold to 1e-14.
    let series = y * (1.0 / 5040.0) + 1.0 / 720.0;
    let series = y * (y * (y * (y * (y * series + 1.0 / 120.0) + 1.0 / 24.0) + 1.0 / 6.0) + 0.5) + 1.0;
    let small = (y.abs() - 0.05).plain();
    let divisor = R::select(small, m, R::constant(1.0));
    R::select(small, (y.exp() - 1.0) / divisor, ln_x * series)
}

/// `ln x` for which [`power_integral`] is `v`.
pub(super) fn power_integral_inverse(v: f64, m: f64) -> f64 {
    if m == 0.0 { v } else { (m * v).ln_1p() / m }
}

/// A radial density in the plane of direction cosines, not normalised.
pub(super) trait Radial {
    /// Its value at radius `r`.
    fn value(&self, r: f64) -> f64;
    /// Its integral over the disk of `radius`, divided by `2 pi`.
    fn disk(&self, radius: f64) -> f64;
    /// The radius of the disk of which [`Radial::disk`] is `v`.
    fn radius(&self, v: f64) -> f64;
}

/// Farthest shift from `w`'s peak to the rim of the unit disk.
fn reach(w: Direction) -> f64 {
    1.0 + w.vec().truncate().length()
}

/// Density per unit solid angle of [`draw`].
pub(super) fn density(radial: &impl Radial, w: Direction, s: Direction) -> f64 {
    let shift = (w.vec() + s.vec()).truncate().length();
    let reach = reach(w);
    // The cosine turns the density over the unit disk into one over solid angle.
    radial.value(shift.min(reach)) / (2.0 * PI * radial.disk(reach)) * s.cos_theta().abs()
}

/// A shift from the inverse of the radial distribution; `None` where it leaves the unit disk.
pub(super) fn draw(radial: &impl Radial, scatters: Scatters, w: Direction, u: [f64; 3]) -> Option<Direction> {
    let r = radial.radius(u[0] * radial.disk(reach(w)));
    let (sin, cos) = (2.0 * PI * u[1]).sin_cos();
    let (x, y) = (r * cos - w.vec().x, r * sin - w.vec().y);
    let z = (1.0 - x * x - y * y).max(0.0).sqrt();
    if z <= 0.0 {
        return None;
    }
    let side = if scatters.into(Component::Reflection) {
        1.0
    } else {
        -1.0
    };
    Direction::new(DVec3::new(x, y, side * z))
}

/// A lobe of optical designers.
pub(super) const fn info(
    name: &'static str,
    title: &'static str,
    source: &'static str,
    scatters: Scatters,
    parameters: &'static [ParameterInfo],
) -> ModelInfo {
    ModelInfo {
        name,
        title,
        source,
        scatters,
        parameters,
        breaks: &[],
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_power_integral_joins_its_series_and_has_its_inverse() {
        for m in [-3.0, -0.1, -1e-3, -1e-12, 0.0, 1e-5, 0.02, 0.75, 2.0] {
            for ln_x in [1e-6_f64, 0.3, 2.0, 9.0] {
                let got = power_integral(ln_x, m);
                let want = if m == 0.0 { ln_x } else { (m * ln_x).exp_m1() / m };
                assert!((got / want - 1.0).abs() < 4e-14, "{m} {ln_x}: {got} {want}");
                // Back through the integral: where it saturates, ln x itself is ill-conditioned.
                let again = power_integral(power_integral_inverse(got, m), m);
                assert!((again / got - 1.0).abs() < 1e-12, "{m} {ln_x}: {again} {got}");
            }
        }
    }
}
