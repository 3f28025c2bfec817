//! Tilt and azimuth offset of the sample, from where its mirror peaks stand.

mod peak;
#[cfg(test)]
mod tests;

use std::f64::consts::TAU;

use gonio_geom::{DVec3, Direction};

pub use self::peak::Peak;
use self::peak::locate;
use crate::invert::invert;
use crate::weigh::weigh;
use crate::{Measurement, ScanError, Slice};

/// How the sample stood in the instrument: its true normal and the zero of the receiver's azimuth.
#[derive(Clone, Debug, PartialEq)]
pub struct Alignment {
    /// Rotation of the normal about the x axis (towards -y), radians.
    pub tilt_x: f64,
    /// Rotation of the normal about the y axis (towards +x), radians.
    pub tilt_y: f64,
    /// Turn of the receiver's azimuths against those of the incidence, radians.
    pub azimuth: f64,
    /// Covariance of (`tilt_x`, `tilt_y`, `azimuth`), rad^2.
    pub covariance: [[f64; 3]; 3],
    /// Peaks the estimate rests on.
    pub peaks: Vec<Peak>,
    /// Rms distance of the peaks from their fitted places, radians.
    pub residual: f64,
}

impl Alignment {
    /// The tilt of the normal, whatever its direction, radians.
    pub fn tilt(&self) -> f64 {
        Direction::NORMAL.angle_to(Direction::from_unit(self.normal()))
    }

    /// Standard uncertainties of (`tilt_x`, `tilt_y`, `azimuth`), radians.
    pub fn u(&self) -> [f64; 3] {
        std::array::from_fn(|k| self.covariance[k][k].max(0.0).sqrt())
    }

    /// Whether the three angles together stand out of their covariance; those that are known exactly do.
    pub fn is_significant(&self) -> bool {
        let p = [self.tilt_x, self.tilt_y, self.azimuth];
        let chi2 = |inverse: [[f64; 3]; 3]| -> f64 {
            let row = |i: usize| (0..3).map(|j| inverse[i][j] * p[j]).sum::<f64>();
            (0..3).map(|i| p[i] * row(i)).sum()
        };
        invert(self.covariance).is_none_or(|inverse| chi2(inverse) >= SIGNIFICANT)
    }

    /// The true normal in the instrument's frame.
    fn normal(&self) -> DVec3 {
        normal(self.tilt_x, self.tilt_y)
    }
}

/// Joint chi-squared of the three angles from which they are corrected: 99 % of its distribution at three degrees of
/// freedom.
const SIGNIFICANT: f64 = 11.34;

/// `z` turned about the axis (`tilt_x`, `tilt_y`, 0) by its length.
fn normal(tilt_x: f64, tilt_y: f64) -> DVec3 {
    let angle = tilt_x.hypot(tilt_y);
    if angle == 0.0 {
        return DVec3::Z;
    }
    let s = angle.sin() / angle;
    DVec3::new(tilt_y * s, -tilt_x * s, angle.cos())
}

fn turned(v: DVec3, azimuth: f64) -> DVec3 {
    let (s, c) = azimuth.sin_cos();
    DVec3::new(c * v.x - s * v.y, s * v.x + c * v.y, v.z)
}

/// Where the mirror peak of `wi` stands for the parameters (`tilt_x`, `tilt_y`, `azimuth`).
fn peak_of(wi: DVec3, p: [f64; 3]) -> DVec3 {
    let n = normal(p[0], p[1]);
    turned(2.0 * n.dot(wi) * n - wi, p[2])
}

/// Estimates tilt and azimuth offset from the mirror peaks of all slices, by weighted least squares: a peak of
/// incidence `wi` stands at `wi` reflected about the true normal, turned by the azimuth offset. Peaks further than
/// five times the median residual from the fit are left out once.
///
/// # Errors
/// [`ScanError::Domain`] when fewer than two slices with different polar angles of incidence show a mirror peak.
pub fn align(measurement: &Measurement) -> Result<Alignment, ScanError> {
    let slices = &measurement.slices;
    let mut peaks: Vec<Peak> = slices
        .iter()
        .enumerate()
        .filter_map(|(k, s)| locate(k, s))
        .collect();
    let span = |peaks: &[Peak]| {
        let t = peaks.iter().map(|p| slices[p.slice].incidence.theta);
        t.clone().fold(0.0, f64::max) - t.fold(f64::INFINITY, f64::min)
    };
    let few = |n: usize| ScanError::Domain {
        field: "alignment",
        found: format!("{n} slices with a mirror peak"),
        allowed: "at least two, at different polar angles of incidence; a matt sample has none".into(),
    };
    if peaks.len() < 2 || span(&peaks) < 0.05 {
        return Err(few(peaks.len()));
    }
    let mut fitted = fit(slices, &peaks)?;
    let mut distances: Vec<f64> = peaks.iter().map(|p| distance(slices, p, fitted.0)).collect();
    let limit = 5.0 * crate::robust::median(&mut distances).unwrap_or(0.0).max(1e-4);
    let kept: Vec<Peak> = peaks
        .iter()
        .copied()
        .filter(|p| distance(slices, p, fitted.0) <= limit)
        .collect();
    if kept.len() < peaks.len() && kept.len() >= 2 && span(&kept) >= 0.05 {
        fitted = fit(slices, &kept)?;
        peaks = kept;
    }
    let (p, covariance) = fitted;
    let square: f64 = peaks.iter().map(|k| distance(slices, k, p).powi(2)).sum();
    Ok(Alignment {
        tilt_x: p[0],
        tilt_y: p[1],
        azimuth: p[2],
        covariance,
        residual: (square / peaks.len() as f64).sqrt(),
        peaks,
    })
}

fn distance(slices: &[Slice], peak: &Peak, p: [f64; 3]) -> f64 {
    peak_of(slices[peak.slice].incidence.direction().vec(), p).distance(peak.direction.vec())
}

type Fit = ([f64; 3], [[f64; 3]; 3]);

/// Gauss–Newton on the tangent-plane residuals.
fn fit(slices: &[Slice], peaks: &[Peak]) -> Result<Fit, ScanError> {
    let degenerate = || ScanError::Domain {
        field: "alignment",
        found: "incidences that do not determine tilt and azimuth".into(),
        allowed: "mirror peaks at two or more polar angles of incidence".into(),
    };
    const STEP: f64 = 1e-6;
    let mut p = [0.0; 3];
    let mut inverse = [[0.0; 3]; 3];
    let (mut chi2, mut rows) = (0.0, 0.0);
    for _ in 0..20 {
        let (mut normal, mut right) = ([[0.0; 3]; 3], [0.0; 3]);
        (chi2, rows) = (0.0, 0.0);
        for peak in peaks {
            let wi = slices[peak.slice].incidence.direction().vec();
            let weight = 1.0 / (peak.u * peak.u).max(1e-12);
            let residual = peak.direction.vec() - peak_of(wi, p);
            let slope: [DVec3; 3] = std::array::from_fn(|k| {
                let mut q = p;
                q[k] += STEP;
                let forward = peak_of(wi, q);
                q[k] -= 2.0 * STEP;
                (forward - peak_of(wi, q)) / (2.0 * STEP)
            });
            for i in 0..3 {
                right[i] += weight * slope[i].dot(residual);
                for j in 0..3 {
                    normal[i][j] += weight * slope[i].dot(slope[j]);
                }
            }
            chi2 += weight * residual.length_squared();
            rows += 2.0;
        }
        inverse = invert(normal).ok_or_else(degenerate)?;
        let step: [f64; 3] = std::array::from_fn(|i| (0..3).map(|j| inverse[i][j] * right[j]).sum());
        for k in 0..3 {
            p[k] += step[k];
        }
        if step.iter().all(|s| s.abs() < 1e-12) {
            break;
        }
    }
    // Scatter beyond the stated uncertainties widens the covariance, less scatter does not narrow it.
    let factor = if rows > 3.0 {
        (chi2 / (rows - 3.0)).max(1.0)
    } else {
        1.0
    };
    Ok((p, inverse.map(|row| row.map(|v| v * factor))))
}

/// Turns all directions of `measurement` into the frame of the sample's true normal, so that mirror peaks stand in
/// mirror directions, and computes weights and integrals anew. The DSF itself holds no cosine and stays; readings may
/// change sides next to the sample plane. Nothing is corrected when the three angles together do not stand out of
/// their covariance (chi-squared below its 99 % quantile). A warning says what was done.
///
/// # Errors
/// [`ScanError::Domain`] when the turned directions cannot be weighed.
pub fn correct_alignment(measurement: &mut Measurement, alignment: &Alignment) -> Result<(), ScanError> {
    let stated = |a: &Alignment| {
        let [ux, uy, ua] = a.u().map(f64::to_degrees);
        let of = |what: &str, value: f64, u: f64| {
            (u > 0.0).then(|| format!("{:.3} ± {u:.3} deg {what}", value.to_degrees()))
        };
        let all = [
            of("of tilt about x", a.tilt_x, ux),
            of("of tilt about y", a.tilt_y, uy),
            of("of azimuth offset", a.azimuth, ua),
        ];
        all.into_iter().flatten().collect::<Vec<_>>().join(", ")
    };
    if !alignment.is_significant() {
        measurement.warnings.push(format!(
            "alignment: nothing was corrected, the angles do not stand out of their uncertainty ({})",
            stated(alignment)
        ));
        return Ok(());
    }
    let n = alignment.normal();
    // The shortest rotation that takes the true normal to z.
    let axis = n.cross(DVec3::Z);
    let cos = n.z;
    let upright = |v: DVec3| {
        // Rodrigues with sin folded into the axis.
        cos * v + axis.cross(v) + axis * (axis.dot(v) / (1.0 + cos))
    };
    for slice in &mut measurement.slices {
        let wi = upright(slice.incidence.direction().vec());
        slice.incidence = Direction::from_unit(wi.normalize()).angles();
        for j in 0..slice.len() {
            let ws = slice.direction(j).vec();
            let d = Direction::from_unit(upright(turned(ws, -alignment.azimuth)).normalize());
            slice.theta_s[j] = d.theta();
            slice.phi_s[j] = d.phi().rem_euclid(TAU);
        }
        let before = std::mem::take(&mut slice.integrals);
        weigh(slice, 0.0)?;
        // What the readings alone do not tell (the zero, peaks between them) was in the integrals before.
        for h in &mut slice.integrals {
            if let Some(b) = before.iter().find(|b| b.side == h.side) {
                h.u = h.u.max(b.u);
                h.u_quadrature = h.u_quadrature.max(b.u_quadrature);
            }
        }
    }
    measurement.warnings.push(format!(
        "alignment: directions corrected for {}",
        stated(alignment)
    ));
    Ok(())
}
