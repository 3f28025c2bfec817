//! Tilt and azimuth offset of the sample, from where its mirror peaks stand.

use std::f64::consts::TAU;

use gonio_geom::{DVec3, Direction};

use crate::weigh::weigh;
use crate::{Measurement, ScanError, Slice};

/// A mirror peak found in one slice.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Peak {
    /// Index of the slice.
    pub slice: usize,
    /// Where it stands.
    pub direction: Direction,
    /// Standard uncertainty of its position on each axis, radians.
    pub u: f64,
}

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

    /// The true normal in the instrument's frame.
    fn normal(&self) -> DVec3 {
        normal(self.tilt_x, self.tilt_y)
    }
}

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

/// Readings above this fraction of the peak locate it.
const ABOVE: [f64; 3] = [0.7, 0.5, 0.3];
/// Readings a peak needs above that fraction.
const READINGS: usize = 8;
/// Angle from the nominal mirror direction within which a peak may stand, radians (15 degrees).
const SEARCH: f64 = 0.261_799_387_799_149_4;
/// Ratio of peak to median below which a slice has no mirror peak.
const CONTRAST: f64 = 2.0;
/// Systematic part of a peak's position, as a fraction of its half width: shadowing and Fresnel skew broad lobes.
const SKEW: f64 = 0.03;

/// The mirror peak of `slice`: vertex of the paraboloid that `ln dsf` follows above a fraction of the maximum, in
/// the tangent plane there. `None` without a peak near the mirror direction, or with too few readings on it.
fn locate(index: usize, slice: &Slice) -> Option<Peak> {
    let mirror = slice.incidence.direction().mirror();
    let side = slice.incidence.direction().side();
    let usable = |j: &usize| {
        let d = slice.direction(*j);
        slice.flags[*j].usable() && d.side() == side && slice.dsf[*j] > 0.0
    };
    let near: Vec<usize> = (0..slice.len())
        .filter(usable)
        .filter(|&j| slice.direction(j).angle_to(mirror) <= 1.5 * SEARCH)
        .collect();
    let top = near
        .iter()
        .copied()
        .max_by(|&a, &b| slice.dsf[a].total_cmp(&slice.dsf[b]))?;
    let mut all: Vec<f64> = (0..slice.len()).filter(usable).map(|j| slice.dsf[j]).collect();
    if slice.dsf[top] < CONTRAST * crate::robust::median(&mut all)? {
        return None;
    }
    let centre = slice.direction(top);
    let (e1, e2) = centre.vec().any_orthonormal_pair();
    for fraction in ABOVE {
        let chosen: Vec<usize> = near
            .iter()
            .copied()
            .filter(|&j| slice.dsf[j] >= fraction * slice.dsf[top])
            .collect();
        if chosen.len() < READINGS {
            continue;
        }
        let rows: Vec<([f64; 6], f64)> = chosen
            .iter()
            .map(|&j| {
                let d = slice.direction(j).vec();
                let (x, y) = (d.dot(e1), d.dot(e2));
                ([1.0, x, y, x * x, x * y, y * y], slice.dsf[j].ln())
            })
            .collect();
        let Some((x, y, u, width)) = vertex(&rows) else {
            continue;
        };
        let direction = Direction::new(centre.vec() + x * e1 + y * e2)?;
        if direction.angle_to(mirror) > SEARCH {
            return None;
        }
        return Some(Peak {
            slice: index,
            direction,
            u: u.hypot(SKEW * width),
        });
    }
    None
}

/// Maximum of the least-squares quadratic through `rows`: position, its standard error from the scatter about the
/// fit, and the half width `1 / sqrt(-curvature)`. `None` when the quadratic has no maximum.
fn vertex(rows: &[([f64; 6], f64)]) -> Option<(f64, f64, f64, f64)> {
    let mut normal = [[0.0; 6]; 6];
    let mut right = [0.0; 6];
    for (a, y) in rows {
        for i in 0..6 {
            right[i] += a[i] * y;
            for j in 0..6 {
                normal[i][j] += a[i] * a[j];
            }
        }
    }
    let inverse = invert(normal)?;
    let c: [f64; 6] = std::array::from_fn(|i| (0..6).map(|j| inverse[i][j] * right[j]).sum());
    let determinant = 4.0 * c[3] * c[5] - c[4] * c[4];
    if c[3] >= 0.0 || determinant <= 0.0 {
        return None;
    }
    let x = (c[4] * c[2] - 2.0 * c[5] * c[1]) / determinant;
    let y = (c[4] * c[1] - 2.0 * c[3] * c[2]) / determinant;
    let square: f64 = rows
        .iter()
        .map(|(a, v)| (v - (0..6).map(|k| a[k] * c[k]).sum::<f64>()).powi(2))
        .sum();
    let scatter = square / (rows.len().max(7) - 6) as f64;
    let curvature = determinant.sqrt(); // geometric mean of the two, of the sign-reversed quadratic's Hessian
    let slope_variance = scatter * 0.5 * (inverse[1][1] + inverse[2][2]);
    Some((x, y, slope_variance.sqrt() / curvature, 1.0 / curvature.sqrt()))
}

/// Inverse by Gauss–Jordan with pivoting; `None` when singular.
fn invert<const N: usize>(mut a: [[f64; N]; N]) -> Option<[[f64; N]; N]> {
    let mut b: [[f64; N]; N] = std::array::from_fn(|i| std::array::from_fn(|j| f64::from(i == j)));
    // Columns of very different size (1, x, x^2) need no scaling with pivoting by rows, but a relative threshold.
    let scale: [f64; N] = std::array::from_fn(|i| a[i][i].abs());
    for k in 0..N {
        let pivot = (k..N).max_by(|&i, &j| a[i][k].abs().total_cmp(&a[j][k].abs()))?;
        if a[pivot][k].abs() <= 1e-13 * scale[k] || a[pivot][k] == 0.0 {
            return None;
        }
        a.swap(k, pivot);
        b.swap(k, pivot);
        let p = a[k][k];
        for j in 0..N {
            a[k][j] /= p;
            b[k][j] /= p;
        }
        for i in (0..N).filter(|&i| i != k) {
            let f = a[i][k];
            for j in 0..N {
                a[i][j] -= f * a[k][j];
                b[i][j] -= f * b[k][j];
            }
        }
    }
    Some(b)
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

/// Joint chi-squared of the three angles from which they are corrected: 99 % of its distribution at three degrees of
/// freedom.
const SIGNIFICANT: f64 = 11.34;

/// Whether the three angles together stand out of their covariance; one that is known exactly does.
fn significant(a: &Alignment) -> bool {
    let p = [a.tilt_x, a.tilt_y, a.azimuth];
    let chi2 = |inverse: [[f64; 3]; 3]| -> f64 {
        let row = |i: usize| (0..3).map(|j| inverse[i][j] * p[j]).sum::<f64>();
        (0..3).map(|i| p[i] * row(i)).sum()
    };
    invert(a.covariance).is_none_or(|inverse| chi2(inverse) >= SIGNIFICANT)
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
    if !significant(alignment) {
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
        weigh(slice, 0.0)?;
    }
    measurement.warnings.push(format!(
        "alignment: directions corrected for {}",
        stated(alignment)
    ));
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::{Noise, path_scan, record, slice_of};
    use gonio_geom::Angles;

    /// Slices of a Gaussian microfacet-like lobe on a sample that stands tilted and turned.
    fn tilted(tilt: [f64; 2], azimuth: f64, noise: f64) -> Measurement {
        let n = Direction::from_unit(normal(tilt[0], tilt[1]));
        let mut random = Noise::new(17);
        let slices = [10.0, 30.0, 50.0, 65.0]
            .iter()
            .map(|&t| {
                let wi = Angles::from_degrees(t, 0.0).direction().vec();
                let scan = path_scan(2.0, 1.0, |ws| {
                    let ws = turned(ws.vec(), -azimuth);
                    let h = Direction::new(wi + ws).unwrap_or(Direction::NORMAL);
                    let lobe = (-(h.angle_to(n) / 0.12).powi(2)).exp();
                    (lobe + 1e-3) * (1.0 + noise * random.normal())
                });
                slice_of(crate::Scan {
                    incidence: record(t, 0.0).incidence,
                    ..scan
                })
            })
            .collect();
        Measurement {
            slices,
            ..Measurement::default()
        }
    }

    #[test]
    fn a_tilt_of_3_degrees_and_an_azimuth_offset_of_2_are_recovered_to_a_tenth() {
        let (tilt, azimuth) = ([1.8_f64.to_radians(), -2.4_f64.to_radians()], 2_f64.to_radians());
        let m = tilted(tilt, azimuth, 0.02);
        let found = align(&m).unwrap();
        assert!((found.tilt().to_degrees() - 3.0).abs() < 0.1);
        for (value, truth) in [
            (found.tilt_x, tilt[0]),
            (found.tilt_y, tilt[1]),
            (found.azimuth, azimuth),
        ] {
            assert!(
                (value - truth).to_degrees().abs() < 0.1,
                "{} {}",
                value.to_degrees(),
                truth.to_degrees()
            );
        }
        assert_eq!(found.peaks.len(), 4);
        // Each parameter within four standard uncertainties (once in 5000 seeds by chance).
        for (k, truth) in [tilt[0], tilt[1], azimuth].into_iter().enumerate() {
            let value = [found.tilt_x, found.tilt_y, found.azimuth][k];
            assert!((value - truth).abs() < 4.0 * found.u()[k]);
        }
    }

    #[test]
    fn after_the_correction_the_mirror_peaks_stand_in_the_mirror_directions() {
        let mut m = tilted([0.03, 0.02], 0.03, 0.0);
        let found = align(&m).unwrap();
        correct_alignment(&mut m, &found).unwrap();
        let again = align(&m).unwrap();
        assert!(
            again.tilt().to_degrees() < 0.1 && again.azimuth.to_degrees().abs() < 0.1,
            "{again:?}"
        );
        let covered: f64 = m.slices[0].omega.iter().sum();
        assert!(covered > 6.0, "{covered}");
    }

    #[test]
    fn angles_that_do_not_stand_out_of_their_uncertainty_are_not_corrected() {
        let mut m = tilted([0.0, 0.03], 0.0, 0.02);
        let found = align(&m).unwrap();
        let before = m.slices.clone();
        let mut vague = found.clone();
        vague.covariance = [[0.5, 0.0, 0.0], [0.0, 0.5, 0.0], [0.0, 0.0, 0.5]];
        correct_alignment(&mut m, &vague).unwrap();
        assert_eq!(m.slices, before);
        assert!(
            m.warnings[0].contains("nothing was corrected"),
            "{:?}",
            m.warnings
        );
        correct_alignment(&mut m, &found).unwrap();
        assert!(m.warnings[1].contains("directions corrected"), "{:?}", m.warnings);
        assert!(align(&m).unwrap().tilt().to_degrees() < 0.1);
    }

    #[test]
    fn an_aligned_sample_stays_and_a_matt_one_cannot_be_aligned() {
        let found = align(&tilted([0.0, 0.0], 0.0, 0.0)).unwrap();
        assert!(found.tilt().to_degrees() < 0.05);
        let matt = Measurement {
            slices: vec![slice_of(path_scan(5.0, 2.0, |d| d.cos_theta())); 3],
            ..Measurement::default()
        };
        assert!(align(&matt).unwrap_err().to_string().contains("mirror peak"));
    }
}
