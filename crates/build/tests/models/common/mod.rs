//! Synthetic measurements: a known model read along a goniophotometer's path, with noise.

#![allow(dead_code, reason = "each test binary uses its part")]

use std::f64::consts::PI;

use gonio_bsdf::analytic::Sum;
use gonio_bsdf::{Bsdf, Channel, Properties};
use gonio_geom::{Angles, Component, DVec3, Direction};
use gonio_scan::{Flags, Measurement, Slice};
use rand::{RngExt, SeedableRng};
use rand_distr::{Distribution, StandardNormal};
use rand_pcg::Pcg64Mcg;

fn normal(rng: &mut Pcg64Mcg) -> f64 {
    StandardNormal.sample(rng)
}

/// The path of an arc scanner: rings 3 degrees apart read every 0.2 degrees up to `last`, and a patch of 15 degrees
/// about the mirror (through) direction in lines 0.5 degrees apart read every 0.1 degrees.
pub(crate) fn path(wi: Direction, component: Component, last: f64, rng: &mut Pcg64Mcg) -> Vec<Direction> {
    let mut points: Vec<DVec3> = Vec::new();
    let mut theta: f64 = 1.5;
    while theta < last {
        let n = (1800.0 * theta.to_radians().sin()).round().max(8.0);
        let start: f64 = rng.random();
        points.extend(
            (0..n as usize).map(|k| {
                Direction::from_spherical(theta.to_radians(), 2.0 * PI * (k as f64 + start) / n).vec()
            }),
        );
        theta += 3.0;
    }
    let m = wi.vec();
    let mirror = DVec3::new(-m.x, -m.y, m.z.abs());
    let across = if mirror.x.hypot(mirror.y) > 1e-9 {
        DVec3::new(-mirror.y, mirror.x, 0.0).normalize()
    } else {
        DVec3::Y
    };
    let along = across.cross(mirror);
    for line in -30..=30 {
        for step in -150..=150 {
            let (x, y) = (0.1 * f64::from(step), 0.5 * f64::from(line));
            if x.hypot(y) <= 15.0 {
                let v = mirror + along * x.to_radians().tan() + across * y.to_radians().tan();
                points.push(v.normalize());
            }
        }
    }
    let flip = component.scattered_side(wi.side()).sign();
    let jitter = f64::to_radians(0.02);
    points
        .into_iter()
        .filter_map(|v| {
            let shaken = v + jitter * DVec3::new(normal(rng), normal(rng), normal(rng));
            Direction::new(shaken)
        })
        .filter(|d| d.theta().to_degrees() < last)
        .map(|d| if flip < 0.0 { d.flipped() } else { d })
        .collect()
}

/// Noise of a simulated reading: relative to the DSF, and absolute in 1/sr.
#[derive(Clone, Copy)]
pub(crate) struct Noise(pub(crate) f64, pub(crate) f64);

/// One slice of `model` from `wi`, `components` each along [`path`].
pub(crate) fn slice(
    model: &dyn Bsdf,
    incidence: Angles,
    components: &[Component],
    last: f64,
    noise: Noise,
    seed: u64,
) -> Slice {
    let mut rng = Pcg64Mcg::seed_from_u64(seed);
    let wi = incidence.direction();
    let mut out = Slice {
        incidence,
        channel: Channel::Photopic,
        theta_s: vec![],
        phi_s: vec![],
        dsf: vec![],
        u_dsf: vec![],
        omega: vec![],
        flags: vec![],
        u_common: 0.0,
        integrals: vec![],
    };
    for &component in components {
        for ws in path(wi, component, last, &mut rng) {
            let dsf = model.eval_first(wi, ws) * ws.cos_theta().abs();
            let read = dsf * (1.0 + noise.0 * normal(&mut rng)) + noise.1 * normal(&mut rng);
            out.theta_s.push(ws.theta());
            out.phi_s.push(ws.phi());
            out.dsf.push(read);
            out.u_dsf.push((noise.0 * dsf).hypot(noise.1));
            out.omega.push(0.0);
            out.flags.push(Flags::NONE);
        }
    }
    out
}

/// A measurement at the given `(theta_i, phi_i)` in degrees.
pub(crate) fn measure(
    model: &dyn Bsdf,
    incidences: &[(f64, f64)],
    components: &[Component],
    last: f64,
    noise: Noise,
) -> Measurement {
    Measurement {
        slices: incidences
            .iter()
            .enumerate()
            .map(|(k, &(theta, phi))| {
                let incidence = Angles::from_degrees(theta, phi);
                slice(model, incidence, components, last, noise, 100 + k as u64)
            })
            .collect(),
        ..Measurement::default()
    }
}

/// Keeps every `step`th reading of every slice.
pub(crate) fn thinned(measurement: &mut Measurement, step: usize) {
    fn keep<T: Copy>(column: &mut Vec<T>, step: usize) {
        *column = column.iter().step_by(step).copied().collect();
    }
    for slice in &mut measurement.slices {
        for column in [
            &mut slice.theta_s,
            &mut slice.phi_s,
            &mut slice.dsf,
            &mut slice.u_dsf,
            &mut slice.omega,
        ] {
            keep(column, step);
        }
        keep(&mut slice.flags, step);
    }
}

/// Error of `model` against `truth` from `wi` into `component`: relative L1 of the DSF over the hemisphere up to 88
/// degrees, and the relative error of its integral.
pub(crate) fn error(truth: &dyn Bsdf, model: &dyn Bsdf, wi: Direction, component: Component) -> (f64, f64) {
    let m = wi.vec();
    let mirror = DVec3::new(-m.x, -m.y, m.z.abs());
    let across = DVec3::new(-mirror.y, mirror.x, 0.0)
        .try_normalize()
        .unwrap_or(DVec3::Y);
    let along = across.cross(mirror);
    let flip = component.scattered_side(wi.side()).sign();
    let (mut apart, mut total, mut predicted) = (0.0, 0.0, 0.0);
    let (rings, spokes) = (240, 120);
    for r in 0..rings {
        // Distances from the mirror direction grow as the square of the ring: fine where the lobe is.
        let edge = |k: f64| PI * (k / f64::from(rings)).powi(2);
        let (a, b) = (edge(f64::from(r)), edge(f64::from(r + 1)));
        let gamma = 0.5 * (a + b);
        let ring = (a.cos() - b.cos()) * 2.0 * PI / f64::from(spokes);
        for k in 0..spokes {
            let phi = 2.0 * PI * (f64::from(k) + 0.5) / f64::from(spokes);
            let v = mirror * gamma.cos() + (along * phi.cos() + across * phi.sin()) * gamma.sin();
            if v.z < f64::to_radians(88.0).cos() {
                continue;
            }
            let ws = Direction::from_unit(DVec3::new(v.x, v.y, flip * v.z).normalize());
            let (f, g) = (truth.eval_first(wi, ws), model.eval_first(wi, ws));
            apart += (f - g).abs() * v.z * ring;
            total += f * v.z * ring;
            predicted += g * v.z * ring;
        }
    }
    (apart / total, predicted / total - 1.0)
}

/// Eight incidences in one plane.
pub(crate) const EIGHT: [(f64, f64); 8] = [
    (10.0, 180.0),
    (20.0, 180.0),
    (30.0, 180.0),
    (40.0, 180.0),
    (50.0, 180.0),
    (60.0, 180.0),
    (70.0, 180.0),
    (80.0, 180.0),
];

/// A material and a Gaussian lobe of its own direction: neither follows the mirror, nor can source and receiver be
/// exchanged.
pub(crate) struct Aside {
    pub(crate) material: Sum,
    /// Sine of the lobe's polar angle from that of the incidence; it leaves at the mirror azimuth.
    pub(crate) sine: fn(f64) -> f64,
    /// 1/e half width, as a chord.
    pub(crate) width: f64,
    /// Its highest value, 1/sr.
    pub(crate) peak: f64,
}

impl Bsdf for Aside {
    fn channels(&self) -> &[Channel] {
        self.material.channels()
    }

    fn properties(&self) -> Properties {
        Properties {
            reciprocal: false,
            ..self.material.properties()
        }
    }

    fn eval(&self, wi: Direction, ws: Direction, f: &mut [f64]) {
        self.material.eval(wi, ws, f);
        if wi.side() == ws.side() {
            let sine = (self.sine)(wi.theta().sin());
            let axis = Direction::from_spherical(sine.asin(), wi.phi() + PI);
            let chord = (axis.vec() - ws.vec()).length();
            f[0] += self.peak * (-(chord / self.width).powi(2)).exp();
        }
    }
}
