//! The instrument signature: what a beam without a sample looks like, and with it the resolution limit.

use std::f64::consts::PI;

use gonio_bsdf::Channel;
use gonio_geom::{DVec3, Direction};

/// Angular profile of the unscattered beam as the detector sees it (beam convolved with the receiver aperture).
///
/// A measured DSF is the true one convolved with this profile about mirror and through directions; a lobe narrower
/// than it cannot be told from the beam \[ASTME2387\].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Signature {
    /// Full width at half maximum of the azimuthally averaged profile, radians.
    pub fwhm: f64,
    /// Angle from the centroid that holds 50 % of the power, radians.
    pub radius_50: f64,
    /// Angle from the centroid that holds 90 % of the power, radians.
    pub radius_90: f64,
    /// Solid angle `(integral S)^2 / integral S^2`, sr.
    pub solid_angle: f64,
    /// Second moment `<gamma^2>` about the centroid, rad^2.
    pub second_moment: f64,
    /// Angle between the centroid and the direction the beam should leave to, radians.
    pub offset: f64,
    /// Direction of the centroid.
    pub centroid: Direction,
}

/// What the readings of one channel resolve: the figures of its instrument signature that later steps need.
#[derive(Clone, Debug, PartialEq)]
pub struct Resolution {
    /// Spectral channel.
    pub channel: Channel,
    /// Full width at half maximum, radians.
    pub fwhm: f64,
    /// Angle from the centroid that holds 50 % of the power, radians.
    pub radius_50: f64,
    /// Angle from the centroid that holds 90 % of the power, radians.
    pub radius_90: f64,
    /// Second moment `<gamma^2>` about the centroid, rad^2: of the beam and of the receiver aperture together.
    pub second_moment: f64,
    /// Half angle of the receiver aperture seen from the sample, radians; `None` where it is not known.
    pub receiver_radius: Option<f64>,
    /// Radius of the lit spot at normal incidence over the detector's distance; `None` where either is not known.
    pub spot_radius: Option<f64>,
}

impl Resolution {
    /// The share of `second_moment` that the receiver aperture makes, a disk: `a^2 / 2`; the beam's divergence makes the
    /// rest. `None` without its radius.
    pub fn receiver_share(&self) -> Option<f64> {
        let own = 0.5 * self.receiver_radius?.powi(2);
        let share = own / self.second_moment;
        share.is_finite().then(|| share.clamp(0.0, 1.0))
    }
}

/// Bins of the radial profile a half width at half maximum is resolved into, at most.
const PROFILE_BINS: usize = 400;

impl Signature {
    /// The signature of readings `value` (dark-subtracted) at `points` with solid angles `omega`, against the
    /// direction `expected`. Readings below `floor` (three standard deviations of the noise) do not enter widths,
    /// which wide wings of noise would otherwise rule. `None` when no power is left.
    pub fn of(
        points: &[DVec3],
        value: &[f64],
        omega: &[f64],
        floor: f64,
        expected: Direction,
    ) -> Option<Self> {
        let mut first = DVec3::ZERO;
        let (mut power, mut square) = (0.0, 0.0);
        for ((&p, &v), &w) in points.iter().zip(value).zip(omega) {
            if v >= floor && v > 0.0 {
                first += p * (v * w);
                power += v * w;
                square += v * v * w;
            }
        }
        let centroid = Direction::new(first)?;
        if power.is_nan() || power <= 0.0 || square <= 0.0 {
            return None;
        }
        let mut rings: Vec<(f64, f64, f64)> = points
            .iter()
            .zip(value)
            .zip(omega)
            .filter(|((p, v), w)| p.is_finite() && v.is_finite() && **w > 0.0)
            .map(|((&p, &v), &w)| (centroid.angle_to(Direction::from_unit(p)), v, w))
            .collect();
        rings.sort_by(|a, b| a.0.total_cmp(&b.0));
        let inside = |fraction: f64| -> f64 {
            let (mut sum, mut before) = (0.0, 0.0);
            for &(gamma, v, w) in rings.iter().filter(|r| r.1 >= floor && r.1 > 0.0) {
                let next = sum + v * w;
                if next >= fraction * power {
                    return before + (gamma - before) * (fraction * power - sum) / (next - sum);
                }
                sum = next;
                before = gamma;
            }
            before
        };
        let second_moment = rings
            .iter()
            .filter(|r| r.1 >= floor && r.1 > 0.0)
            .map(|&(gamma, v, w)| gamma * gamma * v * w)
            .sum::<f64>()
            / power;
        Some(Signature {
            fwhm: full_width(&rings),
            radius_50: inside(0.5),
            radius_90: inside(0.9),
            solid_angle: power * power / square,
            second_moment,
            offset: centroid.angle_to(expected),
            centroid,
        })
    }
}

/// Width of the azimuthal mean at half its maximum. Bins are as wide as one reading's cell, so that each holds some.
fn full_width(rings: &[(f64, f64, f64)]) -> f64 {
    let Some(last) = rings.last() else { return f64::NAN };
    let mut cells: Vec<f64> = rings.iter().map(|r| r.2).collect();
    let cell = crate::robust::median(&mut cells).unwrap_or(0.0);
    let width = (0.5 * (cell / PI).sqrt()).max(last.0 / PROFILE_BINS as f64);
    if width.is_nan() || width <= 0.0 {
        return f64::NAN;
    }
    let n = (last.0 / width) as usize + 1;
    let mut profile = vec![(0.0, 0.0, 0.0); n];
    for &(gamma, v, w) in rings {
        let bin = &mut profile[((gamma / width) as usize).min(n - 1)];
        bin.0 += v * w;
        bin.1 += gamma * w;
        bin.2 += w;
    }
    let mean: Vec<(f64, f64)> = profile
        .iter()
        .filter(|b| b.2 > 0.0)
        .map(|b| (b.1 / b.2, b.0 / b.2))
        .collect();
    let Some(peak) = mean.iter().map(|m| m.1).max_by(f64::total_cmp) else {
        return f64::NAN;
    };
    // Outermost crossing of half the maximum.
    let Some(outer) = mean.iter().rposition(|m| m.1 >= 0.5 * peak) else {
        return f64::NAN;
    };
    match (mean.get(outer), mean.get(outer + 1)) {
        (Some(&(g0, v0)), Some(&(g1, v1))) => 2.0 * (g0 + (g1 - g0) * (v0 - 0.5 * peak) / (v0 - v1)),
        (Some(&(g0, _)), None) => 2.0 * g0,
        _ => f64::NAN,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::beam_scan;

    fn signature(pitch: f64, half_width: f64, profile: impl FnMut(f64) -> f64) -> Signature {
        let scan = beam_scan(20.0, 0.0, pitch, half_width, profile);
        let points: Vec<DVec3> = (0..scan.len()).map(|j| scan.direction(j).vec()).collect();
        let omega = vec![pitch.to_radians().powi(2); points.len()];
        let through = scan.incidence.direction().through();
        Signature::of(&points, &scan.value, &omega, 0.0, through).unwrap()
    }

    #[test]
    fn a_gaussian_beam_has_its_closed_form_widths() {
        let w = 0.4_f64.to_radians();
        let s = signature(0.05, 2.0, |g| (-g * g / (w * w)).exp());
        let half = 2.0 * w * 2.0_f64.ln().sqrt();
        assert!((s.fwhm / half - 1.0).abs() < 0.02, "{} {half}", s.fwhm);
        assert!((s.radius_50 / (w * 2.0_f64.ln().sqrt()) - 1.0).abs() < 0.02);
        assert!((s.radius_90 / (w * 10.0_f64.ln().sqrt()) - 1.0).abs() < 0.02);
        assert!((s.second_moment / (w * w) - 1.0).abs() < 0.01);
        assert!((s.solid_angle / (2.0 * PI * w * w) - 1.0).abs() < 0.01);
        assert!(s.offset < 1e-6);
    }

    #[test]
    fn a_disk_has_its_own_diameter_as_full_width() {
        let radius = 0.5_f64.to_radians();
        let s = signature(0.03, 1.0, |g| f64::from(g <= radius));
        assert!(
            (s.fwhm / (2.0 * radius) - 1.0).abs() < 0.03,
            "{}",
            s.fwhm.to_degrees()
        );
        assert!((s.solid_angle / (PI * radius * radius) - 1.0).abs() < 0.02);
        assert!((s.radius_50 / (radius * 0.5_f64.sqrt()) - 1.0).abs() < 0.03);
    }
}
