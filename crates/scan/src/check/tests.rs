//! Every check with data that pass and data that do not.

use std::f64::consts::PI;

use gonio_bsdf::Quantity;
use gonio_geom::{Direction, Side};

use super::{CheckOptions, check, repeatability};
use crate::testing::{Noise, spiral_scan};
use crate::{Level, Measurement, NoiseModel, NoiseOrigin, ProcessOptions, Scan, Verdict, process};

type Model = fn(Direction, Direction) -> f64;

/// A broad reciprocal lobe on a diffuse base, isotropic: a function of the half vector only, and no more than
/// a third of the light.
fn glossy(wi: Direction, ws: Direction) -> f64 {
    let h = Direction::new(wi.vec() + ws.vec()).unwrap_or(Direction::NORMAL);
    0.2 / PI + 0.15 * (-(h.theta() / 0.35).powi(2)).exp()
}

fn lambert(_: Direction, _: Direction) -> f64 {
    0.5 / PI
}

const RELATIVE: f64 = 0.003;

fn scans(model: Model, incidences: &[(f64, f64)], n: usize, seed: u64) -> Vec<Scan> {
    let mut noise = Noise::new(seed);
    incidences
        .iter()
        .map(|&(t, p)| {
            let wi = Direction::from_degrees(t, p);
            let mut s = spiral_scan(t, p, n, Side::Front, |ws| {
                model(wi, ws) * (1.0 + RELATIVE * noise.normal())
            });
            s.quantity = Quantity::Bsdf;
            s
        })
        .collect()
}

fn options() -> ProcessOptions {
    ProcessOptions {
        noise: Some(NoiseModel {
            readout: 1e-6,
            relative: RELATIVE,
            origin: NoiseOrigin::Stated,
        }),
        ..ProcessOptions::default()
    }
}

fn measured(scans: &[Scan]) -> Measurement {
    process(scans, &[], &[], &options()).unwrap()
}

fn measurement(model: Model, incidences: &[(f64, f64)]) -> Measurement {
    measured(&scans(model, incidences, 2500, 1))
}

fn verdict(m: &Measurement, id: &str) -> Verdict {
    let all = check(m, &CheckOptions::default());
    all.into_iter().find(|v| v.id == id).unwrap()
}

const INCIDENCES: [(f64, f64); 4] = [(0.0, 0.0), (20.0, 0.0), (40.0, 0.0), (60.0, 0.0)];

#[test]
fn a_sound_measurement_passes_every_check() {
    let mut m = measurement(glossy, &INCIDENCES);
    m.signature_fwhm = Some(0.01);
    for v in check(&m, &CheckOptions::default()) {
        let expected = if v.id == "calibration_uncertainty" {
            Level::Info
        } else {
            Level::Pass
        };
        assert_eq!(v.level, expected, "{}: {}", v.id, v.sentence);
    }
}

#[test]
fn a_scan_filed_under_a_second_angle_is_found() {
    let mut all = scans(glossy, &INCIDENCES, 500, 1);
    all[3] = Scan {
        incidence: all[3].incidence,
        ..all[2].clone()
    };
    let v = verdict(&measured(&all), "exact_copies");
    assert_eq!((v.level, v.value), (Level::Fail, Some(1.0)));
    assert!(v.sentence.contains("40.00") && v.sentence.contains("60.00"));
}

#[test]
fn an_ideal_diffuser_without_noise_is_no_copy_of_itself_and_one_with_noise_is() {
    let copies = |scan: Scan| {
        let all: Vec<Scan> = INCIDENCES
            .iter()
            .map(|&(t, p)| Scan {
                incidence: gonio_geom::Angles::from_degrees(t, p),
                ..scan.clone()
            })
            .collect();
        verdict(&measured(&all), "exact_copies")
    };
    let mut flat = spiral_scan(0.0, 0.0, 500, Side::Front, |_| 0.25);
    flat.quantity = Quantity::Bsdf;
    let v = copies(flat.clone());
    assert_eq!(v.level, Level::Warn, "{}", v.sentence);
    assert!(v.sentence.contains("ideal diffuser"), "{}", v.sentence);
    let mut noise = Noise::new(3);
    flat.value
        .iter_mut()
        .for_each(|f| *f *= 1.0 + 0.003 * noise.normal());
    assert_eq!(copies(flat).level, Level::Fail);
    let mut rings = crate::testing::path_scan(10.0, 5.0, |d| d.cos_theta().powi(2));
    rings.quantity = Quantity::Bsdf;
    assert_eq!(copies(rings).level, Level::Warn);
}

#[test]
fn a_bsdf_that_returns_more_than_arrived_fails_energy_and_one_within_its_uncertainty_warns() {
    let m = measurement(|_, _| 1.1 / PI, &INCIDENCES);
    assert_eq!(verdict(&m, "energy").level, Level::Fail);
    let common = ProcessOptions {
        u_calibration: 0.08,
        ..options()
    };
    let m = process(&scans(|_, _| 1.1 / PI, &INCIDENCES, 2500, 1), &[], &[], &common).unwrap();
    assert_eq!(verdict(&m, "energy").level, Level::Warn);
}

#[test]
fn a_model_that_is_not_reciprocal_fails_reciprocity() {
    let m = measurement(
        |wi, ws| 0.3 / PI * (1.0 + wi.theta() - 0.5 * ws.theta()),
        &INCIDENCES,
    );
    let v = verdict(&m, "reciprocity");
    assert!(v.level >= Level::Warn, "{}", v.sentence);
    let v = verdict(&measurement(glossy, &INCIDENCES), "reciprocity");
    assert!(v.value.unwrap() < 1.5, "{}", v.sentence);
}

/// Half-vector lobe of 6 degrees without a diffuse base: between incidences there are only its flanks.
fn satin(wi: Direction, ws: Direction) -> f64 {
    let h = Direction::new(wi.vec() + ws.vec()).unwrap_or(Direction::NORMAL);
    12.0 * (-(h.theta() / 0.1).powi(2)).exp()
}

#[test]
fn the_steep_flanks_of_a_narrow_lobe_are_not_taken_for_a_breach_of_reciprocity() {
    for seed in 1..6 {
        let m = measured(&scans(satin, &INCIDENCES, 10_000, seed));
        let v = verdict(&m, "reciprocity");
        assert_eq!(v.level, Level::Pass, "{}", v.sentence);
        assert!(v.sentence.contains("too steep"), "{}", v.sentence);
    }
}

#[test]
fn a_narrow_lobe_that_favours_one_direction_of_the_light_is_found() {
    fn one_way(wi: Direction, ws: Direction) -> f64 {
        satin(wi, ws) * (0.3 * (wi.theta() - ws.theta())).exp()
    }
    for seed in 1..4 {
        let m = measured(&scans(one_way, &INCIDENCES, 10_000, seed));
        let v = verdict(&m, "reciprocity");
        assert!(v.level >= Level::Warn, "{}", v.sentence);
        // Neighbouring incidences are 0.35 rad apart: exp(2 * 0.3 * 0.35) = 1.23 between the two directions.
        assert!((v.value.unwrap() - 21.0).abs() < 4.0, "{}", v.sentence);
    }
}

#[test]
fn anisotropic_samples_are_compared_at_the_exchanged_directions_only() {
    let several = [(30.0, 0.0), (30.0, 90.0), (60.0, 0.0), (60.0, 90.0)];
    let v = verdict(&measurement(glossy, &several), "reciprocity");
    assert!(v.sentence.starts_with("6 exchanged pairs"), "{}", v.sentence);
    assert_eq!(v.level, Level::Pass);
}

/// `scan` without the readings that `keep` refuses, by polar angle and azimuth in degrees.
fn cut(mut scan: Scan, keep: impl Fn(f64, f64) -> bool) -> Scan {
    let kept: Vec<usize> = (0..scan.len())
        .filter(|&j| keep(scan.theta_s[j].to_degrees(), scan.phi_s[j].to_degrees()))
        .collect();
    for column in [&mut scan.theta_s, &mut scan.phi_s, &mut scan.value] {
        *column = kept.iter().map(|&j| column[j]).collect();
    }
    scan
}

#[test]
fn the_coverage_is_the_share_of_the_integral_that_was_extrapolated() {
    let of = |keep: &dyn Fn(f64, f64) -> bool| {
        let scan = scans(lambert, &[(0.0, 0.0)], 2500, 1).remove(0);
        verdict(&measured(&[cut(scan, keep)]), "coverage")
    };
    // A Lambertian lobe holds cos^2 of its light beyond a polar angle; the cells of the outermost readings reach up
    // to 5 degrees further.
    for (stop, level) in [(50.0_f64, Level::Fail), (75.0, Level::Warn)] {
        let v = of(&|theta, _| theta < stop);
        assert_eq!(v.level, level, "{}", v.sentence);
        let beyond = |theta: f64| 100.0 * theta.to_radians().cos().powi(2);
        let range = beyond(stop + 5.0)..beyond(stop) + 0.5;
        assert!(range.contains(&v.value.unwrap()), "{}", v.sentence);
    }
    // Fewer readings never raise the score.
    let sparse = of(&|theta, phi| theta < 75.0 && (phi as u32).is_multiple_of(2));
    assert!(sparse.level >= Level::Warn, "{}", sparse.sentence);
}

#[test]
fn the_grazing_gap_is_that_of_the_azimuth_scanned_least_far() {
    let scan = scans(lambert, &[(0.0, 0.0)], 10_000, 1).remove(0);
    let part = cut(scan, |theta, phi| theta < 64.0 || !(40.0..60.0).contains(&phi));
    let v = verdict(&measured(&[part]), "coverage");
    let found: f64 = v
        .sentence
        .split(" deg above")
        .next()
        .and_then(|s| s.rsplit(' ').next())
        .and_then(|s| s.parse().ok())
        .unwrap();
    assert!((found - 26.0).abs() <= 2.0, "{}", v.sentence);
}

#[test]
fn readings_in_one_plane_have_no_integral_and_say_so() {
    let scan = scans(lambert, &[(0.0, 0.0)], 10_000, 1).remove(0);
    let mut plane = cut(scan, |_, phi| phi < 3.0);
    plane.phi_s.fill(0.0);
    let v = verdict(&measured(&[plane]), "coverage");
    assert!(v.level >= Level::Warn, "{}", v.sentence);
    assert!(
        v.sentence.contains("too little of the hemisphere"),
        "{}",
        v.sentence
    );
}

#[test]
fn a_signal_at_the_noise_floor_fails_the_dynamic_range() {
    let noisy = ProcessOptions {
        noise: Some(NoiseModel {
            readout: 1.0,
            relative: 0.0,
            origin: NoiseOrigin::Stated,
        }),
        ..ProcessOptions::default()
    };
    let m = process(&scans(lambert, &[(0.0, 0.0)], 500, 1), &[], &[], &noisy).unwrap();
    assert_eq!(verdict(&m, "dynamic_range").level, Level::Fail);
}

#[test]
fn readings_of_nothing_fail_and_no_share_of_nothing_is_stated() {
    let m = measurement(|_, _| 0.0, &[(10.0, 0.0), (30.0, 0.0)]);
    let found = verdict(&m, "negative_readings");
    assert_eq!(found.level, Level::Fail, "{}", found.sentence);
    let found = verdict(&m, "coverage");
    assert!(!found.sentence.contains("NaN"), "{}", found.sentence);
}

#[test]
fn a_reflectance_below_zero_fails() {
    let m = measurement(|_, _| -0.5 / PI, &[(10.0, 0.0), (30.0, 0.0)]);
    for id in ["energy", "negative_readings", "dynamic_range"] {
        let found = verdict(&m, id);
        assert_eq!(found.level, Level::Fail, "{id}: {}", found.sentence);
    }
}

#[test]
fn mostly_negative_readings_fail() {
    let m = measurement(|_, ws| if ws.phi() < 5.0 { -1e-4 } else { 1e-4 }, &[(0.0, 0.0)]);
    let v = verdict(&m, "negative_readings");
    assert_eq!(v.level, Level::Fail, "{}", v.sentence);
    assert!((v.value.unwrap() - 100.0 * 5.0 / (2.0 * PI)).abs() < 1.0);
}

/// Quadrilateral and reciprocal.
fn brushed(wi: Direction, ws: Direction) -> f64 {
    let h = Direction::new(wi.vec() + ws.vec())
        .unwrap_or(Direction::NORMAL)
        .vec();
    0.1 / PI + 0.2 * (-(h.x / 0.5).powi(2) - (h.y / 0.2).powi(2)).exp()
}

#[test]
fn a_brushed_sample_at_one_azimuth_is_no_breach_of_reciprocity() {
    /// Brushed askew to the plane of incidence, as no isotropic sample is.
    fn askew(wi: Direction, ws: Direction) -> f64 {
        let turn = |d: Direction| Direction::from_spherical(d.theta(), d.phi() + 0.5);
        brushed(turn(wi), turn(ws))
    }
    let one = [(30.0, 0.0), (60.0, 0.0)];
    let m = measurement(askew, &one);
    let v = verdict(&m, "reciprocity");
    assert!(v.value.unwrap() > 5.0, "{}", v.sentence);
    assert_eq!(v.level, Level::Info, "{}", v.sentence);
    assert!(v.sentence.contains("--anisotropic"), "{}", v.sentence);
    let stated = |isotropic| {
        let options = CheckOptions {
            isotropic: Some(isotropic),
            ..CheckOptions::default()
        };
        let all = check(&m, &options);
        all.into_iter().find(|v| v.id == "reciprocity").unwrap()
    };
    assert_eq!(stated(false).level, Level::Pass, "{}", stated(false).sentence);
    assert!(stated(true).level >= Level::Warn, "{}", stated(true).sentence);
    assert!(verdict(&m, "quantity").level <= Level::Pass);
}

#[test]
fn incidences_that_a_corrected_tilt_moved_off_their_plane_are_still_compared_as_isotropic() {
    let moved = [(20.0, 3.0), (40.0, 1.0), (60.0, 0.0)];
    let v = verdict(&measurement(glossy, &moved), "reciprocity");
    assert!(v.sentence.contains("taken as isotropic"), "{}", v.sentence);
    assert_eq!(v.level, Level::Pass, "{}", v.sentence);
    // Normal incidence between two azimuths does not join them.
    let two = [(40.0, 0.0), (0.0, 0.0), (40.0, 90.0)];
    let v = verdict(&measurement(glossy, &two), "reciprocity");
    assert!(!v.sentence.contains("taken as isotropic"), "{}", v.sentence);
}

#[test]
fn too_few_exchanged_directions_say_nothing_of_the_quantity() {
    let v = verdict(&measurement(glossy, &[(30.0, 0.0)]), "quantity");
    assert_eq!(v.level, Level::Info, "{}", v.sentence);
}

#[test]
fn a_symmetry_that_the_data_cannot_break_is_not_found() {
    let mut plane = cut(scans(glossy, &[(30.0, 0.0)], 10_000, 1).remove(0), |_, phi| {
        phi < 3.0
    });
    plane.phi_s.fill(0.0);
    let v = verdict(&measured(&[plane]), "symmetry");
    assert_eq!((v.level, v.value), (Level::Info, None), "{}", v.sentence);
    // The azimuth written for normal incidence is no second azimuth.
    for normal in [0.0, 90.0] {
        let v = verdict(&measurement(glossy, &[(0.0, normal), (40.0, 0.0)]), "symmetry");
        assert!(v.sentence.contains("one azimuth"), "{}", v.sentence);
    }
}

#[test]
fn after_the_alignment_it_is_not_advised_again() {
    fn twisted(_: Direction, ws: Direction) -> f64 {
        0.3 / PI * (1.0 + 0.5 * ws.phi().sin() * ws.theta().sin())
    }
    let m = measurement(twisted, &[(40.0, 0.0)]);
    let advised = |aligned| {
        let options = CheckOptions {
            aligned,
            ..CheckOptions::default()
        };
        let all = check(&m, &options);
        all.into_iter().find(|v| v.id == "symmetry").unwrap().sentence
    };
    assert!(advised(false).contains("--align"), "{}", advised(false));
    assert!(!advised(true).contains("--align"), "{}", advised(true));
}

#[test]
fn symmetries_are_told_apart() {
    fn twisted(wi: Direction, ws: Direction) -> f64 {
        let turn = ws.phi() - wi.phi();
        0.3 / PI * (1.0 + 0.5 * turn.sin() * ws.theta().sin() * wi.theta().sin())
    }
    let all = [(0.0, 0.0), (40.0, 0.0), (40.0, 90.0), (40.0, 180.0)];
    let v = verdict(&measurement(glossy, &all), "symmetry");
    assert!(v.sentence.contains("isotropic: rotation"), "{}", v.sentence);
    let v = verdict(&measurement(brushed, &all), "symmetry");
    assert!(v.sentence.contains("quadrilateral"), "{}", v.sentence);
    let v = verdict(&measurement(twisted, &all[1..2]), "symmetry");
    assert_eq!(v.level, Level::Warn, "{}", v.sentence);
}

#[test]
fn a_reflectance_factor_read_as_bsdf_is_named() {
    let v = verdict(
        &measurement(|wi, ws| PI * lambert(wi, ws), &INCIDENCES),
        "quantity",
    );
    assert_eq!(v.level, Level::Fail);
    assert!(v.sentence.contains("reflectance factor"), "{}", v.sentence);
}

#[test]
fn a_surplus_or_missing_cosine_is_named_whatever_the_material() {
    let v = verdict(
        &measurement(|wi, ws| glossy(wi, ws) * ws.cos_theta(), &INCIDENCES),
        "quantity",
    );
    assert_eq!(v.level, Level::Fail);
    assert!(v.sentence.contains("read them as dsf"), "{}", v.sentence);
    assert!((v.value.unwrap() - 1.0).abs() < 0.1);
    let v = verdict(
        &measurement(
            |wi, ws| 0.4 * glossy(wi, ws) / ws.cos_theta().max(0.02),
            &INCIDENCES,
        ),
        "quantity",
    );
    assert!(v.sentence.contains("read them as bsdf"), "{}", v.sentence);
}

#[test]
fn a_lobe_narrower_than_the_beam_cannot_be() {
    let mut m = measurement(glossy, &INCIDENCES);
    m.signature_fwhm = Some(2.0);
    assert_eq!(verdict(&m, "resolution").level, Level::Fail);
    m.signature_fwhm = Some(0.8);
    assert_eq!(verdict(&m, "resolution").level, Level::Warn);
    m.signature_fwhm = None;
    assert_eq!(verdict(&m, "resolution").level, Level::Info);
}

#[test]
fn repeated_measurements_agree_within_their_noise_and_a_brighter_one_does_not() {
    let first = measured(&scans(glossy, &INCIDENCES, 2500, 1));
    let turned: Vec<(f64, f64)> = INCIDENCES.iter().map(|i| (i.0, 90.0)).collect();
    let second = measured(&scans(glossy, &turned, 2500, 2));
    let v = repeatability(&[&first, &second]).unwrap();
    assert_eq!(v.level, Level::Pass, "{}", v.sentence);
    let third = measured(&scans(|wi, ws| 1.1 * glossy(wi, ws), &INCIDENCES, 2500, 3));
    let v = repeatability(&[&first, &second, &third]).unwrap();
    assert_eq!(v.level, Level::Warn);
    assert!((v.value.unwrap() - 9.5).abs() < 0.5, "{}", v.sentence);
    // 1.1 to 1: 0.1 over their mean of 1.05.
    assert!(v.sentence.contains("integral by up to 9.5 %"), "{}", v.sentence);
    assert!(repeatability(&[&first]).is_err());
    let other = measured(&scans(glossy, &[(75.0, 0.0)], 500, 1));
    assert!(repeatability(&[&first, &other]).is_err());
}

#[test]
fn noise_about_zero_is_told_from_a_blank_that_takes_too_much() {
    let dark_side = |offset: f64| {
        let mut noise = Noise::new(4);
        let mut scan = spiral_scan(20.0, 0.0, 2500, Side::Front, |ws| {
            satin(Direction::from_degrees(20.0, 0.0), ws) - offset + 1e-3 * noise.normal()
        });
        scan.quantity = Quantity::Bsdf;
        let stated = ProcessOptions {
            noise: Some(NoiseModel {
                readout: 1e-3,
                relative: 0.0,
                origin: NoiseOrigin::Stated,
            }),
            ..ProcessOptions::default()
        };
        verdict(&process(&[scan], &[], &[], &stated).unwrap(), "negative_readings")
    };
    let v = dark_side(0.0);
    assert_eq!(v.level, Level::Pass, "{}", v.sentence);
    assert!(
        v.value.unwrap() > 30.0 && v.sentence.contains("Noise about zero"),
        "{}",
        v.sentence
    );
    let v = dark_side(4e-3);
    assert_eq!(v.level, Level::Fail, "{}", v.sentence);
}
