use std::io::BufReader;
use std::path::{Path, PathBuf};

use gonio_bsdf::FourComponents;
use gonio_bsdf::klems::{Klems, KlemsBasis, KlemsMatrix, Role};
use gonio_bsdf::tensor_tree::{Rank, TensorTree, Tree, TreeBuilder};
use gonio_geom::Direction;
use proptest::prelude::*;

use super::*;
use crate::IoError;

fn noise(k: usize) -> f32 {
    (((k + 1) as f64 * 0.618_033_988_749).fract().powi(6) * 30.0) as f32
}

fn klems(
    incident: KlemsBasis,
    exit: KlemsBasis,
    keys: &[(Side, Component)],
    channel: Channel,
) -> RadianceXml {
    let mut four = FourComponents::default();
    for (n, (side, component)) in keys.iter().enumerate() {
        let values = (0..incident.len() * exit.len())
            .map(|k| noise(k + 7 * n))
            .collect();
        let m = KlemsMatrix::new(incident.clone(), exit.clone(), values).unwrap();
        four.set(*side, *component, Some(m));
    }
    RadianceXml {
        material: Material {
            name: "felt <grey> & \"white\"".into(),
            manufacturer: "Müller & Söhne".into(),
            device_type: "Other".into(),
            thickness: Some(0.0015),
            width: None,
            height: Some(2.0),
        },
        model: Tabulated::Klems(Klems::new(channel, four)),
    }
}

fn tree(rank: Rank, seed: usize) -> Tree {
    let n = rank.children();
    let mut b = TreeBuilder::new(rank);
    b.branch().unwrap();
    for child in 0..n {
        if child % 2 == 0 {
            b.block(&[noise(child + seed)]).unwrap();
        } else {
            b.branch().unwrap();
            for g in 0..n {
                let m = if g % 3 == 0 { n } else { 1 };
                let values: Vec<f32> = (0..m).map(|k| noise(k + 31 * g + seed)).collect();
                b.block(&values).unwrap();
            }
            b.end().unwrap();
        }
    }
    b.end().unwrap();
    b.finish().unwrap()
}

fn trees(rank: Rank) -> RadianceXml {
    let mut four = FourComponents::default();
    for (k, (s, c)) in FourComponents::<()>::KEYS.into_iter().enumerate() {
        four.set(s, c, Some(tree(rank, 100 * k)));
    }
    RadianceXml {
        material: Material {
            device_type: "Other".into(),
            ..Material::default()
        },
        model: Tabulated::TensorTree(TensorTree::new(Channel::Photopic, four)),
    }
}

fn text(xml: &RadianceXml) -> String {
    let mut out = Vec::new();
    write_to(&mut out, xml).unwrap();
    String::from_utf8(out).unwrap()
}

fn parse(text: &[u8], channel: Channel) -> Result<RadianceXml, IoError> {
    // a small buffer cuts numbers and tags anywhere
    read_from(BufReader::with_capacity(11, text), Path::new("x.xml"), channel)
}

fn message(text: &str) -> String {
    parse(text.as_bytes(), Channel::Photopic).unwrap_err().to_string()
}

#[test]
fn what_was_written_is_read_back_exactly() {
    let all = FourComponents::<()>::KEYS;
    let cases = [
        klems(
            KlemsBasis::full(),
            KlemsBasis::full(),
            &all[..1],
            Channel::Photopic,
        ),
        klems(KlemsBasis::half(), KlemsBasis::half(), &all, Channel::Solar),
        klems(
            KlemsBasis::quarter(),
            KlemsBasis::half(),
            &all[1..3],
            Channel::Wavelength(532.0),
        ),
        trees(Rank::Three),
        trees(Rank::Four),
    ];
    for xml in cases {
        let back = parse(text(&xml).as_bytes(), xml.model.channel()).unwrap();
        assert!(back == xml);
    }
}

#[test]
fn a_file_on_disk_round_trips() {
    let dir = tempfile::tempdir().unwrap();
    let path = dir.path().join("a.xml");
    let xml = trees(Rank::Three);
    write(&path, &xml).unwrap();
    assert!(read(&path, Channel::Photopic).unwrap() == xml);
    assert!(matches!(
        read(dir.path(), Channel::Photopic),
        Err(IoError::File { .. })
    ));
    assert!(matches!(
        read(&dir.path().join("none"), Channel::Photopic),
        Err(IoError::File { .. })
    ));
}

#[test]
fn rows_are_the_transpose_of_columns() {
    let key = [(Side::Front, Component::Reflection)];
    let columns = klems(KlemsBasis::quarter(), KlemsBasis::half(), &key, Channel::Photopic);
    // the same text read as rows: incident is then the row basis
    let swapped = text(&columns).replace(">Columns<", ">Rows<");
    let rows = parse(swapped.as_bytes(), Channel::Photopic).unwrap();
    let (Tabulated::Klems(a), Tabulated::Klems(b)) = (&columns.model, &rows.model) else {
        panic!("matrices expected")
    };
    let a = a.matrix(Side::Front, Component::Reflection).unwrap();
    let b = b.matrix(Side::Front, Component::Reflection).unwrap();
    assert_eq!((a.incident(), a.exit()), (b.exit(), b.incident()));
    for o in 0..a.exit().len() {
        for i in 0..a.incident().len() {
            assert_eq!(a.value(o, i), b.value(i, o));
        }
    }
}

#[test]
fn windows_front_is_gonios_back() {
    let key = [(Side::Front, Component::Reflection)];
    assert!(
        text(&klems(
            KlemsBasis::quarter(),
            KlemsBasis::quarter(),
            &key,
            Channel::Photopic
        ))
        .contains(">Reflection Back<")
    );
    assert_eq!(
        component_of("transmission front"),
        Some((Side::Back, Component::Transmission))
    );
}

#[test]
fn faults_name_line_and_field() {
    let key = [(Side::Front, Component::Reflection)];
    let good = text(&klems(
        KlemsBasis::quarter(),
        KlemsBasis::quarter(),
        &key,
        Channel::Photopic,
    ));
    let line_of = |needle: &str| {
        good.lines()
            .position(|l| l.contains(needle))
            .map(|k| k + 1)
            .unwrap()
    };
    let cases = [
        (
            good.replace(">Columns<", ">Diagonals<"),
            "IncidentDataStructure",
            Some(line_of(">Columns<")),
        ),
        (
            good.replace("<ColumnAngleBasis>LBNL/Klems Quarter", "<ColumnAngleBasis>Other"),
            "ColumnAngleBasis",
            Some(line_of("<ColumnAngleBasis>")),
        ),
        (good.replace(">Visible<", ">NIR<"), "data for NIR only", None),
        (
            good.replace("<ScatteringData>", "<ScatteringData> 0.5"),
            "one more value",
            None,
        ),
        (
            good.replace("<ScatteringData>", "<ScatteringData> nan"),
            "\"nan\"",
            Some(line_of("<ScatteringData>")),
        ),
        (
            good.replace("<ScatteringData>", "<ScatteringData> -0.1"),
            "\"-0.1\"",
            Some(line_of("<ScatteringData>")),
        ),
        (
            good.replace(
                "<ScatteringData>",
                &format!("<ScatteringData> {}", "1".repeat(5000)),
            ),
            "at most 64",
            None,
        ),
        (
            good.replace("<nPhis>8<", "<nPhis>9<"),
            "rings that are not those",
            None,
        ),
        (
            good.replace("Reflection Back", "Sideways"),
            "WavelengthDataDirection",
            Some(line_of("Reflection Back")),
        ),
        (good.replace("</WindowElement>", ""), "end of the file", None),
        (good.replace("</Layer>", "</Later>"), "XML", None),
        (String::new(), "without data", None),
        ("<html></html>".into(), "root element", Some(1)),
        (
            good.replace("</Layer>", "</Layer><Layer></Layer>"),
            "second layer",
            None,
        ),
    ];
    for (bad, wanted, line) in cases {
        let m = message(&bad);
        assert!(m.contains(wanted) && m.contains("x.xml"), "{wanted}: {m}");
        if let Some(line) = line {
            assert!(m.contains(&format!("line {line}:")), "line {line}: {m}");
        }
    }
    let block = good.split_inclusive("\t<WavelengthData>\n").nth(1).unwrap();
    let block = block.split("</Layer>").next().unwrap();
    let twice = good.replace("</Layer>", &format!("\t<WavelengthData>\n{block}</Layer>"));
    assert!(message(&twice).contains("twice"));
}

#[test]
fn every_truncation_is_an_error() {
    let good = text(&trees(Rank::Three));
    let end = good.rfind("</WindowElement>").unwrap();
    for cut in (0..end + 10).step_by(97) {
        assert!(
            parse(&good.as_bytes()[..cut], Channel::Photopic).is_err(),
            "cut at {cut}"
        );
    }
}

#[test]
fn broken_trees_are_refused() {
    let good = text(&trees(Rank::Three));
    let start = good.find("<ScatteringData>").unwrap() + "<ScatteringData>".len();
    let end = good.find("</ScatteringData>").unwrap();
    for data in [
        "",
        "{}",
        "{ 1 2 }",
        "1 2",
        "{ { 1 } }",
        "{ 1 } { 1 }",
        "{ 1",
        "}",
        "{ 1 { 2 } }",
        "{{{{{{{{{{{{{{{{{{{{{{{{{{{{{{",
    ] {
        let bad = format!("{}{data}{}", &good[..start], &good[end..]);
        assert!(message(&bad).contains("x.xml"), "{data}");
    }
}

#[test]
fn a_model_the_format_cannot_say_is_refused_and_leaves_no_file() {
    let dir = tempfile::tempdir().unwrap();
    let path = dir.path().join("a.xml");
    let key = [(Side::Front, Component::Reflection)];
    let red = klems(KlemsBasis::quarter(), KlemsBasis::quarter(), &key, Channel::Red);
    assert!(write(&path, &red).unwrap_err().to_string().contains("channel"));
    let none = klems(
        KlemsBasis::quarter(),
        KlemsBasis::quarter(),
        &[],
        Channel::Photopic,
    );
    assert!(write(&path, &none).is_err());
    let mut mixed = FourComponents::default();
    mixed.set(Side::Front, Component::Reflection, Some(tree(Rank::Three, 0)));
    mixed.set(Side::Back, Component::Reflection, Some(tree(Rank::Four, 0)));
    let mixed = RadianceXml {
        material: Material::default(),
        model: Tabulated::TensorTree(TensorTree::new(Channel::Photopic, mixed)),
    };
    assert!(write(&path, &mixed).is_err());
    assert!(!path.exists());
}

proptest! {
    #[test]
    fn random_bytes_never_panic(bytes in proptest::collection::vec(any::<u8>(), 0..400)) {
        let _ = parse(&bytes, Channel::Photopic);
    }

    #[test]
    fn a_damaged_file_never_panics(at in 0usize..6000, with in any::<u8>(), cut in 0usize..6000) {
        let mut bytes = text(&trees(Rank::Three)).into_bytes();
        let n = bytes.len();
        bytes[at % n] = with;
        bytes.remove(cut % (n - 1));
        let _ = parse(&bytes, Channel::Photopic);
    }
}

/// The folder of real measurements, when it is there.
fn shared(file: &str) -> Option<PathBuf> {
    let root = std::env::var_os("GONIO_SHARED_DATA").map_or_else(
        || Path::new(env!("CARGO_MANIFEST_DIR")).join("../../../shared/data"),
        PathBuf::from,
    );
    let path = root.join(file);
    path.exists().then_some(path)
}

#[test]
fn window_files_have_four_components_and_conserve_energy() {
    let files = [
        "lbnl-wincalc/2011-SA1.XML",
        "lbnl-afc-shades/e-screen-5pct-white.xml",
        "lbnl-afc-shades/silverscreen-2pct-dark-gray.xml",
    ];
    for file in files {
        let Some(path) = shared(file) else { continue };
        for channel in [Channel::Photopic, Channel::Solar] {
            let xml = read(&path, channel).unwrap();
            assert_eq!(xml.model.components().len(), 4, "{file}");
            let Tabulated::Klems(k) = &xml.model else {
                panic!("matrices expected in {file}")
            };
            for theta in [0.0, 30.0, 60.0, 80.0, 120.0, 180.0] {
                let wi = Direction::from_degrees(theta, 20.0);
                let r = k.directional_albedo(wi, Component::Reflection);
                let t = k.directional_albedo(wi, Component::Transmission);
                assert!(r > 0.01 && t > 0.0 && r + t < 1.0, "{file} {theta}: {r} {t}");
            }
            // a shade lets light through unbent: the diagonal of the transmission stands out
            let m = k.matrix(Side::Front, Component::Transmission).unwrap();
            let wi = Direction::from_degrees(20.0, 45.0);
            let i = m.incident().patch(wi, Role::Incident);
            let strongest = (0..m.exit().len()).max_by(|a, b| m.value(*a, i).total_cmp(&m.value(*b, i)));
            assert_eq!(
                strongest,
                Some(m.exit().patch(wi.through(), Role::Exit)),
                "{file}"
            );
        }
    }
}

#[test]
fn files_that_radiance_wrote_are_read() {
    let Some(path) = shared("nist-ptfe-mountain/oracle_radiance_ptfe532_klems.xml") else {
        return;
    };
    let xml = read(&path, Channel::Photopic).unwrap();
    assert_eq!(xml.material.name, "NIST PTFE 532");
    assert_eq!(xml.model.components(), [(Side::Front, Component::Reflection)]);
    let Some(path) = shared("nist-ptfe-mountain/oracle_radiance_ptfe532_t3.xml") else {
        return;
    };
    let Tabulated::TensorTree(t) = read(&path, Channel::Photopic).unwrap().model else {
        panic!("a tree expected")
    };
    let t = t.tree(Side::Front, Component::Reflection).unwrap();
    assert_eq!((t.rank(), t.depth()), (Rank::Three, 4));
    assert!((t.albedo([0.3, 0.0]) - 1.0).abs() < 0.1);
}
