use proptest::prelude::*;

use super::*;

const HEAD: &str = "#format: theta phi BSDF\n#incident_angle 30 0\n#upphi 90\n";

fn parsed(content: impl AsRef<[u8]>) -> Result<Vec<Scan>, IoError> {
    parse(content.as_ref(), Path::new("a.txt"), &ReadOptions::default())
}

fn one(content: impl AsRef<[u8]>) -> Scan {
    parsed(content).unwrap().remove(0)
}

fn message(content: impl AsRef<[u8]>) -> String {
    parsed(content).unwrap_err().to_string()
}

#[test]
fn a_plain_file_is_one_scan() {
    let scan = one(format!(
        "#sample_name \"grey\"\n{HEAD}10 20 0.5\n95\t350.5 -1e-3\n"
    ));
    assert_eq!(
        (scan.kind, scan.quantity, scan.channel),
        (ScanKind::Sample, Quantity::Bsdf, Channel::Photopic)
    );
    assert_eq!(scan.incidence, gonio_geom::Angles::from_degrees(30.0, 0.0));
    assert_eq!(scan.theta_s, [10f64.to_radians(), 95f64.to_radians()]);
    assert_eq!(scan.phi_s, [20f64.to_radians(), 350.5f64.to_radians()]);
    assert_eq!(scan.value, [0.5, -1e-3]);
    assert_eq!(scan.meta.sample_name.as_deref(), Some("grey"));
}

#[test]
fn line_ends_tabs_blank_lines_and_a_byte_order_mark_change_nothing() {
    let plain = one(format!("{HEAD}10 20 0.5\n40 50 0.25\n"));
    let odd = one(format!("\u{feff}{HEAD}\n \t10\t 20  0.5 \n\n  \n40 50 0.25\n\n").replace('\n', "\r\n"));
    assert_eq!(
        (odd.theta_s, odd.phi_s, odd.value),
        (plain.theta_s, plain.phi_s, plain.value)
    );
}

#[test]
fn azimuths_are_turned_so_that_the_up_mark_lies_on_y() {
    let absent = one("#format: theta phi DSF\n#intheta 30\n#inphi 10\n20 300 1\n");
    assert_eq!(absent.incidence, gonio_geom::Angles::from_degrees(30.0, 100.0));
    assert_eq!(absent.phi_s, [30f64.to_radians()]);
    let kept = ReadOptions {
        upphi: Some(90.0),
        ..ReadOptions::default()
    };
    let content = b"#format: theta phi DSF\n#intheta 30\n#inphi 10\n20 300 1\n";
    let scan = parse(content, Path::new("a"), &kept).unwrap().remove(0);
    assert_eq!(scan.phi_s, [300f64.to_radians()]);
}

#[test]
fn a_detector_unit_in_brackets_is_a_signal() {
    let scan = one("#format: theta phi [uA]\n#incident_angle 0 0\n10 0 12.5\n");
    assert_eq!(scan.quantity, Quantity::Signal);
    assert_eq!(scan.meta.other["unit"], "uA");
}

#[test]
fn white_of_equal_energy_has_equal_red_green_and_blue() {
    let scans =
        parsed("#format: theta phi BSDF\n#incident_angle 0 0\n#colorimetry: CIE-XYZ\n10 0 .3 .3 .3\n")
            .unwrap();
    let channels: Vec<_> = scans.iter().map(|s| s.channel).collect();
    assert_eq!(
        channels,
        [Channel::Photopic, Channel::Red, Channel::Green, Channel::Blue]
    );
    for scan in &scans {
        assert!((scan.value[0] - 0.3).abs() < 1e-15);
    }
}

#[test]
fn radiance_primaries_come_back_pure() {
    let [r, g, b] = radiance_rgb([0.640, 0.330, 0.030]);
    assert!(r > 0.0 && g.abs() < 1e-15 && b.abs() < 1e-15);
    // RADIANCE weighs green with 0.670 in its luminance
    let [_, g, _] = radiance_rgb([0.290 / 0.600, 1.0, 0.110 / 0.600]);
    assert!((1.0 / g - 0.670).abs() < 5e-4, "{}", 1.0 / g);
}

#[test]
fn a_reading_without_data_is_kept() {
    let scan = one(format!("{HEAD}10 20 NaN\n10 21 1\n"));
    assert!(scan.value[0].is_nan());
    assert_eq!(scan.len(), 2);
}

#[test]
fn a_header_key_after_data_is_an_error_and_a_comment_is_not() {
    let text = message(format!("{HEAD}10 20 1\n#intheta 40\n10 20 2\n"));
    assert!(
        text.contains("line 5") && text.contains("#intheta after data"),
        "{text}"
    );
    assert_eq!(one(format!("{HEAD}10 20 1\n# pause\n10 30 2\n")).len(), 2);
}

#[test]
fn what_is_missing_is_named() {
    assert!(message("#incident_angle 0 0\n1 2 3\n").contains("#format"));
    assert!(message("#format: theta phi BSDF\n1 2 3\n").contains("#intheta"));
    assert!(message("#format: theta phi BSDF\n#intheta 3\n1 2 3\n").contains("#inphi"));
    assert!(message(HEAD).contains("readings"));
    assert!(message("").contains("0 bytes"));
}

#[test]
fn faults_name_their_line() {
    for (rows, line, what) in [
        ("1 2 3\n1 2\n", 5, "2 columns"),
        ("1 2 3\n1 2 3 4\n", 5, "\"4\" after 3 columns"),
        ("1 2 3\n\n181 2 3\n", 6, "found 181"),
        ("-1 2 3\n", 4, "0 to 180"),
        ("1 2000 3\n", 4, "-360 to 720"),
        ("nan nan nan\n", 4, "found NaN"),
        ("1 2 inf\n", 4, "found inf"),
        ("1 2 3,5\n", 4, "\"3,5\""),
        ("1 2 \0\n", 4, "\\x00"),
        ("1 2 3\n1 2 3\n1", 6, "1 column"),
        ("1 2 3\n1 2 3\n1 2 4e", 6, "\"4e\""),
    ] {
        let text = message(format!("{HEAD}{rows}"));
        assert!(
            text.contains(&format!("line {line}:")) && text.contains(what),
            "{rows:?}: {text}"
        );
    }
}

#[test]
fn a_file_with_fewer_rows_than_promised_is_truncated() {
    let text = message(format!("{HEAD}#datapoints_in_file 3\n1 2 3\n1 3 3\n"));
    assert!(
        text.contains("line 4") && text.contains("holds 2 readings"),
        "{text}"
    );
}

#[test]
fn contradicting_header_lines_are_an_error() {
    let text = message("#format: theta phi BSDF\n#incident_angle 30 0\n#intheta 40\n1 2 3\n");
    assert!(
        text.contains("line 3") && text.contains("line 2 says 30"),
        "{text}"
    );
    assert!(message("#format: theta phi W\n").contains("DSF, BSDF"));
    let stated = ReadOptions {
        quantity: Some(Quantity::Dsf),
        ..ReadOptions::default()
    };
    assert!(parse(format!("{HEAD}1 2 3\n").as_bytes(), Path::new("a"), &stated).is_err());
}

#[test]
fn bytes_that_are_no_text_are_refused_or_read_as_latin_1() {
    assert_eq!(
        one([b"#sample_name \"M\xfcller\"\n", HEAD.as_bytes(), b"1 2 3\n"].concat())
            .meta
            .sample_name
            .as_deref(),
        Some("Müller")
    );
    assert!(message(b"#format\0\n").contains("control characters"));
    assert!(message(b"\xff\xfe#\0f\0").contains("UTF-16"));
}

#[test]
fn an_endless_line_is_refused_wherever_it_stands() {
    assert!(message(vec![b'#'; 1 << 20]).contains("more than 262144 bytes"));
    let text = message([HEAD.as_bytes(), &vec![b'1'; 1 << 20]].concat());
    assert!(text.contains("line 4") && text.len() < 300, "{text}");
    let text = message([HEAD.as_bytes(), b"1 2 3\n", &b"1 ".repeat(1 << 20)].concat());
    assert!(text.contains("line 5") && text.len() < 300, "{text}");
    let text = message([HEAD.as_bytes(), &b"1 ".repeat(1 << 10)].concat());
    assert!(text.contains("after 3 columns") && text.len() < 300, "{text}");
    let text = message([HEAD.as_bytes(), &b"1".repeat(1 << 16)].concat());
    assert!(text.contains("without a blank") && text.len() < 300, "{text}");
}

fn scans() -> impl Strategy<Value = Scan> {
    let value =
        prop_oneof![9 => -1e6..1e6f64, 1 => any::<f64>().prop_filter("finite or nan", |x| !x.is_infinite())];
    let reading = (0.0..=180.0f64, 0.0..360.0f64, value);
    let channel = prop_oneof![
        Just(Channel::Photopic),
        (100.0..3000.0f64).prop_map(Channel::Wavelength)
    ];
    let quantity = prop_oneof![Just(Quantity::Bsdf), Just(Quantity::Dsf), Just(Quantity::Signal)];
    (
        prop::collection::vec(reading, 1..40),
        0.0..=180.0f64,
        0.0..360.0f64,
        channel,
        quantity,
    )
        .prop_map(|(readings, theta_i, phi_i, channel, quantity)| Scan {
            kind: ScanKind::Sample,
            quantity,
            channel,
            incidence: gonio_geom::Angles::from_degrees(theta_i, phi_i),
            theta_s: readings.iter().map(|r| r.0.to_radians()).collect(),
            phi_s: readings.iter().map(|r| r.1.to_radians()).collect(),
            value: readings.iter().map(|r| r.2).collect(),
            time: None,
            meta: gonio_scan::ScanMeta {
                sample_name: Some("a \"b\" c".into()),
                ..Default::default()
            },
        })
}

proptest! {
    #[test]
    fn what_is_written_reads_back_bit_for_bit(scan in scans()) {
        let dir = tempfile::tempdir().unwrap();
        let path = dir.path().join("a.txt");
        write(&path, &scan).unwrap();
        let back = read(&path, &ReadOptions::default()).unwrap().remove(0);
        let bits = |v: &[f64]| v.iter().map(|x| if x.is_nan() { 1 } else { x.to_bits() }).collect::<Vec<_>>();
        prop_assert_eq!(bits(&back.theta_s), bits(&scan.theta_s));
        prop_assert_eq!(bits(&back.phi_s), bits(&scan.phi_s));
        prop_assert_eq!(bits(&back.value), bits(&scan.value));
        prop_assert_eq!((back.incidence, back.channel, back.quantity), (scan.incidence, scan.channel, scan.quantity));
        prop_assert_eq!(back.meta.sample_name, scan.meta.sample_name);
    }

    #[test]
    fn no_content_panics(head in any::<bool>(), tail in prop::collection::vec(any::<u8>(), 0..200)) {
        let mut content = if head { HEAD.as_bytes().to_vec() } else { b"#".to_vec() };
        content.extend(tail);
        let _ = parsed(content);
    }

    #[test]
    fn no_text_panics(tail in "[#0-9 .\\-enafi\n\r\t:a-z]{0,200}") {
        let _ = parsed(format!("{HEAD}{tail}"));
        let _ = parsed(tail);
    }
}
