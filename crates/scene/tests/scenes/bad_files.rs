//! Damaged files beside a scene, functions without end, commands: refused with file and line.

use gonio_scene::cal::{Point, Program};
use gonio_scene::text::Files;
use gonio_trace::scene::Scene;

use super::bad_input::refusal;
use super::*;

#[test]
fn damaged_meshes_are_refused_with_their_file() {
    let ply = "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n\
               element face 1\nproperty list uchar int vertex_indices\nend_header\n";
    let good = format!("{ply}0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n");
    let cut = &good[..good.len() - 8];
    let beyond = format!("{ply}0 0 0\n1 0 0\n0 1 0\n3 0 1 3\n");
    let negative = format!("{ply}0 0 0\n1 0 0\n0 1 0\n3 0 1 -2\n");
    let two = format!("{ply}0 0 0\n1 0 0\n0 1 0\n2 0 1\n");
    let nan = format!("{ply}0 0 0\n1 nan 0\n0 1 0\n3 0 1 2\n");
    let many = good.replace("element vertex 3", "element vertex 4000000000");
    let binary = good
        .replace("ascii", "binary_little_endian")
        .replace("vertex 3", "vertex 4000000000");
    let flat = good
        .replace("property float z\n", "")
        .replace("0 0 0\n1 0 0\n0 1 0", "0 0\n1 0\n0 1");
    let solid = "solid a\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 x 0\nendloop\nendfacet\nendsolid\n";
    let mut short = vec![b' '; 80];
    short.extend(u32::MAX.to_le_bytes());
    short.extend([0; 60]);
    let short = String::from_utf8_lossy(&short).into_owned();
    let cases: [(&str, &str); 16] = [
        ("cut.ply", cut),
        ("beyond.ply", &beyond),
        ("negative.ply", &negative),
        ("two.ply", &two),
        ("nan.ply", &nan),
        ("many.ply", &many),
        ("binary.ply", &binary),
        ("flat.ply", &flat),
        ("none.ply", "x"),
        ("beyond.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 4\n"),
        ("before.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf -1 -2 -5\n"),
        ("zero.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 0 1 2\n"),
        ("words.obj", "v 0 0 zero\nv 1 0 0\nv 0 1 0\nf 1 2 3\n"),
        ("nan.obj", "v 0 0 nan\nv 1 0 0\nv 0 1 0\nf 1 2 3\n"),
        ("words.stl", solid),
        ("short.stl", &short),
    ];
    for (name, text) in cases {
        let e = refusal(&format!("{WHITE}white mesh m 1 {name} 0 0\n"), &[(name, text)]);
        assert!(e.starts_with(name), "{name}: {e}");
    }
    // Meshes again and again have a bound.
    let e = refusal(
        &format!("{WHITE}!xform -a 100000 -t 1 0 0 one.rad\n"),
        &[
            ("one.rad", "white mesh m 1 big.obj 0 0\n"),
            (
                "big.obj",
                &format!("v 0 0 0\nv 1 0 0\nv 0 1 0\n{}", "f 1 2 3\n".repeat(1000)),
            ),
        ],
    );
    assert!(e.starts_with("one.rad, line 1: surfaces: found"), "{e}");
}

#[test]
fn function_files_that_never_end_have_no_value_and_end() {
    let at = Point::default();
    for text in [
        "f(x) = f(x) + 1; v = f(1);",
        "v = w; w = v;",
        "f(x) = if(x, f(x - 1e-9), 0); v = f(1);",
        "f(x) = f(x - 1) + f(x - 2); v = f(1);",
        "f(g, x) = g(g, x); v = f(f, 1);",
        "fib(n) = if(n - 1.5, fib(n - 1) + fib(n - 2), 1); v = fib(60);",
    ] {
        let value = Program::parse(text, "a.cal").unwrap().expression("v").unwrap();
        for _ in 0..100 {
            let e = value.evaluate(&at, &[]).unwrap_err().to_string();
            assert!(e.starts_with("a.cal: an evaluation "), "{text}: {e}");
        }
        let scene = "void brightfunc p 2 v a.cal 0 0\np glow g 0 0 4 1 1 1 0\ng sphere s 0 0 4 0 0 0 1\n";
        let e = refusal(scene, &[("a.cal", text)]);
        assert!(
            e.starts_with("a.rad, line 1: function: found a.cal: an evaluation"),
            "{e}"
        );
    }
    for (text, wanted) in [
        ("v = 1/Pz;", 0.0),
        ("v = 1/(1 - 1) + 2;", 2.0),
        ("v = log(-1) + sqrt(-1) + 3;", 3.0),
        ("v = (-1)^.5 + exp(1e6) + 4;", 4.0),
        ("v = acos(2) + tan(1e300) * 0 + 5;", 5.0),
    ] {
        let program = Program::parse(text, "a.cal").unwrap();
        assert_eq!(
            program.expression("v").unwrap().evaluate(&at, &[]).unwrap(),
            wanted,
            "{text}"
        );
    }
    for (text, wanted) in [
        ("v = 1 +", "line 1"),
        ("\nv = (1;", "line 2"),
        ("v = {", "line 1"),
        ("v = 1 2;", "line 1"),
        ("= 3;", "line 1"),
        ("f(1) = 2;", "line 1"),
        ("v = $", "line 1"),
    ] {
        let e = Program::parse(text, "a.cal").err().unwrap().to_string();
        assert!(e.starts_with("a.cal, ") && e.contains(wanted), "{text}: {e}");
    }
    let nested = format!("v = {}1{};", "(".repeat(100_000), ")".repeat(100_000));
    assert!(Program::parse(&nested, "a.cal").is_err());
    let comments = "{".repeat(1_000_000);
    assert!(Program::parse(&comments, "a.cal").is_err());
}

#[test]
fn data_files_and_transforms_without_sense_are_refused() {
    let pattern =
        "void brightdata p 4 noop a.dat . Px 0 0\np glow g 0 0 4 1 1 1 0\ng sphere s 0 0 4 0 0 0 1\n";
    for (data, wanted) in [
        ("", "a.dat, line 1: dimensions"),
        ("1\n0 1 2\n1", "a.dat, line 3: values: found end of file"),
        ("1\n0 1 1000000000\n1", "a.dat, line 2: places"),
        ("4\n0 1 9999\n0 1 9999\n0 1 9999\n0 1 9999\n", "a.dat, line "),
        ("1\n0 1 2\n1 inf", "a.dat, line 3: values: found \"inf\""),
    ] {
        let e = refusal(pattern, &[("a.dat", data)]);
        assert!(e.starts_with(wanted), "{data}: {e}");
    }
    for transform in ["-s 0", "-s 1e-320", "-t 1 2", "-rx", "-q 3", "word"] {
        let n = 2 + transform.split(' ').count();
        let text = format!(
            "void brightfunc p {n} Px . {transform} 0 0\np glow g 0 0 4 1 1 1 0\ng sphere s 0 0 4 0 0 0 1\n"
        );
        let e = refusal(&text, &[]);
        assert!(e.starts_with("a.rad, line 1: transform"), "{transform}: {e}");
    }
}

#[test]
fn commands_are_never_run_and_their_bad_words_are_named() {
    for bad in [
        "!touch ran",
        "!xform one.rad > ran",
        "!genbox m n 1 1 1; touch ran",
        "!`touch ran`",
        "!xform $(touch ran)",
        "!genbox m n 1 1 1 | touch ran",
        "!gensky 6 21 12 && touch ran",
        "! ",
        "!|",
        "!xform 'one.rad",
        "!sh -c 'touch ran'",
    ] {
        let e = refusal(&format!("\n{bad}\n"), &[("one.rad", "")]);
        assert!(e.starts_with("a.rad, line 2: command: found"), "{bad}: {e}");
    }
    assert!(!std::path::Path::new("ran").exists());
    for bad in [
        "gensky",
        "gensky 13 1 12",
        "gensky -ang",
        "gensky -ang 1e999 0",
        "gensky 6 21 12 -a 91x",
        "gensky 6 21 12 -t nan",
        "gendaylit -ang 30 0 -P nan 1",
        "gendaylit -ang 30 0 -W inf 1",
        "genbox m n 1 1",
        "genbox m n 0 1 1",
        "genbox m n inf 1 1",
        "xform",
        "xform -t 1 2 one.rad",
        "xform none.rad",
    ] {
        let e = refusal(&format!("!{bad}\n"), &[("one.rad", "")]);
        assert!(e.starts_with("a.rad, line 1: "), "{bad}: {e}");
    }
}

/// Pieces from which scenes are made that are nearly right.
const PIECES: [&str; 24] = [
    "void plastic m 0 0 5 .5 .5 .5 .1 .1\n",
    "void metal2 m 4 0 0 1 . 0 6 .5 .5 .5 .5 .1 .2\n",
    "void glass m 0 0 3 .9 .9 .9\n",
    "void light m 0 0 3 1 1 1\n",
    "void glow m 0 0 4 1 1 1 0\n",
    "void illum m 1 void 0 3 1 1 1\n",
    "void spotlight m 0 0 7 1 1 1 30 0 0 -1\n",
    "void brightfunc p 2 Px*Py . 0 0\n",
    "void colorfunc p 6 Px 1/Py sqrt(Pz) . -rz 30 0 0\n",
    "void texfunc p 4 Px Py 0 . 0 0\n",
    "void mixfunc m 4 p m .5 . 0 0\n",
    "p alias m m\n",
    "inherit alias p m\n",
    "m polygon a 0 0 9 0 0 0 1 0 0 0 1 0\n",
    "m polygon a 0 0 12 0 0 0 1 0 0 1 1 .1 0 1 0\n",
    "m sphere a 0 0 4 0 0 0 1\n",
    "m ring a 0 0 8 0 0 0 0 0 1 0 1\n",
    "m cone a 0 0 8 0 0 0 0 0 1 1 .5\n",
    "m source a 0 0 4 0 0 1 180\n",
    "!genbox m b 1 2 3 | xform -a 3 -t 1 1 1 -rx 30\n",
    "!genbox m b 1 2 3 -i\n",
    "!gensky 6 21 12 +s\n",
    "skyfunc glow m 0 0 4 1 1 1 0\n",
    "!gendaylit -ang 40 30 -W 500 100\n",
];

proptest::proptest! {
    #![proptest_config(proptest::prelude::ProptestConfig::with_cases(256))]

    #[test]
    fn scenes_that_are_nearly_right_give_a_scene_that_traces_or_an_error(
        picks in proptest::collection::vec(0..PIECES.len(), 1..8),
        number in 0_usize..200,
        value in proptest::prelude::any::<f64>(),
        cut in proptest::option::of(0_usize..400),
    ) {
        let mut text: String = picks.iter().map(|k| PIECES[*k]).collect();
        // One number becomes another.
        let words: Vec<&str> = text.split(' ').collect();
        let k = number % words.len();
        if words[k].parse::<f64>().is_ok() {
            let mut words: Vec<String> = words.iter().map(|w| (*w).to_owned()).collect();
            words[k] = value.to_string();
            text = words.join(" ");
        }
        if let Some(cut) = cut {
            text.truncate(cut.min(text.len()));
        }
        let files = Files::default();
        if let Ok(entries) = gonio_scene::text::read_from("a.rad".as_ref(), text.as_bytes(), &files)
            && let Ok(loaded) = gonio_scene::assemble::assemble(entries, &files)
        {
            let scene = Scene::new(loaded.parts).unwrap();
            let limits = Limits::default();
            for index in 0..4 {
                let mut sampler = Sampler::new(3, 0, index);
                let (from, along) = (glam::Vec3::new(0.2, 0.3, 4.0), glam::Vec3::new(0.01, 0.02, -1.0));
                let found = scene.radiance(from, along.normalize(), &limits, &mut sampler);
                proptest::prop_assert!(found.is_finite() && found.min_element() >= 0.0, "{} {}", found, text);
            }
        }
    }

    #[test]
    fn formulas_are_read_and_have_a_finite_value_or_an_error(
        picks in proptest::collection::vec(0..TOKENS.len(), 0..40),
        numbers in proptest::collection::vec(proptest::prelude::any::<f64>(), 3),
    ) {
        let text = picks.iter().map(|k| TOKENS[*k]).collect::<Vec<_>>().join(" ");
        if let Ok(program) = Program::parse(&text, "a.cal") {
            for wanted in ["v", "w", "f(1, v)", "Dx + noise3(Px, Py, Pz)"] {
                if let Ok(value) = program.expression(wanted)
                    && let Ok(x) = value.evaluate(&Point::default(), &numbers)
                {
                    proptest::prop_assert!(x.is_finite(), "{} {}", text, x);
                }
            }
        }
        let _ = Program::parse("", "a.cal").unwrap().expression(&text);
    }
}

/// Words of function files.
const TOKENS: [&str; 40] = [
    "v =",
    "w =",
    "v :",
    "f(x, y) =",
    ";",
    ";",
    ";",
    "+",
    "-",
    "*",
    "/",
    "^",
    "(",
    ")",
    ",",
    "1",
    ".5",
    "-2",
    "1e300",
    "0",
    "v",
    "w",
    "x",
    "y",
    "f(v, 1)",
    "f(x, y)",
    "if(v, x, 1)",
    "select(v, 1, w)",
    "A1",
    "arg(v)",
    "noise3(x, y, 1e18)",
    "fnoise3(1e300, v, w)",
    "acos(v)",
    "atan2(v, w)",
    "Px",
    "Dz",
    "{ note }",
    "$1 =",
    "`v",
    "rand(v)",
];
