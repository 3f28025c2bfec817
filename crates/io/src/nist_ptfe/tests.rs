use std::path::PathBuf;

use gonio_scan::Scan;

use super::*;
use crate::mountain;

fn shared() -> Option<PathBuf> {
    let root = std::env::var_os("GONIO_SHARED_DATA").map_or_else(
        || Path::new(env!("CARGO_MANIFEST_DIR")).join("../../../shared/data"),
        PathBuf::from,
    );
    root.is_dir().then_some(root)
}

fn ptfe() -> Option<(PathBuf, Vec<Scan>)> {
    let root = shared()?; // skipped without the shared data
    let scans = read(&root.join("nist-ptfe/PTFE.data.csv"), &ReadOptions::default()).unwrap();
    Some((root, scans))
}

#[test]
fn the_file_holds_four_wavelengths_and_six_incidences() {
    let Some((_, scans)) = ptfe() else { return };
    assert_eq!(scans.len(), 24);
    let green: Vec<i64> = scans
        .iter()
        .filter(|s| s.channel == Channel::Wavelength(532.0))
        .map(|s| s.incidence.to_degrees().0.round() as i64)
        .collect();
    assert_eq!(green, [0, 15, 30, 45, 60, 75]);
    assert!(
        scans
            .iter()
            .all(|s| (303..=305).contains(&s.len()) && s.quantity == Quantity::Bsdf)
    );
}

#[test]
fn the_same_readings_as_mountain_text_agree() {
    let Some((root, scans)) = ptfe() else { return };
    // the Mountain twin states no up mark; its azimuths are those of the table
    let options = ReadOptions {
        upphi: Some(90.0),
        ..ReadOptions::default()
    };
    for scan in scans.iter().filter(|s| s.channel == Channel::Wavelength(532.0)) {
        let theta_i = scan.incidence.to_degrees().0.round();
        let path = root.join(format!("nist-ptfe-mountain/ptfe_532nm_i{theta_i:02}.txt"));
        let twin = mountain::read(&path, &options).unwrap().remove(0);
        let wi = (scan.incidence.direction(), twin.incidence.direction());
        assert!(wi.0.angle_to(wi.1).to_degrees() < 0.01, "{theta_i}");
        // the twin leaves out repeated directions
        for j in 0..twin.len() {
            let near = (0..scan.len()).find(|&k| {
                scan.direction(k).angle_to(twin.direction(j)) < 1e-5
                    && (scan.value[k] - twin.value[j]).abs() < 1e-3
            });
            assert!(
                near.is_some(),
                "{theta_i}: {:?} {}",
                twin.direction(j).angles().to_degrees(),
                twin.value[j]
            );
        }
    }
}

#[test]
fn ptfe_scatters_forward_towards_the_mirror_direction() {
    let Some((_, scans)) = ptfe() else { return };
    for scan in scans.iter().filter(|s| s.incidence.to_degrees().0 > 59.0) {
        let mirror = scan.incidence.direction().mirror();
        let retro = scan.incidence.direction();
        let mean_near = |axis: gonio_geom::Direction| {
            let near: Vec<f64> = (0..scan.len())
                .filter(|&j| scan.direction(j).angle_to(axis) < 0.35)
                .map(|j| scan.value[j])
                .collect();
            near.iter().sum::<f64>() / near.len() as f64
        };
        assert!(
            mean_near(mirror) > 1.2 * mean_near(retro),
            "{} {:?}",
            scan.channel,
            scan.incidence
        );
    }
}

#[test]
fn mueller_matrices_are_normalised_and_one_a_reading() {
    let Some(root) = shared() else { return };
    let both = read_mueller(&root.join("nist-ptfe/PTFE.data.csv"), &ReadOptions::default()).unwrap();
    for (scan, matrices) in &both {
        assert_eq!(scan.len(), matrices.len());
        assert!(
            matrices
                .iter()
                .all(|m| m[0][0] == 1.0 && m.iter().flatten().all(|x| x.abs() <= 1.2))
        );
    }
}

#[test]
fn one_wavelength_can_be_chosen_and_one_that_is_not_there_is_named() {
    let row = format!("0.532,-30,0,10,-90,0.3{}\n", ",0".repeat(15));
    let content = format!("{MAGIC}{}\n{row}", ",m".repeat(15));
    let parsed = |channel| {
        let options = ReadOptions {
            channel: Some(Channel::Wavelength(channel)),
            ..ReadOptions::default()
        };
        parse(content.as_bytes(), Path::new("a"), &options)
    };
    let scan = parsed(532.0).unwrap().remove(0);
    let (theta, phi) = scan.incidence.to_degrees();
    assert!((theta - 30.0).abs() < 1e-12 && (phi - 180.0).abs() < 1e-12);
    assert!((scan.direction(0).angles().to_degrees().1 - 270.0).abs() < 1e-12);
    assert!(parsed(633.0).unwrap_err().to_string().contains("633nm"));
}

#[test]
fn a_cut_row_is_an_error_with_its_line() {
    let content = format!("{MAGIC}{}\n0.532,-30,0,10\n", ",m".repeat(15));
    let text = parse(content.as_bytes(), Path::new("a"), &ReadOptions::default())
        .unwrap_err()
        .to_string();
    assert!(text.contains("line 2") && text.contains("4 columns"), "{text}");
}
