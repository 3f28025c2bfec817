//! What is known of a slice direction by direction: noise left in it, and how far the next reading is.

use std::collections::VecDeque;
use std::f64::consts::{PI, TAU};

use gonio_geom::DVec3;

use crate::plane::{Point, from_plane, to_plane};
use crate::slice_surface::SliceSurface;

/// Cells along one side of the plane: about two degrees.
const CELLS: usize = 90;

/// Azimuths at which the change of a slice towards its edge is looked at, and the step inwards, radians (5 degrees).
const AZIMUTHS: usize = 72;
const STEP: f64 = 5.0 * PI / 180.0;

/// Greatest relative noise that is kept: where a slice vanishes its noise is more than any value.
const MOST: f64 = 1e3;

/// Noise and distance to the readings of one slice over the hemisphere of the local frame.
#[derive(Clone, Debug)]
pub(crate) struct LocalError {
    /// Noise over the value, standard deviation.
    noise: Vec<f32>,
    /// Angle to the next direction that readings surround, radians.
    distance: Vec<f32>,
    /// Relative change of the slice (of its ratio to the base) towards its edge, 1/rad.
    edge: f64,
    /// Relative uncertainty that all readings share.
    pub(crate) common: f64,
}

impl LocalError {
    /// Of the mean of `surfaces` and, when `bilateral`, of their mirror images; `common` is what their readings share.
    pub(crate) fn new(surfaces: &[SliceSurface], bilateral: bool, common: f64) -> Self {
        let views = surfaces.len() as f64 * if bilateral { 2.0 } else { 1.0 };
        let measured = |p: Point| {
            let image = [p[0], -p[1]];
            surfaces
                .iter()
                .any(|s| s.measured(p) || (bilateral && s.measured(image)))
        };
        let cells = CELLS * CELLS;
        let noise = (0..cells)
            .map(|k| {
                let each: Vec<f64> = surfaces
                    .iter()
                    .map(|s| s.relative_noise(centre(k)).min(MOST))
                    .collect();
                let square: f64 = each.iter().map(|n| n * n).sum::<f64>() / each.len().max(1) as f64;
                (square / views).sqrt() as f32
            })
            .collect();
        LocalError {
            noise,
            distance: distances(|k| measured(centre(k))),
            edge: edge(surfaces),
            common,
        }
    }

    /// Relative noise at the local direction `s`.
    pub(crate) fn noise(&self, s: DVec3) -> f64 {
        f64::from(self.noise[cell(s)])
    }

    /// Relative error at the local direction `s` of taking the slice from the nearest readings: 0 among them.
    pub(crate) fn extrapolation(&self, s: DVec3) -> f64 {
        self.edge * f64::from(self.distance[cell(s)])
    }
}

/// Middle of cell `k`.
fn centre(k: usize) -> Point {
    let at = |n: usize| 2.0 * (n as f64 + 0.5) / CELLS as f64 - 1.0;
    [at(k % CELLS), at(k / CELLS)]
}

fn cell(s: DVec3) -> usize {
    let p = to_plane(s);
    let at = |x: f64| (((x + 1.0) * 0.5 * CELLS as f64).max(0.0) as usize).min(CELLS - 1);
    at(p[1]) * CELLS + at(p[0])
}

/// Angle of every cell to the nearest one for which `known` holds, over the cells between; pi/2 where there is none.
fn distances(known: impl Fn(usize) -> bool) -> Vec<f32> {
    let mut out = vec![(0.5 * PI) as f32; CELLS * CELLS];
    // The nearest known cell travels with the front.
    let mut from: Vec<Option<usize>> = (0..CELLS * CELLS).map(|k| known(k).then_some(k)).collect();
    let mut front: VecDeque<usize> = (0..CELLS * CELLS).filter(|&k| from[k].is_some()).collect();
    for &k in &front {
        out[k] = 0.0;
    }
    while let Some(k) = front.pop_front() {
        let Some(source) = from[k] else { continue };
        let (x, y) = ((k % CELLS) as i64, (k / CELLS) as i64);
        for (dx, dy) in [(1, 0), (-1, 0), (0, 1), (0, -1)] {
            let (a, b) = (x + dx, y + dy);
            if !(0..CELLS as i64).contains(&a) || !(0..CELLS as i64).contains(&b) {
                continue;
            }
            let next = (b as usize) * CELLS + a as usize;
            let angle = from_plane(centre(next)).angle_between(from_plane(centre(source))) as f32;
            if angle + 1e-6 < out[next] {
                out[next] = angle;
                from[next] = Some(source);
                front.push_back(next);
            }
        }
    }
    out
}

/// Root mean square of the relative change over one step inwards from the edge of what was measured, per radian.
fn edge(surfaces: &[SliceSurface]) -> f64 {
    let (mut sum, mut count) = (0.0, 0.0);
    for surface in surfaces {
        for k in 0..AZIMUTHS {
            let (sin, cos) = (TAU * (k as f64 + 0.5) / AZIMUTHS as f64).sin_cos();
            let at = |theta: f64| to_plane(DVec3::new(theta.sin() * cos, theta.sin() * sin, theta.cos()));
            let last = (1..90)
                .rev()
                .map(|t| f64::from(t).to_radians())
                .find(|&t| surface.measured(at(t)));
            let Some(last) = last.filter(|t| *t > 2.0 * STEP) else {
                continue;
            };
            let (outer, inner) = (surface.ratio_at(at(last)).0, surface.ratio_at(at(last - STEP)).0);
            let mean = 0.5 * (outer.abs() + inner.abs());
            if mean > 0.0 {
                sum += ((outer - inner) / mean).powi(2);
                count += 1.0;
            }
        }
    }
    if count > 0.0 {
        f64::sqrt(sum / count) / STEP
    } else {
        1.0 / STEP
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::readings::Readings;
    use gonio_geom::Direction;

    /// Readings up to `last` degrees whose value is `f` and whose noise is a hundredth of it.
    fn surface(last: f64, f: impl Fn(f64) -> f64) -> SliceSurface {
        let mut readings = Readings::default();
        let mut theta = 1.5;
        while theta < last {
            let n = (120.0 * f64::to_radians(theta).sin()).ceil() as usize + 3;
            for k in 0..n {
                let d = Direction::from_degrees(theta, 360.0 * (k as f64 + 0.3) / n as f64);
                readings.points.push(to_plane(d.vec()));
                readings.value.push(f(theta));
                readings.sigma.push(0.01 * f(theta));
            }
            theta += 3.0;
        }
        SliceSurface::new(&readings, false).unwrap()
    }

    fn at(theta: f64) -> DVec3 {
        Direction::from_degrees(theta, 40.0).vec()
    }

    #[test]
    fn noise_is_that_of_the_readings_and_halves_with_four_views() {
        let one = LocalError::new(&[surface(80.0, |_| 0.3)], false, 0.02);
        // Between three readings of equal weight the noise is less than at one.
        for theta in [10.0, 40.0, 70.0] {
            let n = one.noise(at(theta));
            assert!((0.0055..=0.0101).contains(&n), "{theta}: {n}");
        }
        let four = LocalError::new(&[surface(80.0, |_| 0.3), surface(80.0, |_| 0.3)], true, 0.0);
        assert!((four.noise(at(40.0)) / one.noise(at(40.0)) - 0.5).abs() < 1e-6);
        assert!((one.common - 0.02).abs() < 1e-15);
    }

    #[test]
    fn extrapolation_grows_with_the_distance_and_with_the_change_at_the_edge() {
        let falling = LocalError::new(&[surface(75.0, |t| 1.0 - t / 100.0)], false, 0.0);
        assert!(falling.extrapolation(at(40.0)) < 1e-12);
        let near = falling.extrapolation(at(80.0));
        let far = falling.extrapolation(at(88.0));
        assert!(near > 0.0 && far > 1.5 * near, "{near} {far}");
        // The truth has fallen from .27 to .12 between the last reading (73.5) and 88 degrees: half of .27.
        assert!((0.25..1.2).contains(&far), "{far}");
        let flat = LocalError::new(&[surface(75.0, |_| 1.0)], false, 0.0);
        assert!(flat.extrapolation(at(88.0)) < 1e-9);
    }
}
