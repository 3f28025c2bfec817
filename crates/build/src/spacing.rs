//! How far the readings of a slice are apart where its lobe is narrow.
//!
//! Interpolation in a slice leans on what the readings are divided by: the base, a fall-off, lobes of its own. Where that has the
//! shape of the sample it hides how little the readings themselves show of a lobe. So that shape is taken as the slice, and
//! interpolated linearly between its values at the readings: what is lost says how far they are apart.

use crate::plane::{Point, from_plane, solid_angle_density};
use crate::slice_surface::SliceSurface;

/// Most triangles that are looked at.
const TRIANGLES: usize = 6000;

/// Mean error of a parabola between the corners of a triangle over that in its middle.
const MEAN: f64 = 0.75;

/// Share of the light of a Gaussian ridge `exp(-x^2 / w^2)` that linear interpolation between readings `d` apart misses, over
/// `(d / w)^2`: a twelfth of the integral of `|f''|` over that of `f`, `4 sqrt(2 / e) / (12 sqrt(pi))`.
const MISSED: f64 = 0.161_3;

/// Distance of the readings over the narrow half width (1/e) of the slice, as the loss of light between them tells: that of lines of
/// readings across a Gaussian ridge which would lose as much. 0 where readings are divided by nothing.
pub(crate) fn spacing(surface: &SliceSurface) -> f64 {
    let mesh = surface.mesh();
    let all: Vec<usize> = surface.measured_triangles().collect();
    let picked: Vec<usize> = all
        .iter()
        .copied()
        .step_by(all.len().div_ceil(TRIANGLES).max(1))
        .collect();
    let points: Vec<Point> = picked
        .iter()
        .flat_map(|&t| {
            let [a, b, c] = mesh.corners(t);
            [a, b, c, mesh.centroid(t)]
        })
        .collect();
    let Some(shape) = surface.divisors(&points) else {
        return 0.0;
    };
    let (mut missed, mut light) = (0.0, 0.0);
    for ((&t, shape), points) in picked.iter().zip(shape.chunks(4)).zip(points.chunks(4)) {
        let ratio = mesh.triangles()[t]
            .iter()
            .map(|&k| surface.ratio_of(k as usize).0)
            .sum::<f64>()
            / 3.0;
        let corners = (shape[0] + shape[1] + shape[2]) / 3.0;
        let weight = ratio.abs() * mesh.area(t) * solid_angle_density(points[3]) * from_plane(points[3]).z;
        missed += weight * MEAN * (shape[3] - corners).abs();
        light += weight * (corners + MEAN * (shape[3] - corners));
    }
    if light > 0.0 {
        (missed / light / MISSED).sqrt()
    } else {
        0.0
    }
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use super::*;
    use crate::base::Divisor;
    use crate::lobes::{Lobe, Lobes, Symmetric};
    use crate::plane::to_plane;
    use crate::readings::Readings;
    use gonio_geom::DVec3;

    /// A ridge of half width (1/e) `w` across x over direction cosines, read on a grid of pitch `d`.
    fn ridge(w: f64, d: f64) -> f64 {
        let lobes = Arc::new(Lobes {
            floor: 1e-6,
            lobes: vec![Lobe {
                centre: [0.0, 0.0],
                covariance: Symmetric {
                    xx: 0.5 * w * w,
                    xy: 0.0,
                    yy: 0.02,
                },
                height: 1.0,
            }],
        });
        let mut readings = Readings::default();
        let n = (0.5 / d) as i32;
        for x in -n..=n {
            for y in -n..=n {
                // Off the axes of the ridge, as readings stand.
                let p = [d * (f64::from(x) + 0.31), d * (f64::from(y) + 0.1)];
                let s = DVec3::new(p[0], p[1], (1.0 - p[0] * p[0] - p[1] * p[1]).sqrt());
                readings.push(to_plane(s), lobes.eval(s), 0.0);
            }
        }
        let mut surface = SliceSurface::flat(&readings).unwrap();
        surface.fill(&readings, false, Some(Divisor::Own(lobes)));
        spacing(&surface)
    }

    #[test]
    fn the_spacing_is_that_of_the_lines_across_a_ridge() {
        for (w, d) in [(0.1, 0.01), (0.05, 0.01), (0.05, 0.02), (0.02, 0.01)] {
            let found = ridge(w, d);
            assert!((found / (d / w) - 1.0).abs() < 0.25, "{found} {}", d / w);
        }
    }

    #[test]
    fn readings_divided_by_nothing_tell_nothing() {
        let mut readings = Readings::default();
        for k in 0..100 {
            readings.push([0.01 * f64::from(k % 10), 0.01 * f64::from(k / 10)], 1.0, 0.0);
        }
        assert!(spacing(&SliceSurface::new(&readings, false).unwrap()) == 0.0);
    }
}
