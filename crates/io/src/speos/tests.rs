use std::f64::consts::PI;
use std::path::PathBuf;

use gonio_geom::Direction;
use proptest::prelude::*;

use super::*;
use crate::zemax;

fn shared() -> Option<PathBuf> {
    let root = std::env::var_os("GONIO_SHARED_DATA").map_or_else(
        || Path::new(env!("CARGO_MANIFEST_DIR")).join("../../../shared/data"),
        PathBuf::from,
    );
    root.is_dir().then_some(root)
}

/// A Lambertian of 40 % at 400 nm and 80 % at 600 nm; `kind` 1 holds BSDF values, 0 intensities.
fn lambertian(kind: u8) -> String {
    let mut text = format!(
        "{MAGIC}8.0\n0\nmade up\n9\ntwo\nlines\n0 1 0\n1 0\n{kind}\n1\n30.0\n2\n0 40\n20 30\nReflection Spectrum\n2\n400 40\n600 80\n"
    );
    for _ in 0..2 {
        text.push_str("46 5\n\t0 90 180 270 360\n");
        for k in 0..46 {
            let theta = 2.0 * f64::from(k);
            let value = if kind == 1 {
                7.0
            } else {
                7.0 * theta.to_radians().cos()
            };
            text.push_str(&format!("{theta}{}\n", format!("\t{value}").repeat(5)));
        }
    }
    text.push_str("End of file\n");
    text
}

fn parsed(content: &str, options: &ReadOptions) -> Result<Vec<Scan>, IoError> {
    parse(content.as_bytes(), Path::new("a"), options)
}

#[test]
fn the_spectrum_gives_the_tables_their_scale() {
    for (kind, quantity) in [(1, Quantity::Bsdf), (0, Quantity::Dsf)] {
        let scans = parsed(&lambertian(kind), &ReadOptions::default()).unwrap();
        let channels: Vec<Channel> = scans.iter().map(|s| s.channel).collect();
        let [a, b] = [400.0, 600.0].map(Channel::Wavelength);
        assert_eq!(channels, [a, b, a, b]);
        for scan in &scans {
            let rho = if scan.channel == a { 0.4 } else { 0.8 };
            assert_eq!(scan.quantity, quantity);
            // the pole once, then four azimuths a ring
            assert_eq!(scan.len(), 1 + 45 * 4);
            for j in 0..scan.len() {
                let wanted = match quantity {
                    Quantity::Bsdf => rho / PI,
                    _ => rho / PI * scan.theta_s[j].cos(),
                };
                // the trapezoid rule of 2 degrees
                assert!(
                    (scan.value[j] - wanted).abs() < 1e-3 * rho,
                    "{} {wanted}",
                    scan.value[j]
                );
            }
        }
        assert_eq!(scans[0].meta.other["description"], "two\nlines");
        let options = ReadOptions {
            channel: Some(Channel::Wavelength(500.0)),
            ..ReadOptions::default()
        };
        let middle = parsed(&lambertian(kind), &options).unwrap();
        assert!((middle[0].value[0] - 0.6 / PI).abs() < 1e-3);
    }
}

#[test]
fn azimuths_count_from_the_specular_direction_and_turn_with_the_anisotropy_angle() {
    let scan = parsed(&lambertian(1), &ReadOptions::default()).unwrap().remove(2);
    let wi = Direction::from_degrees(40.0, 210.0);
    assert!(scan.incidence.direction().angle_to(wi) < 1e-12);
    let mirror = (0..scan.len()).find(|&j| scan.direction(j).angle_to(wi.mirror()) < 1e-9);
    // ring of 40 degrees, azimuth 0
    assert_eq!(mirror, Some(1 + 19 * 4));
}

#[test]
fn the_file_of_the_imaging_sphere_agrees_with_its_zemax_twin() {
    let Some(root) = shared() else { return };
    let folder = root.join("ansys-formats");
    let stem = "test_13_planesymmetric_brdf";
    let options = ReadOptions {
        channel: Some(Channel::Photopic),
        ..ReadOptions::default()
    };
    let scans = read(
        &folder.join(format!("{stem}_speos_reference.anisotropicbsdf")),
        &options,
    )
    .unwrap();
    let twins = zemax::read(&folder.join(format!("{stem}_zemax.bsdf")), &options).unwrap();
    assert_eq!(scans.len(), 13);
    for (scan, twin) in scans.iter().zip(&twins) {
        // the twin's incidence lies at azimuth 0, this one's at 180
        assert!((scan.incidence.theta - twin.incidence.theta).abs() < 1e-12);
        let mut ratios = Vec::new();
        for j in 0..scan.len() {
            let d = scan.direction(j).rotated(PI);
            let near = (0..twin.len()).find(|&k| twin.direction(k).angle_to(d) < 1e-3);
            ratios.extend(
                near.filter(|&k| twin.value[k] > 0.0)
                    .map(|k| scan.value[j] / twin.value[k]),
            );
        }
        ratios.sort_by(f64::total_cmp);
        // the converter that made the twin scaled each incidence to the total scatter of its line
        let median = ratios[ratios.len() / 2];
        assert!((0.9..1.35).contains(&median), "{:?}: {median}", scan.incidence);
        let same = ratios.iter().filter(|r| (*r / median - 1.0).abs() < 2e-3).count();
        assert!(
            ratios.len() >= 8 && 10 * same >= 8 * ratios.len(),
            "{:?}: {ratios:?}",
            scan.incidence
        );
    }
}

#[test]
fn faults_are_named_with_line_and_field() {
    let good = lambertian(1);
    for (from, to, what) in [
        ("v8.0\n0", "v5.0\n0", "line 1: header: found"),
        ("8.0\n0\n", "8.0\n1\n", "line 2: mode: found 1, a binary file"),
        ("\n1 0\n", "\n0 0\n", "neither reflection nor transmission"),
        ("\n1 0\n", "\n1 2\n", "line 8: transmission: found 2"),
        ("0 40\n", "40 0\n", "line 13: angle of incidence: found 0"),
        ("600 80", "300 80", "line 18: wavelength: found 300"),
        ("46 5\n", "46 0\n", "line 19: number of phi: found 0"),
        ("End of file", "", "a"),
    ] {
        let changed = good.replacen(from, to, 1);
        match parsed(&changed, &ReadOptions::default()) {
            Err(error) => assert!(error.to_string().contains(what), "{from:?}: {error}"),
            Ok(_) => assert_eq!(from, "End of file"),
        }
    }
    let cut = &good[..good.len() / 2];
    let text = parsed(cut, &ReadOptions::default()).unwrap_err().to_string();
    assert!(text.contains("cut short") || text.contains("number"), "{text}");
    let black = parsed(&good.replace("\t7", "\t0"), &ReadOptions::default()).unwrap_err();
    assert!(
        black.to_string().contains("value: found an integral of 0"),
        "{black}"
    );
    let options = ReadOptions {
        channel: Some(Channel::Photopic),
        ..ReadOptions::default()
    };
    let text = parsed(&good, &options).unwrap_err().to_string();
    assert!(
        text.contains("channel: found photopic, allowed a wavelength from 400nm to 600nm"),
        "{text}"
    );
    let options = ReadOptions {
        quantity: Some(Quantity::Dsf),
        ..ReadOptions::default()
    };
    assert!(parsed(&good, &options).is_err());
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(300))]

    #[test]
    fn no_content_panics(
        places in prop::collection::vec((any::<prop::sample::Index>(), any::<u8>()), 0..6),
        cut in any::<prop::sample::Index>(),
    ) {
        let mut bytes = lambertian(1).into_bytes();
        for (place, value) in places {
            let n = bytes.len();
            bytes[place.index(n)] = value;
        }
        let _ = parse(&bytes, Path::new("a"), &ReadOptions::default());
        bytes.truncate(cut.index(bytes.len()));
        let _ = parse(&bytes, Path::new("a"), &ReadOptions::default());
    }
}
