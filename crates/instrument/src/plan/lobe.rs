//! Lobes: how wide they are, and in which plane.

use std::f64::consts::{PI, TAU};

use gonio_geom::{Component, DVec3, Direction};

use super::chart::Chart;
use super::field::Field;

/// Share of the highest that a lobe must rise above what lies about it.
const RISE: f64 = 0.02;
/// Azimuths in which a lobe is followed outwards.
const AZIMUTHS: usize = 16;
/// Distances at which it is looked at in each, from the first one on in equal ratios.
const STEPS: usize = 72;
const FIRST: f64 = 2e-4;
const RATIO: f64 = 1.14;
/// `exp(-1/4)`: a Gaussian falls to it at half its 1/e half width.
const NEAR_TOP: f64 = 0.778_800_783_071_404_9;
/// Share of its height below which a lobe is part of the background.
const TAIL: f64 = 1e-4;
/// Extent of a lobe in units of its width at most.
const FARTHEST: f64 = 12.0;

/// A lobe laid out in a plane: an ellipse of 1/e half widths.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Lobe {
    chart: Chart,
    origin: [f64; 2],
    /// Half widths along the longer and the shorter axis as vectors of the plane.
    axes: [[f64; 2]; 2],
    /// The same as angles on the sphere, radians, longer first.
    pub(super) width: [f64; 2],
    /// Where it ends, in units of the widths.
    pub(super) extent: f64,
    pub(super) peak: Direction,
    /// Height, 1/sr, background included.
    pub(super) height: f64,
}

impl Lobe {
    /// The direction `a` widths along the longer axis and `b` along the shorter one from the peak.
    pub(super) fn direction(&self, a: f64, b: f64) -> Option<Direction> {
        let [u, v] = self.axes;
        self.chart.direction([
            self.origin[0] + a * u[0] + b * v[0],
            self.origin[1] + a * u[1] + b * v[1],
        ])
    }

    /// Distance of `d` from the peak in units of the widths.
    pub(super) fn distance(&self, d: Direction) -> f64 {
        let p = self.chart.point(d);
        let (x, y) = (p[0] - self.origin[0], p[1] - self.origin[1]);
        let along = |axis: [f64; 2]| (x * axis[0] + y * axis[1]) / (axis[0] * axis[0] + axis[1] * axis[1]);
        along(self.axes[0]).hypot(along(self.axes[1]))
    }

    /// Whether another detector sees `other` as this lobe: its top within half a width, its widths the same within a quarter.
    pub(super) fn is_about(&self, other: &Lobe) -> bool {
        let alike = |a: f64, b: f64| (a / b).ln().abs() < 0.25;
        self.distance(other.peak) < 0.5
            && alike(self.width[0], other.width[0])
            && alike(self.width[1], other.width[1])
    }

    /// A round lobe of a given width that is not looked at: a region asked for.
    pub(super) fn round(peak: Direction, width: f64, extent: f64) -> Lobe {
        Lobe {
            chart: Chart::tangent(peak),
            origin: [0.0; 2],
            axes: [[width, 0.0], [0.0, width]],
            width: [width; 2],
            extent,
            peak,
            height: 0.0,
        }
    }
}

/// The lobe about a peak in the plane that makes it most of an ellipse; `None` where it hardly rises.
pub(super) fn measured(
    field: &Field<'_>,
    wi: Direction,
    component: Component,
    (peak, height): (Direction, f64),
    background: f64,
) -> Option<Lobe> {
    let level = background * peak.cos_theta().abs();
    if height - level < RISE * height {
        return None;
    }
    let slope = Chart::slope(wi, component);
    let about = |chart: Chart| ellipse(field, chart, (peak, height), background);
    let charts = [about(slope), about(Chart::tangent(peak))];
    charts
        .into_iter()
        .flatten()
        .min_by(|a, b| a.1.total_cmp(&b.1))
        .map(|found| found.0)
}

/// The ellipse of `chart` near the top, and by how much the lobe further down departs from it.
fn ellipse(
    field: &Field<'_>,
    chart: Chart,
    (peak, height): (Direction, f64),
    background: f64,
) -> Option<(Lobe, f64)> {
    let origin = chart.point(peak);
    let radius = |k: usize| FIRST * RATIO.powi(k as i32);
    let azimuth = |j: usize| TAU * j as f64 / AZIMUTHS as f64;
    let mut at = Vec::with_capacity(AZIMUTHS * STEPS);
    let mut place = Vec::with_capacity(AZIMUTHS * STEPS);
    for j in 0..AZIMUTHS {
        let (s, c) = azimuth(j).sin_cos();
        for k in 0..STEPS {
            let Some(d) = chart.direction([origin[0] + radius(k) * c, origin[1] + radius(k) * s]) else {
                break;
            };
            at.push(d);
            place.push((j, k));
        }
    }
    let value = field.seen(&at);
    let top = height - background * peak.cos_theta().abs();
    let excess: Vec<f64> = value
        .iter()
        .zip(&at)
        .map(|(v, d)| (v - background * d.cos_theta().abs()) / top)
        .collect();
    let row = |j: usize| {
        let first = place.partition_point(|p| p.0 < j);
        let last = place.partition_point(|p| p.0 <= j);
        &excess[first..last]
    };
    // Where an azimuth first falls to `level`: ln of the excess is even in the distance.
    let falls = |j: usize, level: f64| {
        let row = row(j);
        let k = row.iter().position(|e| *e < level)?;
        let (r1, e1) = (radius(k), row[k].max(1e-12));
        let (r0, e0) = match k.checked_sub(1) {
            Some(k) => (radius(k), row[k]),
            None => (0.0, 1.0),
        };
        let share = (e0.ln() - level.ln()) / (e0.ln() - e1.ln());
        Some((r0 * r0 + share * (r1 * r1 - r0 * r0)).sqrt())
    };
    let mut normal = [[0.0; 3]; 3];
    let mut right = [0.0; 3];
    let mut count = 0;
    for j in 0..AZIMUTHS {
        let Some(r) = falls(j, NEAR_TOP) else { continue };
        let (s, c) = azimuth(j).sin_cos();
        let terms = [c * c, 2.0 * c * s, s * s];
        // Relative errors of the distance count alike.
        let weight = r.powi(4);
        for (a, x) in terms.iter().enumerate() {
            right[a] += weight * x / (4.0 * r * r);
            for (b, y) in terms.iter().enumerate() {
                normal[a][b] += weight * x * y;
            }
        }
        count += 1;
    }
    if count < 5 {
        return None;
    }
    let [xx, xy, yy] = solve(normal, right)?;
    let mean = 0.5 * (xx + yy);
    let apart = (0.5 * (xx - yy)).hypot(xy);
    let (small, large) = (mean - apart, mean + apart);
    if small <= 0.0 {
        return None;
    }
    // The axis of the smaller eigenvalue is the longer one.
    let turn = 0.5 * xy.atan2(0.5 * (xx - yy)) + 0.5 * PI;
    let (s, c) = turn.sin_cos();
    let (long, short) = (small.sqrt().recip(), large.sqrt().recip());
    let axes = [[long * c, long * s], [-short * s, short * c]];
    let fitted = |j: usize, depth: f64| {
        let (s, c) = azimuth(j).sin_cos();
        (depth / (xx * c * c + 2.0 * xy * c * s + yy * s * s)).sqrt()
    };
    let mut departure = Vec::new();
    let mut extent: f64 = 1.0;
    for j in 0..AZIMUTHS {
        if let Some(r) = falls(j, 0.1) {
            departure.push((r / fitted(j, 1.0)).ln());
        }
        let end = row(j).iter().position(|e| *e < TAIL).unwrap_or(row(j).len());
        extent = extent.max(radius(end) / fitted(j, 1.0));
    }
    let mean = departure.iter().sum::<f64>() / departure.len().max(1) as f64;
    let scatter = departure.iter().map(|d| (d - mean).powi(2)).sum::<f64>();
    let mut lobe = Lobe {
        chart,
        origin,
        axes,
        width: [0.0; 2],
        extent: extent.min(FARTHEST),
        peak,
        height,
    };
    let angle = |a: f64, b: f64| {
        let both = [1.0, -1.0].map(|s| lobe.direction(0.1 * s * a, 0.1 * s * b));
        let steps: Vec<f64> = both
            .into_iter()
            .flatten()
            .map(|d| 10.0 * d.angle_to(peak))
            .collect();
        steps.iter().sum::<f64>() / steps.len().max(1) as f64
    };
    let width = [angle(1.0, 0.0), angle(0.0, 1.0)];
    if width.iter().any(|w| *w <= 0.0) {
        return None;
    }
    lobe.width = width;
    if width[0] < width[1] {
        lobe.width.swap(0, 1);
        lobe.axes.swap(0, 1);
    }
    Some((lobe, scatter))
}

/// Solves three equations by Cramer's rule.
fn solve(m: [[f64; 3]; 3], r: [f64; 3]) -> Option<[f64; 3]> {
    let m = glam::DMat3::from_cols_array_2d(&m).transpose();
    let determinant = m.determinant();
    if determinant.abs() <= 0.0 || !determinant.is_finite() {
        return None;
    }
    Some((m.inverse() * DVec3::from_array(r)).to_array())
}
