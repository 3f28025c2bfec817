//! The power of the beam, from a scan of the beam without a sample.

use gonio_bsdf::{Channel, Quantity};
use gonio_geom::{DVec3, Direction};

use crate::flagging::half_angle;
use crate::phase::raster_uncertainty;
use crate::robust::mean_and_deviation;
use crate::weigh::patch_omega;
use crate::{NoiseModel, Resolution, Scan, ScanError, ScanKind, Signature};

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
    /// Diameter of the beam at the sample, metres.
    pub spot_diameter: Option<f64>,
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
    /// What readings of this beam resolve; `None` when its raster is too coarse to tell.
    pub fn resolution(&self) -> Option<Resolution> {
        let s = &self.signature;
        let known = |v: f64| v.is_finite() && v > 0.0;
        let all = [s.fwhm, s.radius_50, s.radius_90, s.second_moment];
        all.into_iter().all(known).then(|| Resolution {
            channel: self.channel,
            fwhm: s.fwhm,
            radius_50: s.radius_50,
            radius_90: s.radius_90,
            second_moment: s.second_moment,
            receiver_radius: self.receiver_solid_angle.map(half_angle).filter(|r| known(*r)),
            spot_radius: self
                .spot_diameter
                .zip(self.distance)
                .map(|(spot, distance)| 0.5 * spot / distance)
                .filter(|r| known(*r)),
        })
    }

    /// Relative combined standard uncertainty of the power.
    ///
    /// Repeated scans scatter by noise and raster phase, which are known. Where they scatter by more, the beam itself
    /// varies: then their scatter counts, widened by Student's factor, so that twice the result still covers 95 %
    /// [JCGM100, G.3]. The scatter of two scans says too little to trust a small one: the larger figure counts.
    pub fn u_power(&self) -> f64 {
        let known = self.u_quadrature.hypot(self.u_noise);
        match self.u_repeatability {
            Some(u) if self.scans == 2 => known.max(u * student_factor(2)),
            Some(u) if u > known => u * student_factor(self.scans),
            _ => known,
        }
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
        spot_diameter: first.meta.beam_diameter,
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
mod tests;
