//! Damaged, absurd and hostile scenes: one clear error with file and line, or a warning where RADIANCE warns.

use super::*;

/// The error of a scene with files beside it.
#[track_caller]
pub(crate) fn refusal(text: &str, more: &[(&str, &str)]) -> String {
    match load_with(text, more) {
        Ok(_) => panic!("read: {text}"),
        Err(e) => e,
    }
}

/// Cases of a scene and how its error begins.
#[track_caller]
fn all_refused(cases: &[(&str, &str)], more: &[(&str, &str)]) {
    for (text, wanted) in cases {
        let e = refusal(text, more);
        assert!(e.starts_with(wanted), "{text}: {e}");
    }
}

#[test]
fn items_that_radiance_does_not_have_or_that_end_too_soon_are_refused() {
    all_refused(
        &[
            (
                "void plastic a 0 0 5 1 1 1 0 0\n\na polyhedron b 0 0 0",
                "a.rad, line 3: type: found \"polyhedron\", allowed a type of RADIANCE",
            ),
            ("void", "a.rad, line 1: type: found end of file"),
            ("void glow", "a.rad, line 1: id: found end of file"),
            (
                "\nvoid polygon p 0 0 9 0 0",
                "a.rad, line 2: real arguments: found end of file",
            ),
            (
                "void polygon p 0 0 nine",
                "a.rad, line 1: real arguments: found \"nine\"",
            ),
            (
                "void polygon p 0 0 18446744073709551615 0",
                "a.rad, line 1: real arguments: found end of file",
            ),
            (
                "void polygon p -1 0 0",
                "a.rad, line 1: string arguments: found \"-1\"",
            ),
            ("void alias", "a.rad, line 1: id: found end of file"),
            (
                "white sphere s 0 0 4 0 0 0 1",
                "a.rad, line 1: modifier: found \"white\"",
            ),
        ],
        &[],
    );
}

#[test]
fn wrong_numbers_of_arguments_are_refused_for_every_type() {
    for (item, given) in [
        ("plastic m", "4 1 1 1 0"),
        ("metal m", "3 1 1 1"),
        ("trans m", "5 1 1 1 0 0"),
        ("glass m", "2 1 1"),
        ("dielectric m", "3 1 1 1"),
        ("mirror m", "1 1"),
        ("light m", "2 1 1"),
        ("glow m", "3 1 1 1"),
        ("spotlight m", "4 1 1 1 20"),
        ("illum m", "0"),
        ("sphere m", "3 0 0 0"),
        ("bubble m", "5 0 0 0 1 1"),
        ("cylinder m", "6 0 0 0 0 0 1"),
        ("tube m", "8 0 0 0 0 0 1 1 1"),
        ("cone m", "7 0 0 0 0 0 1 1"),
        ("cup m", "0"),
        ("ring m", "7 0 0 0 0 0 1 0"),
        ("source m", "3 0 0 1"),
        ("polygon m", "6 0 0 0 1 0 0"),
        ("polygon m", "10 0 0 0 1 0 0 0 1 0 0"),
    ] {
        let text = format!("\nvoid {item} 0 0 {given}\nm sphere used 0 0 4 0 0 0 1\n");
        let e = refusal(&text, &[]);
        let (place, found) = (
            e.starts_with("a.rad, line 2: real arguments: found "),
            &given[..1],
        );
        assert!(
            place && e.contains(&format!("found {found}")),
            "{item} {given}: {e}"
        );
    }
    for (item, strings) in [
        ("metal2 m", "3 0 0 1 0 6 1 1 1 0 .1 .2"),
        ("BSDF m", "2 0 x.xml 0 0"),
        ("brightfunc m", "1 A 0 0"),
        ("colorfunc m", "3 A B C 0 0"),
        ("brightdata m", "2 A B 0 0"),
        ("mesh m", "0 0 0"),
    ] {
        let text = format!("void {item} {strings}\nm glow g 0 0 4 1 1 1 0\ng sphere used 0 0 4 0 0 0 1\n");
        let e = refusal(&text, &[]);
        assert!(e.starts_with("a.rad, line 1: "), "{item}: {e}");
    }
}

#[test]
fn coordinates_that_are_no_place_are_refused() {
    for bad in ["nan", "inf", "-inf", "NaN", "infinity", "1e400", "-1e10", "1e39"] {
        for text in [
            format!("void polygon p 0 0 9 0 0 0 1 0 0 0 {bad} 0"),
            format!("void sphere s 0 0 4 {bad} 0 0 1"),
            format!("void sphere s 0 0 4 0 0 0 {bad}"),
            format!("void cylinder c 0 0 7 0 0 0 0 0 {bad} 1"),
            format!("void cone c 0 0 8 0 0 0 0 0 1 1 {bad}"),
            format!("void ring r 0 0 8 0 0 {bad} 0 0 1 0 1"),
        ] {
            // A sphere of radius -1e10 is too large as well as inside out.
            let e = refusal(&text, &[]);
            assert!(e.starts_with("a.rad, line 1: "), "{text}: {e}");
        }
    }
    all_refused(
        &[
            (
                "!xform -s 1e300 -s 1e300 b.rad",
                "a.rad, line 1: xform: found -s 1e300 -s 1e300",
            ),
            ("!xform -t nan 0 0 b.rad", "a.rad, line 1: xform: found -t nan"),
            (
                "!xform -t 1e12 0 0 b.rad",
                "b.rad, line 1: coordinates: found 1000000000001",
            ),
        ],
        &[("b.rad", "void polygon p 0 0 9 1 0 0 2 0 0 0 1 0")],
    );
}

#[test]
fn surfaces_without_extent_are_refused_or_left_out_with_a_warning() {
    all_refused(
        &[
            ("void sphere s 0 0 4 0 0 0 0", "a.rad, line 1: radius"),
            ("void sphere s 0 0 4 0 0 0 1e-40", "a.rad, line 1: radius"),
            ("void cylinder c 0 0 7 1 1 1 1 1 1 1", "a.rad, line 1: ends"),
            ("void cylinder c 0 0 7 0 0 0 0 0 1e-30 1", "a.rad, line 1: ends"),
            ("void cylinder c 0 0 7 0 0 0 0 0 1 0", "a.rad, line 1: radius"),
            ("void cone c 0 0 8 0 0 0 0 0 1 0 0", "a.rad, line 1: radius"),
            ("void cone c 0 0 8 0 0 0 0 0 1 1 -1", "a.rad, line 1: radius"),
            ("void ring r 0 0 8 0 0 0 0 0 0 0 1", "a.rad, line 1: normal"),
            ("void ring r 0 0 8 0 0 0 0 0 1 1 1", "a.rad, line 1: radii"),
            ("void ring r 0 0 8 0 0 0 0 0 1 -1 1", "a.rad, line 1: radii"),
            ("void source s 0 0 4 0 0 0 10", "a.rad, line 1: direction"),
            (
                "void light l 0 0 3 1 1 1\nl source s 0 0 4 0 0 1 0",
                "a.rad, line 2: angle",
            ),
            (
                "void light l 0 0 3 1 1 1\nl source s 0 0 4 0 0 1 361",
                "a.rad, line 2: angle",
            ),
        ],
        &[],
    );
    for corners in [
        "9 0 0 0 1 1 1 2 2 2",
        "9 1 1 1 1 1 1 1 1 1",
        "12 0 0 0 1 0 0 0 0 0 1 0 0",
    ] {
        for modifier in ["white", "lamp"] {
            let loaded = load(&format!(
                "{WHITE}void light lamp 0 0 3 1 1 1\n{modifier} polygon p 0 0 {corners}\n"
            ));
            let loaded = loaded.unwrap();
            assert_eq!(loaded.parts.triangles.len(), 0);
            let warning = loaded.warnings[0].to_string();
            assert!(
                warning.contains("a.rad, line 3: polygon without area"),
                "{warning}"
            );
        }
    }
}

#[test]
fn files_and_scenes_within_themselves_end_at_once() {
    let deep: Vec<(String, String)> = (0..40)
        .map(|k| (format!("d{k}.rad"), format!("!xform d{}.rad\n", k + 1)))
        .collect();
    let mut files: Vec<(&str, &str)> = deep.iter().map(|(n, t)| (n.as_str(), t.as_str())).collect();
    files.extend([
        ("loop.rad", "\n!xform b.rad"),
        ("b.rad", "!xform loop.rad"),
        ("self.txt", "-t 0 0 1 -f self.txt"),
        (
            "two.txt",
            "-f two.txt\n-f two.txt\n-f two.txt\n-f two.txt\n-f two.txt\n-f two.txt\n-f two.txt\n",
        ),
    ]);
    all_refused(
        &[
            (
                "!xform a.rad",
                "a.rad, line 1: file: found \"a.rad\", allowed a file that does not include itself",
            ),
            ("!xform loop.rad", "b.rad, line 1: file: found \"loop.rad\""),
            (
                "!xform d0.rad",
                "d30.rad, line 1: file: found \"d31.rad\", allowed at most 32 files",
            ),
            (
                "!xform -f self.txt a.rad",
                "a.rad, line 1: xform: found -f \"self.txt\"",
            ),
            (
                "!xform -f two.txt a.rad",
                "a.rad, line 1: xform: found -f \"two.txt\"",
            ),
            (
                "void instance i 1 a.oct 0 0",
                "a.rad, line 1: instance: found \"a.oct\"",
            ),
            ("void mesh i 1 a.rad 0 0", "a.rad, line 1: mesh: found \"a.rad\""),
        ],
        &files,
    );
}

#[test]
fn arrays_beyond_memory_are_refused_before_they_are_made() {
    let one = (
        "one.rad",
        "void sphere s 0 0 4 0 0 0 1\nvoid sphere t 0 0 4 0 0 0 1\n",
    );
    all_refused(
        &[
            (
                "!xform -a 1000000000 -t 1 0 0 one.rad",
                "a.rad, line 1: command: found 1000000000 items",
            ),
            (
                "!xform -a 1000000 -t 1 0 0 -a 1000000 -t 0 1 0 one.rad",
                "a.rad, line 1: command: found 1000000000000 items",
            ),
            (
                "!xform -a 1000000 -a 4 -t 0 1 0 one.rad",
                "a.rad, line 1: command: found 8000000 items",
            ),
            ("!xform -a 0 -t 1 0 0 one.rad", "a.rad, line 1: xform: found -a 0"),
            ("!xform -a -5 one.rad", "a.rad, line 1: xform: found -a -5"),
            (
                "!xform -a 99999999999999999999999 one.rad",
                "a.rad, line 1: xform: found -a 9",
            ),
            (
                "!xform -i 1e9 -t 1 0 0 one.rad",
                "a.rad, line 1: xform: found -i 1e9",
            ),
            (
                "!xform -a 2 -a 2 -a 2 -a 2 -a 2 -a 2 -a 2 -a 2 -a 2 one.rad",
                "a.rad, line 1: xform: found -a 2, allowed -a and how many copies, 1 to 1048576, 8 deep",
            ),
        ],
        &[one],
    );
    // Copies of copies, each within its bound.
    let files = [
        one,
        ("b.rad", "!xform -a 2000 one.rad\n"),
        ("c.rad", "!xform -a 2000 b.rad\n"),
    ];
    let e = refusal("!xform c.rad\n", &files);
    assert!(
        e.starts_with("c.rad, line 1: command: found 8000000 items"),
        "{e}"
    );
}

#[test]
fn materials_that_are_not_there_or_emit_where_they_may_not_are_refused() {
    all_refused(
        &[
            (
                "void BSDF m 6 0 none.xml 0 0 1 . 0 0\nm sphere s 0 0 4 0 0 0 1",
                "a.rad, line 1: file: found \"none.xml\", which is not there",
            ),
            (
                "void BSDF m 6 0 text.xml 0 0 1 . 0 0\nm sphere s 0 0 4 0 0 0 1",
                "a.rad, line 1: BSDF: found \"text.xml\", allowed a file with scattering data",
            ),
            (
                "void BSDF m 6 0 text.xml x 0 1 . 0 0\nm sphere s 0 0 4 0 0 0 1",
                "a.rad, line 1: function: found ., line 1: `x` is not a variable",
            ),
            (
                "void metal2 m 4 0 0 0 . 0 6 1 1 1 .5 .1 .2\nm sphere s 0 0 4 0 0 0 1",
                "a.rad, line 1: ux uy uz: found 0 0 0",
            ),
            (
                "void illum l 1 none 0 3 1 1 1\nl sphere s 0 0 4 0 0 0 1",
                "a.rad, line 1: alternate material",
            ),
            (
                "void light a 0 0 3 1 1 1\nvoid illum l 1 a 0 3 1 1 1\nl sphere s 0 0 4 0 0 0 1",
                "a.rad, line 1: alternate material: found a light",
            ),
            (
                "void light l 0 0 3 1 1 1e30\nl sphere s 0 0 4 0 0 0 1",
                "a.rad, line 1: red green blue: found 1000",
            ),
            (
                "void spotlight l 0 0 7 1 1 1 20 0 0 0\nl sphere s 0 0 4 0 0 0 1",
                "a.rad, line 1: direction",
            ),
            (
                "void plastic p 0 0 5 1.5 0 0 0 0\np sphere s 0 0 4 0 0 0 1",
                "a.rad, line 1: red",
            ),
        ],
        &[("text.xml", "no xml at all")],
    );
    let chain: String = (0..70)
        .map(|k| format!("p{k} brightfunc p{} 2 1 . 0 0\n", k + 1))
        .collect();
    let text =
        format!("void brightfunc p0 2 1 . 0 0\n{chain}p70 glow g 0 0 4 1 1 1 0\ng sphere s 0 0 4 0 0 0 1\n");
    let e = refusal(&text, &[]);
    assert!(e.contains("at most 64 behind a surface"), "{e}");
}
