//! The all-weather sky of Perez, from irradiances, illuminances or its own two indices, as `gendaylit` makes it.

use std::f64::consts::{FRAC_PI_2, PI, TAU};

use super::cie::Kind;
use super::sun::direction;
use super::{Sun, above, between};

/// What is known of the light. Irradiances in W/m², illuminances in lx.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Given {
    /// Perez's clearness ε and brightness Δ.
    Indices(f64, f64),
    /// Direct normal and diffuse horizontal irradiance.
    Irradiance(f64, f64),
    /// Direct normal and diffuse horizontal illuminance.
    Illuminance(f64, f64),
    /// Direct and diffuse irradiance, both of the horizontal.
    HorizontalIrradiance(f64, f64),
    /// Irradiance of the horizontal by sun and sky, split after [Erbs1982]: a rough estimate.
    Global(f64),
}

/// Of what the sky is made.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Output {
    /// Radiance of visible light, W/(m² sr) at 179 lm/W.
    Visible,
    /// Radiance of the whole solar spectrum, W/(m² sr).
    Solar,
    /// Luminance, cd/m².
    Luminance,
}

/// A sky to be made.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Weather {
    /// Altitude of the sun, radians.
    pub altitude: f64,
    /// Azimuth of the sun west of south, radians.
    pub azimuth: f64,
    /// Day of the year, for the distance of the sun; 0 where it is not known.
    pub day: f64,
    /// What is known of the light.
    pub given: Given,
    /// Of what the sky is made.
    pub output: Output,
    /// Precipitable water, cm.
    pub water: f64,
    /// Whether the sun's own light falls on the ground.
    pub sun: bool,
    /// Reflectance of the ground.
    pub ground_reflectance: f64,
}

/// A Perez sky and the ground below it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PerezSky {
    /// ε: 1 for overcast, 12 for the clearest.
    pub clearness: f64,
    /// Δ.
    pub brightness: f64,
    /// a to e [Perez1993, eq. 1].
    pub coefficients: [f64; 5],
    /// Radiance over relative radiance.
    pub factor: f64,
    /// Radiance of the ground.
    pub ground: f64,
    /// The sun.
    pub sun: Sun,
    /// How a global irradiance was split: extraterrestrial, clearness index, direct and diffuse on the horizontal.
    pub split: Option<[f64; 4]>,
}

/// Solar constant, W/m², and its illuminance, lx.
const SOLAR: f64 = 1367.0;
const SOLAR_LUX: f64 = 127_500.0;
/// lm/W of RADIANCE's visible watt.
const EFFICACY: f64 = 179.0;
/// Half of the sun's disc, degrees.
const HALF_SUN: f64 = 0.2665;
/// Largest clearness of the model, and what stands for more.
const CLEAREST: f64 = 12.01;
/// Lower bounds of ε of the eight categories [Perez1990, table 1].
const CATEGORIES: [f64; 8] = [1.0, 1.065, 1.230, 1.500, 1.950, 2.800, 4.500, 6.200];

/// Four coefficients each of a to e, by category [Perez1993, table 1].
#[rustfmt::skip]
const PEREZ: [[f32; 20]; 8] = [
    [1.3525, -0.2576, -0.2690, -1.4366, -0.7670, 0.0007, 1.2734, -0.1233, 2.8000, 0.6004, 1.2375, 1.000, 1.8734, 0.6297, 0.9738, 0.2809, 0.0356, -0.1246, -0.5718, 0.9938],
    [-1.2219, -0.7730, 1.4148, 1.1016, -0.2054, 0.0367, -3.9128, 0.9156, 6.9750, 0.1774, 6.4477, -0.1239, -1.5798, -0.5081, -1.7812, 0.1080, 0.2624, 0.0672, -0.2190, -0.4285],
    [-1.1000, -0.2515, 0.8952, 0.0156, 0.2782, -0.1812, -4.5000, 1.1766, 24.7219, -13.0812, -37.7000, 34.8438, -5.0000, 1.5218, 3.9229, -2.6204, -0.0156, 0.1597, 0.4199, -0.5562],
    [-0.5484, -0.6654, -0.2672, 0.7117, 0.7234, -0.6219, -5.6812, 2.6297, 33.3389, -18.3000, -62.2500, 52.0781, -3.5000, 0.0016, 1.1477, 0.1062, 0.4659, -0.3296, -0.0876, -0.0329],
    [-0.6000, -0.3566, -2.5000, 2.3250, 0.2937, 0.0496, -5.6812, 1.8415, 21.0000, -4.7656, -21.5906, 7.2492, -3.5000, -0.1554, 1.4062, 0.3988, 0.0032, 0.0766, -0.0656, -0.1294],
    [-1.0156, -0.3670, 1.0078, 1.4051, 0.2875, -0.5328, -3.8500, 3.3750, 14.0000, -0.9999, -7.1406, 7.5469, -3.4000, -0.1078, -1.0750, 1.5702, -0.0672, 0.4016, 0.3017, -0.4844],
    [-1.0000, 0.0211, 0.5025, -0.5119, -0.3000, 0.1922, 0.7023, -1.6317, 19.0000, -5.0000, 1.2438, -1.9094, -4.0000, 0.0250, 0.3844, 0.2656, 1.0468, -0.3788, -2.4517, 1.4656],
    [-1.0500, 0.0289, 0.4260, 0.3590, -0.3250, 0.1156, 0.7781, 0.0025, 31.0625, -14.5000, -46.1148, 55.3750, -7.2312, 0.4050, 13.3500, 0.6234, 1.5000, -0.6426, 1.8564, 0.5636],
];

/// Luminous efficacy of the diffuse light, by category: constant, water, cosine, log of the brightness [Perez1990, table 4].
const DIFFUSE: [[f64; 4]; 8] = [
    [97.24, -0.46, 12.00, -8.91],
    [107.22, 1.15, 0.59, -3.95],
    [104.97, 2.96, -5.53, -8.77],
    [102.39, 5.59, -13.95, -13.90],
    [100.71, 5.94, -22.75, -23.74],
    [106.42, 3.83, -36.15, -28.83],
    [141.88, 1.90, -53.24, -14.03],
    [152.23, 0.35, -45.27, -7.98],
];

/// Luminous efficacy of the direct light: constant, water, growth with the zenith angle, brightness [Perez1990, table 4].
const DIRECT: [[f64; 4]; 8] = [
    [57.20, -4.55, -2.98, 117.12],
    [98.99, -3.46, -1.21, 12.38],
    [109.83, -4.90, -1.71, -8.81],
    [110.34, -5.84, -1.99, -4.56],
    [106.36, -3.97, -1.75, -6.16],
    [107.19, -1.25, -1.51, -26.73],
    [105.75, 0.77, -1.26, -34.44],
    [101.18, 1.58, -1.10, -8.29],
];

/// Rings of the subdivision of the hemisphere into 145 directions [Tregenza1987]: zenith angle in degrees, directions.
const RINGS: [(f64, u32); 8] = [
    (84.0, 30),
    (72.0, 30),
    (60.0, 24),
    (48.0, 24),
    (36.0, 18),
    (24.0, 12),
    (12.0, 6),
    (0.0, 1),
];

fn category(clearness: f64) -> usize {
    CATEGORIES
        .iter()
        .rposition(|bound| clearness >= *bound)
        .unwrap_or(0)
}

/// Light on the way to the two indices.
struct Light<'w> {
    weather: &'w Weather,
    /// Zenith angle of the sun, radians, at most π/2.
    zenith: f64,
    direct: f64,
    diffuse: f64,
    clearness: f64,
    brightness: f64,
}

impl Light<'_> {
    /// Brightness over diffuse irradiance: relative air mass [Kasten1965] over the irradiance outside the atmosphere.
    fn brightness_per_irradiance(&self) -> f64 {
        let degrees = self.zenith.to_degrees();
        1.0 / (self.zenith.cos() + 0.15 * (93.885 - degrees).powf(-1.253))
            / (SOLAR * eccentricity(self.weather.day))
    }

    /// [Perez1990, eq. 1]: 1.041 times the cube of the zenith angle.
    fn cube(&self) -> f64 {
        1.041 * self.zenith.powi(3)
    }

    fn bound(&mut self) {
        if self.clearness > CLEAREST {
            self.clearness = CLEAREST - 0.001;
        }
        self.clearness = self.clearness.max(1.0);
        self.brightness = self.brightness.clamp(0.01, 0.6);
    }

    fn indices(&mut self) {
        self.brightness = self.diffuse * self.brightness_per_irradiance();
        self.clearness = ((self.diffuse + self.direct) / self.diffuse + self.cube()) / (1.0 + self.cube());
        self.bound();
    }

    fn efficacies(&self) -> (f64, f64) {
        let row = category(self.clearness);
        let [a, b, c, d] = DIFFUSE[row];
        let water = self.weather.water;
        let diffuse = a + b * water + c * self.zenith.cos() + d * self.brightness.ln();
        let [a, b, c, d] = DIRECT[row];
        let direct = a + b * water + c * (5.73 * self.zenith - 5.0).exp() + d * self.brightness;
        (direct.max(0.0), diffuse)
    }
}

fn eccentricity(day: f64) -> f64 {
    let angle = TAU * (day - 1.0) / 365.0;
    1.00011
        + 0.034221 * angle.cos()
        + 0.00128 * angle.sin()
        + 0.000719 * (2.0 * angle).cos()
        + 0.000077 * (2.0 * angle).sin()
}

/// Not below zero, together above zero, direct not above the sun's outside the atmosphere; None otherwise.
fn possible(direct: f64, diffuse: f64, most: f64) -> Option<(f64, f64)> {
    let (direct, diffuse) = (direct.max(0.0), diffuse.max(0.0));
    (direct + diffuse > 0.0 && direct <= most).then_some((direct, diffuse))
}

fn coefficients(clearness: f64, brightness: f64, zenith: f64) -> [f64; 5] {
    // The program's own correction of the model for skies of little light between overcast and clear.
    let delta = if clearness > 1.065 && clearness < 2.8 {
        brightness.max(0.2)
    } else {
        brightness
    };
    let row = category(f64::from(clearness as f32));
    let x = |i: usize, j: usize| f64::from(PEREZ[row][4 * i + j]);
    let mut all: [f64; 5] =
        std::array::from_fn(|i| x(i, 0) + x(i, 1) * zenith + delta * (x(i, 2) + x(i, 3) * zenith));
    if row == 0 {
        all[2] = (delta * (x(2, 0) + x(2, 1) * zenith)).powf(x(2, 2)).exp() - x(2, 3);
        all[3] = -(delta * (x(3, 0) + x(3, 1) * zenith)).exp() + x(3, 2) + delta * x(3, 3);
    }
    all
}

fn relative([a, b, c, d, e]: [f64; 5], up: f64, gamma: f64) -> f64 {
    (1.0 + a * (b / up).exp()) * (1.0 + c * (d * gamma).exp() + e * gamma.cos().powi(2))
}

impl PerezSky {
    /// Makes the sky [Perez1993; Perez1990] as RADIANCE's `gendaylit` does. None where there is no light, more than the sun gives,
    /// or no sky of the model (b above zero): `gendaylit` then writes a black sky.
    pub fn new(weather: &Weather) -> Option<Self> {
        let mut light = Light {
            weather,
            zenith: (FRAC_PI_2 - weather.altitude).min(FRAC_PI_2),
            direct: 0.0,
            diffuse: 0.0,
            clearness: 1.0,
            brightness: 0.0,
        };
        let (mut split, mut lux) = (None, None);
        match weather.given {
            Given::Indices(clearness, brightness) => {
                (light.clearness, light.brightness) = (clearness, brightness);
                light.bound();
                light.diffuse = light.brightness / light.brightness_per_irradiance();
                light.direct = light.diffuse * (light.clearness - 1.0) * (1.0 + light.cube());
                possible(light.direct, light.diffuse, SOLAR)?;
            }
            Given::Illuminance(direct, diffuse) => {
                let (direct, diffuse) = possible(direct, diffuse, SOLAR_LUX)?;
                light.direct = direct * SOLAR / SOLAR_LUX;
                light.diffuse = diffuse * SOLAR / SOLAR_LUX;
                light.indices();
                // The efficacies depend on the indices that they give: nine rounds, as the program has them.
                for _ in 0..9 {
                    let (of_direct, of_diffuse) = light.efficacies();
                    light.diffuse = diffuse / of_diffuse;
                    light.direct = if of_direct < 0.1 { 0.0 } else { direct / of_direct };
                    light.indices();
                }
                lux = Some((direct, diffuse));
            }
            Given::Irradiance(direct, diffuse) => {
                (light.direct, light.diffuse) = possible(direct, diffuse, SOLAR)?;
                light.indices();
            }
            Given::HorizontalIrradiance(direct, diffuse) => {
                if weather.altitude <= 0.0 {
                    return None;
                }
                (light.direct, light.diffuse) = possible(direct / weather.altitude.sin(), diffuse, SOLAR)?;
                light.indices();
            }
            Given::Global(global) => {
                if weather.altitude <= 0.0 {
                    return None;
                }
                let parts = erbs(global, SOLAR * eccentricity(weather.day) * weather.altitude.sin());
                (light.direct, light.diffuse) = possible(parts[2] / weather.altitude.sin(), parts[3], SOLAR)?;
                light.indices();
                split = Some(parts);
            }
        }
        if light.clearness >= CLEAREST || light.clearness.is_nan() || light.brightness.is_nan() {
            return None;
        }
        let (direct, diffuse) = match (weather.output, lux) {
            (Output::Solar, _) => (light.direct, light.diffuse),
            (_, Some(lux)) => lux,
            _ => {
                let (of_direct, of_diffuse) = light.efficacies();
                possible(light.direct * of_direct, light.diffuse * of_diffuse, SOLAR_LUX)?
            }
        };
        let unit = if weather.output == Output::Visible {
            EFFICACY
        } else {
            1.0
        };
        light.finish(direct / unit, diffuse / unit, split)
    }

    /// The sky of the ten numbers that `gendaylit` hands to `skybright` of perezlum.cal; without its indices and without the
    /// light of its sun, which stand elsewhere. `None` for another count and numbers that are not finite.
    pub fn of_pattern(numbers: &[f64]) -> Option<Self> {
        let [factor, ground, a, b, c, d, e, x, y, z] = *numbers else {
            return None;
        };
        numbers.iter().all(|v| v.is_finite()).then_some(PerezSky {
            clearness: f64::NAN,
            brightness: f64::NAN,
            coefficients: [a, b, c, d, e],
            factor,
            ground,
            sun: Sun {
                direction: [x, y, z],
                angle: 0.0,
                radiance: 0.0,
            },
            split: None,
        })
    }

    /// Radiance from a unit direction.
    pub fn radiance(&self, direction: [f64; 3]) -> f64 {
        let (gamma, cosine) = between(direction, self.sun.direction);
        let [a, b, c, d, e] = self.coefficients;
        let bounded = |exponent: f64| if exponent > -100.0 { exponent.exp() } else { 0.0 };
        let up = direction[2].max(0.01);
        let sky =
            self.factor * (1.0 + a * bounded(b / up)) * (1.0 + c * bounded(d * gamma) + e * cosine * cosine);
        above(self.ground, sky, direction[2])
    }
}

impl Light<'_> {
    /// The sky of these indices with this direct normal and diffuse horizontal light.
    fn finish(&self, direct: f64, diffuse: f64, split: Option<[f64; 4]>) -> Option<PerezSky> {
        let (weather, zenith) = (self.weather, self.zenith);
        let coefficients = coefficients(self.clearness, self.brightness, zenith);
        let mut sum = 0.0;
        for (theta, directions) in RINGS {
            let theta = theta.to_radians();
            for k in 0..directions {
                let phi = TAU * f64::from(k) / f64::from(directions);
                let cosine = zenith.cos() * theta.cos() + zenith.sin() * theta.sin() * phi.cos();
                sum += relative(coefficients, theta.cos(), cosine.clamp(-1.0, 1.0).acos()) * theta.cos();
            }
        }
        let factor = diffuse / (sum * TAU / 145.0);
        let disc = TAU * (1.0 - HALF_SUN.to_radians().cos());
        let sun = Sun {
            direction: direction(weather.altitude, weather.azimuth),
            angle: 2.0 * HALF_SUN.to_radians(),
            radiance: if self.clearness > 1.0 { direct / disc } else { 0.0 },
        };
        let kind = match self.clearness {
            c if c <= 1.0 => Kind::Overcast,
            c if c < 6.0 => Kind::Intermediate,
            _ => Kind::Clear,
        };
        let mut ground = factor * relative(coefficients, 1.0, zenith) * kind.horizontal(weather.altitude);
        if weather.sun {
            ground += 6.8e-5 / PI * sun.radiance * sun.direction[2];
        }
        (coefficients[1] <= 0.0).then_some(PerezSky {
            clearness: self.clearness,
            brightness: self.brightness,
            coefficients,
            factor,
            ground: ground * weather.ground_reflectance,
            sun,
            split,
        })
    }
}

/// Extraterrestrial irradiance of the horizontal, clearness index, direct and diffuse irradiance of the horizontal [Erbs1982].
fn erbs(global: f64, outside: f64) -> [f64; 4] {
    let global = if global > outside { 0.999 * outside } else { global };
    let k = global / outside;
    let share = match k {
        k if k <= 0.22 => 1.0 - 0.09 * k,
        k if k <= 0.8 => 0.9511 - 0.1604 * k + 4.388 * k.powi(2) - 16.638 * k.powi(3) + 12.336 * k.powi(4),
        _ => 0.165,
    };
    [outside, k, global * (1.0 - share), global * share]
}
