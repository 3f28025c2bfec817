//! Dark subtraction: levels, blanks, drift in time.

use super::*;
use crate::testing::{Noise, path_scan, record};
use gonio_bsdf::Channel;

const NOISELESS: NoiseModel = NoiseModel::UNKNOWN;

#[test]
fn a_blank_is_subtracted_direction_by_direction_in_any_order() {
    let stray = |d: Direction| 0.1 + 0.05 * d.phi().sin();
    let mut scan = path_scan(10.0, 5.0, |d| 2.0 * d.cos_theta() + stray(d));
    let mut blank = path_scan(10.0, 5.0, stray);
    blank.theta_s.reverse();
    blank.phi_s.reverse();
    blank.value.reverse();
    let noise = NoiseModel {
        readout: 0.01,
        ..NOISELESS
    };
    let found = subtract(&mut scan, &[blank], &noise, &DarkOptions::default())
        .unwrap()
        .unwrap();
    assert_eq!(found.method, DarkMethod::Direction);
    assert_eq!(found.u_independent, 0.01);
    for j in 0..scan.len() {
        assert!((scan.value[j] - 2.0 * scan.theta_s[j].cos()).abs() < 1e-12);
    }
}

#[test]
fn a_blank_of_another_incidence_does_not_pass_for_this_one() {
    let mut scan = path_scan(10.0, 5.0, |_| 1.0);
    let mut blank = path_scan(10.0, 5.0, |_| 0.5);
    blank.incidence = record(30.0, 0.0).incidence;
    let options = DarkOptions {
        method: DarkMethod::Direction,
        ..DarkOptions::default()
    };
    let error = subtract(&mut scan, &[blank], &NOISELESS, &options).unwrap_err();
    assert!(error.to_string().contains("30.00"), "{error}");
}

#[test]
fn a_blank_that_leaves_directions_out_is_an_error_when_demanded() {
    let mut scan = path_scan(10.0, 5.0, |_| 1.0);
    let blank = path_scan(20.0, 5.0, |_| 0.5);
    let options = DarkOptions {
        method: DarkMethod::Direction,
        ..DarkOptions::default()
    };
    assert!(subtract(&mut scan, &[blank], &NOISELESS, &options).is_err());
}

#[test]
fn a_drifting_dark_is_interpolated_in_time() {
    // The dark rises by 1 a second; shutter readings before and after the scan.
    let mut scan = path_scan(10.0, 5.0, |_| 0.0);
    let n = scan.len();
    scan.value = (0..n).map(|j| 7.0 + 100.0 + j as f64 * 0.1).collect();
    scan.time = Some((0..n).map(|j| j as f64 * 0.1).collect());
    scan.meta.started = Some("2026-03-01T09:00:00".into());
    let shutter = |started: &str, level: f64| {
        let mut d = record(0.0, 0.0);
        d.push(Direction::NORMAL, level);
        d.meta.started = Some(started.into());
        d
    };
    let darks = [
        shutter("2026-03-01T09:05:00", 400.0),
        shutter("2026-03-01T08:59:00", 40.0),
    ];
    let noise = NoiseModel {
        readout: 0.5,
        ..NOISELESS
    };
    let found = subtract(&mut scan, &darks, &noise, &DarkOptions::default())
        .unwrap()
        .unwrap();
    assert_eq!(found.method, DarkMethod::Time);
    assert!(scan.value.iter().all(|v| (v - 7.0).abs() < 1e-6));
    assert!(
        found.u_common > 0.3 && found.u_common <= 0.5,
        "{}",
        found.u_common
    );
}

#[test]
fn records_of_one_clock_keep_their_dark_readings_apart() {
    // All times count from the begin of the campaign; the dark rises evenly, then falls.
    let level = |t: f64| 2.0 + if t < 3000.0 { 1e-3 * t } else { 6.0 - 1e-3 * t };
    let mut scan = path_scan(10.0, 5.0, |_| 0.0);
    let n = scan.len();
    let times: Vec<f64> = (0..n).map(|j| 3020.0 + 380.0 * j as f64 / n as f64).collect();
    scan.value = times.iter().map(|&t| 7.0 + level(t)).collect();
    scan.time = Some(times);
    scan.meta.started = Some("2026-03-01T09:00:00".into());
    let darks: Vec<Scan> = [1000.0, 2000.0, 3000.0, 3410.0]
        .iter()
        .map(|&at| {
            let mut d = record(0.0, 0.0);
            d.meta.started = Some("2026-03-01T09:00:00".into());
            d.time = Some((0..10).map(|k| at + f64::from(k)).collect());
            d.value = (0..10).map(|k| level(at + f64::from(k))).collect();
            (d.theta_s, d.phi_s) = (vec![0.0; 10], vec![0.0; 10]);
            d
        })
        .collect();
    let found = subtract(&mut scan, &darks, &NOISELESS, &DarkOptions::default()).unwrap();
    assert_eq!(found.unwrap().method, DarkMethod::Time);
    assert!(scan.value.iter().all(|v| (v - 7.0).abs() < 1e-9));
}

#[test]
fn without_times_or_directions_the_mean_level_is_taken_with_its_standard_error() {
    let mut noise = Noise::new(5);
    let mut scan = path_scan(10.0, 5.0, |_| 1.3);
    let mut dark = record(0.0, 0.0);
    for _ in 0..100 {
        dark.push(Direction::NORMAL, 0.3 + 0.02 * noise.normal());
    }
    let found = subtract(&mut scan, &[dark], &NOISELESS, &DarkOptions::default())
        .unwrap()
        .unwrap();
    assert_eq!(found.method, DarkMethod::Level);
    assert!((found.u_common / 0.002 - 1.0).abs() < 0.3);
    assert!(scan.value.iter().all(|v| (v - 1.0).abs() < 4.0 * found.u_common));
}

#[test]
fn a_dark_of_another_channel_or_gain_is_refused() {
    let mut scan = path_scan(10.0, 5.0, |_| 1.0);
    let mut dark = path_scan(10.0, 5.0, |_| 0.5);
    dark.channel = Channel::Wavelength(532.0);
    let error = subtract(&mut scan, &[dark.clone()], &NOISELESS, &DarkOptions::default()).unwrap_err();
    assert!(error.to_string().contains("532nm"), "{error}");
    dark.channel = scan.channel;
    dark.meta.other.insert("gain".into(), "1e6".into());
    scan.meta.other.insert("gain".into(), "1e3".into());
    let error = subtract(&mut scan, &[dark], &NOISELESS, &DarkOptions::default()).unwrap_err();
    assert!(error.to_string().contains("1e6"), "{error}");
}
