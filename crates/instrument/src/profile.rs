//! A beam profile given as a table.

use std::f64::consts::PI;

use crate::InstrumentError;

/// Density of the beam at steps of the angle from its centre, linear between them and zero beyond the last.
#[derive(Clone, Debug, PartialEq)]
pub struct ProfileTable {
    /// Chords of the angles.
    chord: Vec<f64>,
    /// Density there, 1/sr; its integral is 1.
    density: Vec<f64>,
    /// Share of the beam within each chord.
    share: Vec<f64>,
}

/// Share of the beam in the annulus from chord `c0` to `c`, the density being `v0` at `c0` and rising by `slope`.
fn annulus(c0: f64, v0: f64, slope: f64, c: f64) -> f64 {
    let offset = v0 - slope * c0;
    2.0 * PI * (0.5 * offset * (c * c - c0 * c0) + slope * (c.powi(3) - c0.powi(3)) / 3.0)
}

impl ProfileTable {
    /// From angles (radians, increasing from 0, at most .1) and relative values `>= 0`.
    ///
    /// # Errors
    /// [`InstrumentError::Domain`] for fewer than two points or more than 10,000, angles that do not increase from 0 or pass .1,
    /// values that are negative or all zero.
    pub fn new(angle: &[f64], value: &[f64]) -> Result<Self, InstrumentError> {
        let refused = |found: String| InstrumentError::Domain {
            field: "beam profile",
            found,
            allowed: "2 to 10000 angles that increase from 0 to at most 0.1 rad, values >= 0 and not all 0"
                .into(),
        };
        if angle.len() != value.len() || !(2..=10_000).contains(&angle.len()) {
            return Err(refused(format!("{} angles, {} values", angle.len(), value.len())));
        }
        let rising = angle[0] == 0.0 && angle.windows(2).all(|w| w[0] < w[1]);
        let last = angle[angle.len() - 1];
        if !(rising && (1e-4..=0.1).contains(&last)) {
            return Err(refused(format!("angles from {} to {last} rad", angle[0])));
        }
        if let Some(bad) = value.iter().find(|v| !(v.is_finite() && **v >= 0.0)) {
            return Err(refused(format!("value {bad}")));
        }
        let chord: Vec<f64> = angle.iter().map(|a| 2.0 * (0.5 * a).sin()).collect();
        let mut share = vec![0.0];
        for k in 1..chord.len() {
            let slope = (value[k] - value[k - 1]) / (chord[k] - chord[k - 1]);
            share.push(share[k - 1] + annulus(chord[k - 1], value[k - 1], slope, chord[k]));
        }
        let whole = share[share.len() - 1];
        if !(whole > 0.0 && whole.is_finite()) {
            return Err(refused("values that are all 0".into()));
        }
        Ok(ProfileTable {
            chord,
            density: value.iter().map(|v| v / whole).collect(),
            share: share.iter().map(|s| s / whole).collect(),
        })
    }

    fn slope(&self, k: usize) -> f64 {
        (self.density[k] - self.density[k - 1]) / (self.chord[k] - self.chord[k - 1])
    }

    /// Density at chord `c`, 1/sr.
    pub fn density(&self, c: f64) -> f64 {
        let k = self.chord.partition_point(|x| *x < c).max(1);
        if k == self.chord.len() {
            return 0.0;
        }
        self.density[k - 1] + self.slope(k) * (c - self.chord[k - 1])
    }

    /// Chord of the last point.
    pub fn reach(&self) -> f64 {
        self.chord[self.chord.len() - 1]
    }

    /// Smallest chord at which the density has fallen to half its maximum.
    pub fn width(&self) -> f64 {
        let peak = self.density.iter().copied().fold(0.0, f64::max);
        let top = self.density.iter().position(|d| *d == peak).unwrap_or(0);
        let half = self.density[top..].iter().position(|d| *d <= 0.5 * peak);
        half.map_or(self.reach(), |k| self.chord[top + k])
    }

    /// Chord that holds the share `u` of the beam, `u` in `[0, 1)`.
    pub(crate) fn chord_of_share(&self, u: f64) -> f64 {
        let k = self
            .share
            .partition_point(|s| *s <= u)
            .clamp(1, self.chord.len() - 1);
        let (mut low, mut high) = (self.chord[k - 1], self.chord[k]);
        let (c0, v0, slope) = (low, self.density[k - 1], self.slope(k));
        for _ in 0..50 {
            let middle = 0.5 * (low + high);
            if self.share[k - 1] + annulus(c0, v0, slope, middle) < u {
                low = middle;
            } else {
                high = middle;
            }
        }
        0.5 * (low + high)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_fine_table_of_a_gaussian_is_that_gaussian() {
        let w = 0.004_f64;
        let angle: Vec<f64> = (0..400).map(|k| f64::from(k) * 5e-5).collect();
        let value: Vec<f64> = angle.iter().map(|a| 7.0 * (-(a * a) / (w * w)).exp()).collect();
        let table = ProfileTable::new(&angle, &value).unwrap();
        assert!((table.density(0.0) * PI * w * w - 1.0).abs() < 1e-3);
        for u in [0.1, 0.5, 0.9] {
            let expected = w * (-(1.0_f64 - u).ln()).sqrt();
            assert!((table.chord_of_share(u) / expected - 1.0).abs() < 1e-3);
        }
        assert!((table.width() / (w * 2.0_f64.ln().sqrt()) - 1.0).abs() < 0.02);
    }

    #[test]
    fn a_table_that_is_no_profile_is_refused() {
        for (angle, value) in [
            (&[0.0][..], &[1.0][..]),
            (&[0.0, 0.01, 0.01], &[1.0, 1.0, 0.0]),
            (&[0.001, 0.01], &[1.0, 0.0]),
            (&[0.0, 0.2], &[1.0, 0.0]),
            (&[0.0, 0.01], &[1.0, -1.0]),
            (&[0.0, 0.01], &[0.0, 0.0]),
        ] {
            assert!(ProfileTable::new(angle, value).is_err(), "{angle:?} {value:?}");
        }
    }
}
