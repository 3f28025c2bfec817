//! Geometry, files, commands, names and errors.

use glam::Vec3;
use gonio_scene::read;
use gonio_trace::shape::Shape;
use std::path::PathBuf;

use crate::{WHITE, close, load, load_with, look, parts};

#[test]
fn every_primitive_becomes_its_shape() {
    let p = parts(&format!(
        "{WHITE}white polygon a 0 0 9 0 0 0 1 0 0 0 1 0\nwhite sphere b 0 0 4 0 0 0 1\nwhite bubble c 0 0 4 0 0 0 2\n\
         white cylinder d 0 0 7 0 0 0 0 0 1 .5\nwhite tube e 0 0 7 0 0 0 0 0 1 .5\nwhite cone f 0 0 8 0 0 0 0 0 1 .5 0\n\
         white cup g 0 0 8 0 0 0 0 0 1 .5 .2\nwhite ring h 0 0 8 0 0 0 0 0 2 .5 .2\n"
    ));
    assert_eq!(
        (p.triangles.len(), p.surfaces.len(), p.materials.len()),
        (1, 1, 1)
    );
    let shapes: Vec<Shape> = p.shapes.iter().map(|s| s.0).collect();
    let cone = |radii, inward| Shape::Cone {
        from: Vec3::ZERO,
        to: Vec3::Z,
        radii,
        inward,
    };
    let sphere = |radius, inward| Shape::Sphere {
        centre: Vec3::ZERO,
        radius,
        inward,
    };
    let wanted = [
        sphere(1.0, false),
        sphere(2.0, true),
        cone([0.5, 0.5], false),
        cone([0.5, 0.5], true),
        cone([0.5, 0.0], false),
        cone([0.5, 0.2], true),
        Shape::Ring {
            centre: Vec3::ZERO,
            normal: Vec3::Z,
            radii: [0.2, 0.5],
        },
    ];
    assert_eq!(shapes, wanted);
}

#[test]
fn xform_moves_turns_copies_and_renames_what_a_file_holds() {
    let one = "void plastic red 0 0 5 .5 0 0 0 0\nred sphere s 0 0 4 1 0 0 .5\n";
    let main = format!("{WHITE}!xform -n copy -m white -a 2 -t 0 0 10 -a 3 -rz 90 -i 1 -s 2 one.rad\n");
    let loaded = load_with(&main, &[("one.rad", one)]).unwrap();
    let centres: Vec<Vec3> = loaded
        .parts
        .shapes
        .iter()
        .map(|(s, _)| match s {
            Shape::Sphere { centre, radius, .. } if *radius == 1.0 => *centre,
            other => panic!("{other:?}"),
        })
        .collect();
    let wanted = [
        [2., 0., 0.],
        [0., 2., 0.],
        [-2., 0., 0.],
        [2., 0., 20.],
        [0., 2., 20.],
        [-2., 0., 20.],
    ];
    assert_eq!(centres.len(), wanted.len());
    for w in wanted {
        assert!(
            centres.iter().any(|c| c.distance(Vec3::from(w)) < 1e-5),
            "{w:?} {centres:?}"
        );
    }
}

#[test]
fn a_mirrored_box_keeps_its_front_outside_and_an_inverted_one_turns_it_in() {
    let volume = |text: &str| {
        let p = parts(&format!("{WHITE}{text}\n"));
        assert_eq!(p.triangles.len(), 12);
        let each = p.triangles.iter().map(|t| {
            let [a, b, c] = t.map(|k| Vec3::from(p.vertices[k as usize]));
            a.dot(b.cross(c)) / 6.0
        });
        each.sum::<f32>()
    };
    assert!((volume("!genbox white b 1 2 3") - 6.0).abs() < 1e-4);
    assert!((volume("!genbox white b 1 2 3 | xform -mx -ry 20 -s 2") - 48.0).abs() < 1e-3);
    assert!((volume("!genbox white b 1 2 3 -i | xform -t 5 5 5") + 6.0).abs() < 1e-3);
    assert!((volume("!genbox white b 1 2 3 \\\n | xform -I -t 5 5 5") + 6.0).abs() < 1e-3);
}

#[test]
fn files_are_found_beside_the_file_that_names_them_and_along_the_search_list() {
    let dir = tempfile::tempdir().unwrap();
    let (a, b) = (dir.path().join("a"), dir.path().join("b"));
    std::fs::create_dir_all(a.join("in")).unwrap();
    std::fs::create_dir_all(&b).unwrap();
    std::fs::write(a.join("main.rad"), "!xform in/one.rad\n").unwrap();
    std::fs::write(a.join("in/one.rad"), "!xform two.rad\n!xform three.rad\n").unwrap();
    std::fs::write(a.join("in/two.rad"), WHITE).unwrap();
    // What stands above in the whole scene is known in a file that is included.
    std::fs::write(b.join("three.rad"), "white sphere s 0 0 4 0 0 0 1\n").unwrap();
    assert_eq!(read(&[a.join("main.rad")], &[b]).unwrap().parts.shapes.len(), 1);
    let e = read(&[a.join("main.rad")], &[]).err().unwrap().to_string();
    assert!(e.contains("one.rad, line 2: file: found \"three.rad\""), "{e}");
}

#[test]
fn bad_scenes_are_refused_with_file_and_line() {
    for (text, wanted) in [
        ("\nvoid wood a 0 0 0", "a.rad, line 2: type: found \"wood\""),
        (
            "void plastic a 0 0 4 1 1 1 0",
            "a.rad, line 1: real arguments: found 4, allowed 5",
        ),
        (
            "\n\nwhite polygon a 0 0 9 0 0 0 1 0 0 0 1 0",
            "a.rad, line 3: modifier: found \"white\", allowed void or",
        ),
        ("void alias x y", "a.rad, line 1: alias: found \"y\""),
        (
            "void sphere a 0 0 3 0 0 0",
            "a.rad, line 1: real arguments: found 3, allowed 4",
        ),
        (
            "void polygon a 0 0 8 0 0 0 1 0 0 1 1",
            "a.rad, line 1: real arguments: found 8",
        ),
        (
            "void polygon a 0 0 9 0 0 0 1 0 0 0 nan 0",
            "a.rad, line 1: real arguments: found NaN",
        ),
        (
            "void sphere a 0 0 4 0 0 1e300 1",
            "a.rad, line 1: coordinates: found 0 0 1",
        ),
        ("void cylinder a 0 0 7 0 0 0 0 0 0 1", "a.rad, line 1: ends"),
        ("void ring a 0 0 8 0 0 0 0 0 1 1 1", "a.rad, line 1: radii"),
        ("void source a 0 0 4 0 0 0 1", "a.rad, line 1: direction"),
        ("!xform a.rad", "a.rad, line 1: file: found"),
        (
            "!rm -rf x",
            "a.rad, line 1: command: found \"!rm -rf x\", allowed xform, genbox",
        ),
        ("!xform b.rad; ls", "a.rad, line 1: command: found ';'"),
        ("!xform -rq 3 a.rad", "a.rad, line 1: xform: found -rq"),
        (
            "!genbox m n 1 1 -1",
            "a.rad, line 1: command: found -1, allowed sizes above 0",
        ),
        ("!genbox m n 1 1 1 -r .6", "a.rad, line 1: command: found .6"),
        (
            "void instance i 1 x.oct 0 0",
            "a.rad, line 1: instance: found \"x.oct\", allowed a file .obj",
        ),
        (
            "void BSDF b 6 0 x.xml 0 0 1 . 0 0\nb sphere s 0 0 4 0 0 0 1",
            "a.rad, line 1: file: found \"x.xml\", which is not there",
        ),
        (
            "void mist m 0 0 0\nm sphere s 0 0 4 0 0 0 1",
            "a.rad, line 1: type: found mist",
        ),
        (
            "void plastic a 0 0 5 1 1 1 0 0\na metal b 0 0 5 1 1 1 0 0\nb sphere s 0 0 4 0 0 0 1",
            "a.rad, line 1: modifier: found \"a\", a second material",
        ),
        (
            "void polygon bow 0 0 12 0 0 0 4 4 0 4 0 0 0 3 0",
            "a.rad, line 1: polygon: found 4 corners whose edges cross",
        ),
        (
            "void light l 0 0 3 -1 0 0\nl sphere s 0 0 4 0 0 0 1",
            "a.rad, line 1: red green blue: found -1",
        ),
    ] {
        let e = load(text).err().unwrap();
        assert!(e.starts_with(wanted), "{text}: {e}");
    }
    let missing = read(&[PathBuf::from("no such file.rad")], &[]).err().unwrap();
    assert!(missing.to_string().contains("no such file.rad"), "{missing}");
}

#[test]
fn what_radiance_warns_of_is_a_warning() {
    let line = "white polygon a 0 0 9 0 0 0 1 0 0 2 0 0\n";
    let bent = "white polygon a 0 0 12 0 0 0 1 0 0 1 1 .1 0 1 0\n";
    for (text, wanted, triangles) in [(line, "without area", 0), (bent, "off its plane", 2)] {
        let loaded = load(&format!("{WHITE}{text}")).unwrap();
        assert_eq!(loaded.parts.triangles.len(), triangles);
        let warning = loaded.warnings[0].to_string();
        assert!(
            warning.contains("a.rad, line 2: ") && warning.contains(wanted),
            "{warning}"
        );
    }
    let turned = load(&format!("{WHITE}white sphere a 0 0 4 0 0 0 -1\n")).unwrap();
    assert!(matches!(
        turned.parts.shapes[0].0,
        Shape::Sphere { inward: true, .. }
    ));
    assert_eq!(turned.warnings.len(), 1);
}

#[test]
fn a_name_means_the_last_modifier_above_and_aliases_follow() {
    let text = "void glow w 0 0 4 1 1 1 0\nw sphere a 0 0 4 0 0 0 1\nvoid glow w 0 0 4 2 2 2 0\n\
                void alias v w\nv sphere b 0 0 4 5 0 0 1\nvoid glow w 0 0 4 3 3 3 0\n";
    close(look(text, Vec3::new(0.0, 0.0, 5.0), Vec3::ZERO), Vec3::ONE);
    let other = look(text, Vec3::new(5.0, 0.0, 5.0), Vec3::new(5.0, 0.0, 0.0));
    close(other, Vec3::splat(2.0));
}
