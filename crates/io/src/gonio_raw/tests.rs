use gonio_bsdf::{Channel, Quantity};
use gonio_geom::Angles;
use gonio_scan::{ScanKind, ScanMeta};
use proptest::prelude::*;

use super::*;

const FIELDS: &str = "#kind: beam\n#quantity: signal\n#channel: 532nm\n#theta_i: 10\n#phi_i: 20\n";

fn parsed(content: impl AsRef<[u8]>) -> Result<Vec<Scan>, IoError> {
    parse(content.as_ref(), Path::new("a.txt"), &ReadOptions::default())
}

fn message(content: impl AsRef<[u8]>) -> String {
    parsed(content).unwrap_err().to_string()
}

#[test]
fn one_record_needs_no_record_line() {
    let scans = parsed(format!(
        "{MAGIC}\n# a comment\n{FIELDS}#columns: theta_s phi_s value\n1 2 3\n"
    ))
    .unwrap();
    assert_eq!(scans.len(), 1);
    assert_eq!(
        (scans[0].kind, scans[0].channel),
        (ScanKind::Beam, Channel::Wavelength(532.0))
    );
    assert!(scans[0].meta.other.is_empty());
}

#[test]
fn common_fields_hold_for_every_record_and_a_record_may_replace_them() {
    let columns = "#columns: theta_s phi_s value time_s\n1 2 3 4\n";
    let scans = parsed(format!(
        "{MAGIC}\n{FIELDS}#lamp: xenon\n#record\n{columns}\n#record\n#kind: dark\n#distance_mm: 500\n{columns}"
    ))
    .unwrap();
    assert_eq!(
        scans.iter().map(|s| s.kind).collect::<Vec<_>>(),
        [ScanKind::Beam, ScanKind::Dark]
    );
    assert!(
        scans
            .iter()
            .all(|s| s.meta.other["lamp"] == "xenon" && s.time.as_deref() == Some(&[4.0]))
    );
    assert_eq!(scans[1].meta.distance, Some(0.5));
}

#[test]
fn faults_are_named() {
    let columns = "#columns: theta_s phi_s value\n";
    for (content, what) in [
        ("#gonio raw 2\n".to_string(), "line 1"),
        (format!("{MAGIC}\n"), "#columns"),
        (format!("{MAGIC}\n{FIELDS}"), "#columns"),
        (format!("{MAGIC}\n{FIELDS}{columns}"), "at least one row"),
        (format!("{MAGIC}\n{columns}1 2 3\n"), "line 2: #kind"),
        (
            format!("{MAGIC}\n{FIELDS}{columns}1 2 3\n#kind: dark\n"),
            "line 9",
        ),
        (
            format!("{MAGIC}\n{FIELDS}{columns}1 2 3\n{columns}1 2 3\n"),
            "#record before",
        ),
        (format!("{MAGIC}\n#record\n#record\n"), "line 3"),
        (format!("{MAGIC}\n{FIELDS}1 2 3\n"), "does not start with #"),
        (
            format!("{MAGIC}\n{FIELDS}#readings: 5\n{columns}1 2 3\n"),
            "holds 1",
        ),
        (
            format!("{MAGIC}\n{FIELDS}#columns: theta phi value\n1 2 3\n"),
            "theta_s phi_s value",
        ),
        (format!("{MAGIC}\n{FIELDS}{columns}1 2 3 4\n"), "after 3 columns"),
        (format!("{MAGIC}\n#channel: purple\n"), "line 2: #channel"),
        (format!("{MAGIC}\n#theta_i: 190\n"), "0 to 180"),
        (format!("{MAGIC}\n#noise_readout: -1\n"), "at least 0"),
        (format!("{MAGIC}\n#distance_mm: nan\n"), "#distance_mm"),
    ] {
        let text = message(&content);
        assert!(text.contains(what), "{content:?}: {text}");
    }
}

#[test]
fn a_stated_option_may_not_contradict_the_file() {
    let content = format!("{MAGIC}\n{FIELDS}#columns: theta_s phi_s value\n1 2 3\n");
    let options = ReadOptions {
        kind: Some(ScanKind::Sample),
        ..ReadOptions::default()
    };
    let text = parse(content.as_bytes(), Path::new("a"), &options)
        .unwrap_err()
        .to_string();
    assert!(text.contains("beam in the file, sample stated"), "{text}");
}

#[test]
fn a_free_key_that_means_something_cannot_be_written() {
    let mut scan = parsed(format!("{MAGIC}\n{FIELDS}#columns: theta_s phi_s value\n1 2 3\n"))
        .unwrap()
        .remove(0);
    scan.meta.other.insert("kind".into(), "x".into());
    let dir = tempfile::tempdir().unwrap();
    assert!(write(&dir.path().join("a"), &[scan]).is_err());
    assert_eq!(std::fs::read_dir(dir.path()).unwrap().count(), 0);
}

fn scan() -> impl Strategy<Value = Scan> {
    let number =
        || prop_oneof![9 => -1e6..1e6f64, 1 => any::<f64>().prop_filter("finite", |x| x.is_finite())];
    let size = || prop::option::of(0.0..1e4f64);
    let reading = (0.0..=180.0f64, 0.0..360.0f64, number(), number());
    let kind = prop::sample::select(vec![
        ScanKind::Sample,
        ScanKind::Beam,
        ScanKind::Dark,
        ScanKind::Standard,
    ]);
    let quantity = prop::sample::select(vec![
        Quantity::Signal,
        Quantity::Bsdf,
        Quantity::Dsf,
        Quantity::ReflectanceFactor,
    ]);
    let channel = prop_oneof![
        Just(Channel::Photopic),
        Just(Channel::Red),
        Just(Channel::Green),
        Just(Channel::Blue),
        (100.0..3000.0f64).prop_map(Channel::Wavelength)
    ];
    let name = || prop::option::of("[a-zA-Zäß0-9.,;%-]([a-z :#\"]{0,10}[a-z])?");
    let meta = (
        name(),
        name(),
        size(),
        prop::option::of(0.0..10.0f64),
        size(),
        size(),
        size(),
        prop::option::of(0.0..=1.0f64),
        size(),
        "[a-z_]{1,5}x",
        name(),
    )
        .prop_map(
            |(
                sample_name,
                instrument,
                mm,
                omega,
                beam,
                readout,
                relative,
                integration,
                saturation,
                key,
                value,
            )| {
                ScanMeta {
                    sample_name,
                    instrument,
                    distance: mm.map(|x| x / 1000.0),
                    receiver_solid_angle: omega,
                    beam_diameter: beam.map(|x| x / 1000.0),
                    noise_readout: readout,
                    noise_relative: relative,
                    integration,
                    saturation,
                    started: Some("2026-11-22T03:00:00Z".into()),
                    source: None,
                    other: value.map(|v| (key, v)).into_iter().collect(),
                }
            },
        );
    let readings = prop::collection::vec(reading, 1..20);
    (
        kind,
        quantity,
        channel,
        (0.0..=180.0f64, 0.0..360.0f64),
        readings,
        any::<bool>(),
        meta,
    )
        .prop_map(
            |(kind, quantity, channel, (theta_i, phi_i), readings, timed, meta)| Scan {
                kind,
                quantity,
                channel,
                incidence: Angles::from_degrees(theta_i, phi_i),
                theta_s: readings.iter().map(|r| r.0.to_radians()).collect(),
                phi_s: readings.iter().map(|r| r.1.to_radians()).collect(),
                value: readings.iter().map(|r| r.2).collect(),
                time: timed.then(|| readings.iter().map(|r| r.3).collect()),
                meta,
            },
        )
}

proptest! {
    #[test]
    fn what_is_written_reads_back_equal(scans in prop::collection::vec(scan(), 1..4)) {
        let dir = tempfile::tempdir().unwrap();
        let path = dir.path().join("a.txt");
        write(&path, &scans).unwrap();
        let mut back = read(&path, &ReadOptions::default()).unwrap();
        for scan in &mut back {
            prop_assert_eq!(scan.meta.source.take(), Some(path.display().to_string()));
        }
        prop_assert_eq!(back, scans);
    }

    #[test]
    fn no_content_panics(tail in prop::collection::vec(any::<u8>(), 0..200)) {
        let mut content = format!("{MAGIC}\n{FIELDS}").into_bytes();
        content.extend(tail);
        let _ = parsed(content);
    }

    #[test]
    fn no_text_panics(tail in "(#record|#columns: theta_s phi_s value|#kind: dark|[0-9.]{1,3}|[ \n#]){0,30}") {
        let _ = parsed(format!("{MAGIC}\n{FIELDS}{tail}"));
    }
}
