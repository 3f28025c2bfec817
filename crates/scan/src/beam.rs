//! The power of the beam, from a scan of the beam without a sample.

use gonio_bsdf::{Channel, Quantity};
use gonio_geom::{DVec3, Direction};

use crate::phase::raster_uncertainty;
use crate::robust::mean_and_deviation;
use crate::weigh::patch_omega;
use crate::{NoiseModel, Scan, ScanError, ScanKind, Signature};

/// What a reference scan of one channel says about the beam.
#[derive(Clone, Debug, PartialEq)]
pub struct Beam {
    /// Spectral channel.
    pub channel: Channel,
    /// `P_i = sum E_s Omega_s` \[ApianBennewitz2010; eq. 6.2 of the source chapter\], unit of the readings times sr; the mean over repeated scans.
    pub power: f64,
    /// Relative standard uncertainty of `power` from the raster's quadrature.
    pub u_quadrature: f64,
    /// Relative standard uncertainty of `power` from noise and dark.
    pub u_noise: f64,
    /// Relative standard uncertainty of `power` from the scatter of repeated reference scans; `None` for one scan.
    pub u_repeatability: Option<f64>,
    /// Angular profile of the beam: the instrument signature.
    pub signature: Signature,
    /// Detector distance of the reference scan, metres.
    pub distance: Option<f64>,
    /// Receiver solid angle of the reference scan, sr.
    pub receiver_solid_angle: Option<f64>,
    /// Gain of the reference scan as its record names it.
    pub gain: Option<String>,
    /// Number of reference scans.
    pub scans: usize,
    /// Mean signal at the rim of the raster as a fraction of its peak.
    pub rim: f64,
}

impl Beam {
    /// Relative combined standard uncertainty of the power.
    ///
    /// The scatter of few repeated scans is widened by Student's factor, so that twice the result still covers 95 %
    /// [JCGM100, G.3].
    pub fn u_power(&self) -> f64 {
        // Repeated scans scatter by noise and raster phase too: the larger of the two accounts, not both.
        let repeated = self
            .u_repeatability
            .map_or(0.0, |u| u * student_factor(self.scans));
        self.u_quadrature.hypot(self.u_noise).max(repeated)
    }
}

/// Half width of the 95 % interval of a mean of `n >= 2` values over that of a known standard deviation.
fn student_factor(n: usize) -> f64 {
    const NORMAL: f64 = 1.959_964;
    // Two-sided 95 % points of Student's t for 1 to 9 degrees of freedom; from there on its expansion in 1/nu.
    const T95: [f64; 9] = [12.706, 4.303, 3.182, 2.776, 2.571, 2.447, 2.365, 2.306, 2.262];
    let nu = n.saturating_sub(1).max(1);
    let t = T95.get(nu - 1).copied().unwrap_or_else(|| {
        let nu = nu as f64;
        NORMAL + 2.3723 / nu + 2.8225 / (nu * nu)
    });
    t / NORMAL
}

/// Largest mean signal at the rim of the raster, as a fraction of the peak, at which it still covers the beam.
const RIM_LIMIT: f64 = 0.01;

/// Beam power and signature from the dark-subtracted reference scans of one channel. `u_dark` is the standard
/// uncertainty that all readings of a scan share (dark level).
///
/// Scans repeated over the same directions tell their noise reading by reading; of others `noise` has to, which counts
/// the structure of a steep beam along with it.
///
/// The quadrature's uncertainty is one and a half times the scatter of the sum over positions of the raster, for the
/// beam's fall-off as the readings show it; not less than an eighth of, and not more than, the rms change of the sum when
/// the raster is thinned to twice its pitch (docs/uncertainty.md).
///
/// # Errors
/// [`ScanError::Mismatch`] for a record that is no beam scan, holds no signal, mixes channels, distances, apertures
/// or gains, or does not cover the beam; [`ScanError::Domain`] when there is no usable reading or no power.
pub fn beam_power(scans: &[Scan], noise: &NoiseModel, u_dark: f64) -> Result<Beam, ScanError> {
    let Some(first) = scans.first() else {
        return Err(ScanError::Domain {
            field: "beam",
            found: "no reference scan".into(),
            allowed: "at least one".into(),
        });
    };
    let singles: Vec<Single> = scans
        .iter()
        .map(|scan| {
            same_set_up(first, scan)?;
            single(scan, noise, u_dark)
        })
        .collect::<Result<_, _>>()?;
    let powers: Vec<f64> = singles.iter().map(|s| s.power).collect();
    let n = powers.len() as f64;
    let (power, deviation) = mean_and_deviation(&powers).unwrap_or((0.0, 0.0));
    let rms = |pick: fn(&Single) -> f64| -> f64 {
        (singles.iter().map(|s| pick(s).powi(2)).sum::<f64>() / n).sqrt() / n.sqrt()
    };
    let u_noise = match scatter_of_repeats(scans, &singles[0].omega) {
        Some(sum) => (sum / n.sqrt()).hypot(rms(|s| s.u_dark) * power) / power,
        None => rms(|s| s.u_noise.hypot(s.u_dark)),
    };
    Ok(Beam {
        channel: first.channel,
        power,
        u_quadrature: rms(|s| s.u_quadrature),
        u_noise,
        u_repeatability: (powers.len() > 1).then(|| deviation / n.sqrt() / power),
        signature: singles[0].signature,
        distance: first.meta.distance,
        receiver_solid_angle: first.meta.receiver_solid_angle,
        gain: first.meta.other.get("gain").cloned(),
        scans: scans.len(),
        rim: singles.iter().map(|s| s.rim).fold(0.0, f64::max),
    })
}

struct Single {
    power: f64,
    u_quadrature: f64,
    u_noise: f64,
    u_dark: f64,
    omega: Vec<f64>,
    signature: Signature,
    rim: f64,
}

fn name_of(scan: &Scan) -> String {
    match &scan.meta.source {
        Some(source) => format!("reference scan {source}"),
        None => "reference scan".into(),
    }
}

fn same_set_up(first: &Scan, scan: &Scan) -> Result<(), ScanError> {
    let mismatch = |what: &str, found: String, needed: String| {
        Err(ScanError::Mismatch {
            what: format!("{what} of the {}", name_of(scan)),
            found,
            needed,
        })
    };
    if scan.kind != ScanKind::Beam {
        return mismatch("kind", scan.kind.to_string(), ScanKind::Beam.to_string());
    }
    if scan.quantity != Quantity::Signal {
        return mismatch(
            "quantity",
            scan.quantity.to_string(),
            Quantity::Signal.to_string(),
        );
    }
    if scan.channel != first.channel {
        return mismatch("channel", scan.channel.to_string(), first.channel.to_string());
    }
    let differ = |a: Option<f64>, b: Option<f64>| matches!((a, b), (Some(a), Some(b)) if (a - b).abs() > 1e-6 * a.abs());
    if differ(scan.meta.distance, first.meta.distance) {
        return mismatch(
            "distance",
            format!("{:?} m", scan.meta.distance.unwrap_or(f64::NAN)),
            format!(
                "{:?} m as in the first reference scan",
                first.meta.distance.unwrap_or(f64::NAN)
            ),
        );
    }
    if scan.meta.other.get("gain") != first.meta.other.get("gain") {
        return mismatch(
            "gain",
            format!("{:?}", scan.meta.other.get("gain")),
            format!(
                "{:?} as in the first reference scan",
                first.meta.other.get("gain")
            ),
        );
    }
    Ok(())
}

fn single(scan: &Scan, noise: &NoiseModel, u_dark: f64) -> Result<Single, ScanError> {
    let (mut points, mut value): (Vec<DVec3>, Vec<f64>) = (Vec::new(), Vec::new());
    let saturation = scan.meta.saturation.unwrap_or(f64::INFINITY);
    for j in 0..scan.len() {
        if !scan.value[j].is_finite() {
            continue;
        }
        if scan.value[j] >= saturation {
            return Err(ScanError::Domain {
                field: "beam",
                found: format!(
                    "{}: reading {} of {saturation}, saturated",
                    name_of(scan),
                    scan.value[j]
                ),
                allowed: "readings below saturation (use a neutral-density filter or a lower gain)".into(),
            });
        }
        points.push(scan.direction(j).vec());
        value.push(scan.value[j]);
    }
    if points.len() < 9 {
        return Err(ScanError::Domain {
            field: "beam",
            found: format!("{}: {} usable readings", name_of(scan), points.len()),
            allowed: "at least 9, spread over the beam".into(),
        });
    }
    let omega = patch_omega(&points)?;
    let sum = |w: &[f64]| -> f64 { value.iter().zip(w).map(|(v, w)| v * w).sum() };
    let power = sum(&omega);
    let peak = value.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    let peak_noise = noise.readout;
    if power.is_nan() || power <= 0.0 || peak <= 5.0 * peak_noise {
        return Err(ScanError::Domain {
            field: "beam",
            found: format!(
                "{}: power {power:.3e}, peak {peak:.3e}, noise {peak_noise:.3e}",
                name_of(scan)
            ),
            allowed: "a beam well above the noise (is it the dark record?)".into(),
        });
    }
    let rim = rim_level(&points, &value) / peak;
    if rim > RIM_LIMIT {
        return Err(ScanError::Mismatch {
            what: format!("extent of the {}", name_of(scan)),
            found: format!("{:.1} % of the peak signal at the rim of the raster", 100.0 * rim),
            needed: format!(
                "less than {:.0} %: scan a wider field about the beam",
                100.0 * RIM_LIMIT
            ),
        });
    }
    let variance: f64 = value
        .iter()
        .zip(&omega)
        .map(|(&v, w)| (w * noise.sigma(v)).powi(2))
        .sum();
    let field: f64 = omega.iter().sum();
    let expected = scan.incidence.direction().through();
    let signature =
        Signature::of(&points, &value, &omega, 3.0 * noise.readout, expected).ok_or(ScanError::Domain {
            field: "beam",
            found: format!("{}: no reading above the noise", name_of(scan)),
            allowed: "a beam well above the noise".into(),
        })?;
    let u_quadrature = raster_uncertainty(&points, &value, &omega, signature.centroid, power, variance)?;
    Ok(Single {
        power,
        u_quadrature: u_quadrature / power,
        u_noise: variance.sqrt() / power,
        u_dark: u_dark * field / power,
        omega,
        signature,
        rim,
    })
}

/// Standard deviation of the beam sum of one scan from the scatter of each reading over repeated scans, in which the
/// beam's structure cancels. `None` for a single scan, or for scans of other directions or with readings missing.
fn scatter_of_repeats(scans: &[Scan], omega: &[f64]) -> Option<f64> {
    let (first, rest) = scans.split_first()?;
    let same = |scan: &Scan| {
        scan.len() == omega.len()
            && scan.value.iter().all(|v| v.is_finite())
            && (0..scan.len()).all(|j| scan.direction(j).angle_to(first.direction(j)) < 1e-6)
    };
    if rest.is_empty() || !scans.iter().all(same) {
        return None;
    }
    let variance: f64 = (0..first.len())
        .map(|j| {
            let repeats: Vec<f64> = scans.iter().map(|s| s.value[j]).collect();
            let deviation = mean_and_deviation(&repeats).map_or(0.0, |m| m.1);
            (omega[j] * deviation).powi(2)
        })
        .sum();
    Some(variance.sqrt())
}

/// Mean signal of the readings on the convex rim of the raster, seen in the tangent plane of its centre.
fn rim_level(points: &[DVec3], value: &[f64]) -> f64 {
    let centre = points.iter().copied().sum::<DVec3>();
    let Some(centre) = Direction::new(centre) else {
        return 0.0;
    };
    let n = centre.vec();
    let e1 = n.any_orthonormal_vector();
    let e2 = n.cross(e1);
    // Azimuthal equidistant, 36 sectors: the outermost reading of each.
    let mut outer: [Option<(f64, f64)>; 36] = [None; 36];
    for (&p, &v) in points.iter().zip(value) {
        let gamma = centre.angle_to(Direction::from_unit(p));
        let azimuth = p.dot(e2).atan2(p.dot(e1)) + std::f64::consts::PI;
        let sector = ((azimuth / std::f64::consts::TAU * 36.0) as usize).min(35);
        if outer[sector].is_none_or(|o| gamma > o.0) {
            outer[sector] = Some((gamma, v));
        }
    }
    let rim: Vec<f64> = outer.iter().flatten().map(|o| o.1).collect();
    mean_and_deviation(&rim).map_or(0.0, |m| m.0)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::{Noise, beam_scan};

    const W: f64 = 0.5;

    fn gauss(g: f64) -> f64 {
        (-(g.to_degrees() / W).powi(2)).exp()
    }

    fn gauss_power() -> f64 {
        std::f64::consts::PI * W.to_radians().powi(2)
    }

    #[test]
    fn the_power_of_a_gaussian_beam_is_its_closed_form() {
        let scan = beam_scan(0.0, 0.0, 0.15, 2.0, gauss);
        let beam = beam_power(&[scan], &NoiseModel::UNKNOWN, 0.0).unwrap();
        assert!(
            (beam.power / gauss_power() - 1.0).abs() < 2e-4,
            "{}",
            beam.power / gauss_power()
        );
        assert!(beam.u_power() < 5e-3, "{}", beam.u_power());
        assert_eq!(beam.u_repeatability, None);
    }

    /// Overlap of disks of radius `a` and `b` at distance `d`, as a share of the second.
    fn disk_seen_through_an_aperture(a: f64, b: f64, d: f64) -> f64 {
        let part = |r: f64, x: f64| {
            let c = (x / r).clamp(-1.0, 1.0);
            r * r * (c.acos() - c * (1.0 - c * c).max(0.0).sqrt())
        };
        let covered = if d >= a + b {
            0.0
        } else if d <= (a - b).abs() {
            std::f64::consts::PI * a.min(b).powi(2)
        } else {
            let x = (d * d + a * a - b * b) / (2.0 * d);
            part(a, x) + part(b, d - x)
        };
        covered / (std::f64::consts::PI * b * b)
    }

    /// Error and claim of the power over random phases of a raster of `along` by `across` degrees, relative.
    fn phases(
        profile: &dyn Fn(f64) -> f64,
        reach: f64,
        along: f64,
        across: f64,
        jitter: f64,
    ) -> Vec<(f64, f64)> {
        let steps = 20_000;
        let truth: f64 = (0..steps)
            .map(|k| {
                let g = (f64::from(k) + 0.5) * reach / f64::from(steps);
                std::f64::consts::TAU
                    * profile(g)
                    * g.to_radians().sin()
                    * (reach / f64::from(steps)).to_radians()
            })
            .sum();
        let mut noise = Noise::new(5);
        let half = reach + 4.0 * across;
        (0..100)
            .map(|_| {
                let mut scan = crate::testing::record(0.0, 0.0);
                scan.kind = ScanKind::Beam;
                let (ox, oy) = (noise.uniform() * along, noise.uniform() * across);
                let mut y = -half + oy;
                while y < half {
                    let mut x = -half + ox;
                    while x < half {
                        let (a, b) = (
                            (x + jitter * along * (noise.uniform() - 0.5)).to_radians(),
                            (y + jitter * across * (noise.uniform() - 0.5)).to_radians(),
                        );
                        let d = Direction::from_unit(DVec3::new(a, b, -1.0).normalize());
                        let gamma = DVec3::NEG_Z.angle_between(d.vec()).to_degrees();
                        scan.push(d, profile(gamma));
                        x += along;
                    }
                    y += across;
                }
                let beam = beam_power(&[scan], &NoiseModel::UNKNOWN, 0.0).unwrap();
                (beam.power / truth - 1.0, beam.u_power())
            })
            .collect()
    }

    #[test]
    fn the_stated_quadrature_uncertainty_covers_random_phases_of_the_raster_and_is_not_idle() {
        let pillbox = |r: f64, a: f64| move |g: f64| disk_seen_through_an_aperture(r, a, g);
        let (wide, narrow, broad) = (pillbox(0.3, 0.25), pillbox(0.15, 0.1), pillbox(0.5, 0.5));
        let smooth = |g: f64| (-(g / 0.3_f64).powi(2)).exp();
        type Case<'a> = (&'a str, &'a dyn Fn(f64) -> f64, f64, [f64; 3]);
        let cases: [Case<'_>; 11] = [
            ("pillbox .3 + .25", &wide, 0.56, [0.1, 0.1, 0.0]),
            ("pillbox .3 + .25", &wide, 0.56, [0.2, 0.2, 0.0]),
            ("pillbox .3 + .25", &wide, 0.56, [0.05, 0.2, 0.0]),
            ("pillbox .3 + .25", &wide, 0.56, [0.1, 0.1, 0.3]),
            ("pillbox .15 + .1", &narrow, 0.26, [0.05, 0.05, 0.0]),
            ("pillbox .15 + .1", &narrow, 0.26, [0.1, 0.1, 0.0]),
            ("pillbox .5 + .5", &broad, 1.01, [0.2, 0.2, 0.0]),
            ("pillbox .5 + .5", &broad, 1.01, [0.3, 0.3, 0.3]),
            ("gaussian .3", &smooth, 1.3, [0.1, 0.1, 0.0]),
            ("gaussian .3", &smooth, 1.3, [0.1, 0.1, 0.3]),
            ("gaussian .3", &smooth, 1.3, [0.2, 0.2, 0.3]),
        ];
        for (name, profile, reach, [along, across, jitter]) in cases {
            let found = phases(profile, reach, along, across, jitter);
            let n = found.len() as f64;
            let held = found.iter().filter(|(e, u)| e.abs() <= 2.0 * u + 1e-6).count();
            let rms = (found.iter().map(|f| f.0 * f.0).sum::<f64>() / n).sqrt();
            let u = (found.iter().map(|f| f.1 * f.1).sum::<f64>() / n).sqrt();
            // Of 100 trials at 95 % fewer than 90 hold once in 40 right claims.
            assert!(
                held >= 90,
                "{name}, {along} x {across}, jitter {jitter}: {held} held"
            );
            assert!(
                u < 2.5 * rms || u < 1e-4,
                "{name}, {along} x {across}, jitter {jitter}: {u:.2e} claimed, {rms:.2e} found"
            );
        }
    }

    #[test]
    fn noise_and_repeated_scans_enter_the_uncertainty() {
        let mut noise = Noise::new(11);
        let model = NoiseModel {
            readout: 0.002,
            relative: 0.01,
            ..NoiseModel::UNKNOWN
        };
        let mut errors = Vec::new();
        let mut claimed = 0.0;
        for _ in 0..60 {
            let scan = beam_scan(0.0, 0.0, 0.2, 2.0, |g| {
                gauss(g) + noise.normal() * model.sigma(gauss(g))
            });
            let beam = beam_power(&[scan], &model, 0.0).unwrap();
            errors.push(beam.power / gauss_power() - 1.0);
            claimed = beam.u_noise;
        }
        let (_, spread) = mean_and_deviation(&errors).unwrap();
        // 60 repeats: the standard deviation is known to 9 %; 0.7..1.35 lets a right claim fail once in 1000 seeds.
        assert!((0.7..1.35).contains(&(claimed / spread)), "{claimed} {spread}");
        // Repeats over the same directions tell the noise without any model of it.
        let mut ratios = Vec::new();
        for _ in 0..30 {
            let scans: Vec<Scan> = (0..3)
                .map(|_| {
                    beam_scan(0.0, 0.0, 0.2, 2.0, |g| {
                        gauss(g) + noise.normal() * model.sigma(gauss(g))
                    })
                })
                .collect();
            ratios.push(beam_power(&scans, &NoiseModel::UNKNOWN, 0.0).unwrap().u_noise / claimed);
        }
        let (mean, _) = mean_and_deviation(&ratios).unwrap();
        // The variance of some 40 readings in the beam with two degrees of freedom each: a ratio scatters by 8 %,
        // the mean of 30 by 1.5 %; five of those.
        assert!((mean * 3.0_f64.sqrt() - 1.0).abs() < 0.075, "{mean}");
        let scans: Vec<Scan> = [1.0, 1.02, 0.98]
            .iter()
            .map(|f| beam_scan(0.0, 0.0, 0.2, 2.0, |g| f * gauss(g)))
            .collect();
        let beam = beam_power(&scans, &NoiseModel::UNKNOWN, 0.0).unwrap();
        let u = beam.u_repeatability.unwrap();
        assert!((u - 0.02 / 3.0_f64.sqrt()).abs() < 1e-4, "{u}");
        // Student's t of two degrees of freedom.
        assert!((beam.u_power() / u - 4.303 / 1.96).abs() < 1e-3);
        assert!((student_factor(31) * 1.96 - 2.0423).abs() < 1e-3);
    }

    #[test]
    fn a_raster_that_cuts_the_beam_off_is_refused() {
        let scan = beam_scan(0.0, 0.0, 0.1, 0.5, gauss);
        let error = beam_power(&[scan], &NoiseModel::UNKNOWN, 0.0).unwrap_err();
        assert!(error.to_string().contains("wider field"), "{error}");
    }

    #[test]
    fn a_dark_record_or_another_kind_does_not_pass_for_the_beam() {
        let mut noise = Noise::new(2);
        let model = NoiseModel {
            readout: 1.0,
            ..NoiseModel::UNKNOWN
        };
        let scan = beam_scan(0.0, 0.0, 0.2, 2.0, |_| noise.normal());
        assert!(beam_power(&[scan], &model, 0.0).is_err());
        let mut scan = beam_scan(0.0, 0.0, 0.2, 2.0, gauss);
        scan.kind = ScanKind::Sample;
        let error = beam_power(&[scan], &NoiseModel::UNKNOWN, 0.0).unwrap_err();
        assert!(error.to_string().contains("kind"), "{error}");
    }
}
