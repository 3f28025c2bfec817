//! Closed forms, errors and the Monte Carlo proof of the stated uncertainty.

use std::f64::consts::PI;

use gonio_bsdf::{Channel, Quantity};
use gonio_geom::{Direction, Side};

use crate::testing::{Noise, beam_scan, path_scan, record, spiral, spiral_scan};
use crate::{Flags, Level, NoiseModel, NoiseOrigin, ProcessOptions, Scan, ScanKind, process};

/// A Gaussian beam of unit peak: power `pi w^2`.
fn beam(w: f64) -> Scan {
    beam_scan(0.0, 0.0, 0.3 * w, 4.0 * w, move |g| {
        (-(g.to_degrees() / w).powi(2)).exp()
    })
}

fn power(w: f64) -> f64 {
    PI * w.to_radians().powi(2)
}

const W: f64 = 0.5;

#[test]
fn a_lambertian_sample_gives_its_reflectance_back() {
    let rho = 0.8;
    let sample = spiral_scan(30.0, 0.0, 4000, Side::Front, |d| {
        power(W) * rho * d.cos_theta() / PI
    });
    let m = process(&[sample], &[beam(W)], &[], &ProcessOptions::default()).unwrap();
    let slice = &m.slices[0];
    for j in (0..3900).step_by(13) {
        let expected = rho * slice.theta_s[j].cos() / PI;
        assert!((slice.dsf[j] / expected - 1.0).abs() < 1e-3);
        assert!((slice.bsdf(j) - rho / PI).abs() < 1e-3);
    }
    let h = slice.integral(Side::Front).unwrap();
    assert!(
        (h.value - rho).abs() < 3.0 * h.u.max(1e-4) && (h.value - rho).abs() < 3e-3,
        "{h:?}"
    );
    assert!(slice.integral(Side::Back).is_none());
    let fwhm = m.signature_fwhm.unwrap().to_degrees();
    assert!((fwhm - 2.0 * W * 2.0_f64.ln().sqrt()).abs() < 0.05, "{fwhm}");
}

#[test]
fn transmission_and_reflection_are_integrated_apart() {
    let mut sample = spiral_scan(0.0, 0.0, 3000, Side::Front, |d| 0.3 * d.cos_theta() / PI);
    for d in spiral(3000, Side::Back) {
        sample.push(d, 0.5 * d.cos_theta().abs() / PI);
    }
    sample.quantity = Quantity::Dsf;
    let m = process(&[sample], &[], &[], &ProcessOptions::default()).unwrap();
    let value = |side| m.slices[0].integral(side).unwrap().value;
    assert!((value(Side::Front) - 0.3).abs() < 1e-3);
    assert!((value(Side::Back) - 0.5).abs() < 1e-3);
}

#[test]
fn a_longer_detector_distance_is_corrected_by_its_square() {
    let rho = 0.5;
    let mut sample = spiral_scan(0.0, 0.0, 2000, Side::Front, |d| {
        power(W) * rho * d.cos_theta() / PI / 4.0 // twice as far: a quarter of the illuminance
    });
    sample.meta.distance = Some(2.0);
    let mut reference = beam(W);
    reference.meta.distance = Some(1.0);
    let m = process(&[sample], &[reference], &[], &ProcessOptions::default()).unwrap();
    let expected = rho * m.slices[0].theta_s[10].cos() / PI;
    assert!((m.slices[0].dsf[10] / expected - 1.0).abs() < 1e-3);
}

#[test]
fn every_quantity_ends_as_the_same_dsf() {
    let rho = 0.6;
    let of = |quantity: Quantity, f: fn(f64) -> f64| {
        let mut s = spiral_scan(0.0, 0.0, 500, Side::Front, |d| rho * f(d.cos_theta()));
        s.quantity = quantity;
        process(&[s], &[], &[], &ProcessOptions::default())
            .unwrap()
            .slices
            .remove(0)
    };
    let a = of(Quantity::Bsdf, |_| 1.0 / PI);
    let b = of(Quantity::Dsf, |c| c / PI);
    let c = of(Quantity::ReflectanceFactor, |_| 1.0);
    for j in 0..500 {
        assert!((a.dsf[j] - b.dsf[j]).abs() < 1e-12 && (a.dsf[j] - c.dsf[j]).abs() < 1e-12);
    }
}

#[test]
fn a_missing_or_foreign_reference_scan_is_refused() {
    let sample = spiral_scan(0.0, 0.0, 500, Side::Front, |d| d.cos_theta());
    let options = ProcessOptions::default();
    let error = process(std::slice::from_ref(&sample), &[], &[], &options)
        .unwrap_err()
        .to_string();
    assert!(error.contains("no reference scan"), "{error}");
    let mut foreign = beam(W);
    foreign.channel = Channel::Wavelength(633.0);
    let error = process(std::slice::from_ref(&sample), &[foreign], &[], &options)
        .unwrap_err()
        .to_string();
    assert!(error.contains("633nm") && error.contains("photopic"), "{error}");
    let mut other = sample.clone();
    other.meta.distance = Some(1.0);
    other.meta.receiver_solid_angle = Some(1e-4);
    let mut reference = beam(W);
    reference.meta.distance = Some(1.0);
    reference.meta.receiver_solid_angle = Some(4e-4);
    let error = process(&[other], &[reference], &[], &options)
        .unwrap_err()
        .to_string();
    assert!(error.contains("aperture"), "{error}");
}

#[test]
fn records_that_are_no_data_are_refused_with_their_name() {
    let options = ProcessOptions::default();
    assert!(process(&[], &[beam(W)], &[], &options).is_err());
    let mut empty = record(20.0, 0.0);
    empty.meta.source = Some("empty.txt".into());
    let error = process(&[empty], &[beam(W)], &[], &options)
        .unwrap_err()
        .to_string();
    assert!(error.contains("empty.txt"), "{error}");
    let good = spiral_scan(0.0, 0.0, 100, Side::Front, |_| 1.0);
    let mut short = good.clone();
    short.phi_s.pop();
    assert!(process(&[short], &[beam(W)], &[], &options).is_err());
    let mut wide = good.clone();
    wide.theta_s[5] = 4.0;
    let error = process(&[wide], &[beam(W)], &[], &options)
        .unwrap_err()
        .to_string();
    assert!(error.contains("reading 5"), "{error}");
    let mut other = good.clone();
    other.quantity = Quantity::Bsdf;
    let error = process(&[good.clone(), other], &[beam(W)], &[], &options)
        .unwrap_err()
        .to_string();
    assert!(error.contains("quantity"), "{error}");
    let mut kind = good;
    kind.kind = ScanKind::Beam;
    assert!(process(&[kind], &[beam(W)], &[], &options).is_err());
}

#[test]
fn negative_readings_are_kept_and_flagged() {
    let mut sample = path_scan(10.0, 5.0, |_| 1e-3);
    let mut blank = path_scan(10.0, 5.0, |_| 2e-3);
    blank.kind = ScanKind::Dark;
    sample.meta.noise_readout = Some(1e-4);
    let m = process(&[sample], &[beam(W)], &[blank], &ProcessOptions::default()).unwrap();
    let slice = &m.slices[0];
    assert!(slice.dsf.iter().all(|d| *d < 0.0));
    assert!(
        slice
            .flags
            .iter()
            .all(|f| f.intersects(Flags::NEGATIVE) && f.usable())
    );
    assert_eq!(m.processing.findings[0].level, Level::Fail);
    assert!(!m.warnings.is_empty());
}

#[test]
fn a_blank_of_the_same_stray_light_matches_and_another_does_not() {
    let stray = |d: Direction| {
        0.02 * f64::from((d.phi() * 9.0).sin() > 0.0) + 0.01 * f64::from((d.theta() * 40.0).sin() > 0.0)
    };
    let sigma = 3e-4;
    let run = |amount: f64| {
        let mut noise = Noise::new(9);
        let sample = path_scan(4.0, 1.0, |d| {
            0.05 * d.cos_theta() + stray(d) + sigma * noise.normal()
        });
        let mut blank = path_scan(4.0, 1.0, |d| amount * stray(d) + sigma * noise.normal());
        blank.kind = ScanKind::Dark;
        let m = process(&[sample], &[beam(W)], &[blank], &ProcessOptions::default()).unwrap();
        m.processing.findings[0].clone()
    };
    let right = run(1.0);
    assert_eq!(right.level, Level::Pass, "{}", right.sentence);
    let wrong = run(3.0);
    assert!(wrong.level >= Level::Warn, "{}", wrong.sentence);
}

#[test]
fn a_dsf_blank_below_zero_warns_that_the_instruments_zero_moved() {
    let run = |level: f64| {
        let mut sample = path_scan(10.0, 5.0, |d| 0.1 * d.cos_theta() + 0.01);
        let mut blank = path_scan(10.0, 5.0, |_| level);
        blank.kind = ScanKind::Dark;
        for scan in [&mut sample, &mut blank] {
            scan.quantity = Quantity::Dsf;
            scan.meta.noise_readout = Some(1e-5);
        }
        let m = process(&[sample], &[], &[blank], &ProcessOptions::default()).unwrap();
        m.processing.findings[0].clone()
    };
    assert_eq!(run(1e-3).level, Level::Pass);
    let found = run(-1e-3);
    assert_eq!(found.level, Level::Warn);
    assert!(
        found.sentence.contains("zero was another one"),
        "{}",
        found.sentence
    );
}

#[test]
fn raw_signals_without_a_dark_are_reported_with_what_an_offset_would_do() {
    let (rho, offset) = (0.5, 0.01);
    let sample = || {
        spiral_scan(0.0, 0.0, 2000, Side::Front, |d| {
            power(W) * (rho * d.cos_theta() / PI + offset)
        })
    };
    let found = |dark: &[Scan]| {
        let m = process(&[sample()], &[beam(W)], dark, &ProcessOptions::default()).unwrap();
        let finding = m
            .processing
            .findings
            .iter()
            .find(|f| f.id == "dark_subtracted")
            .cloned();
        (finding, m.warnings)
    };
    let (finding, warnings) = found(&[]);
    let finding = finding.unwrap();
    assert_eq!(finding.level, Level::Warn);
    assert!(finding.sentence.contains("--dark"), "{}", finding.sentence);
    assert!(warnings.contains(&finding.sentence));
    // The lowest 5 % of the readings end at cos theta_s = 0.05.
    let low = rho * 0.05 / PI + offset;
    let expected = 100.0 * 2.0 * PI * low / (rho + 2.0 * PI * offset);
    assert!((finding.value.unwrap() - expected).abs() < 0.3, "{finding:?}");
    let mut dark = record(0.0, 0.0);
    dark.kind = ScanKind::Dark;
    for _ in 0..20 {
        dark.push(Direction::NORMAL, power(W) * offset);
    }
    assert_eq!(found(&[dark]).0, None);
}

#[test]
fn calibrated_values_without_a_calibration_uncertainty_say_so_once() {
    let run = |u_calibration: f64| {
        let mut sample = spiral_scan(0.0, 0.0, 500, Side::Front, |_| 0.2);
        sample.quantity = Quantity::Bsdf;
        let options = ProcessOptions {
            u_calibration,
            ..ProcessOptions::default()
        };
        let m = process(&[sample.clone(), sample], &[], &[], &options).unwrap();
        m.processing.findings
    };
    let unstated = run(0.0);
    assert_eq!(unstated.len(), 1, "{unstated:?}");
    assert_eq!(
        (unstated[0].id, unstated[0].level),
        ("calibration_uncertainty", Level::Info)
    );
    assert!(run(0.01).is_empty());
}

#[test]
fn an_in_plane_scan_says_once_why_it_has_no_integral() {
    let mut plane = record(20.0, 0.0);
    for theta in 1..85 {
        plane.push(Direction::from_degrees(f64::from(theta), 0.0), 0.2);
        plane.push(Direction::from_degrees(f64::from(theta), 180.0), 0.2);
    }
    plane.quantity = Quantity::Bsdf;
    let whole = spiral_scan(20.0, 0.0, 500, Side::Front, |_| 0.2);
    let of = |scan: Scan| {
        let scan = Scan {
            quantity: Quantity::Bsdf,
            ..scan
        };
        process(&[scan.clone(), scan], &[], &[], &ProcessOptions::default())
            .unwrap()
            .warnings
    };
    let warnings = of(plane);
    assert_eq!(warnings.len(), 1, "{warnings:?}");
    assert!(warnings[0].contains("2 of 2 scans") && warnings[0].contains("in-plane"));
    assert!(of(whole).is_empty());
}

#[test]
fn a_blank_that_does_not_match_is_reported_once_with_the_cause_first() {
    let mut sample = path_scan(10.0, 5.0, |d| 0.1 * d.cos_theta() + 0.01);
    let mut blank = path_scan(10.0, 5.0, |_| -1e-3);
    blank.kind = ScanKind::Dark;
    for scan in [&mut sample, &mut blank] {
        scan.quantity = Quantity::Dsf;
        scan.meta.noise_readout = Some(1e-5);
    }
    let three = [sample.clone(), sample.clone(), sample];
    let m = process(&three, &[], &[blank], &ProcessOptions::default()).unwrap();
    let found: Vec<_> = m
        .processing
        .findings
        .iter()
        .filter(|f| f.id == "blank_match")
        .collect();
    assert_eq!(found.len(), 1);
    assert_eq!(found[0].value, Some(100.0), "the share that decided");
    let text = &found[0].sentence;
    assert!(
        text.starts_with("100 % of the blank itself lies below zero"),
        "{text}"
    );
    assert!(text.ends_with("2 more scans show the same."), "{text}");
    assert_eq!(m.warnings.len(), 1, "{:?}", m.warnings);
}

/// 95 % intervals of single values and of the DHR over 200 simulated measurements with noise, dark noise and a noisy
/// reference scan.
#[test]
fn the_stated_uncertainty_is_the_spread_of_repeated_measurements() {
    let model = NoiseModel {
        readout: 2e-6,
        relative: 0.01,
        origin: NoiseOrigin::Stated,
    };
    let rho = 0.7;
    let mut noise = Noise::new(2024);
    let state = |scan: &mut Scan| {
        scan.meta.noise_readout = Some(model.readout);
        scan.meta.noise_relative = Some(model.relative);
    };
    let (mut inside, mut total, mut inside_dhr) = (0_usize, 0_usize, 0_usize);
    let runs = 200;
    for _ in 0..runs {
        let mut sample = spiral_scan(0.0, 0.0, 600, Side::Front, |d| {
            let s = power(W) * rho * d.cos_theta() / PI;
            s + 3e-6 + noise.normal() * model.sigma(s)
        });
        let mut reference = beam_scan(0.0, 0.0, 0.25, 2.0, |g| {
            let s = (-(g.to_degrees() / W).powi(2)).exp();
            s + 3e-6 + noise.normal() * model.sigma(s)
        });
        let mut dark = record(0.0, 0.0);
        dark.kind = ScanKind::Dark;
        for _ in 0..40 {
            dark.push(Direction::NORMAL, 3e-6 + noise.normal() * model.readout);
        }
        state(&mut sample);
        state(&mut reference);
        let m = process(&[sample], &[reference], &[dark], &ProcessOptions::default()).unwrap();
        let slice = &m.slices[0];
        for j in 0..slice.len() {
            let truth = rho * slice.theta_s[j].cos() / PI;
            inside += usize::from((slice.dsf[j] - truth).abs() <= 1.96 * slice.u_dsf[j]);
            total += 1;
        }
        let h = slice.integral(Side::Front).unwrap();
        inside_dhr += usize::from((h.value - rho).abs() <= 1.96 * h.u);
    }
    let coverage = inside as f64 / total as f64;
    // Values of one run share the beam power (0.4 % of 1.1 %), which widens the binomial spread to about 0.3 %.
    assert!((0.94..=0.965).contains(&coverage), "{coverage}");
    // Binomial with p = 0.95, n = 200: below 0.89 once in 2000 seeds; above 0.995 would be too wide a claim, except
    // for the quadrature's share, which only ever widens.
    let dhr = inside_dhr as f64 / f64::from(runs);
    assert!(dhr >= 0.89, "{dhr}");
}
