//! Measurement relative to a calibrated standard.

use std::f64::consts::PI;

use gonio_bsdf::Quantity;
use gonio_geom::{DVec3, Direction};
use rayon::prelude::*;

use crate::assemble::{Done, assemble};
use crate::assumed::{lacks_dark, no_u_standard};
use crate::dark::subtract;
use crate::flagging::raw_flags;
use crate::nearest::DirectionIndex;
use crate::process::{
    ProcessOptions, add_direction_uncertainty, apertures, combine, model_of, noise_models, to_slice,
};
use crate::unresolved;
use crate::validate::{sample_records, well_formed};
use crate::{Flags, Measurement, NoiseModel, Scan, ScanError, ScanKind};

/// What is known of the standard: its reflectance factor `beta = pi f`.
#[derive(Clone, Debug, PartialEq)]
pub struct Standard {
    /// Reflectance factor over the receiver's polar angle (radians, ascending), `> 0`; linear between the entries,
    /// constant beyond them. One entry is a constant.
    pub reflectance_factor: Vec<(f64, f64)>,
    /// Relative standard uncertainty of the reflectance factor, common to all values, as a fraction.
    pub u_relative: f64,
}

impl Standard {
    /// A standard of one reflectance factor in all directions.
    pub fn constant(reflectance_factor: f64, u_relative: f64) -> Self {
        Standard {
            reflectance_factor: vec![(0.0, reflectance_factor)],
            u_relative,
        }
    }

    /// Reflectance factor at the polar angle `theta` from the normal, folded to `[0, pi/2]`.
    pub fn at(&self, theta: f64) -> f64 {
        let theta = theta.min(PI - theta);
        let table = &self.reflectance_factor;
        let after = table.partition_point(|e| e.0 < theta);
        match (after.checked_sub(1).and_then(|k| table.get(k)), table.get(after)) {
            (Some(a), Some(b)) => a.1 + (b.1 - a.1) * (theta - a.0) / (b.0 - a.0),
            (Some(e), None) | (None, Some(e)) => e.1,
            (None, None) => f64::NAN,
        }
    }

    fn check(&self) -> Result<(), ScanError> {
        let ascending = self.reflectance_factor.windows(2).all(|w| w[0].0 < w[1].0);
        let positive = |e: &(f64, f64)| e.0.is_finite() && e.1.is_finite() && e.1 > 0.0;
        if self.reflectance_factor.is_empty() || !ascending || !self.reflectance_factor.iter().all(positive) {
            return Err(ScanError::Domain {
                field: "reflectance_factor",
                found: format!("{:?}", self.reflectance_factor),
                allowed: "at least one value > 0, polar angles ascending".into(),
            });
        }
        if !(self.u_relative.is_finite() && (0.0..1.0).contains(&self.u_relative)) {
            return Err(ScanError::Domain {
                field: "u_standard",
                found: self.u_relative.to_string(),
                allowed: "0 to 1, a fraction".into(),
            });
        }
        Ok(())
    }
}

/// Largest relative standard uncertainty a reading of the standard may have to be divided by.
const USEFUL: f64 = 0.2;

/// DSF relative to a calibrated standard scanned over the sample's directions:
/// `DSF = (E_sample / E_standard) beta |cos theta_s| / pi`, each reading divided by that of the standard in the same
/// direction (nearest within `options.dark.tolerance`), at the same incidence and channel. The detector's aperture,
/// distance and gain cancel when both scans share them.
///
/// Readings whose standard is missing, unusable or less than five times its noise are flagged
/// [`Flags::NO_DATA`] and become NaN.
///
/// # Errors
/// As [`crate::process_owned`]; [`ScanError::Mismatch`] when a sample record has no standard of its incidence and
/// channel, when distances or gains differ, or when no direction is shared.
pub fn process_relative(
    sample: Vec<Scan>,
    standard: &[Scan],
    dark: &[Scan],
    reference: &Standard,
    options: &ProcessOptions,
) -> Result<Measurement, ScanError> {
    reference.check()?;
    sample_records(&sample)?;
    for scan in standard.iter().chain(dark) {
        well_formed(scan)?;
    }
    if let Some(s) = sample
        .iter()
        .chain(standard)
        .find(|s| s.quantity != Quantity::Signal)
    {
        return Err(ScanError::Mismatch {
            what: "quantity of a relative measurement".into(),
            found: s.quantity.to_string(),
            needed: Quantity::Signal.to_string(),
        });
    }
    if let Some(s) = standard.iter().find(|s| s.kind != ScanKind::Standard) {
        return Err(ScanError::Mismatch {
            what: "kind of a record of the standard".into(),
            found: s.kind.to_string(),
            needed: ScanKind::Standard.to_string(),
        });
    }
    let noise = noise_models(&sample, dark, options);
    let sample_name = sample.iter().find_map(|s| s.meta.sample_name.clone());
    let without_dark = lacks_dark(&sample, dark);
    let unstated = reference.u_relative == 0.0 && options.u_calibration == 0.0;
    let assumed = unstated.then(no_u_standard).into_iter().collect();
    let done: Vec<Done> = sample
        .into_par_iter()
        .map(|scan| {
            let model = model_of(&noise, &scan, options);
            let partner = partner(&scan, standard, options.dark.tolerance)?;
            one(scan, partner, dark, reference, model, options)
        })
        .collect::<Result<_, _>>()?;
    Ok(assemble(
        done,
        Vec::new(),
        sample_name,
        Vec::new(),
        without_dark,
        assumed,
    ))
}

/// The record of the standard at the incidence and channel of `scan`.
fn partner<'a>(scan: &Scan, standard: &'a [Scan], tolerance: f64) -> Result<&'a Scan, ScanError> {
    let at = scan.incidence.direction();
    let found = standard
        .iter()
        .find(|s| s.channel == scan.channel && s.incidence.direction().angle_to(at) <= tolerance);
    let place = |s: &Scan| {
        format!(
            "{} at theta_i {:.2} deg",
            s.channel,
            s.incidence.theta.to_degrees()
        )
    };
    let Some(found) = found else {
        let have: Vec<String> = standard.iter().map(place).collect();
        return Err(ScanError::Mismatch {
            what: "record of the standard".into(),
            found: if have.is_empty() {
                "none".into()
            } else {
                have.join(", ")
            },
            needed: place(scan),
        });
    };
    let (a, b) = (scan.meta.other.get("gain"), found.meta.other.get("gain"));
    if a.is_some() && b.is_some() && a != b {
        return Err(ScanError::Mismatch {
            what: "gain of the record of the standard".into(),
            found: format!("{b:?}"),
            needed: format!("{a:?} as in the sample record"),
        });
    }
    if let (Some(a), Some(b)) = (scan.meta.distance, found.meta.distance)
        && (a - b).abs() > 1e-6 * a
    {
        return Err(ScanError::Mismatch {
            what: "detector distance of the record of the standard".into(),
            found: format!("{b} m"),
            needed: format!("{a} m as in the sample record"),
        });
    }
    Ok(found)
}

fn one(
    mut scan: Scan,
    standard: &Scan,
    dark: &[Scan],
    reference: &Standard,
    noise: NoiseModel,
    options: &ProcessOptions,
) -> Result<Done, ScanError> {
    let mut standard = standard.clone();
    let mut flags = raw_flags(&scan, &noise, apertures(&scan, None, options));
    let standard_flags = raw_flags(&standard, &noise, apertures(&standard, None, options));
    let found = subtract(&mut scan, dark, &noise, &options.dark)?;
    let of_standard = subtract(&mut standard, dark, &noise, &options.dark)?;
    let u_dark = of_standard.map_or(0.0, |d| d.u_independent.hypot(d.u_common));
    let points: Vec<DVec3> = (0..standard.len())
        .map(|j| {
            if standard_flags[j].usable() {
                standard.direction(j).vec()
            } else {
                DVec3::NAN
            }
        })
        .collect();
    let index = DirectionIndex::new(points);
    // Relative uncertainty of the ratio's denominator, and its value in the unit of DSF / signal.
    let mut scale = vec![f64::NAN; scan.len()];
    let mut u_scale = vec![0.0; scan.len()];
    let mut shared = 0;
    for j in 0..scan.len() {
        let d: Direction = scan.direction(j);
        // Next to the sample plane the nearest direction may lie on the other side.
        let partner = index.nearest(d.vec(), options.dark.tolerance).map(|n| n.0);
        let Some(k) = partner.filter(|&k| standard.direction(k).side() == d.side()) else {
            continue;
        };
        let e = standard.value[k];
        let u = noise.sigma(e).hypot(u_dark) / e;
        if e > 0.0 && u <= USEFUL {
            scale[j] = reference.at(d.theta()) * d.cos_theta().abs() / (PI * e);
            u_scale[j] = u;
            shared += 1;
        }
    }
    if shared == 0 {
        return Err(ScanError::Mismatch {
            what: "directions of the standard".into(),
            found: format!(
                "none within {:.3} deg of a sample reading",
                options.dark.tolerance.to_degrees()
            ),
            needed: "a scan over the sample's directions, above the noise".into(),
        });
    }
    for (flag, s) in flags.iter_mut().zip(&scale) {
        if s.is_nan() {
            *flag |= Flags::NO_DATA;
        }
    }
    let u_common = reference.u_relative.hypot(options.u_calibration);
    let integration = scan.meta.integration;
    let mut slice = to_slice(scan, flags, &noise, found, u_common, |_| 1.0);
    let mean_scale = scale.iter().filter(|s| s.is_finite()).sum::<f64>() / shared as f64;
    for j in 0..slice.len() {
        slice.dsf[j] *= scale[j];
        slice.u_dsf[j] = (slice.u_dsf[j] * scale[j]).hypot(u_scale[j] * slice.dsf[j]);
    }
    add_direction_uncertainty(&mut slice, options.u_angle);
    combine(&mut slice, found.map_or(0.0, |d| d.u_common) * mean_scale)?;
    unresolved::add_uncertainty(&mut slice, None, integration);
    Ok(Done {
        slice,
        noise,
        dark: found,
        findings: Vec::new(),
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::{Noise, spiral_scan};
    use gonio_geom::Side;

    fn standard(level: f64) -> Scan {
        let mut s = spiral_scan(8.0, 0.0, 1500, Side::Front, |d| {
            level * d.cos_theta() * (1.0 + 0.1 * d.theta().sin())
        });
        s.kind = ScanKind::Standard;
        s
    }

    #[test]
    fn the_ratio_to_the_standard_gives_the_sample_whatever_the_instruments_response() {
        let sample = spiral_scan(8.0, 0.0, 1500, Side::Front, |d| {
            0.5 * 7.0 * d.cos_theta() * (1.0 + 0.1 * d.theta().sin())
        });
        let m = process_relative(
            vec![sample],
            &[standard(7.0)],
            &[],
            &Standard::constant(0.98, 0.005),
            &ProcessOptions::default(),
        )
        .unwrap();
        let slice = &m.slices[0];
        for j in (0..1400).step_by(7) {
            assert!((slice.bsdf(j) - 0.49 / PI).abs() < 1e-12);
            assert!((slice.u_dsf[j] / slice.dsf[j] - 0.005).abs() < 1e-9);
        }
        let h = slice.integral(Side::Front).unwrap();
        assert!((h.value - 0.49).abs() < 2e-3 && h.u >= 0.005 * 0.48);
    }

    #[test]
    fn the_noise_of_both_readings_is_in_the_uncertainty() {
        let mut noise = Noise::new(4);
        let model = NoiseModel {
            relative: 0.01,
            ..NoiseModel::UNKNOWN
        };
        let options = ProcessOptions {
            noise: Some(model),
            ..ProcessOptions::default()
        };
        let mut reading = |level: f64| level * (1.0 + 0.01 * noise.normal());
        let sample = spiral_scan(8.0, 0.0, 2000, Side::Front, |d| reading(3.5 * d.cos_theta()));
        let mut white = spiral_scan(8.0, 0.0, 2000, Side::Front, |d| reading(7.0 * d.cos_theta()));
        white.kind = ScanKind::Standard;
        let m = process_relative(
            vec![sample],
            &[white],
            &[],
            &Standard::constant(1.0, 0.0),
            &options,
        )
        .unwrap();
        let slice = &m.slices[0];
        let inside = (0..slice.len())
            .filter(|&j| (slice.bsdf(j) - 0.5 / PI).abs() * slice.theta_s[j].cos() <= 1.96 * slice.u_dsf[j])
            .count();
        // Binomial, p = 0.95, n = 2000: 0.935 to 0.965 holds for all but one seed in 500.
        let coverage = inside as f64 / slice.len() as f64;
        assert!((0.935..=0.965).contains(&coverage), "{coverage}");
    }

    #[test]
    fn a_reflectance_factor_by_angle_is_interpolated() {
        let s = Standard {
            reflectance_factor: vec![(0.0, 1.0), (1.0, 0.8)],
            u_relative: 0.0,
        };
        assert!((s.at(0.5) - 0.9).abs() < 1e-15);
        assert!((s.at(1.2) - 0.8).abs() < 1e-15);
        assert!((s.at(PI - 0.5) - 0.9).abs() < 1e-12);
    }

    #[test]
    fn a_standard_of_another_incidence_distance_or_with_too_few_directions_is_refused() {
        let run = |sample: Scan, white: Scan| {
            let reference = Standard::constant(1.0, 0.0);
            process_relative(
                vec![sample],
                &[white],
                &[],
                &reference,
                &ProcessOptions::default(),
            )
        };
        let sample = spiral_scan(8.0, 0.0, 1500, Side::Front, |d| d.cos_theta());
        let other = spiral_scan(45.0, 0.0, 1500, Side::Front, |d| d.cos_theta());
        assert!(
            run(other, standard(1.0))
                .unwrap_err()
                .to_string()
                .contains("45.00")
        );
        let mut far = sample.clone();
        far.meta.distance = Some(2.0);
        let mut near = standard(1.0);
        near.meta.distance = Some(1.0);
        assert!(run(far, near).unwrap_err().to_string().contains("distance"));
        let back = spiral_scan(8.0, 0.0, 1500, Side::Back, |d| -d.cos_theta());
        assert!(
            run(back, standard(1.0))
                .unwrap_err()
                .to_string()
                .contains("directions")
        );
        assert!(Standard::constant(-1.0, 0.0).check().is_err());
    }

    #[test]
    fn directions_the_standard_does_not_hold_become_no_data() {
        let sample = spiral_scan(8.0, 0.0, 1500, Side::Front, |d| d.cos_theta());
        let mut white = standard(1.0);
        white.value[10] = f64::NAN;
        let m = process_relative(
            vec![sample],
            &[white],
            &[],
            &Standard::constant(1.0, 0.0),
            &ProcessOptions::default(),
        )
        .unwrap();
        let slice = &m.slices[0];
        assert!(slice.flags[10].intersects(Flags::NO_DATA) && slice.dsf[10].is_nan());
        assert_eq!(slice.omega[10], 0.0);
        assert!(slice.integrals[0].value.is_finite());
    }
}
