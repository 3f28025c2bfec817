//! Light followed through a sphere.
//!
//! Light that leaves a Lambertian point of a sphere's wall arrives evenly over the sphere, and within a port evenly over its cap:
//! both are drawn as such. The detector is looked at from every Lambertian point, so that no path needs to find it.

use std::f64::consts::{FRAC_PI_2, TAU};

use gonio_geom::DVec3;
use gonio_trace::sampler::Sampler;

use super::fill::{Fill, Filled};
use super::layout::on_wall;
use super::plan::{Arrangement, PortName};
use super::reading::{Source, State};
use super::{Screen, Sphere};
use crate::InstrumentError;

/// What the wall leaves of a path when it may end by chance, and at its end.
const FAINT: f64 = 0.2;
const NOTHING: f64 = 1e-9;
/// Bounces, at most and at least.
const BOUNCES: (f64, f64) = (8.0, 1e5);
/// A ray begins so far from the surface that it leaves.
const OFF: f64 = 1e-12;

/// A sphere in a state, to be walked through.
pub(super) struct Walk<'a> {
    sphere: &'a Sphere,
    ports: Vec<Filled<'a>>,
    detector: usize,
    cos_view: f64,
    /// Axes across that of the detector.
    across: (DVec3, DVec3),
    /// Whether all of the wall sees all of the detector alike.
    even: bool,
    /// Bounces after which a path may end by chance, and at most.
    faint: u32,
    most: u32,
}

/// Numbers of one path: those of the looks at the detector apart, so that the evenest ones go to the directions.
pub(super) struct Numbers {
    way: Sampler,
    look: Sampler,
}

impl Numbers {
    pub(super) fn new(seed: u64, ray: u32) -> Self {
        Numbers {
            way: Sampler::new(seed, 0, ray),
            look: Sampler::new(seed, 1, ray),
        }
    }

    fn two(&mut self) -> [f64; 2] {
        self.way.two().map(f64::from)
    }

    fn one(&mut self) -> f64 {
        f64::from(self.way.one())
    }

    fn look(&mut self) -> [f64; 2] {
        self.look.two().map(f64::from)
    }
}

/// Where light is scattered next.
#[derive(Clone, Copy)]
enum Met<'a> {
    Wall,
    Port(usize),
    Screen(&'a Screen),
}

/// Light on its way.
struct Ray {
    from: DVec3,
    /// Where it would meet the wall.
    end: DVec3,
    left: f64,
    /// Whether the detector has been looked at from where it comes from.
    looked: bool,
}

impl<'a> Walk<'a> {
    pub(super) fn new(sphere: &'a Sphere, state: &State) -> Result<Self, InstrumentError> {
        let ports = sphere
            .ports
            .iter()
            .map(|port| Filled::new(sphere, port, state))
            .collect::<Result<Vec<_>, _>>()?;
        let detector = ports
            .iter()
            .position(|p| p.port.name == PortName::Detector)
            .unwrap_or(0);
        let view = sphere.plan.detector.view;
        let bounces = |left: f64| (left.ln() / sphere.plan.wall.ln()).clamp(BOUNCES.0, BOUNCES.1) as u32;
        Ok(Walk {
            sphere,
            faint: bounces(FAINT),
            most: bounces(FAINT) + bounces(NOTHING),
            across: sphere.ports[detector].axis.any_orthonormal_pair(),
            even: sphere.screens.is_empty() && view >= FRAC_PI_2,
            ports,
            detector,
            cos_view: if view < FRAC_PI_2 { view.cos() } else { 0.0 },
        })
    }

    /// Share of the light of one ray of a lamp that reaches the detector.
    pub(super) fn share(&self, source: Source, numbers: &mut Numbers) -> f64 {
        let mut sum = 0.0;
        let Some(mut ray) = self.begin(source, numbers, &mut sum) else {
            return sum;
        };
        for bounce in 0..self.most {
            let (at, met) = self.meet(&ray);
            if !self.scatter(&mut ray, at, met, numbers, &mut sum) {
                break;
            }
            // By the number of bounces, not by what is left: with any sample light takes the same ways.
            if bounce >= self.faint {
                if numbers.look()[0] >= self.sphere.plan.wall {
                    break;
                }
                ray.left /= self.sphere.plan.wall;
            }
        }
        sum
    }

    /// Light of a lamp, the beam's as it leaves the sample.
    fn begin(&self, source: Source, numbers: &mut Numbers, sum: &mut f64) -> Option<Ray> {
        let ray = |from, along| Ray {
            from,
            end: on_wall(from, along),
            left: 1.0,
            looked: false,
        };
        if let (Source::Auxiliary, Some(lamp)) = (source, self.sphere.port(PortName::Auxiliary)) {
            return Some(ray(DVec3::ZERO, -lamp.axis));
        }
        let plan = &self.sphere.plan;
        let [u, v] = numbers.two();
        let at = self.sphere.spot_point(u.sqrt(), TAU * v);
        let mut along = -self.sphere.towards_source();
        if plan.divergence > 0.0 {
            let [u, v] = numbers.two();
            let (x, y) = along.any_orthonormal_pair();
            let tilt = plan.divergence * u.sqrt();
            let across = (TAU * v).cos() * x + (TAU * v).sin() * y;
            along = tilt.cos() * along + tilt.sin() * across;
        }
        // A ray that comes from outside meets the sample before it.
        let mut ray = Ray {
            end: at,
            ..ray(at - along, along)
        };
        let sample = self.ports.iter().position(|p| p.port.name == PortName::Sample)?;
        if matches!(self.ports[sample].fill, Fill::Open) {
            ray.from = at;
            ray.end = on_wall(at, along);
            return (plan.arrangement == Arrangement::Transmission).then_some(ray);
        }
        self.scatter(&mut ray, at, Met::Port(sample), numbers, sum)
            .then_some(ray)
    }

    fn meet(&self, ray: &Ray) -> (DVec3, Met<'_>) {
        let (end, way) = (ray.end, ray.end - ray.from);
        let mut nearest = (1.0, None);
        for screen in &self.sphere.screens {
            if let Some(t) = crossing(screen, ray.from, way)
                && t < nearest.0
            {
                nearest = (t, Some(screen));
            }
        }
        if let (t, Some(screen)) = nearest {
            return (ray.from + t * way, Met::Screen(screen));
        }
        match self.ports.iter().position(|p| end.dot(p.port.axis) > p.cos) {
            None => (end, Met::Wall),
            Some(k) => {
                let p = &self.ports[k];
                let t = (p.middle - ray.from).dot(p.port.axis) / way.dot(p.port.axis);
                (ray.from + t * way, Met::Port(k))
            }
        }
    }

    /// What the surface does to light. Whether it goes on.
    fn scatter(&self, ray: &mut Ray, at: DVec3, met: Met<'_>, numbers: &mut Numbers, sum: &mut f64) -> bool {
        let (reflectance, normal) = match met {
            Met::Wall => {
                ray.left *= self.sphere.plan.wall;
                *sum += ray.left * self.seen_from_wall(at, numbers);
                ray.from = at;
                ray.end = on_sphere(numbers.two());
                ray.looked = true;
                return true;
            }
            Met::Screen(screen) => {
                let side = -screen.normal.dot(ray.end - ray.from).signum();
                (screen.reflectance, side * screen.normal)
            }
            Met::Port(k) => {
                let filled = &self.ports[k];
                match &filled.fill {
                    Fill::Open => return false,
                    Fill::Lambert(reflectance) => (*reflectance, -filled.port.axis),
                    Fill::Detector(reflectance) => {
                        let along = (ray.end - ray.from).normalize_or(filled.port.axis);
                        if !ray.looked && along.dot(filled.port.axis) >= self.cos_view {
                            *sum += ray.left;
                        }
                        (*reflectance, -filled.port.axis)
                    }
                    Fill::Model(model) => {
                        let numbers = (numbers.two(), numbers.one());
                        let Some((along, weight)) = filled.scatter(model, ray.from - ray.end, numbers) else {
                            return false;
                        };
                        ray.from = at;
                        ray.end = on_wall(at, along);
                        ray.left *= weight;
                        ray.looked = false;
                        // Light that goes outward is lost.
                        return along.dot(filled.port.axis) < 0.0;
                    }
                }
            }
        };
        ray.left *= reflectance;
        if ray.left <= 0.0 {
            return false;
        }
        if !matches!(met, Met::Port(k) if k == self.detector) {
            *sum += ray.left * self.seen_from(at, normal, numbers.look());
        }
        let [u, v] = numbers.two();
        if matches!(met, Met::Port(k) if self.ports[k].port.name == PortName::Sample) {
            // As many numbers as a model takes: with either in the port, light takes the same ways afterwards.
            numbers.one();
        }
        let (x, y) = normal.any_orthonormal_pair();
        let (r, (sin, cos)) = (u.sqrt(), (TAU * v).sin_cos());
        let along = r * cos * x + r * sin * y + (1.0 - u).sqrt() * normal;
        ray.from = at + OFF * normal;
        ray.end = on_wall(ray.from, along);
        ray.looked = true;
        true
    }

    /// Share of a Lambertian wall point's light that reaches the detector, by one look.
    #[inline]
    fn seen_from_wall(&self, at: DVec3, numbers: &mut Numbers) -> f64 {
        let port = self.ports[self.detector].port;
        if self.even {
            return port.fraction();
        }
        let [u, v] = numbers.look();
        let cos = 1.0 - u * (1.0 - self.ports[self.detector].cos);
        let sin = (1.0 - cos * cos).max(0.0).sqrt();
        let (x, y) = self.across;
        let end = cos * port.axis + sin * ((TAU * v).cos() * x + (TAU * v).sin() * y);
        let way = end - at;
        let in_view = self.cos_view <= 0.0 || way.dot(port.axis) >= self.cos_view * way.length();
        if in_view && self.free(at, way) {
            port.fraction()
        } else {
            0.0
        }
    }

    /// The same of a point of a flat Lambertian surface.
    fn seen_from(&self, at: DVec3, normal: DVec3, [u, v]: [f64; 2]) -> f64 {
        let port = self.ports[self.detector].port;
        let (x, y) = self.across;
        let r = port.rim() * u.sqrt();
        let end = self.ports[self.detector].middle + r * ((TAU * v).cos() * x + (TAU * v).sin() * y);
        let way = end - at;
        let distance = way.length();
        let (leaves, arrives) = (way.dot(normal) / distance, way.dot(port.axis) / distance);
        if leaves <= 0.0 || arrives <= self.cos_view || !self.free(at, way) {
            return 0.0;
        }
        leaves * arrives * port.rim().powi(2) / (distance * distance)
    }

    /// Whether no baffle lies on a way.
    fn free(&self, from: DVec3, way: DVec3) -> bool {
        self.sphere
            .screens
            .iter()
            .all(|s| crossing(s, from, way).is_none_or(|t| t >= 1.0))
    }
}

/// Where a way crosses a baffle, in lengths of `along`.
fn crossing(screen: &Screen, from: DVec3, along: DVec3) -> Option<f64> {
    let t = (screen.middle - from).dot(screen.normal) / along.dot(screen.normal);
    (t > 1e-9 && (from + t * along - screen.middle).length_squared() < screen.radius * screen.radius)
        .then_some(t)
}

/// A point drawn evenly from the unit sphere.
fn on_sphere([u, v]: [f64; 2]) -> DVec3 {
    let z = 1.0 - 2.0 * u;
    let r = (1.0 - z * z).max(0.0).sqrt();
    let (sin, cos) = (TAU * v).sin_cos();
    DVec3::new(r * cos, r * sin, z)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn points_of_the_sphere_are_even() {
        let mut mean = [DVec3::ZERO; 2];
        let n = 1 << 14;
        for k in 0..n {
            let p = on_sphere(Numbers::new(1, k).two());
            assert!((p.length() - 1.0).abs() < 1e-12);
            mean[0] += p / f64::from(n);
            mean[1] += p * p / f64::from(n);
        }
        assert!(
            mean[0].length() < 1e-3 && (mean[1] - 1.0 / 3.0).length() < 1e-3,
            "{mean:?}"
        );
    }
}
