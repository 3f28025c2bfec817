//! Light that passes or is mirrored unscattered becomes the ideal part of a model, and only that.

use std::f64::consts::{LN_2, PI};

use crate::common::{Noise, error, measure};
use gonio_bsdf::analytic::{Lambert, Spectrum, Sum, WardGmd, family};
use gonio_bsdf::{Bsdf, Channel, Lobe};
use gonio_build::{BuildOptions, DataDriven};
use gonio_geom::{Component, Direction};
use gonio_scan::{Measurement, Resolution};
use rand::{RngExt, SeedableRng};
use rand_distr::{Distribution, StandardNormal};
use rand_pcg::Pcg64Mcg;

/// 1/e half width of the beam, radians: resolved by the lines of the synthetic path.
const WIDTH: f64 = 0.8 * PI / 180.0;

const INCIDENCES: [(f64, f64); 6] = [
    (0.0, 0.0),
    (15.0, 0.0),
    (30.0, 0.0),
    (45.0, 0.0),
    (60.0, 0.0),
    (70.0, 0.0),
];
const NOISE: Noise = Noise(0.01, 2e-4);

/// The share that passes straight at `theta_i` degrees.
fn share(theta: f64) -> f64 {
    0.4 * (1.0 - (theta / 90.0).powi(2))
}

fn curtain() -> Sum {
    let lobe = family("bounded-transmission-lobe").unwrap();
    Sum::new(vec![
        Box::new(Lambert::transmission(&Spectrum::photopic("tau_d", 0.15).unwrap()).unwrap()),
        lobe.model(&[(Channel::Photopic, vec![0.2, 0.2])]).unwrap(),
    ])
    .unwrap()
}

/// Adds the image of a beam `scale` times as wide about the straight direction of every slice.
fn with_peak(measurement: &mut Measurement, component: Component, scale: f64, share: impl Fn(f64) -> f64) {
    let w = scale * WIDTH;
    let mut rng = Pcg64Mcg::seed_from_u64(5);
    for slice in &mut measurement.slices {
        let wi = slice.incidence.direction();
        let straight = match component {
            Component::Reflection => wi.mirror(),
            Component::Transmission => wi.through(),
        };
        let share = share(wi.theta().to_degrees());
        for j in 0..slice.len() {
            let gamma = slice.direction(j).angle_to(straight);
            let value = share * (-(gamma / w).powi(2)).exp() / (PI * w * w);
            let noise: f64 = StandardNormal.sample(&mut rng);
            slice.dsf[j] += value * (1.0 + NOISE.0 * noise);
            slice.u_dsf[j] = slice.u_dsf[j].hypot(NOISE.0 * value);
        }
    }
    measurement.resolutions = vec![Resolution {
        channel: Channel::Photopic,
        fwhm: 2.0 * WIDTH * LN_2.sqrt(),
        radius_50: WIDTH * LN_2.sqrt(),
        radius_90: WIDTH * 10f64.ln().sqrt(),
        second_moment: WIDTH * WIDTH,
        receiver_radius: None,
        spot_radius: None,
    }];
}

fn measured_curtain() -> Measurement {
    let mut measurement = measure(&curtain(), &INCIDENCES, &[Component::Transmission], 88.0, NOISE);
    with_peak(&mut measurement, Component::Transmission, 1.0, share);
    measurement
}

#[test]
fn a_through_peak_as_narrow_as_the_beam_becomes_the_ideal_part() {
    let model = DataDriven::build(&measured_curtain(), &BuildOptions::default()).unwrap();
    assert_eq!(model.direct().len(), INCIDENCES.len());
    for peak in model.direct() {
        let theta = peak.incidence.to_degrees().0;
        // half a percent of the incident light, and what the peak itself states
        let apart = (peak.share - share(theta)).abs();
        assert!(apart < 5e-3, "{theta} deg: {} for {}", peak.share, share(theta));
        assert!(
            apart < 4.0 * peak.u_share + 1e-4,
            "{theta} deg: {apart} with u {}",
            peak.u_share
        );
        assert!((peak.width - 1.0).abs() < 0.05 && peak.offset.to_degrees() < 0.1);
    }
    let mut found = [0.0];
    for theta in [0.0, 7.0, 22.0, 37.0, 52.0, 65.0] {
        let wi = Direction::from_degrees(theta, 20.0);
        let to = model.delta(wi, Component::Transmission, &mut found).unwrap();
        assert!(to.angle_to(wi.through()) < 1e-12);
        assert!(
            (found[0] - share(theta)).abs() < 6e-3,
            "{theta} deg: {}",
            found[0]
        );
        let (apart, energy) = error(&curtain(), &model, wi, Component::Transmission);
        assert!(
            apart < 0.02 && energy.abs() < 0.01,
            "{theta} deg: {apart} {energy}"
        );
    }
    assert!(
        model
            .delta(Direction::NORMAL, Component::Reflection, &mut found)
            .is_none()
    );
}

#[test]
fn samples_of_ideal_and_scattered_light_carry_the_albedo() {
    let model = DataDriven::build(&measured_curtain(), &BuildOptions::default()).unwrap();
    let mut rng = Pcg64Mcg::seed_from_u64(8);
    for theta in [10.0, 50.0] {
        let wi = Direction::from_degrees(theta, 0.0);
        let (n, mut sum, mut square, mut ideal) = (40_000, 0.0, 0.0, 0.0);
        for _ in 0..n {
            let Some(s) = model.sample(wi, rng.random()) else {
                continue;
            };
            sum += s.weight;
            square += s.weight * s.weight;
            if s.lobe == Lobe::Delta {
                ideal += s.weight;
            } else {
                assert!((s.pdf / model.pdf(wi, s.direction) - 1.0).abs() < 1e-9);
            }
        }
        let n = f64::from(n);
        let (mean, ideal) = (sum / n, ideal / n);
        let sigma = ((square / n - mean * mean) / n).sqrt();
        // 4.5 standard deviations: false alarm 7e-6
        assert!(
            (mean - model.albedo(wi)).abs() < 4.5 * sigma + 2e-3 * mean,
            "{mean} {}",
            model.albedo(wi)
        );
        assert!((ideal - share(theta)).abs() < 0.012, "{ideal}");
    }
}

#[test]
fn the_density_of_samples_integrates_to_the_scattered_share() {
    let model = DataDriven::build(&measured_curtain(), &BuildOptions::default()).unwrap();
    let wi = Direction::from_degrees(30.0, 0.0);
    let n = 800;
    let mut sum = 0.0;
    for a in 0..n {
        for b in 0..n {
            let centre = |k: i32| (f64::from(k) + 0.5) / f64::from(n);
            let (x, y) = gonio_geom::disk::square_to_disk(centre(a), centre(b));
            let z = (1.0 - x * x - y * y).sqrt();
            let ws = Direction::new(gonio_geom::DVec3::new(x, y, -z)).unwrap();
            sum += model.pdf(wi, ws) / z * PI / f64::from(n * n);
        }
    }
    let mut share = [0.0];
    model.delta(wi, Component::Transmission, &mut share);
    let scattered = 1.0 - share[0] / model.albedo(wi);
    assert!((sum - scattered).abs() < 0.03, "{sum} {scattered}");
}

#[test]
fn a_lobe_wider_than_the_beam_stays_in_the_bsdf() {
    let mut measurement = measure(&curtain(), &INCIDENCES, &[Component::Transmission], 88.0, NOISE);
    with_peak(&mut measurement, Component::Transmission, 1.5, share);
    let model = DataDriven::build(&measurement, &BuildOptions::default()).unwrap();
    assert!(model.direct().is_empty(), "{:?}", model.direct());
}

#[test]
fn a_mirror_peak_over_gloss_is_found_and_gloss_alone_is_none() {
    let paint = Sum::new(vec![
        Box::new(Lambert::reflection(&Spectrum::photopic("rho_d", 0.3).unwrap()).unwrap()) as Box<dyn Bsdf>,
        Box::new(WardGmd::isotropic(&Spectrum::photopic("rho_s", 0.04).unwrap(), 0.08).unwrap()),
    ])
    .unwrap();
    let mut measurement = measure(&paint, &INCIDENCES, &[Component::Reflection], 88.0, NOISE);
    with_peak(&mut measurement, Component::Reflection, 1.0, |_| 0.0);
    let none = DataDriven::build(&measurement, &BuildOptions::default()).unwrap();
    assert!(none.direct().is_empty() && !none.has_delta());
    with_peak(&mut measurement, Component::Reflection, 1.0, |_| 0.03);
    let model = DataDriven::build(&measurement, &BuildOptions::default()).unwrap();
    assert!(!model.direct().is_empty());
    for peak in model.direct() {
        assert!((peak.share - 0.03).abs() < 2e-3, "{peak:?}");
    }
    // Left alone when asked.
    let options = BuildOptions {
        direct: false,
        ..BuildOptions::default()
    };
    assert!(!DataDriven::build(&measurement, &options).unwrap().has_delta());
}
