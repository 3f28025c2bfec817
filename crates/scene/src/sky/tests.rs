use super::cie::{CieSky, Kind};
use super::general::GeneralSky;
use super::perez::{Given, Output, PerezSky, Weather};
use super::*;
use crate::cal::{Point, Program, shipped};
use crate::generate::{gendaylit, gensky};

/// Unit directions of equal solid angle over the upper hemisphere.
fn upper() -> impl Iterator<Item = [f64; 3]> {
    (0..200_000).map(|k| {
        let z = (f64::from(k) + 0.5) / 200_000.0;
        let (s, c) = (f64::from(k) * 2.399_963_229_728_653).sin_cos();
        let r = (1.0 - z * z).sqrt();
        [r * c, r * s, z]
    })
}

/// Irradiance of level ground from the upper hemisphere.
fn irradiance(radiance: impl Fn([f64; 3]) -> f64) -> f64 {
    upper().map(|d| radiance(d) * d[2]).sum::<f64>() * std::f64::consts::TAU / 200_000.0
}

/// The sky of a generator's text, by the numbers of its pattern.
fn sky_of(numbers: &[f64]) -> Box<dyn Fn([f64; 3]) -> f64> {
    if let Some(sky) = PerezSky::of_pattern(numbers) {
        return Box::new(move |d| sky.radiance(d));
    }
    let sky = CieSky::of_pattern(numbers).unwrap();
    Box::new(move |d| sky.radiance(d))
}

#[test]
fn radiances_of_directions_are_those_of_rtrace_within_a_thousandth() {
    for line in include_str!("../../tests/data/radiances.txt").lines() {
        let parts: Vec<_> = line.split(" | ").collect();
        let words: Vec<_> = parts[0].split(' ').collect();
        let text = match words[0] {
            "gensky" => gensky(&words[1..]).unwrap(),
            _ => gendaylit(&words[1..]).unwrap(),
        };
        let numbers: Vec<f64> = text
            .lines()
            .last()
            .unwrap()
            .split_whitespace()
            .skip(1)
            .map(|x| x.parse().unwrap())
            .collect();
        let d: Vec<f64> = parts[1].split(' ').map(|x| x.parse().unwrap()).collect();
        let direction = [d[0], d[1], d[2]];
        let expected: f64 = parts[2].parse().unwrap();
        let (file, name) = if words[0] == "gensky" {
            ("skybright.cal", "skybr")
        } else {
            ("perezlum.cal", "skybright")
        };
        let program = Program::parse(shipped(file).unwrap(), file).unwrap();
        let at = Point {
            direction,
            ..Point::default()
        };
        let by_text = program.expression(name).unwrap().evaluate(&at, &numbers).unwrap();
        for found in [sky_of(&numbers)(direction), by_text] {
            assert!((found / expected - 1.0).abs() < 1e-3, "{line}: {found}");
        }
        assert!(
            (sky_of(&numbers)(direction) / by_text - 1.0).abs() < 1e-6,
            "{line}"
        );
    }
}

#[test]
fn a_perez_sky_gives_the_diffuse_irradiance_that_it_was_made_of() {
    // The 145 directions that normalise it, and a horizon smoothed to the ground, are not the integral: 3 %.
    for (altitude, direct, diffuse) in [(40.0f64, 600.0, 150.0), (20.0, 100.0, 120.0), (60.0, 10.0, 200.0)] {
        let weather = Weather {
            altitude: altitude.to_radians(),
            azimuth: 0.3,
            day: 172.0,
            given: Given::Irradiance(direct, diffuse),
            output: Output::Solar,
            water: 2.0,
            sun: true,
            ground_reflectance: 0.2,
        };
        let sky = PerezSky::new(&weather).unwrap();
        let found = irradiance(|d| sky.radiance(d));
        assert!((found / diffuse - 1.0).abs() < 0.03, "{found} of {diffuse}");
        let disc = std::f64::consts::TAU * (1.0 - (sky.sun.angle / 2.0).cos());
        assert!((sky.sun.radiance * disc / direct - 1.0).abs() < 1e-9);
    }
}

#[test]
fn the_general_sky_holds_the_old_skies() {
    let sun = [0.6, 0.0, 0.8];
    let zenith = [0.0, 0.0, 1.0];
    for number in 1..=15 {
        let sky = GeneralSky::new(number, sun, 7.0).unwrap();
        assert!((sky.radiance(zenith) - 7.0).abs() < 1e-12);
        assert!(upper().all(|d| sky.radiance(d) > 0.0), "{number}");
    }
    assert!(GeneralSky::new(0, sun, 7.0).is_none() && GeneralSky::new(16, sun, 7.0).is_none());
    let uniform = GeneralSky::new(5, sun, 7.0).unwrap();
    assert!((irradiance(|d| uniform.radiance(d)) / (7.0 * std::f64::consts::PI) - 1.0).abs() < 1e-4);
    // Sky 12 is the clear sky of 1996 with more digits in its constants, and without a ground that shows above the horizon.
    let clear = GeneralSky::new(12, sun, 7.0).unwrap();
    let old = CieSky {
        kind: Kind::Clear,
        sun,
        zenith: 7.0,
        ground: 0.0,
    };
    for d in upper().filter(|d| d[2] > 0.6).step_by(997) {
        assert!((clear.radiance(d) / old.radiance(d) - 1.0).abs() < 2e-3);
    }
}

#[test]
fn an_almanac_knows_the_solstice() {
    // Noon of the sun on 21 June 2024 at Greenwich: 23.44 degrees of declination.
    let site = sun::Site {
        latitude: 51.4779f64.to_radians(),
        longitude: 0.0,
        meridian: 0.0,
    };
    let moment = sun::Moment {
        year: Some(2024),
        month: 6,
        day: 21,
        hour: 12.0,
        solar: true,
    };
    let position = moment.sun(&site);
    assert!((position.altitude.to_degrees() - (90.0 - 51.4779 + 23.436)).abs() < 0.01);
    assert!(position.azimuth.abs() < 1e-12);
}
