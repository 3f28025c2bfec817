use std::path::Path;

use gonio_bsdf::RadianceMaterial;
use gonio_bsdf::radiance::Plastic;
use proptest::prelude::*;

use super::*;
use crate::IoError;

fn parse(text: &str) -> Result<Vec<Item>, IoError> {
    read_from(Path::new("a.rad"), text.as_bytes())
}

fn refusal(text: &str) -> String {
    parse(text).unwrap_err().to_string()
}

fn named(text: &str) -> Result<Vec<NamedMaterial>, IoError> {
    materials(Path::new("a.rad"), &parse(text)?)
}

const PANEL: &str = "# a library\nvoid plastic white_paint\n0\n0\n5 .8 .8 .8\n  .02 # spec\n  .1\n\
    void metal2 brushed\n4 1 0 0 .\n0\n6 .7 .6 .5 .9 .05 .2\n";

#[test]
fn items_of_a_file_come_in_order_with_names_and_lines() {
    let items = parse(PANEL).unwrap();
    let heads: Vec<_> = items
        .iter()
        .map(|i| (i.id.as_str(), i.line, i.modifier.as_str()))
        .collect();
    assert_eq!(heads, [("white_paint", 2, "void"), ("brushed", 8, "void")]);
    assert_eq!(
        items[0].body,
        Body::Material(Plastic::new([0.8; 3], 0.02, 0.1).unwrap().into())
    );
}

#[test]
fn a_command_is_refused_with_its_line_and_not_run() {
    let dir = tempfile::tempdir().unwrap();
    let mark = dir.path().join("ran");
    let file = dir.path().join("a.rad");
    std::fs::write(&file, format!("\n# x\n  !touch {}\n", mark.display())).unwrap();
    let e = read(&file).unwrap_err().to_string();
    assert!(
        e.starts_with(&format!("{}, line 3: command: found \"!touch ", file.display())),
        "{e}"
    );
    assert!(e.ends_with("commands are not run; run it yourself and read what it prints"));
    assert!(!mark.exists());
}

#[test]
fn faults_name_file_line_field_and_what_is_allowed() {
    assert_eq!(
        refusal("void plastic a 0 0 5 .8 .8 .8\n.02\n1.5\n"),
        "a.rad, line 3: rough: found 1.5, allowed 0 to 1"
    );
    assert_eq!(
        refusal("\nvoid plastic a 0 0 4 .8 .8 .8 .02"),
        "a.rad, line 2: real arguments: found 4, allowed 5: red green blue spec rough"
    );
    assert_eq!(
        refusal("void plastic a\n0\n0\n5 .8 .8 .8"),
        "a.rad, line 4: real arguments: found end of file, allowed as many finite numbers as counted"
    );
    assert_eq!(
        refusal("void plastic a\n0\n0\n5 .8 .8 .8 none .1"),
        "a.rad, line 4: real arguments: found \"none\", allowed as many finite numbers as counted"
    );
    assert_eq!(
        refusal("void plastic a 0 0 5 .8 .8 .8 nan .1"),
        "a.rad, line 1: real arguments: found NaN, allowed as many finite numbers as counted"
    );
    assert_eq!(
        refusal("void plastic a\n0\n-1"),
        "a.rad, line 3: integer arguments: found \"-1\", allowed the number of arguments that follow"
    );
    assert_eq!(
        refusal("void plastic a 0 1 3 5 .8 .8 .8 0 .1"),
        "a.rad, line 1: integer arguments: found 1, allowed 0"
    );
    assert!(refusal("void plastik a 0 0 0").starts_with(
        "a.rad, line 1: type: found \"plastik\", allowed a type of RADIANCE, \"plastic\" perhaps"
    ));
    assert_eq!(
        refusal("void"),
        "a.rad, line 1: type: found end of file, allowed modifier type id and three argument lists"
    );
    let e = read_from(Path::new("a.rad"), b"void plastic a\xff 0 0 5 1 1 1 0 0").unwrap_err();
    assert_eq!(
        e.to_string(),
        r#"a.rad, line 1: id: found "a\xff", allowed UTF-8 text"#
    );
    assert!(matches!(
        read(Path::new("no such file.rad")),
        Err(IoError::File { .. })
    ));
}

#[test]
fn an_absurd_count_ends_at_the_end_of_the_file() {
    assert!(refusal("void plastic a 18446744073709551615 x").contains("end of file"));
    assert!(refusal("void plastic a 18446744073709551616 x").contains("the number of arguments that follow"));
}

#[test]
fn comments_in_any_encoding_and_windows_line_ends_are_passed_over() {
    let text = b"\xef\xbb\xbf# gl\xe4nzend\r\nvoid mirror m\r\n0\r\n0\r\n3 .9 .9 .9\r\n# \xff";
    let items = read_from(Path::new("a.rad"), text).unwrap();
    assert_eq!((items.len(), items[0].line), (1, 2));
}

#[test]
fn types_without_a_model_are_kept_and_their_aliases_are_no_materials() {
    let text = "void light sun 0 0 3 1 1 1\nsun source s 0 0 4 0 0 1 .5\nvoid alias lamp sun\n\
        void glass g 0 0 3 .9 .9 .9\n";
    assert_eq!(parse(text).unwrap().len(), 4);
    let found = named(text).unwrap();
    assert_eq!(found.iter().map(|m| m.id.as_str()).collect::<Vec<_>>(), ["g"]);
}

#[test]
fn an_alias_is_the_material_it_names_under_its_own_modifier_or_the_inherited_one() {
    let found = named(
        "void brightfunc grain 2 grain wood.cal 0 0\ngrain plastic a 0 0 5 .1 .1 .1 0 0\n\
         void alias b a\ninherit alias c a\nvoid plastic a 0 0 5 .2 .2 .2 0 0\nvoid alias d a\n",
    )
    .unwrap();
    let rows: Vec<_> = found
        .iter()
        .map(|m| (m.id.as_str(), m.modifier.as_str(), m.material.reals()[0], m.line))
        .collect();
    assert_eq!(
        rows,
        [
            ("a", "grain", 0.1, 2),
            ("b", "void", 0.1, 3),
            ("c", "grain", 0.1, 4),
            ("a", "void", 0.2, 5),
            ("d", "void", 0.2, 6),
        ]
    );
    assert_eq!(
        named("void alias b a").unwrap_err().to_string(),
        "a.rad, line 1: alias: found \"a\", allowed the name of an item above it"
    );
}

#[test]
fn the_writer_gives_the_listing_of_the_manual() {
    let item = Item::material("paint", Plastic::new([0.5, 0.4, 0.3], 0.05, 1e-5).unwrap());
    let text = to_text(&[item], &["fitted".into()]).unwrap();
    assert_eq!(
        text,
        "# fitted\n\nvoid plastic paint\n0\n0\n5 0.5 0.4 0.3 0.05 1e-5\n"
    );
}

#[test]
fn the_writer_refuses_what_the_reader_would() {
    let mut bad = Plastic::new([0.5; 3], 0.05, 0.1).unwrap();
    bad.specularity = f64::NAN;
    let e = to_text(&[Item::material("a", bad)], &[]).unwrap_err();
    assert_eq!(e.to_string(), "spec: found NaN, allowed 0 to 1");
    let good = Plastic::new([0.5; 3], 0.05, 0.1).unwrap();
    for id in ["", "a\tb", "a\nb"] {
        let e = to_text(&[Item::material(id, good.clone())], &[]).unwrap_err();
        assert!(e.to_string().starts_with("id: found"), "{e}");
    }
    for type_word in ["wood", "plastic"] {
        let item = Item {
            body: Body::Other {
                type_word: type_word.into(),
                strings: vec![],
                integers: vec![],
                reals: vec![],
            },
            ..Item::material("a", good.clone())
        };
        assert!(to_text(&[item], &[]).is_err());
    }
}

#[test]
fn a_refused_write_leaves_the_old_file() {
    let dir = tempfile::tempdir().unwrap();
    let path = dir.path().join("a.rad");
    let good = Plastic::new([0.5; 3], 0.05, 0.1).unwrap();
    write(&path, &[Item::material("a", good.clone())], &[]).unwrap();
    let before = std::fs::read(&path).unwrap();
    let e = write(&path, &[Item::material("", good)], &[]).unwrap_err();
    assert_eq!(
        e.to_string(),
        format!(
            "{}: id: found \"\", allowed a name without tabs and line ends",
            path.display()
        )
    );
    assert_eq!(std::fs::read(&path).unwrap(), before);
}

/// Reals of `type_word` inside their ranges, ends included.
fn reals_of(type_word: &'static str) -> BoxedStrategy<Vec<f64>> {
    let all = RadianceMaterial::arguments_of(type_word).unwrap();
    let each: Vec<_> = all
        .iter()
        .map(|a| prop_oneof![4 => a.low..=a.high, 1 => Just(a.low), 1 => Just(a.high)])
        .collect();
    each.boxed()
}

fn names() -> impl Strategy<Value = String> {
    prop_oneof![
        "[A-Za-z_][A-Za-z0-9_.-]{0,8}",
        "[ #!'\"a-zäß]{1,8}",
        Just("#not a comment".to_owned()),
        Just("!not a command".to_owned()),
    ]
}

fn bodies() -> impl Strategy<Value = Body> {
    let material = (0..RadianceMaterial::TYPES.len())
        .prop_flat_map(|k| {
            let word = RadianceMaterial::TYPES[k];
            (
                Just(word),
                reals_of(word),
                proptest::collection::vec(names(), 0..3),
            )
        })
        .prop_filter_map("parameters that exclude each other", |(word, reals, more)| {
            let strings = match word {
                "plastic2" | "metal2" | "trans2" | "ashik2" => {
                    [vec!["1".into(), "0".into(), "-.5".into(), ".".into()], more].concat()
                }
                "mirror" => more.into_iter().take(1).collect(),
                _ => vec![],
            };
            RadianceMaterial::from_arguments(word, &strings, &reals)?.ok()
        })
        .prop_map(Body::Material);
    let other = (
        0..OTHER_TYPES.len(),
        proptest::collection::vec("[ \t\n#!'\"a-zäß]{0,8}", 0..4),
        proptest::collection::vec(any::<i64>(), 0..3),
        proptest::collection::vec(proptest::num::f64::NORMAL | proptest::num::f64::ZERO, 0..20),
    )
        .prop_map(|(k, strings, integers, reals)| Body::Other {
            type_word: OTHER_TYPES[k].into(),
            strings,
            integers,
            reals,
        });
    prop_oneof![6 => material, 1 => other, 1 => names().prop_map(Body::Alias)]
}

fn items() -> impl Strategy<Value = Vec<Item>> {
    let item = (names(), names(), bodies()).prop_map(|(modifier, id, body)| Item {
        modifier,
        id,
        body,
        line: 0,
    });
    proptest::collection::vec(item, 0..5)
}

fn without_lines(items: Vec<Item>) -> Vec<Item> {
    items.into_iter().map(|i| Item { line: 0, ..i }).collect()
}

proptest! {
    #[test]
    fn what_is_written_reads_back_the_same(items in items(), comment in "\\PC{0,20}") {
        let text = to_text(&items, &[comment]).unwrap();
        prop_assert_eq!(without_lines(parse(&text).unwrap()), items);
    }

    #[test]
    fn the_layout_does_not_matter(reals in reals_of("trans"), gaps in proptest::collection::vec("[ \t\r\n]{1,3}", 13)) {
        let words = ["void", "trans", "t", "0", "0", "7"].map(String::from);
        let text: String = words
            .into_iter()
            .chain(reals.iter().map(f64::to_string))
            .zip(&gaps)
            .map(|(w, g)| w + g)
            .collect();
        let expected = RadianceMaterial::from_arguments("trans", &[], &reals).unwrap().unwrap();
        let items = parse(&text).unwrap();
        prop_assert_eq!(&items[0].body, &Body::Material(expected));
    }

    #[test]
    fn no_text_makes_the_reader_panic(bytes in proptest::collection::vec(any::<u8>(), 0..200), cut in 0_usize..150) {
        let path = Path::new("a.rad");
        let _ = read_from(path, &bytes);
        let mut damaged = PANEL.as_bytes().to_vec();
        damaged.splice(cut.min(damaged.len())..(cut + 3).min(damaged.len()), bytes.iter().copied().take(3));
        if let Ok(items) = read_from(path, &damaged) {
            let _ = materials(path, &items);
        }
    }
}
