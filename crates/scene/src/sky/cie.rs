//! The four skies of `gensky`.

use std::f64::consts::{FRAC_PI_2, FRAC_PI_4, PI};

use super::{above, between};

/// Which sky.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Kind {
    /// CIE standard clear sky [CIES003].
    Clear,
    /// CIE standard overcast sky [MoonSpencer1942].
    Overcast,
    /// The same radiance everywhere.
    Uniform,
    /// Between clear and overcast [Matsuura1990].
    Intermediate,
}

/// A sky and the ground below it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CieSky {
    /// Which.
    pub kind: Kind,
    /// Unit direction towards the sun; of no effect on overcast and uniform skies.
    pub sun: [f64; 3],
    /// Radiance of the zenith, W/(m² sr).
    pub zenith: f64,
    /// Radiance of the ground, W/(m² sr).
    pub ground: f64,
}

impl Kind {
    /// Whether the sun's place is of no effect.
    pub fn hides_the_sun(self) -> bool {
        matches!(self, Kind::Overcast | Kind::Uniform)
    }

    /// The relative radiance of the zenith with the sun at this altitude, radians: what the radiance of the zenith is divided
    /// by. 1 for skies that hide the sun.
    pub fn zenith_relative(self, altitude: f64) -> f64 {
        let below = FRAC_PI_2 - altitude;
        match self {
            Kind::Overcast | Kind::Uniform => 1.0,
            Kind::Clear => 0.274 * (0.91 + 10.0 * (-3.0 * below).exp() + 0.45 * altitude.sin().powi(2)),
            Kind::Intermediate => {
                (2.739 + 0.9891 * (0.3119 + 2.6 * altitude).sin())
                    * (-below * (0.4441 + 1.48 * altitude)).exp()
            }
        }
    }

    /// Irradiance of level ground over π times the radiance of the zenith, by the polynomials of RADIANCE's program [Radiance].
    pub fn horizontal(self, altitude: f64) -> f64 {
        let series: [f64; 5] = match self {
            Kind::Uniform => return 1.0,
            Kind::Overcast => return 0.777778,
            Kind::Clear => [2.766521, 0.547665, -0.369832, 0.009237, 0.059229],
            Kind::Intermediate => [3.5556, -2.7152, -1.3081, 1.0660, 0.60227],
        };
        let x = (altitude - FRAC_PI_4) / FRAC_PI_4;
        series.iter().rev().fold(0.0, |sum, k| sum * x + k) / self.zenith_relative(altitude) / PI
    }
}

impl CieSky {
    /// The sky of the numbers that `gensky` hands to `skybr` of skybright.cal: seven, or three for a sky that hides the sun.
    /// `None` for other counts and numbers that are not finite.
    pub fn of_pattern(numbers: &[f64]) -> Option<Self> {
        let (number, zenith, ground, relative, sun) = match *numbers {
            [n, zenith, ground] => (n, zenith, ground, None, [0.0, 0.0, 1.0]),
            [n, zenith, ground, relative, x, y, z] => (n, zenith, ground, Some(relative), [x, y, z]),
            _ => return None,
        };
        let kinds = [Kind::Clear, Kind::Overcast, Kind::Uniform, Kind::Intermediate];
        let kind = *kinds.get((number as usize).checked_sub(1)?)?;
        // The text divides by its own rounded number.
        let scale = match (kind.hides_the_sun(), relative) {
            (true, _) => 1.0,
            (false, None) => return None,
            (false, Some(relative)) => kind.zenith_relative(sun[2].clamp(-1.0, 1.0).asin()) / relative,
        };
        (scale.is_finite() && numbers.iter().all(|v| v.is_finite())).then_some(CieSky {
            kind,
            sun,
            zenith: zenith * scale,
            ground,
        })
    }

    /// Radiance from a unit direction, W/(m² sr).
    pub fn radiance(&self, direction: [f64; 3]) -> f64 {
        let up = direction[2];
        let altitude = self.sun[2].clamp(-1.0, 1.0).asin();
        let scale = self.zenith / self.kind.zenith_relative(altitude);
        let (gamma, cosine) = between(direction, self.sun);
        let sky = match self.kind {
            Kind::Uniform => self.zenith,
            Kind::Overcast => self.zenith * (1.0 + 2.0 * up) / 3.0,
            Kind::Clear => {
                let gradation = if up > 0.01 { 1.0 - (-0.32 / up).exp() } else { 1.0 };
                scale * (0.91 + 10.0 * (-3.0 * gamma).exp() + 0.45 * cosine * cosine) * gradation
            }
            Kind::Intermediate => {
                let eta = up.clamp(-1.0, 1.0).acos();
                let below = FRAC_PI_2 - altitude;
                let gradation =
                    (1.35 * (5.631 - 3.59 * eta).sin() + 3.12) * (4.396 - 2.6 * below).sin() + 6.37 - eta;
                scale * gradation / 2.326 * (-0.563 * gamma * ((2.629 - eta) * (1.562 - below) + 0.812)).exp()
            }
        };
        above(self.ground, sky, up)
    }
}
