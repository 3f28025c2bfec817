//! Samples with axes: images of the incidences, lobes that move on their own, and narrow peaks.

#![allow(
    clippy::unwrap_used,
    reason = "a test that cannot set up its material has failed"
)]

use std::f64::consts::{PI, TAU};

use gonio_bsdf::analytic::{Analytic, Lambert, Spectrum, Sum, WardGmd};
use gonio_bsdf::{Bsdf, Channel, Properties};
use gonio_build::{BuildOptions, Candidate, DataDriven, Frame, Method, SymmetryChoice};
use gonio_geom::Component::{self, Reflection, Transmission};
use gonio_geom::{Angles, DVec3, Direction};
use gonio_scan::{Flags, Measurement, Slice};

/// The normal, and three polar angles at each of some azimuths.
fn incidences(azimuths: &[f64]) -> Vec<(f64, f64)> {
    let rings = [20.0, 40.0, 60.0].into_iter();
    let mut all = vec![(0.0, 0.0)];
    all.extend(rings.flat_map(|t| azimuths.iter().map(move |&p| (t, p))));
    all
}

/// Directions of the upper hemisphere, evenly spread within `radius` (radians) of `axis`.
fn cone(axis: DVec3, radius: f64, count: usize) -> Vec<DVec3> {
    let golden = PI * (1.0 + 5f64.sqrt());
    let (a, b) = axis.any_orthonormal_pair();
    (0..count)
        .map(|k| {
            let z = 1.0 - (1.0 - radius.cos()) * (k as f64 + 0.5) / count as f64;
            let (s, c) = (golden * k as f64).sin_cos();
            axis * z + (a * c + b * s) * (1.0 - z * z).sqrt()
        })
        .filter(|d| d.z > 0.03)
        .collect()
}

fn mirror(wi: Direction) -> DVec3 {
    let v = wi.vec();
    DVec3::new(-v.x, -v.y, v.z)
}

fn placed(d: DVec3, component: Component) -> Direction {
    let z = if component == Transmission { -d.z } else { d.z };
    Direction::from_unit(DVec3::new(d.x, d.y, z))
}

/// The hemisphere, and patches (radius in degrees, readings) about the mirror (through) direction, read without error.
fn read(truth: &dyn Bsdf, at: &[(f64, f64)], component: Component, patches: &[(f64, usize)]) -> Measurement {
    let slice = |&(theta, phi): &(f64, f64)| {
        let incidence = Angles::from_degrees(theta, phi);
        let wi = incidence.direction();
        let mut directions = cone(DVec3::Z, 1.54, 4000);
        for (radius, count) in patches {
            directions.extend(cone(mirror(wi), radius.to_radians(), *count));
        }
        let ws: Vec<Direction> = directions.into_iter().map(|d| placed(d, component)).collect();
        let dsf: Vec<f64> = ws
            .iter()
            .map(|&s| truth.eval_first(wi, s) * s.cos_theta().abs())
            .collect();
        Slice {
            incidence,
            channel: Channel::Photopic,
            theta_s: ws.iter().map(|s| s.theta()).collect(),
            phi_s: ws.iter().map(|s| s.phi()).collect(),
            u_dsf: dsf.iter().map(|d| 0.002 * d + 1e-6).collect(),
            omega: vec![0.0; dsf.len()],
            flags: vec![Flags::NONE; dsf.len()],
            dsf,
            u_common: 0.0,
            integrals: vec![],
        }
    };
    Measurement {
        slices: at.iter().map(slice).collect(),
        ..Measurement::default()
    }
}

fn built(data: &Measurement, candidate: Option<Method>) -> DataDriven {
    let options = BuildOptions {
        symmetry: SymmetryChoice::Anisotropic,
        candidate: candidate.map(Candidate::linear),
        ..BuildOptions::default()
    };
    DataDriven::build(data, &options).unwrap()
}

/// Relative L1 error of the DSF at one incidence.
fn error(truth: &dyn Bsdf, model: &DataDriven, wi: Direction, component: Component) -> f64 {
    let (mut apart, mut all) = (0.0, 0.0);
    for d in cone(DVec3::Z, 1.5, 40_000) {
        let s = placed(d, component);
        let (f, g) = (truth.eval_first(wi, s), model.eval_first(wi, s));
        apart += (f - g).abs() * d.z;
        all += f * d.z;
    }
    apart / all
}

fn elliptic(phi_x: f64) -> Sum {
    ridge(0.12, phi_x)
}

/// A lobe `alpha_x` by 0.3 whose x axis has azimuth `phi_x` (degrees).
fn ridge(alpha_x: f64, phi_x: f64) -> Sum {
    let grey = |v| Spectrum::photopic("rho", v).unwrap();
    let values = vec![0.3, alpha_x, 0.3, phi_x.to_radians()];
    let lobe = Analytic::<WardGmd>::new(&[(Channel::Photopic, values)]).unwrap();
    Sum::new(vec![
        Box::new(Lambert::reflection(&grey(0.3)).unwrap()),
        Box::new(lobe),
    ])
    .unwrap()
}

/// A BSDF by its values in one component; directions of scattering with z taken positive.
struct By<F>(Component, F);

impl<F: Fn(DVec3, DVec3) -> f64 + Send + Sync> Bsdf for By<F> {
    fn channels(&self) -> &[Channel] {
        &[Channel::Photopic]
    }

    fn properties(&self) -> Properties {
        Properties {
            reciprocal: false,
            energy_conserving: true,
            isotropic: false,
        }
    }

    fn eval(&self, wi: Direction, ws: Direction, f: &mut [f64]) {
        let s = ws.vec();
        f[0] = if Component::between(wi.side(), ws.side()) == self.0 {
            self.1(wi.vec(), DVec3::new(s.x, s.y, s.z.abs()))
        } else {
            0.0
        };
    }
}

#[test]
fn a_quarter_of_the_azimuths_is_enough_where_both_mirror_planes_show() {
    let truth = elliptic(0.0);
    let data = read(
        &truth,
        &incidences(&[0.0, 30.0, 60.0, 90.0]),
        Reflection,
        &[(25.0, 3000)],
    );
    let model = built(&data, None);
    assert_eq!(model.summary()[0].symmetry, "quadrilateral");
    for (theta, phi) in [(30.0, 15.0), (50.0, 130.0), (30.0, 220.0), (50.0, 320.0)] {
        let off = error(&truth, &model, Direction::from_degrees(theta, phi), Reflection);
        assert!(off < 0.01, "{theta} {phi}: {off}");
    }
}

#[test]
fn readings_too_far_apart_for_a_ridge_are_told_though_a_base_of_its_own_family_fills_the_gaps() {
    // Readings 2.3 degrees apart, 0.8 about the mirror direction; the ridge is 2.3 degrees wide (1/e, half), or 13.7.
    for (alpha_x, told) in [(0.02, true), (0.12, false)] {
        let truth = ridge(alpha_x, 0.0);
        let data = read(
            &truth,
            &incidences(&[0.0, 30.0, 60.0, 90.0]),
            Reflection,
            &[(25.0, 3000)],
        );
        let model = built(&data, None);
        let off = error(&truth, &model, Direction::from_degrees(30.0, 15.0), Reflection);
        assert!(off < 0.02, "the base knows the ridge: {off}");
        let said = model.warnings().iter().any(|w| w.contains("undersampled"));
        let spacings = &model.summary()[0].spacings;
        assert_eq!(said, told, "{spacings:?}");
        assert_eq!(spacings.iter().any(|s| *s > 0.5), told, "{spacings:?}");
    }
}

#[test]
fn axes_off_the_mirror_planes_leave_half_a_turn() {
    let truth = elliptic(25.0);
    let half = incidences(&[0.0, 36.0, 72.0, 108.0, 144.0]);
    let data = read(&truth, &half, Reflection, &[(25.0, 3000)]);
    let model = built(&data, None);
    assert_eq!(model.summary()[0].symmetry, "half-turn");
    let off = error(&truth, &model, Direction::from_degrees(30.0, 270.0), Reflection);
    assert!(off < 0.01, "{off}");
    // With a model of other facets the ratio makes up for them.
    let options = BuildOptions {
        symmetry: SymmetryChoice::Anisotropic,
        without: vec!["ward-gmd-anisotropic".into(), "ward-gmd".into()],
        ..BuildOptions::default()
    };
    let model = DataDriven::build(&data, &options).unwrap();
    let off = error(&truth, &model, Direction::from_degrees(30.0, 270.0), Reflection);
    assert!(off < 0.03, "{off}");
}

#[test]
fn lobes_that_refraction_sends_their_own_ways_are_followed() {
    // Two lobes that move by .75 of what the through direction does, aside by .3 and -.3, one three times as strong.
    let truth = By(Transmission, |i: DVec3, s: DVec3| {
        let lobe = |aside: f64| {
            let (x, y) = (s.x + 0.75 * i.x - aside, s.y + 0.75 * i.y);
            (-(x * x + y * y) / (2.0 * 0.05f64.powi(2))).exp()
        };
        0.02 + 6.0 * lobe(0.3) + 2.0 * lobe(-0.3)
    });
    let data = read(
        &truth,
        &incidences(&[0.0, 45.0, 90.0, 135.0, 180.0]),
        Transmission,
        &[(60.0, 6000)],
    );
    let model = built(&data, None);
    let summary = &model.summary()[0];
    assert_eq!(summary.symmetry, "bilateral");
    assert_eq!(summary.candidate.method, Method::Tracked, "{:?}", summary.scores);
    let shifted = built(&data, Some(Method::Ratio(Frame::CosineShift)));
    for (theta, phi) in [(30.0, 20.0), (30.0, 160.0), (50.0, 300.0)] {
        let wi = Direction::from_degrees(theta, phi);
        let (own, other) = (
            error(&truth, &model, wi, Transmission),
            error(&truth, &shifted, wi, Transmission),
        );
        assert!(own < 0.02 && own < 0.2 * other, "{theta} {phi}: {own} {other}");
    }
    let measured = error(&truth, &model, Direction::from_degrees(40.0, 45.0), Transmission);
    assert!(measured < 0.01, "a measured incidence is its slice: {measured}");
}

#[test]
fn a_narrow_peak_whose_amplitude_falls_is_interpolated_apart() {
    let width = 0.6f64.to_radians();
    let share = |i: DVec3| {
        let (x, y) = (i.x / i.z, i.y / i.z);
        0.1 * (-x * x / 1.5 - y * y / 0.8).exp()
    };
    let truth = By(Transmission, |i: DVec3, s: DVec3| {
        let chord2 = (s - DVec3::new(-i.x, -i.y, i.z)).length_squared();
        let peak = (-chord2 / (width * width)).exp() / (PI * width * width);
        (0.2 + 0.1 * s.x * s.x - 0.05 * i.x * i.x) / PI + share(i) * peak / s.z.max(0.02)
    });
    let at = incidences(&[0.0, 22.5, 45.0, 67.5, 90.0]);
    let data = read(&truth, &at, Transmission, &[(15.0, 1500), (3.0, 3000)]);
    let model = built(&data, None);
    let peak = model.summary()[0].peak.as_ref().expect("a peak");
    assert!(peak.radius.to_degrees() > 1.0 && peak.radius.to_degrees() < 3.0);
    for (incidence, found) in &peak.shares {
        let wanted = share(incidence.direction().vec());
        assert!((found - wanted).abs() < 0.02 * wanted + 1e-4, "{found} {wanted}");
    }
    for (theta, phi) in [(30.0, 11.25), (30.0, 78.75), (50.0, 100.0)] {
        let wi = Direction::from_degrees(theta, phi);
        let radius = 2f64.to_radians();
        let directions = cone(mirror(wi), radius, 20_000);
        let cell = TAU * (1.0 - radius.cos()) / directions.len() as f64;
        let off: f64 = directions
            .iter()
            .map(|d| {
                let s = placed(*d, Transmission);
                (model.eval_first(wi, s) - truth.eval_first(wi, s)) * d.z * cell
            })
            .sum();
        assert!(off.abs() < 0.005, "{theta} {phi}: {off} of the incident light");
    }
}
