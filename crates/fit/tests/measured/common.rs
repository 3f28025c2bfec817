//! Measurements of known models, as an instrument with noise and a beam of finite width would take them.
// Shared by tests and an example, none of which uses all of it; helpers fail a test by panicking.
#![allow(dead_code, unreachable_pub, clippy::unwrap_used)]

use gonio_bsdf::Channel;
use gonio_fit::FitModel;
use gonio_geom::{Angles, Component, DVec3, Direction};
use gonio_scan::{Flags, Measurement, Slice};
use rand::{RngExt, SeedableRng};
use rand_distr::{Distribution, StandardNormal};
use rand_pcg::Pcg64Mcg;

/// How a sample is measured.
#[derive(Clone, Debug)]
pub struct Campaign {
    /// Polar angles of incidence, degrees.
    pub incidences: Vec<f64>,
    /// Pitch of the grid over the hemisphere and of the patch at the peak, degrees.
    pub pitch: (f64, f64),
    /// Radius of the patch, degrees.
    pub patch: f64,
    /// Relative noise and read-out noise (1/sr).
    pub noise: (f64, f64),
    /// Standard uncertainty of the beam power.
    pub u_common: f64,
    /// Full width at half maximum of a Gaussian beam, degrees.
    pub beam: Option<f64>,
    /// Azimuth of incidence, degrees.
    pub phi_i: f64,
}

impl Default for Campaign {
    fn default() -> Self {
        Campaign {
            incidences: vec![10.0, 30.0, 50.0, 70.0],
            pitch: (5.0, 1.0),
            patch: 12.0,
            noise: (0.0, 0.0),
            u_common: 0.0,
            beam: None,
            phi_i: 20.0,
        }
    }
}

pub fn rng(seed: u64) -> Pcg64Mcg {
    Pcg64Mcg::seed_from_u64(seed)
}

pub fn normal(rng: &mut Pcg64Mcg) -> f64 {
    StandardNormal.sample(rng)
}

pub fn uniform(rng: &mut Pcg64Mcg, low: f64, high: f64) -> f64 {
    rng.random_range(low..high)
}

fn grid(component: Component, wi: Direction, campaign: &Campaign) -> Vec<(Direction, f64)> {
    let side = component.scattered_side(wi.side()).sign();
    let mut all = Vec::new();
    let (pitch, fine) = (campaign.pitch.0, campaign.pitch.1);
    let peak = match component {
        Component::Reflection => wi.mirror(),
        Component::Transmission => wi.through(),
    };
    let push = |all: &mut Vec<(Direction, f64)>, d: Direction, omega: f64| {
        if d.cos_theta() * side > 0.0 {
            all.push((d, omega));
        }
    };
    let mut theta = 0.5 * pitch;
    while theta < 90.0 {
        let n = ((360.0 * theta.to_radians().sin() / pitch).round() as usize).max(1);
        for k in 0..n {
            let d = Direction::from_degrees(theta, 360.0 * (k as f64 + 0.3) / n as f64);
            let d = if side > 0.0 { d } else { d.flipped() };
            if d.angle_to(peak).to_degrees() > campaign.patch {
                push(&mut all, d, pitch.to_radians().powi(2));
            }
        }
        theta += pitch;
    }
    let (a, b) = peak.vec().any_orthonormal_pair();
    let steps = (campaign.patch / fine) as i32;
    for i in -steps..=steps {
        for j in -steps..=steps {
            let (x, y) = (f64::from(i) * fine, f64::from(j) * fine);
            if x.hypot(y) <= campaign.patch {
                let v: DVec3 = peak.vec() + a * x.to_radians().tan() + b * y.to_radians().tan();
                push(&mut all, Direction::new(v).unwrap(), fine.to_radians().powi(2));
            }
        }
    }
    all
}

/// The DSF a Gaussian beam of this full width sees.
fn seen(dsf: &dyn Fn(Direction) -> f64, d: Direction, fwhm: Option<f64>) -> f64 {
    let Some(fwhm) = fwhm else { return dsf(d) };
    let w = fwhm.to_radians() / (2.0 * 2.0_f64.ln().sqrt());
    let (a, b) = d.vec().any_orthonormal_pair();
    // Wide beams need more directions.
    let (rings, spokes) = if fwhm < 1.0 { (10, 8) } else { (24, 12) };
    let mut sum = 0.0;
    for r in 0..rings {
        // Rings of equal power exp(-g^2/w^2); each at its mean of g^2, so that the second moment is exact.
        let outside = |k: i32| 1.0 - f64::from(k) / f64::from(rings);
        let integral = |v: f64| if v > 0.0 { v - v * v.ln() } else { 0.0 };
        let gamma = w * ((integral(outside(r)) - integral(outside(r + 1))) * f64::from(rings)).sqrt();
        for s in 0..spokes {
            let psi = std::f64::consts::TAU * (f64::from(s) + 0.5 * f64::from(r % 2)) / f64::from(spokes);
            let v = d.vec() * gamma.cos() + (a * psi.cos() + b * psi.sin()) * gamma.sin();
            sum += dsf(Direction::new(v).unwrap());
        }
    }
    sum / f64::from(rings * spokes)
}

/// A measurement of `model` with parameters `q` a channel, in every component the model scatters into.
pub fn measure(
    model: &FitModel,
    q: &[(Channel, Vec<f64>)],
    campaign: &Campaign,
    rng: &mut Pcg64Mcg,
) -> Measurement {
    let bsdf = model.bsdf(q).unwrap();
    let power = 1.0 + campaign.u_common * normal(rng);
    let mut slices = Vec::new();
    for &theta in &campaign.incidences {
        let incidence = Angles::from_degrees(theta, campaign.phi_i);
        let wi = incidence.direction();
        for (c, (channel, _)) in q.iter().enumerate() {
            let dsf = |ws: Direction| {
                let mut f = vec![0.0; q.len()];
                bsdf.eval(wi, ws, &mut f);
                f[c] * ws.cos_theta().abs()
            };
            let mut slice = Slice {
                incidence,
                channel: *channel,
                theta_s: Vec::new(),
                phi_s: Vec::new(),
                dsf: Vec::new(),
                u_dsf: Vec::new(),
                omega: Vec::new(),
                flags: Vec::new(),
                u_common: campaign.u_common,
                integrals: Vec::new(),
            };
            for component in [Component::Reflection, Component::Transmission] {
                if !model.scatters_into(component) {
                    continue;
                }
                for (d, omega) in grid(component, wi, campaign) {
                    let exact = seen(&dsf, d, campaign.beam) * power;
                    let sigma = campaign.noise.1.hypot(campaign.noise.0 * exact);
                    let read = exact + sigma * normal(rng);
                    slice.theta_s.push(d.theta());
                    slice.phi_s.push(d.phi());
                    slice.dsf.push(read);
                    let u = campaign.noise.1.hypot(campaign.noise.0 * read);
                    slice.u_dsf.push(u.hypot(campaign.u_common * read));
                    slice.omega.push(omega);
                    slice.flags.push(Flags::NONE);
                }
            }
            slices.push(slice);
        }
    }
    Measurement {
        slices,
        signature_fwhm: campaign.beam.map(f64::to_radians),
        ..Measurement::default()
    }
}

/// Parameters between the bounds that a measurement of this pitch can determine, one list a channel.
pub fn random_parameters(
    model: &FitModel,
    channels: &[Channel],
    rng: &mut Pcg64Mcg,
) -> Vec<(Channel, Vec<f64>)> {
    use gonio_bsdf::analytic::Role;
    let shared: Vec<f64> = model
        .parameters
        .iter()
        .map(|p| match p.role {
            Role::Width => {
                let (low, high) = (0.04_f64.max(p.low), 0.3_f64.min(p.high));
                (uniform(rng, low.ln(), high.ln())).exp()
            }
            Role::Amplitude if p.low == 0.0 && p.high == 1.0 => uniform(rng, 0.1, 0.4),
            Role::Angle => uniform(rng, -0.6, 0.6),
            _ if p.low > 0.0 && p.high / p.low > 100.0 => {
                let (low, high) = (p.low.ln(), p.high.ln());
                let centre = p.default.ln();
                uniform(rng, centre - 0.1 * (centre - low), centre + 0.1 * (high - centre)).exp()
            }
            _ => uniform(
                rng,
                p.default - 0.15 * (p.default - p.low),
                p.default + 0.15 * (p.high - p.default),
            ),
        })
        .collect();
    channels
        .iter()
        .map(|c| {
            let q = model
                .parameters
                .iter()
                .zip(&shared)
                .map(|(p, v)| {
                    if p.per_channel && p.role == Role::Amplitude && p.high == 1.0 {
                        uniform(rng, 0.1, 0.4)
                    } else {
                        *v
                    }
                })
                .collect();
            (*c, q)
        })
        .collect()
}
