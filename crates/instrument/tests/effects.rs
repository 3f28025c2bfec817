//! Each part of the instrument does to the readings what its closed form says.

#![allow(clippy::unwrap_used)] // helpers outside #[test] fail a test by panicking, as the tests themselves do

use gonio_bsdf::analytic::{Lambert, Spectrum, Sum, WardGmd};
use gonio_bsdf::{Bsdf, Channel};
use gonio_geom::{Angles, Component, Direction};
use gonio_instrument::*;
use gonio_scan::{Scan, ScanKind};

fn lambert(rho: f64) -> Sum {
    Sum::new(vec![Box::new(
        Lambert::reflection(&Spectrum::photopic("rho", rho).unwrap()).unwrap(),
    )])
    .unwrap()
}

fn gloss(alpha: f64) -> Sum {
    Sum::new(vec![Box::new(
        WardGmd::isotropic(&Spectrum::photopic("rho", 0.5).unwrap(), alpha).unwrap(),
    )])
    .unwrap()
}

/// Without noise, dark and pointing error.
fn silent() -> Instrument {
    let mut it = Instrument::default();
    it.detector.noise_readout = 0.0;
    it.detector.noise_relative = 0.0;
    it.detector.dark_level = 0.0;
    it.detector.dark_swing = 0.0;
    it.detector.pointing = 0.0;
    it.path.patch = None;
    it.path.jitter = 0.0;
    it
}

fn at(theta: f64) -> Campaign {
    Campaign {
        incidences: vec![Angles::from_degrees(theta, 0.0)],
        dark_readings: 10,
        beam_scans: 1,
        ..Campaign::default()
    }
}

fn sample(model: &dyn Bsdf, it: &Instrument, campaign: &Campaign) -> Scan {
    let records = simulate(model, it, campaign).unwrap();
    records.into_iter().find(|r| r.kind == ScanKind::Sample).unwrap()
}

fn brightest(scan: &Scan) -> Direction {
    let j = (0..scan.len())
        .max_by(|&a, &b| scan.value[a].total_cmp(&scan.value[b]))
        .unwrap();
    scan.direction(j)
}

#[test]
fn an_overfilled_sample_returns_the_share_of_the_spot_that_meets_it() {
    let model = lambert(0.8);
    let mut it = silent();
    let whole = sample(&model, &it, &at(60.0));
    it.holder.outline = Outline::Rectangle {
        width: 0.01,
        height: 0.1,
    };
    let refused = simulate(&model, &it, &at(60.0)).unwrap_err().to_string();
    assert!(refused.contains("overfill = true"), "{refused}");
    it.holder.overfill = true;
    let part = sample(&model, &it, &at(60.0));
    // A spot of 10 by 20 mm, of which a strip of 10 mm across the long axis is left: of a disk the part |x| < R/2.
    let expected = 2.0 / std::f64::consts::PI * ((0.5_f64).asin() + 0.5 * 0.75_f64.sqrt());
    for (a, b) in part.value.iter().zip(&whole.value).step_by(97) {
        assert!((a / b / expected - 1.0).abs() < 2e-3, "{} {expected}", a / b);
    }
}

#[test]
fn a_tilted_sample_mirrors_by_twice_its_tilt() {
    let mut it = silent();
    it.path.patch = Some(Patch::default());
    it.detector.shadow = 0.0;
    it.holder.tilt = [0.0, 1.0_f64.to_radians()];
    let peak = brightest(&sample(&gloss(0.03), &it, &at(0.0)));
    // Turned about y: the normal goes towards +x.
    assert!(peak.angle_to(Direction::from_degrees(2.0, 0.0)) < 0.2_f64.to_radians());
}

#[test]
fn a_beam_focused_on_the_sample_is_wider_on_the_sphere_by_the_spot() {
    let rms = |focus| {
        let mut it = silent();
        it.beam.focus = focus;
        it.beam.profile = BeamProfile::TopHat { radius: 0.002 };
        let records = simulate(&lambert(0.5), &it, &at(0.0)).unwrap();
        let beam = records.iter().find(|r| r.kind == ScanKind::Beam).unwrap();
        let (mut sum, mut moment) = (0.0, 0.0);
        for j in 0..beam.len() {
            sum += beam.value[j];
            moment += beam.value[j] * beam.direction(j).angle_to(Direction::NORMAL.through()).powi(2);
        }
        moment / sum
    };
    // Second moments of disks, r^2 / 2, add up: beam .002, aperture, spot 5 mm over 1020 mm.
    let aperture = Detector::default().aperture;
    let narrow = 0.5 * (0.002_f64.powi(2) + aperture * aperture);
    let wide = narrow + 0.5 * (0.005_f64 / 1.02).powi(2);
    assert!((rms(Focus::Detector) / narrow - 1.0).abs() < 0.01);
    assert!((rms(Focus::Sample) / wide - 1.0).abs() < 0.01);
}

#[test]
fn drift_of_the_lamp_shows_in_the_readings_and_not_in_the_dark() {
    let model = lambert(0.8);
    let mut it = silent();
    it.detector.dark_level = 3.0;
    let steady = sample(&model, &it, &at(30.0));
    it.lamp.drift = 0.1;
    let drifting = sample(&model, &it, &at(30.0));
    for j in (0..steady.len()).step_by(501) {
        let expected = 1.0 + 0.1 * steady.time.as_ref().unwrap()[j] / 3600.0;
        let found = (drifting.value[j] - 3.0) / (steady.value[j] - 3.0);
        assert!((found - expected).abs() < 1e-9, "{found} {expected}");
    }
}

#[test]
fn gain_ranges_set_noise_error_and_saturation_by_level() {
    let range = |full_scale, noise_readout, gain_error| GainRange {
        full_scale,
        noise_readout,
        gain_error,
    };
    let model = lambert(0.8);
    let mut it = silent();
    it.detector.ranges = vec![
        range(100.0, 0.0, 0.0),
        range(200.0, 0.0, 0.01),
        range(240.0, 0.0, 0.0),
    ];
    let plain = sample(&model, &silent(), &at(10.0));
    let ranged = sample(&model, &it, &at(10.0));
    let mut seen = [0; 3];
    for (v, w) in plain.value.iter().zip(&ranged.value) {
        let (k, expected) = match *v {
            v if v <= 95.0 => (0, v),
            v if v <= 190.0 => (1, 1.01 * v),
            v => (2, v.min(240.0)),
        };
        seen[k] += 1;
        assert!((w - expected).abs() < 1e-9, "{v} {w}");
    }
    assert!(seen.iter().all(|n| *n > 100), "{seen:?}");
}

#[test]
fn a_converter_rounds_to_its_step() {
    let mut it = silent();
    it.detector.saturation = 256.0;
    it.detector.bits = 10;
    let scan = sample(&lambert(0.8), &it, &at(10.0));
    assert!(scan.value.iter().all(|v| (v / 0.25).fract() == 0.0));
}

#[test]
fn shot_noise_grows_as_the_root_of_the_signal() {
    let model = lambert(0.8);
    let mut it = silent();
    let still = sample(&model, &it, &at(10.0));
    it.detector.noise_shot = 0.01;
    let noisy = sample(&model, &it, &at(10.0));
    let z: Vec<f64> = noisy
        .value
        .iter()
        .zip(&still.value)
        .map(|(a, b)| (a - b) / (0.01 * b).sqrt())
        .collect();
    let n = z.len() as f64;
    let variance = z.iter().map(|z| z * z).sum::<f64>() / n;
    assert!(
        (variance - 1.0).abs() < 5.0 * (2.0 / n).sqrt() + 0.01,
        "{variance}"
    );
}

#[test]
fn a_moving_detector_smears_a_peak_by_the_way_it_goes() {
    // A line through the mirror direction with 1 degree between readings, during all of which it moves.
    let mut it = silent();
    it.path.planes = vec![std::f64::consts::PI];
    it.path.pitch_along = 1.0_f64.to_radians();
    let still = sample(&gloss(0.02), &it, &at(30.0));
    it.detector.integration = 1.0;
    let moving = sample(&gloss(0.02), &it, &at(30.0));
    let sum = |s: &Scan| s.value.iter().sum::<f64>();
    let peak = |s: &Scan| s.value.iter().copied().fold(0.0, f64::max);
    // Lobe of 1/e half width 2.29 degrees: the box of one degree takes (1/24) * 2 * 1 / 2.29^2 of the peak, 1.6 %.
    assert!((sum(&moving) / sum(&still) - 1.0).abs() < 2e-3);
    assert!(peak(&moving) < 0.995 * peak(&still) && peak(&moving) > 0.97 * peak(&still));
}

#[test]
fn a_slow_detector_takes_its_time() {
    let mut it = silent();
    it.detector.rate = 1000.0;
    it.detector.speed = Some(10.0_f64.to_radians());
    let scan = sample(&lambert(0.5), &it, &at(0.0));
    let time = scan.time.as_ref().unwrap();
    for j in 1..scan.len() {
        let way = scan.direction(j - 1).angle_to(scan.direction(j));
        let took = time[j] - time[j - 1];
        assert!(
            (took - (way / 10.0_f64.to_radians()).max(1e-3)).abs() < 3e-6,
            "{took}"
        );
    }
}

#[test]
fn outputs_mix_the_channels_of_the_model_and_carry_their_power() {
    let spectrum = Spectrum::new("rho", &[(Channel::Red, 0.2), (Channel::Green, 0.6)]).unwrap();
    let model = Sum::new(vec![Box::new(Lambert::reflection(&spectrum).unwrap())]).unwrap();
    let mut it = silent();
    let output = |channel, power, weights| Output {
        channel,
        power,
        weights,
    };
    it.detector.outputs = vec![
        output(Channel::Photopic, 1.0, vec![0.25, 0.75]),
        output(Channel::Wavelength(900.0), 3.0, vec![1.0, 0.0]),
    ];
    let records = simulate(&model, &it, &at(0.0)).unwrap();
    let of = |kind, channel| {
        records
            .iter()
            .find(|r| r.kind == kind && r.channel == channel)
            .unwrap()
    };
    let ratio =
        |kind, j: usize| of(kind, Channel::Wavelength(900.0)).value[j] / of(kind, Channel::Photopic).value[j];
    assert!((ratio(ScanKind::Sample, 100) - 3.0 * 0.2 / 0.5).abs() < 1e-12);
    let beam = of(ScanKind::Beam, Channel::Photopic);
    let top = (0..beam.len())
        .max_by(|&a, &b| beam.value[a].total_cmp(&beam.value[b]))
        .unwrap();
    assert!((ratio(ScanKind::Beam, top) - 3.0).abs() < 1e-12);
    it.detector.outputs[0].weights.pop();
    let refused = simulate(&model, &it, &at(0.0)).unwrap_err().to_string();
    assert!(refused.contains("weights of a channel"), "{refused}");
}

#[test]
fn a_fast_scan_finds_a_peak_nobody_told_of_and_reads_it_densely() {
    // A mirror lobe, read without the patch that would know of it.
    let mut it = silent();
    it.detector.noise_readout = 0.05;
    it.path.prescan = Some(Prescan {
        pitch: 4.0_f64.to_radians(),
        threshold: 3.0,
        count: 2,
        patch: Patch {
            radius: 5.0_f64.to_radians(),
            ..Patch::default()
        },
    });
    let scan = sample(&gloss(0.05), &it, &at(40.0));
    let mirror = Direction::from_degrees(40.0, 180.0);
    let near = (0..scan.len()).filter(|&j| scan.direction(j).angle_to(mirror) < 2.0_f64.to_radians());
    assert!(near.count() > 200);
    let flat = sample(&lambert(0.5), &it, &at(40.0));
    assert!(flat.len() + 200 < scan.len());
}

#[test]
fn regions_planes_and_tables_are_read_where_they_are_stated() {
    let mut it = silent();
    it.path.planes = vec![0.0, 1.0];
    let wi = Direction::from_degrees(30.0, 20.0);
    let mut rng = <rand_pcg::Pcg64 as rand::SeedableRng>::seed_from_u64(1);
    let mut planes = |path: &DetectorPath| path.directions(wi, Component::Reflection, 0.0, &[], &mut rng);
    let read = planes(&it.path);
    assert!(
        read.iter()
            .all(|d| (d.phi() - wi.phi()).abs() < 1e-9 || (d.phi() - wi.phi() - 1.0).abs() < 1e-9)
    );
    it.path.regions = vec![Region {
        around: Around::At(Angles::from_degrees(50.0, 200.0)),
        patch: Patch {
            radius: 0.05,
            ..Patch::default()
        },
    }];
    let more = planes(&it.path);
    let inside = more
        .iter()
        .filter(|d| d.angle_to(Direction::from_degrees(50.0, 200.0)) < 0.06)
        .count();
    assert_eq!(more.len(), read.len() + inside);
    let line = vec![
        Direction::from_degrees(10.0, 3.0),
        Direction::from_degrees(120.0, 3.0),
    ];
    it.path.table = Some(PathTable {
        lines: vec![(Angles::from_degrees(30.0, 20.0), line.clone())],
    });
    assert_eq!(planes(&it.path), line[..1]);
    let refused = simulate(&lambert(0.5), &it, &at(40.0)).unwrap_err().to_string();
    assert!(refused.contains("incidences of the path's table"), "{refused}");
}

#[test]
fn a_detector_inside_the_holder_is_refused() {
    let mut it = silent();
    it.holder.radius = 1.1;
    let refused = simulate(&lambert(0.5), &it, &at(40.0)).unwrap_err().to_string();
    assert!(refused.contains("inside the sample holder"), "{refused}");
}
