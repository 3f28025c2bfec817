//! One incidence: the BSDF over a hemisphere, interpolated between scattered readings.
//!
//! The readings are triangulated and the BSDF, or its ratio to a parametric base, is linear in every triangle. A ring of points on the horizon carries
//! the value of the readings nearest to it, so that the BSDF (or its ratio) stays constant beyond the last reading (the
//! DSF falls to zero with the cosine). A hole, such as the detector's shadow around the retro direction, is bridged from its
//! rim. Both are marked as extrapolated.

use rayon::prelude::*;
use std::f64::consts::TAU;

use crate::base::Divisor;
use crate::mesh::Mesh;
use crate::plane::{Point, from_plane, into_disk, solid_angle_density};
use crate::profile::Profile;
use crate::readings::Readings;
use crate::smoothing::smooth;

/// Points on the horizon.
const RIM: usize = 360;

/// Readings within this factor of the distance to the nearest one give a point of the horizon its value.
const RIM_REACH: f64 = 1.25;

/// A triangle with an edge longer than this factor times the usual longest edge (median over solid angle) is a hole.
const HOLE_FACTOR: f64 = 2.5;

/// No triangle with edges shorter than this angle (radians) is a hole: 5 degrees.
const HOLE_LEAST: f64 = 5.0 * std::f64::consts::PI / 180.0;

/// How a model knows a value.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Coverage {
    /// Between readings of a measured incidence.
    Measured,
    /// Between measured incidences, in directions all of them cover.
    Interpolated,
    /// Beyond the data: past the last incidence, between the last reading and the horizon, in a hole.
    Extrapolated,
    /// Not known at all: a component that was not measured; the model answers 0.
    Missing,
}

impl Coverage {
    /// Name used in files and Python.
    pub fn name(self) -> &'static str {
        match self {
            Coverage::Measured => "measured",
            Coverage::Interpolated => "interpolated",
            Coverage::Extrapolated => "extrapolated",
            Coverage::Missing => "missing",
        }
    }
}

/// The BSDF of one incidence and component over the upper hemisphere of the local frame.
#[derive(Debug)]
pub(crate) struct SliceSurface {
    mesh: Mesh,
    /// What is linear in every triangle, at the vertices: readings first, then the rim. The BSDF, or its ratio to
    /// `divisor`.
    values: Vec<f64>,
    /// Noise left in the values of the readings, standard deviation.
    noise: Vec<f64>,
    divisor: Option<Divisor>,
    /// What the ratio to a joint base is divided by before it is interpolated.
    profile: Option<Profile>,
    readings: usize,
    /// Longest edge of a triangle that still counts as measured, radians.
    longest_edge: f64,
}

impl SliceSurface {
    /// The surface through `readings`, smoothed within their stated noise when `smoothed`. `None` when the readings
    /// span no triangle.
    pub(crate) fn new(readings: &Readings, smoothed: bool) -> Option<Self> {
        let mut surface = SliceSurface::flat(readings)?;
        surface.fill(readings, smoothed, None);
        Some(surface)
    }

    /// The triangles of `readings`, not filled yet: the BSDF is 0.
    pub(crate) fn flat(readings: &Readings) -> Option<Self> {
        let count = readings.len();
        if count < 3 {
            return None;
        }
        let mut points = readings.points.clone();
        points.extend((0..RIM).map(|k| {
            let (s, c) = (TAU * (k as f64 + 0.5) / RIM as f64).sin_cos();
            [c, s]
        }));
        let mesh = Mesh::new(points)?;
        let mut surface = SliceSurface {
            values: vec![0.0; count + RIM],
            noise: vec![0.0; count],
            mesh,
            divisor: None,
            profile: None,
            readings: count,
            longest_edge: f64::INFINITY,
        };
        surface.longest_edge = surface
            .usual_edge()
            .map_or(0.0, |e| HOLE_LEAST.max(HOLE_FACTOR * e));
        Some(surface)
    }

    /// Takes the values of `readings`, those it was made of; their ratio to `divisor` when there is one.
    pub(crate) fn fill(&mut self, readings: &Readings, smoothed: bool, divisor: Option<Divisor>) {
        let count = self.readings;
        self.profile = None;
        let divided = divisor.as_ref().map(|divisor| {
            let mut level = divisor.eval_all(readings.points.iter().map(|&p| from_plane(p)));
            if let Divisor::Joint(_, i) = divisor {
                let omega = self.solid_angles();
                self.profile = Profile::new(*i, &readings.points, &readings.value, &level, &omega);
            }
            if let Some(profile) = &self.profile {
                for (m, &p) in level.iter_mut().zip(&readings.points) {
                    *m *= profile.at(p, || *m);
                }
            }
            let over = |v: &[f64]| v.iter().zip(&level).map(|(v, m)| v / m).collect::<Vec<f64>>();
            (over(&readings.value), over(&readings.sigma))
        });
        let (value, sigma) = divided
            .as_ref()
            .map_or((&readings.value, &readings.sigma), |(v, u)| (v, u));
        let (mut values, noise) = if smoothed {
            smooth(&self.mesh, value, sigma).into_iter().unzip()
        } else {
            (value.clone(), sigma.clone())
        };
        self.noise = noise;
        let rim: Vec<f64> = self.mesh.points()[count..]
            .par_iter()
            .map(|&p| rim_value(p, &readings.points, &values))
            .collect();
        values.extend(rim);
        self.values = values;
        self.divisor = divisor;
    }

    /// What is linear in every triangle at a point of the plane, and whether readings surround it. Outside the disk
    /// the value on the horizon. May be negative where readings are.
    pub(crate) fn ratio_at(&self, p: Point) -> (f64, bool) {
        let Some(at) = self.mesh.locate(inside(p)) else {
            return (0.0, false);
        };
        let value: f64 = (0..3)
            .map(|k| at.weights[k] * self.values[at.vertices[k] as usize])
            .sum();
        let value = match (&self.profile, &self.divisor) {
            (Some(profile), Some(divisor)) => {
                let p = inside(p);
                value * profile.at(p, || divisor.eval(from_plane(p)))
            }
            _ => value,
        };
        let measured = match at.vertices {
            [a, b, _] if a == b => (a as usize) < self.readings,
            _ => self.is_measured(at.triangle as usize),
        };
        (value, measured)
    }

    /// The BSDF at a point of the plane.
    pub(crate) fn value(&self, p: Point) -> f64 {
        let ratio = self.ratio_at(p).0;
        match &self.divisor {
            Some(divisor) => ratio * divisor.eval(from_plane(p)),
            None => ratio,
        }
    }

    /// Whether readings surround `p`.
    pub(crate) fn measured(&self, p: Point) -> bool {
        self.ratio_at(p).1
    }

    /// Noise at a point of the plane over the value there: that of the readings of the triangle, each by its weight.
    pub(crate) fn relative_noise(&self, p: Point) -> f64 {
        let Some(at) = self.mesh.locate(inside(p)) else {
            return 0.0;
        };
        let (mut square, mut value, mut weight) = (0.0, 0.0, 0.0);
        for (&k, w) in at.vertices.iter().zip(at.weights) {
            // Points of the rim have no noise of their own.
            if let Some(noise) = self.noise.get(k as usize) {
                square += (w * noise).powi(2);
                value += w * self.values[k as usize];
                weight += w;
            }
        }
        if weight > 0.0 && value != 0.0 {
            square.sqrt() / value.abs()
        } else {
            0.0
        }
    }

    /// Solid angle of each reading: a third of the measured triangles around it.
    pub(crate) fn solid_angles(&self) -> Vec<f64> {
        let mut omega = vec![0.0; self.readings];
        for t in self.measured_triangles() {
            let third = self.solid_angle(t) / 3.0;
            for corner in self.mesh.triangles()[t] {
                omega[corner as usize] += third;
            }
        }
        omega
    }

    /// What the values are divided by at points of the plane; `None` where they are divided by nothing.
    pub(crate) fn divisors(&self, points: &[Point]) -> Option<Vec<f64>> {
        let mut level = self
            .divisor
            .as_ref()?
            .eval_all(points.iter().map(|&p| from_plane(p)));
        if let Some(profile) = &self.profile {
            for (m, &p) in level.iter_mut().zip(points) {
                *m *= profile.at(p, || *m);
            }
        }
        Some(level)
    }

    /// The triangles between readings that count as measured.
    pub(crate) fn measured_triangles(&self) -> impl Iterator<Item = usize> {
        (0..self.mesh.triangles().len()).filter(|&t| self.is_measured(t))
    }

    /// The mesh.
    pub(crate) fn mesh(&self) -> &Mesh {
        &self.mesh
    }

    /// What is linear in every triangle, at reading `j`, and the noise left in it.
    pub(crate) fn ratio_of(&self, j: usize) -> (f64, f64) {
        (self.values[j], self.noise[j])
    }

    /// Points of the readings.
    pub(crate) fn points(&self) -> &[Point] {
        &self.mesh.points()[..self.readings]
    }

    fn is_measured(&self, triangle: usize) -> bool {
        self.is_between_readings(triangle) && self.edge(triangle) <= self.longest_edge
    }

    fn is_between_readings(&self, triangle: usize) -> bool {
        self.mesh.triangles()[triangle]
            .iter()
            .all(|&k| (k as usize) < self.readings)
    }

    fn solid_angle(&self, triangle: usize) -> f64 {
        self.mesh.area(triangle) * solid_angle_density(self.mesh.centroid(triangle))
    }

    /// Longest edge of a triangle as an angle, radians.
    fn edge(&self, triangle: usize) -> f64 {
        let [a, b, c] = self.mesh.corners(triangle).map(from_plane);
        let chord = (a - b).length().max((b - c).length()).max((c - a).length());
        2.0 * (0.5 * chord).min(1.0).asin()
    }

    /// Median over solid angle of the longest edge of the triangles between readings.
    fn usual_edge(&self) -> Option<f64> {
        let mut edges: Vec<(f64, f64)> = (0..self.mesh.triangles().len())
            .filter(|&t| self.is_between_readings(t))
            .map(|t| (self.edge(t), self.solid_angle(t)))
            .collect();
        edges.sort_unstable_by(|a, b| a.0.total_cmp(&b.0));
        let half = 0.5 * edges.iter().map(|e| e.1).sum::<f64>();
        let mut sum = 0.0;
        edges
            .iter()
            .find(|e| {
                sum += e.1;
                sum >= half
            })
            .map(|e| e.0)
    }
}

/// The rim is a polygon: a point between it and the horizon is taken at the polygon.
fn inside(p: Point) -> Point {
    let apothem = (0.5 * TAU / RIM as f64).cos();
    into_disk(p, apothem * (1.0 - 1e-9))
}

/// Mean of the readings nearest to a point of the horizon.
fn rim_value(p: Point, points: &[Point], values: &[f64]) -> f64 {
    let d2 = |q: &Point| (q[0] - p[0]).powi(2) + (q[1] - p[1]).powi(2);
    let reach = points.iter().map(d2).fold(f64::INFINITY, f64::min) * RIM_REACH * RIM_REACH;
    let (mut sum, mut count) = (0.0, 0.0);
    for (q, v) in points.iter().zip(values) {
        if d2(q) <= reach {
            sum += v;
            count += 1.0;
        }
    }
    if count > 0.0 { sum / count } else { 0.0 }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::plane::to_plane;
    use gonio_geom::Direction;

    /// Readings of `f` on rings every 3 degrees up to `last`, without those within `hole` degrees of `retro`.
    fn rings(last: f64, retro: Direction, hole: f64, f: impl Fn(Direction) -> f64) -> Readings {
        let mut readings = Readings::default();
        let mut theta = 1.5;
        while theta < last {
            let n = (360.0 * f64::to_radians(theta).sin()).ceil() as usize;
            for k in 0..n {
                let d = Direction::from_degrees(theta, 360.0 * (k as f64 + 0.3) / n as f64);
                if d.angle_to(retro).to_degrees() >= hole {
                    readings.points.push(to_plane(d.vec()));
                    readings.value.push(f(d));
                    readings.sigma.push(0.0);
                }
            }
            theta += 3.0;
        }
        readings
    }

    #[test]
    fn a_constant_is_kept_everywhere_and_the_mask_shows_gap_and_hole() {
        let retro = Direction::from_degrees(30.0, 180.0);
        let surface = SliceSurface::new(&rings(82.0, retro, 8.0, |_| 0.3), true).unwrap();
        for theta in [0.0, 10.0, 45.0, 80.0, 85.0, 90.0] {
            for phi in [0.0, 77.0, 180.0] {
                let p = to_plane(Direction::from_degrees(theta, phi).vec());
                assert!((surface.value(p) - 0.3).abs() < 1e-12, "{theta} {phi}");
            }
        }
        let measured = |theta, phi| surface.measured(to_plane(Direction::from_degrees(theta, phi).vec()));
        assert!(measured(45.0, 0.0) && measured(0.0, 0.0) && measured(79.0, 120.0));
        assert!(!measured(85.0, 0.0), "beyond the last ring");
        assert!(!measured(30.0, 180.0), "inside the shadow");
    }

    #[test]
    fn a_smooth_lobe_is_interpolated_to_second_order() {
        let f = |d: Direction| 0.1 + d.vec().dot(Direction::from_degrees(40.0, 0.0).vec()).powi(8);
        let surface = SliceSurface::new(&rings(88.0, Direction::NORMAL, 0.0, f), true).unwrap();
        for (theta, phi) in [(40.0, 0.0), (20.0, 30.0), (60.0, 350.0)] {
            let d = Direction::from_degrees(theta, phi);
            let value = surface.value(to_plane(d.vec()));
            assert!((value / f(d) - 1.0).abs() < 0.005, "{value} {}", f(d));
        }
    }

    #[test]
    fn solid_angles_add_up_to_the_measured_cap() {
        let surface = SliceSurface::new(&rings(82.0, Direction::NORMAL, 0.0, |_| 1.0), false).unwrap();
        let sum: f64 = surface.solid_angles().iter().sum();
        let cap = TAU * (1.0 - f64::to_radians(79.5).cos());
        assert!((sum / cap - 1.0).abs() < 0.01, "{sum} {cap}");
    }
}
