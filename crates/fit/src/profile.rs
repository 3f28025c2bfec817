//! The instrument signature as a quadrature rule: a model is compared with readings as the instrument would see it.

use gonio_scan::{Measurement, Resolution};
use nalgebra::{DMatrix, SymmetricEigen};
use std::f64::consts::{LN_2, TAU};

/// A direction of the rule relative to its centre: angle, azimuth about the centre, weight.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Node {
    /// Angle from the centre, radians.
    pub gamma: f64,
    /// Azimuth about the centre, radians.
    pub psi: f64,
    /// Share of the beam's power.
    pub weight: f64,
}

/// The beam profile as the detector sees it: rotationally symmetric, `exp(-(gamma / w)^shape)`.
///
/// `shape` is 2 for a Gaussian beam and large for a disk. It follows from the ratio of the radii that hold 90 % and 50 %
/// of the power, `w` from the second moment: the signature enters a smooth lobe through its second moment first.
#[derive(Clone, Debug, PartialEq)]
pub struct Profile {
    /// Exponent of the profile.
    pub shape: f64,
    /// Second moment `<gamma^2>`, rad^2.
    pub second_moment: f64,
    /// The share of `second_moment` that the receiver aperture makes; the beam's divergence makes the rest.
    pub receiver_share: Option<f64>,
    /// Second moment of the lit spot, a disk seen from the detector at normal incidence, over `second_moment`.
    pub spot_share: f64,
    rules: Vec<Vec<Node>>,
}

/// Radii and azimuths of the rules, coarse to fine.
const RULES: [(usize, usize); 4] = [(1, 6), (2, 8), (4, 12), (7, 20)];
/// Range of the exponent: from wings broader than a Gaussian's to nearly a disk.
const SHAPES: (f64, f64) = (1.2, 16.0);
/// Radial steps of the discretised profile.
const STEPS: usize = 2000;

impl Profile {
    /// The profile with exponent `shape` (clamped to `[1.2, 16]`) and `second_moment`; `None` unless that is positive
    /// and below (30 deg)^2.
    pub fn new(shape: f64, second_moment: f64) -> Option<Self> {
        if !(second_moment > 0.0 && second_moment < 0.27 && shape.is_finite()) {
            return None;
        }
        let shape = shape.clamp(SHAPES.0, SHAPES.1);
        let measure = radial_measure(shape);
        let own: f64 = measure.iter().map(|m| m.0 * m.1).sum();
        let rules = RULES
            .iter()
            .map(|&(radii, azimuths)| rule(&measure, second_moment / own, radii, azimuths))
            .collect();
        Some(Profile {
            shape,
            second_moment,
            receiver_share: None,
            spot_share: 0.0,
            rules,
        })
    }

    /// A Gaussian beam of full width at half maximum `fwhm`, radians.
    pub fn gaussian(fwhm: f64) -> Option<Self> {
        Profile::new(2.0, fwhm * fwhm / (4.0 * LN_2))
    }

    /// The profile of a measured signature; `None` when its moments are not finite.
    pub fn of(resolution: &Resolution) -> Option<Self> {
        let ratio = resolution.radius_90 / resolution.radius_50;
        let profile = Profile::new(shape_of(ratio), resolution.second_moment)?;
        Some(Profile {
            receiver_share: resolution.receiver_share(),
            spot_share: 0.5 * resolution.spot_radius.unwrap_or(0.0).powi(2) / resolution.second_moment,
            ..profile
        })
    }

    /// The profile of `channel` in a measurement: of its beam, or a Gaussian of the stated width.
    pub fn of_measurement(measurement: &Measurement, channel: gonio_bsdf::Channel) -> Option<Self> {
        let own = |r: &&Resolution| r.channel == channel;
        measurement
            .resolutions
            .iter()
            .find(own)
            .and_then(Profile::of)
            .or_else(|| measurement.signature_fwhm.and_then(Profile::gaussian))
    }

    /// Radius of the disk of the same second moment, radians: the resolution limit.
    pub fn radius(&self) -> f64 {
        (2.0 * self.second_moment).sqrt()
    }

    /// Number of rules; rule 0 is the coarsest.
    pub fn levels(&self) -> usize {
        self.rules.len()
    }

    /// The nodes of rule `level`.
    pub fn rule(&self, level: usize) -> &[Node] {
        &self.rules[level]
    }
}

/// Squared radii (in units of `w^2`) and shares of the power.
fn radial_measure(shape: f64) -> Vec<(f64, f64)> {
    // exp(-u^shape) < 1e-13 beyond.
    let end = 30.0_f64.powf(1.0 / shape);
    let h = end / STEPS as f64;
    let mut all: Vec<(f64, f64)> = (0..STEPS)
        .map(|k| {
            let u = (k as f64 + 0.5) * h;
            (u * u, u * (-u.powf(shape)).exp())
        })
        .collect();
    let sum: f64 = all.iter().map(|m| m.1).sum();
    all.iter_mut().for_each(|m| m.1 /= sum);
    all
}

/// The exponent whose profile has this ratio of the radii that hold 90 % and 50 % of the power.
fn shape_of(ratio: f64) -> f64 {
    let ratio_of = |shape: f64| {
        let measure = radial_measure(shape);
        let inside = |share: f64| {
            let mut sum = 0.0;
            measure
                .iter()
                .find(|m| {
                    sum += m.1;
                    sum >= share
                })
                .map_or(f64::NAN, |m| m.0.sqrt())
        };
        inside(0.9) / inside(0.5)
    };
    if !ratio.is_finite() {
        return 2.0;
    }
    let (mut low, mut high) = SHAPES;
    // The ratio falls with the exponent.
    for _ in 0..30 {
        let middle = (low * high).sqrt();
        if ratio_of(middle) > ratio {
            low = middle;
        } else {
            high = middle;
        }
    }
    (low * high).sqrt()
}

/// Gauss quadrature of the radial measure in the squared radius (Golub and Welsch \[GolubWelsch1969\], recurrence by
/// Stieltjes' procedure) times equally spaced azimuths, each ring turned by half a step against the last.
fn rule(measure: &[(f64, f64)], scale: f64, radii: usize, azimuths: usize) -> Vec<Node> {
    let mut diagonal = vec![0.0; radii];
    let mut off = vec![0.0; radii];
    let (mut before, mut current) = (vec![0.0; measure.len()], vec![1.0; measure.len()]);
    let mut norm_before = 1.0;
    for k in 0..radii {
        let norm: f64 = measure.iter().zip(&current).map(|(m, p)| m.1 * p * p).sum();
        diagonal[k] = measure
            .iter()
            .zip(&current)
            .map(|(m, p)| m.0 * m.1 * p * p)
            .sum::<f64>()
            / norm;
        off[k] = if k == 0 { 0.0 } else { norm / norm_before };
        let next: Vec<f64> = (0..measure.len())
            .map(|j| (measure[j].0 - diagonal[k]) * current[j] - off[k] * before[j])
            .collect();
        before = std::mem::replace(&mut current, next);
        norm_before = norm;
    }
    let jacobi = DMatrix::from_fn(radii, radii, |a, b| match a.abs_diff(b) {
        0 => diagonal[a],
        1 => off[a.max(b)].sqrt(),
        _ => 0.0,
    });
    let eigen = SymmetricEigen::new(jacobi);
    let mut nodes = Vec::with_capacity(radii * azimuths);
    for k in 0..radii {
        let gamma = (eigen.eigenvalues[k].max(0.0) * scale).sqrt();
        let weight = eigen.eigenvectors[(0, k)].powi(2) / azimuths as f64;
        for m in 0..azimuths {
            let psi = TAU * (m as f64 + 0.5 * (k % 2) as f64) / azimuths as f64;
            nodes.push(Node { gamma, psi, weight });
        }
    }
    nodes
}

#[cfg(test)]
mod tests {
    use super::*;

    fn mean(nodes: &[Node], f: impl Fn(f64) -> f64) -> f64 {
        nodes.iter().map(|n| n.weight * f(n.gamma)).sum()
    }

    #[test]
    fn every_rule_has_unit_power_and_the_stated_second_moment() {
        for shape in [1.3, 2.0, 4.0, 16.0] {
            let profile = Profile::new(shape, 3e-4).unwrap();
            for level in 0..profile.levels() {
                let nodes = profile.rule(level);
                assert!((mean(nodes, |_| 1.0) - 1.0).abs() < 1e-12);
                assert!((mean(nodes, |g| g * g) / 3e-4 - 1.0).abs() < 1e-9);
            }
        }
    }

    #[test]
    fn a_gaussian_lobe_seen_by_a_gaussian_beam_has_the_closed_form_peak() {
        // exp(-g^2/w^2) convolved with a Gaussian of second moment m: peak w^2 / (w^2 + m).
        let profile = Profile::gaussian(0.01).unwrap();
        let m = profile.second_moment;
        for factor in [0.5, 1.0, 4.0] {
            let w2 = factor * m;
            let peak = mean(profile.rule(profile.levels() - 1), |g| (-g * g / w2).exp());
            assert!((peak - w2 / (w2 + m)).abs() < 1e-3, "{factor}: {peak}");
        }
    }

    #[test]
    fn a_gaussian_lobe_seen_by_a_disk_has_the_closed_form_peak() {
        // (w/r)^2 (1 - exp(-(r/w)^2)): .969, .885, .632 for r/w = .25, .5, 1.
        let profile = Profile::new(16.0, 0.5e-4).unwrap();
        let r = profile.radius();
        for (ratio, peak) in [(0.25, 0.969), (0.5, 0.885), (1.0, 0.632)] {
            let w = r / ratio;
            let found = mean(profile.rule(2), |g| (-g * g / (w * w)).exp());
            assert!((found - peak).abs() < 3e-3, "{ratio}: {found}");
        }
    }

    #[test]
    fn the_radii_of_a_gaussian_and_of_a_disk_give_their_exponents() {
        assert!((shape_of((10.0_f64.ln() / LN_2).sqrt()) - 2.0).abs() < 0.02);
        assert!(shape_of((0.9_f64 / 0.5).sqrt()) > 15.0);
    }
}
