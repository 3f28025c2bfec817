use proptest::prelude::*;

use super::*;

const HEAD: &str = "LAB_NAME Somewhere\nSYSTEM_NAME gonio\n\nSAMPLE_NAME \"paint\"\nNUM_POINTS 2\n";

fn parsed(content: &str, options: &ReadOptions) -> Result<Vec<Scan>, IoError> {
    parse(content.as_bytes(), Path::new("a.astm"), options)
}

fn stated(channel: Channel) -> ReadOptions {
    ReadOptions {
        channel: Some(channel),
        ..ReadOptions::default()
    }
}

#[test]
fn rows_of_radians_make_scans_a_channel() {
    let content = format!(
        "{HEAD}VARS theta_i,phi_i,theta_s,phi_s,465nm,630nm\n0.5,0,1.0,-1.5,0.1,0.2\r\n0.5,0,0,3.0,0.3,0.4\r\n"
    );
    let scans = parsed(&content, &ReadOptions::default()).unwrap();
    let channels: Vec<Channel> = scans.iter().map(|s| s.channel).collect();
    assert_eq!(channels, [465.0, 630.0].map(Channel::Wavelength));
    assert_eq!(scans[1].value, [0.2, 0.4]);
    assert_eq!(scans[0].incidence.theta, 0.5);
    assert!((scans[0].phi_s[0] - (std::f64::consts::TAU - 1.5)).abs() < 1e-12);
    assert_eq!(scans[0].meta.sample_name.as_deref(), Some("paint"));
    assert_eq!(scans[0].meta.instrument.as_deref(), Some("gonio"));
    assert_eq!(scans[0].meta.other["lab_name"], "Somewhere");
    let one = parsed(&content, &stated(Channel::Wavelength(630.0))).unwrap();
    assert_eq!(one.len(), 1);
    assert_eq!(
        crate::detect(content.as_bytes(), Path::new("a")).unwrap(),
        crate::Format::Astm
    );
}

#[test]
fn colours_and_one_unnamed_channel_are_taken() {
    let row = "0.5,0,1.0,1,0.1,0.1,0.1\n0.5,0,0.2,1,0.3,0.3,0.3\n";
    let rgb = parsed(
        &format!("{HEAD}VARS theta_i,phi_i,theta_s,phi_s,R,G,B\n{row}"),
        &ReadOptions::default(),
    );
    let channels: Vec<Channel> = rgb.unwrap().iter().map(|s| s.channel).collect();
    assert_eq!(channels, [Channel::Red, Channel::Green, Channel::Blue]);
    let xyz = parsed(
        &format!("{HEAD}VARS theta_i,phi_i,theta_s,phi_s,X,Y,Z\n{row}"),
        &ReadOptions::default(),
    )
    .unwrap();
    assert_eq!(xyz.len(), 4);
    assert!(xyz.iter().all(|s| (s.value[1] - 0.3).abs() < 1e-12));
    let one = "VARS theta_i,phi_i,theta_s,phi_s,BRDF\n0.5,0,1.0,1,0.1\n0.5,0,0.2,1,0.3\n";
    let scans = parsed(&format!("{HEAD}{one}"), &stated(Channel::Photopic)).unwrap();
    assert_eq!(scans[0].channel, Channel::Photopic);
    let text = parsed(&format!("{HEAD}{one}"), &ReadOptions::default())
        .unwrap_err()
        .to_string();
    assert!(text.contains("line 6: VARS: found \"BRDF\""), "{text}");
}

#[test]
fn faults_are_named_with_line_and_field() {
    let good = format!("{HEAD}VARS theta_i,phi_i,theta_s,phi_s,465nm\n0.5,0,1.0,1,0.1\n0.5,0,0.2,1,0.3\n");
    for (from, to, what) in [
        ("VARS", "NAMES", "VARS: found no such line"),
        ("phi_s,", "", "line 6: VARS: found theta_i,phi_i,theta_s,465nm"),
        ("NUM_POINTS 2", "NUM_POINTS x", "line 5: NUM_POINTS: found \"x\""),
        (
            "NUM_POINTS 2",
            "NUM_POINTS 3",
            "rows: found 2, allowed NUM_POINTS, 3",
        ),
        (
            "0.5,0,0.2,1,0.3",
            "0.5,0,20,1,0.3",
            "line 8: theta_s: found 20, allowed radians",
        ),
        ("0.5,0,0.2,1,0.3", "0.5,0,0.2,1", "line 8: row: found 4 columns"),
        ("0.5,0,0.2,1,0.3", "0.5,0,0.2,1,x", "line 8: 465nm: found \"x\""),
    ] {
        let text = parsed(&good.replacen(from, to, 1), &ReadOptions::default())
            .unwrap_err()
            .to_string();
        assert!(text.contains(what), "{from:?} -> {to:?}: {text}");
    }
    let text = parsed(&good, &stated(Channel::Photopic)).unwrap_err().to_string();
    assert!(
        text.contains("channel: found photopic, allowed one of 465nm"),
        "{text}"
    );
}

proptest! {
    #[test]
    fn no_content_panics(tail in prop::collection::vec(any::<u8>(), 0..200)) {
        let names = "VARS theta_i,phi_i,theta_s,phi_s,465nm\n";
        for content in [tail.clone(), [HEAD.as_bytes(), &tail].concat(), [names.as_bytes(), &tail].concat()] {
            let _ = parse(&content, Path::new("a"), &ReadOptions::default());
        }
    }
}
