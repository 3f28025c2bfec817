use std::path::{Path, PathBuf};

use gonio_bsdf::analytic::{Sum, family};
use gonio_bsdf::{Bsdf, Channel, Quantity, directional_albedo};
use gonio_geom::{Angles, Component, Direction, Side};
use gonio_scan::Scan;
use proptest::prelude::*;

use super::frame::Frame;
use super::*;
use crate::{IoError, ReadOptions};

fn shared() -> Option<PathBuf> {
    let root = std::env::var_os("GONIO_SHARED_DATA").map_or_else(
        || Path::new(env!("CARGO_MANIFEST_DIR")).join("../../../shared/data"),
        PathBuf::from,
    );
    root.is_dir().then_some(root)
}

fn options() -> ReadOptions {
    ReadOptions {
        channel: Some(Channel::Wavelength(650.0)),
        ..ReadOptions::default()
    }
}

fn parsed(content: &str, options: &ReadOptions) -> Result<Vec<Scan>, IoError> {
    parse(content.as_bytes(), Path::new("a.bsdf"), options)
}

fn file(symmetry: &str, spectrum: &str, scatter: &str, azimuths: &str, parts: &str) -> String {
    let n = azimuths.split_whitespace().count();
    format!(
        "# made up\nSource Measured\nSymmetry {symmetry}\nSpectralContent {spectrum}\nScatterType {scatter}\n\
         SampleRotation 1\n20\nAngleOfIncidence 1\n30\nScatterAzimuth {n}\n{azimuths}\nScatterRadial 2\n0 10\n\n{parts}"
    )
}

const ONE: &str = "Monochrome\nDataBegin\nTIS 0.5\n1 2\n1 3\n1 4\nDataEnd\n";

/// The value of the reading nearest to a direction.
fn near(scan: &Scan, direction: Direction) -> f64 {
    let distance = |j: &usize| scan.direction(*j).angle_to(direction);
    let j = (0..scan.len())
        .min_by(|a, b| distance(a).total_cmp(&distance(b)))
        .unwrap();
    assert!(distance(&j) < 1e-9, "{}", distance(&j));
    scan.value[j]
}

#[test]
fn radial_zero_is_the_mirror_direction_and_azimuth_zero_leads_to_the_normal() {
    let content = file("PlaneSymmetrical", "Monochrome", "BRDF", "0 90 180", ONE);
    let scan = parsed(&content, &options()).unwrap().remove(0);
    assert_eq!(
        (scan.quantity, scan.channel),
        (Quantity::Bsdf, Channel::Wavelength(650.0))
    );
    let wi = Direction::from_degrees(30.0, 20.0);
    assert!(scan.incidence.direction().angle_to(wi) < 1e-12);
    // the pole once, both ends of the plane, and azimuth 90 with its mirror image
    assert_eq!(scan.len(), 5);
    assert_eq!(near(&scan, wi.mirror()), 1.0);
    assert_eq!(near(&scan, Direction::from_degrees(20.0, 200.0)), 2.0);
    assert_eq!(near(&scan, Direction::from_degrees(40.0, 200.0)), 4.0);
    let sides: Vec<f64> = (0..5)
        .filter(|&j| scan.value[j] == 3.0)
        .map(|j| scan.phi_s[j])
        .collect();
    assert!(
        (sides[0] + sides[1] - 2.0 * 200f64.to_radians()).abs() < 1e-9,
        "{sides:?}"
    );
    assert_eq!(scan.meta.other["symmetry"], "PlaneSymmetrical");
    assert_eq!(scan.meta.other["readings_mirrored"], "1");
    assert_eq!(scan.meta.other["tis"], "0.5");
    assert_eq!(scan.meta.other["comments"], "made up");
}

#[test]
fn azimuths_count_counter_clockwise_seen_from_the_front() {
    for component in [Component::Reflection, Component::Transmission] {
        let frame = Frame::new(Angles::from_degrees(30.0, 0.0), component);
        assert!(frame.direction(0.5, 0.2).y > 0.0);
    }
    let content = file("ASymmetrical", "Monochrome", "BRDF", "0 90 360", ONE);
    let scan = parsed(&content.replace("1 4\n", "1 2\n"), &options())
        .unwrap()
        .remove(0);
    // azimuth 360 repeats azimuth 0 with the same values
    assert_eq!(scan.value, [1.0, 2.0, 3.0]);
    let other = parsed(&content, &options()).unwrap().remove(0);
    assert_eq!(other.value, [1.0, 2.0, 3.0, 4.0]);
}

#[test]
fn transmission_counts_from_the_unbent_direction() {
    let content = file("PlaneSymmetrical", "Monochrome", "BTDF", "0 90 180", ONE);
    let scan = parsed(&content, &options()).unwrap().remove(0);
    let wi = Direction::from_degrees(30.0, 20.0);
    assert_eq!(near(&scan, wi.through()), 1.0);
    assert_eq!(near(&scan, Direction::from_degrees(160.0, 200.0)), 2.0);
    assert!((0..scan.len()).all(|j| scan.direction(j).side() == Side::Back));
}

#[test]
fn tristimulus_values_make_four_channels() {
    let parts: String = ["X", "Y", "Z"]
        .iter()
        .map(|n| ONE.replace("Monochrome", &format!("Tristimulus{n}")))
        .collect();
    let content = file("PlaneSymmetrical", "XYZ", "BRDF", "0 90 180", &parts);
    let scans = parsed(&content, &ReadOptions::default()).unwrap();
    let channels: Vec<Channel> = scans.iter().map(|s| s.channel).collect();
    assert_eq!(
        channels,
        [Channel::Photopic, Channel::Red, Channel::Green, Channel::Blue]
    );
    // equal X, Y and Z are equal R, G and B
    for scan in &scans {
        assert!(
            scan.value
                .iter()
                .zip(&scans[0].value)
                .all(|(a, b)| (a - b).abs() < 1e-12)
        );
    }
    assert_eq!(scans[0].meta.other["tis"], "0.5 0.5 0.5");
    let text = parsed(&content, &options()).unwrap_err().to_string();
    assert!(text.contains("channel: found 650nm for a file of XYZ"), "{text}");
}

#[test]
fn faults_are_named_with_line_and_field() {
    let good = file("PlaneSymmetrical", "Monochrome", "BRDF", "0 90 180", ONE);
    for (from, to, what) in [
        ("PlaneSymmetrical", "Round", "line 3: Symmetry: found \"Round\""),
        (
            "SampleRotation 1",
            "SampleRotation 0",
            "line 6: SampleRotation: found 0",
        ),
        (
            "AngleOfIncidence",
            "Incidence",
            "line 8: AngleOfIncidence: found \"Incidence\"",
        ),
        ("0 90 180", "0 180 90", "line 11: ScatterAzimuth: found 90"),
        ("0 90 180", "0 90 270", "270 in a file that is PlaneSymmetrical"),
        ("0 10\n", "0 x\n", "line 13: ScatterRadial: found \"x\""),
        ("1 3\n", "1\n", "line 21: BSDF: found \"DataEnd\""),
        ("1 4\n", "1 4 5\n", "line 20: DataEnd: found \"5\""),
        ("1 4\n", "1 nan\n", "line 20: BSDF: found \"nan\""),
        ("DataEnd\n", "", "DataEnd: found the end of the file"),
        ("DataEnd\n", "DataEnd\nmore", "line 22: DataEnd: found \"more\""),
    ] {
        let text = parsed(&good.replacen(from, to, 1), &options())
            .unwrap_err()
            .to_string();
        assert!(text.contains(what), "{from:?} -> {to:?}: {text}");
    }
    let text = parsed(&good, &ReadOptions::default()).unwrap_err().to_string();
    assert!(text.contains("channel: found none"), "{text}");
    let stated = ReadOptions {
        quantity: Some(Quantity::Dsf),
        ..options()
    };
    assert!(
        parsed(&good, &stated)
            .unwrap_err()
            .to_string()
            .contains("bsdf in the file, dsf stated")
    );
    assert!(
        parsed("", &options())
            .unwrap_err()
            .to_string()
            .contains("0 bytes")
    );
}

/// Integral of the BSDF times the cosine over the cells of a real file, in the frame of its angles.
fn integral(scan: &Scan, azimuths: &[f64], radials: &[f64]) -> f64 {
    let frame = Frame::new(scan.incidence, Component::Reflection);
    let mut sum = 0.0;
    for a in azimuths.windows(2) {
        for r in radials.windows(2) {
            let (s0, s1) = ((0.5 * r[0].to_radians()).sin(), (0.5 * r[1].to_radians()).sin());
            let solid_angle = 2.0 * (s1 * s1 - s0 * s0) * (a[1] - a[0]).to_radians();
            for (a, r) in [(a[0], r[0]), (a[0], r[1]), (a[1], r[0]), (a[1], r[1])] {
                let r = if r == 0.0 { 0.0 } else { r };
                if let Some(d) = frame.on_its_side(if r == 0.0 { 0.0 } else { a }, r) {
                    sum += 2.0 * 0.25 * solid_angle * near(scan, d) * d.cos_theta();
                }
            }
        }
    }
    sum
}

#[test]
fn the_total_scatter_of_the_imaging_sphere_is_the_integral_with_the_cosine() {
    let Some(root) = shared() else { return };
    let path = root.join("ansys-formats/test_13_planesymmetric_brdf_zemax.bsdf");
    let scans = read(&path, &options()).unwrap();
    assert_eq!(scans.len(), 13);
    let azimuths: Vec<f64> = (0..19).map(|k| 10.0 * f64::from(k)).collect();
    let radials = [0.0, 5.0, 10.0, 15.0, 20.0, 30.0, 40.0, 50.0, 60.0, 70.0, 80.0];
    // from 15 to 30 degrees the grid leaves out little: what lies beyond 80 degrees from the mirror direction
    for scan in scans.iter().take(4) {
        let tis: f64 = scan.meta.other["tis"].parse().unwrap();
        let found = integral(scan, &azimuths, &radials);
        assert!(
            (0.9..1.0).contains(&(found / tis)),
            "{:?}: {found} {tis}",
            scan.incidence
        );
    }
}

#[test]
fn the_published_files_of_the_rt300s_hold_one_scan_an_incidence() {
    let Some(root) = shared() else { return };
    for name in ["AnoBlackEC1onAlum", "AnoBlackNiTEonSteel"] {
        let scans = read(&root.join(format!("loft-zemax/{name}.bsdf")), &options()).unwrap();
        let theta: Vec<f64> = scans.iter().map(|s| s.incidence.to_degrees().0.round()).collect();
        assert_eq!(theta, [10.0, 30.0, 50.0, 70.0]);
        assert!(scans[0].meta.other["comments"].contains("RT-300S"));
        assert!(
            scans
                .iter()
                .all(|s| s.len() > 250 && s.theta_s.iter().all(|t| t.to_degrees() < 90.0))
        );
    }
}

fn sum_of(parts: &[(&str, &[f64])]) -> Sum {
    let model = |(name, values): &(&str, &[f64])| {
        let parameters = [(Channel::Green, values.to_vec())];
        family(name).unwrap().model(&parameters).unwrap()
    };
    Sum::new(parts.iter().map(model).collect()).unwrap()
}

fn small_grid() -> Grid {
    Grid {
        rotations: vec![0.0, 45.0],
        incidences: vec![0.0, 30.0, 75.0],
        azimuths: vec![0.0, 45.0, 90.0, 180.0],
        radials: vec![0.0, 5.0, 30.0, 80.0, 120.0],
    }
}

/// Largest relative difference between the readings of a written file and the model.
fn round_trip(model: &dyn Bsdf, component: Component, symmetry: &str) -> f64 {
    let dir = tempfile::tempdir().unwrap();
    let path = dir.path().join("a.bsdf");
    let written = write(&path, model, 0, component, &small_grid(), "by gonio\ntwice").unwrap();
    assert_eq!(written.symmetry, symmetry);
    let scans = read(&path, &options()).unwrap();
    assert_eq!(scans[0].meta.other["comments"], "by gonio\ntwice");
    let mut worst: f64 = 0.0;
    for scan in &scans {
        let wi = scan.incidence.direction();
        let tis: f64 = scan.meta.other["tis"].parse().unwrap();
        let albedo = directional_albedo(model, wi, component, 0);
        assert!((tis - albedo).abs() < 1e-6, "{tis} {albedo}");
        for j in 0..scan.len() {
            let f = model.eval_first(wi, scan.direction(j));
            worst = worst.max((scan.value[j] - f).abs() / f.abs().max(1e-12));
        }
    }
    worst
}

#[test]
fn written_models_are_read_back_to_the_digits_of_the_file() {
    let isotropic = sum_of(&[("lambert", &[0.2]), ("ward-gmd", &[0.1, 0.2])]);
    assert!(round_trip(&isotropic, Component::Reflection, "PlaneSymmetrical") < 1e-6);
    let anisotropic = sum_of(&[
        ("lambert", &[0.2]),
        ("ward-gmd-anisotropic", &[0.1, 0.1, 0.4, 0.3]),
    ]);
    assert!(round_trip(&anisotropic, Component::Reflection, "ASymmetrical4D") < 1e-5);
    let through = sum_of(&[("lambert-transmission", &[0.3])]);
    assert!(round_trip(&through, Component::Transmission, "PlaneSymmetrical") < 1e-6);
}

#[test]
fn what_cannot_be_written_is_refused_and_nothing_is_left() {
    let model = sum_of(&[("lambert", &[0.2])]);
    let dir = tempfile::tempdir().unwrap();
    let path = dir.path().join("a.bsdf");
    let refused = |channel, grid: Grid| {
        write(&path, &model, channel, Component::Reflection, &grid, "")
            .unwrap_err()
            .to_string()
    };
    assert!(refused(1, small_grid()).contains("channel: found 1"));
    let mut grid = small_grid();
    grid.incidences = vec![30.0, 20.0];
    assert!(refused(0, grid).contains("incidences: found [30.0, 20.0]"));
    let mut grid = small_grid();
    grid.azimuths.pop();
    assert!(refused(0, grid).contains("azimuths"));
    assert!(!path.exists());
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(500))]

    #[test]
    fn directions_return_to_their_scatter_angles(
        theta in 0.0..89.0f64, phi in 0.0..360.0f64, azimuth in 0.0..360.0f64, radial in 0.1..170.0f64,
    ) {
        let incidence = Angles::from_degrees(theta, phi);
        for component in [Component::Reflection, Component::Transmission] {
            let frame = Frame::new(incidence, component);
            let v = frame.direction(azimuth.to_radians(), radial.to_radians());
            prop_assert!((v.length() - 1.0).abs() < 1e-12);
            let pole = frame.direction(0.0, 0.0);
            let back = pole.cross(v).length().atan2(pole.dot(v)).to_degrees();
            prop_assert!((back - radial).abs() < 1e-9, "{} {}", back, radial);
        }
    }

    #[test]
    fn no_content_panics(
        places in prop::collection::vec((any::<prop::sample::Index>(), any::<u8>()), 0..6),
        cut in any::<prop::sample::Index>(),
    ) {
        let mut bytes = file("PlaneSymmetrical", "Monochrome", "BRDF", "0 90 180", ONE).into_bytes();
        for (place, value) in places {
            let n = bytes.len();
            bytes[place.index(n)] = value;
        }
        let _ = parse(&bytes, Path::new("a"), &options());
        bytes.truncate(cut.index(bytes.len()));
        let _ = parse(&bytes, Path::new("a"), &options());
    }
}
