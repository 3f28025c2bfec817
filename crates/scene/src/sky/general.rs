//! The CIE standard general sky: fifteen kinds by two functions [ISO15469].

use super::between;

/// a and b of the gradation, c, d and e of the indicatrix, by number of the sky from 1 [ISO15469, table 1].
const KINDS: [[f64; 5]; 15] = [
    [4.0, -0.70, 0.0, -1.0, 0.00],
    [4.0, -0.70, 2.0, -1.5, 0.15],
    [1.1, -0.80, 0.0, -1.0, 0.00],
    [1.1, -0.80, 2.0, -1.5, 0.15],
    [0.0, -1.00, 0.0, -1.0, 0.00],
    [0.0, -1.00, 2.0, -1.5, 0.15],
    [0.0, -1.00, 5.0, -2.5, 0.30],
    [0.0, -1.00, 10.0, -3.0, 0.45],
    [-1.0, -0.55, 2.0, -1.5, 0.15],
    [-1.0, -0.55, 5.0, -2.5, 0.30],
    [-1.0, -0.55, 10.0, -3.0, 0.45],
    [-1.0, -0.32, 10.0, -3.0, 0.45],
    [-1.0, -0.32, 16.0, -3.0, 0.30],
    [-1.0, -0.15, 16.0, -3.0, 0.30],
    [-1.0, -0.15, 24.0, -2.8, 0.15],
];

/// One of the fifteen skies, above the horizon; black below it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct GeneralSky {
    coefficients: [f64; 5],
    sun: [f64; 3],
    /// Radiance over relative radiance.
    scale: f64,
}

impl GeneralSky {
    /// The sky of this number (1 to 15; 1 overcast, 5 uniform, 12 clear), with the unit direction to the sun and the radiance
    /// of the zenith in W/(m² sr). None for other numbers.
    pub fn new(number: usize, sun: [f64; 3], zenith: f64) -> Option<Self> {
        let coefficients = *KINDS.get(number.checked_sub(1)?)?;
        let mut sky = GeneralSky {
            coefficients,
            sun,
            scale: 1.0,
        };
        sky.scale = zenith / sky.relative([0.0, 0.0, 1.0]);
        Some(sky)
    }

    fn relative(&self, direction: [f64; 3]) -> f64 {
        let [a, b, c, d, e] = self.coefficients;
        let (chi, cosine) = between(direction, self.sun);
        let gradation = 1.0 + a * (b / direction[2].max(1e-6)).exp();
        let indicatrix =
            1.0 + c * ((d * chi).exp() - (d * std::f64::consts::FRAC_PI_2).exp()) + e * cosine * cosine;
        gradation * indicatrix
    }

    /// Radiance from a unit direction, W/(m² sr): L = zenith · φ(Z) f(χ) / (φ(0) f(Z_s)) [ISO15469, eq. 1].
    pub fn radiance(&self, direction: [f64; 3]) -> f64 {
        if direction[2] < 0.0 {
            return 0.0;
        }
        self.scale * self.relative(direction)
    }
}
