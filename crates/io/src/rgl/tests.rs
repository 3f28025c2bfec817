use std::f64::consts::PI;

use gonio_bsdf::Bsdf;
use gonio_geom::Direction;
use proptest::prelude::*;

use super::*;
use crate::tensor_file::tests::written;

type Row = (&'static str, u8, Vec<u64>, Vec<u8>);

fn floats(name: &'static str, shape: &[u64], f: impl Fn(usize) -> f32) -> Row {
    let n: u64 = shape.iter().product();
    let data = (0..n as usize).flat_map(|k| f(k).to_le_bytes()).collect();
    (name, 10, shape.to_vec(), data)
}

/// A small isotropic material of constant tables.
fn rows() -> Vec<Row> {
    vec![
        ("description", 1, vec![6], b"paint\0".to_vec()),
        floats("theta_i", &[3], |k| 0.7 * k as f32),
        floats("phi_i", &[1], |_| 0.0),
        floats("sigma", &[2, 3], |_| 0.5),
        floats("ndf", &[2, 3], |_| 2.0),
        floats("vndf", &[1, 3, 4, 5], |k| 1.0 + (k % 5) as f32),
        floats("luminance", &[1, 3, 2, 4], |_| 1.0),
        floats("rgb", &[1, 3, 3, 2, 4], |k| if k < 8 { -0.25 } else { 0.25 }),
        ("jacobian", 1, vec![1], vec![1]),
        ("valid", 1, vec![3], vec![0xff, 0x0f, 0xff]),
    ]
}

fn parsed(rows: &[Row]) -> Result<RglFile, IoError> {
    parse(&written(rows), Path::new("a.bsdf"))
}

#[test]
fn a_material_comes_back_with_its_channels_description_and_mask() {
    let file = parsed(&rows()).unwrap();
    assert_eq!(file.description, "paint");
    assert_eq!(
        file.model.channels(),
        [Channel::Red, Channel::Green, Channel::Blue]
    );
    assert_eq!(file.negative_share, [1.0 / 3.0, 0.0, 0.0]);
    let wi = Direction::from_spherical(f64::from(0.7f32), 0.0);
    let ws = Direction::from_degrees(30.0, 200.0);
    let mut f = [0.0; 3];
    file.model.eval(wi, ws, &mut f);
    let expected = 0.25 / ws.cos_theta();
    assert!(f.iter().all(|f| (f - expected).abs() < 1e-6), "{f:?}");
    // the mask of the second incidence begins with four zero bits: the first row of its nodes
    assert!(!file.model.has_data(wi, ws));
    assert!(file.model.has_data(Direction::NORMAL, ws));
}

#[test]
fn spectral_materials_have_a_channel_a_wavelength() {
    let mut rows = rows();
    rows[7] = floats("spectra", &[1, 3, 2, 2, 4], |_| 0.25);
    rows.push(floats("wavelengths", &[2], |k| [360.5, 532.1][k]));
    let file = parsed(&rows).unwrap();
    let expected = [Channel::Wavelength(360.5), Channel::Wavelength(532.1)];
    assert_eq!(file.model.channels(), expected);
    rows[10] = floats("wavelengths", &[2], |k| [532.0, 360.0][k]);
    let text = parsed(&rows).unwrap_err().to_string();
    assert!(text.contains("wavelengths: found [532.0, 360.0]"), "{text}");
}

#[test]
fn fields_that_do_not_fit_are_refused_by_name() {
    let cases: [(usize, Row, &str); 7] = [
        (1, ("theta_i", 11, vec![0], vec![]), "theta_i: found float64"),
        (
            1,
            floats("theta_i", &[1, 3], |_| 0.0),
            "theta_i: found shape [1, 3]",
        ),
        (
            2,
            floats("phi_i", &[2], |k| PI as f32 * k as f32),
            "vndf: found shape",
        ),
        (
            4,
            floats("ndf", &[2, 3], |_| f32::NAN),
            "ndf: found NaN at value 1",
        ),
        (7, floats("rgb", &[1, 3, 2, 2, 4], |_| 0.0), "rgb: found shape"),
        (8, ("jacobian", 1, vec![1], vec![7]), "jacobian: found 7"),
        (
            9,
            ("valid", 1, vec![2], vec![0, 0]),
            "valid: found uint8 of shape [2]",
        ),
    ];
    for (place, row, expected) in cases {
        let mut rows = rows();
        rows[place] = row;
        let text = parsed(&rows).unwrap_err().to_string();
        assert!(text.starts_with(&format!("a.bsdf: {expected}")), "{text}");
    }
    for place in [1, 2, 3, 4, 5, 6, 7, 8] {
        let mut rows = rows();
        let name = rows.remove(place).0;
        let text = parsed(&rows).unwrap_err().to_string();
        // without rgb the colours are looked for under spectra
        let name = if name == "rgb" { "spectra" } else { name };
        assert!(
            text.starts_with(&format!("a.bsdf: {name}: found no such field")),
            "{text}"
        );
    }
}

#[test]
fn a_material_without_a_mask_has_data_up_to_its_last_incidence() {
    let mut rows = rows();
    rows.pop();
    let model = parsed(&rows).unwrap().model;
    let ws = Direction::from_degrees(30.0, 200.0);
    assert!(model.has_data(Direction::from_degrees(80.0, 0.0), ws));
    assert!(!model.has_data(Direction::from_degrees(80.5, 0.0), ws));
}

#[test]
fn written_tables_are_read_back_with_their_channels_and_mask() {
    use gonio_bsdf::analytic::family;
    use gonio_bsdf::rgl::RglOptions;

    let values = vec![0.3, 0.3];
    let parameters: Vec<(Channel, Vec<f64>)> = [400.5, 532.0]
        .map(|nm| (Channel::Wavelength(nm), values.clone()))
        .into();
    let model = family("ward-gmd").unwrap().model(&parameters).unwrap();
    let options = RglOptions {
        theta_i: vec![0.0, 0.7, 1.4],
        resolution: 9,
        half_vector: (9, 16),
        ..RglOptions::of(model.as_ref())
    };
    let dir = tempfile::tempdir().unwrap();
    let path = dir.path().join("a.bsdf");
    let colours = [(Channel::Red, 0), (Channel::Green, 1), (Channel::Blue, 1)];
    let spectral = [(parameters[0].0, 0), (parameters[1].0, 1)];
    for channels in [&colours[..], &spectral] {
        let tables = RglTables::of(model.as_ref(), channels, &options).unwrap();
        write(&path, &tables, "made up").unwrap();
        let file = read(&path).unwrap();
        assert_eq!(file.description, "made up");
        let there: Vec<Channel> = channels.iter().map(|c| c.0).collect();
        assert_eq!(file.model.channels(), there);
        let direct = Rgl::new(tables).unwrap();
        let (mut f, mut g) = (vec![0.0; channels.len()], vec![0.0; channels.len()]);
        for (theta_i, theta_s) in [(0.0, 10.0), (20.0, 60.0), (55.0, 50.0), (79.0, 85.0)] {
            let wi = Direction::from_degrees(theta_i, 30.0);
            let ws = Direction::from_degrees(theta_s, 200.0);
            direct.eval(wi, ws, &mut f);
            file.model.eval(wi, ws, &mut g);
            // angles of incidence are kept in single precision
            assert!(
                f.iter().zip(&g).all(|(f, g)| (f - g).abs() <= 1e-6 * f),
                "{f:?} {g:?}"
            );
            assert_eq!(direct.has_data(wi, ws), file.model.has_data(wi, ws));
        }
    }
    let grey = RglTables::of(model.as_ref(), &[(Channel::Photopic, 0)], &options).unwrap();
    let text = write(&path, &grey, "").unwrap_err().to_string();
    assert!(text.contains("channels: found photopic"), "{text}");
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(2000))]

    #[test]
    fn spoilt_bytes_are_refused_or_give_a_model_that_answers(
        places in proptest::collection::vec((any::<prop::sample::Index>(), any::<u8>()), 1..6),
        cut in any::<prop::sample::Index>(),
        whole in any::<bool>(),
    ) {
        let mut bytes = written(&rows());
        for (place, value) in places {
            let n = bytes.len();
            bytes[place.index(n)] = value;
        }
        if !whole {
            bytes.truncate(cut.index(bytes.len()));
        }
        if let Ok(file) = parse(&bytes, Path::new("a.bsdf")) {
            let mut f = vec![0.0; file.model.channels().len()];
            for theta in [0.0, 35.0, 89.9] {
                let wi = Direction::from_degrees(theta, 0.0);
                file.model.eval(wi, Direction::from_degrees(30.0, 200.0), &mut f);
                prop_assert!(f.iter().all(|f| *f >= 0.0));
                let _ = file.model.sample(wi, [0.3, 0.6, 0.1]);
            }
        }
    }
}
