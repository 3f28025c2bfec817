//! Scenes of RADIANCE text become what they say, and bad ones one clear error with file and line.
#![allow(clippy::unwrap_used, clippy::panic, missing_docs)]

use std::path::PathBuf;

use glam::Vec3;
use gonio_scene::{Loaded, read};
use gonio_trace::camera::Camera;
use gonio_trace::path::Limits;
use gonio_trace::render::{Effort, Picture};
use gonio_trace::sampler::Sampler;
use gonio_trace::scene::{Parts, Scene};
use gonio_trace::shape::Shape;

/// A scene of one file, in a folder of its own.
fn load(text: &str) -> Result<Loaded, String> {
    load_with(text, &[])
}

fn load_with(text: &str, more: &[(&str, &str)]) -> Result<Loaded, String> {
    let dir = tempfile::tempdir().unwrap();
    let file = dir.path().join("a.rad");
    std::fs::write(&file, text).unwrap();
    for (name, text) in more {
        std::fs::write(dir.path().join(name), text).unwrap();
    }
    let folder = format!("{}/", dir.path().display());
    read(&[file], &[]).map_err(|e| e.to_string().replace(&folder, ""))
}

fn parts(text: &str) -> Parts {
    match load(text) {
        Ok(loaded) => {
            assert!(loaded.warnings.is_empty(), "{:?}", loaded.warnings);
            loaded.parts
        }
        Err(e) => panic!("{e}"),
    }
}

/// Mean radiance from a point towards another, and its standard error.
fn look(text: &str, from: Vec3, to: Vec3) -> (Vec3, f32) {
    let scene = Scene::new(parts(text)).unwrap();
    let limits = Limits::default();
    let (mut sum, mut square) = (Vec3::ZERO, 0.0);
    for pixel in 0..64 {
        let mut mean = Vec3::ZERO;
        for index in 0..256 {
            let mut sampler = Sampler::new(3, pixel, index);
            mean += scene.radiance(from, (to - from).normalize(), &limits, &mut sampler) / 256.0;
        }
        sum += mean / 64.0;
        square += mean.y * mean.y / 64.0;
    }
    (sum, ((square - sum.y * sum.y).max(0.0) / 63.0).sqrt())
}

/// Four standard errors and a thousandth for single precision and facets; false alarm 6e-5 a comparison.
#[track_caller]
fn close((found, error): (Vec3, f32), wanted: Vec3) {
    let off = (found - wanted).abs();
    let allowed = Vec3::splat(4.0 * error) + 1e-3 * wanted.abs();
    assert!(
        off.cmple(allowed + 1e-7).all(),
        "{found} +- {error}, wanted {wanted}"
    );
}

const WHITE: &str = "void plastic white 0 0 5 .5 .5 .5 0 0\n";
const FLOOR: &str =
    "void plastic white 0 0 5 .5 .5 .5 0 0\nwhite polygon f 0 0 12 -9 -9 0 9 -9 0 9 9 0 -9 9 0\n";
/// Above the floor, below what is tested at height 4.
const EYE: Vec3 = Vec3::new(0.0, 0.0, 3.0);

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
        ("!genbox m n 1 1 1 -r .1", "a.rad, line 1: command: found -r"),
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

#[test]
fn lights_of_every_shape_give_the_irradiance_of_their_size() {
    let lit = |light: &str| {
        let text = format!("{FLOOR}void light l 0 0 3 8 4 2\nl {light}\n");
        look(&text, EYE, Vec3::ZERO)
    };
    // Radiance of the floor: rho times irradiance over pi.
    let floor = |over_pi: f32| 0.5 * over_pi * Vec3::new(8.0, 4.0, 2.0);
    // A disk at height h: E = pi L r^2 / (r^2 + h^2).
    close(lit("ring s 0 0 8 0 0 4 0 0 -1 0 1"), floor(1.0 / 17.0));
    let hollow = lit("ring s 0 0 8 0 0 4 0 0 -1 .5 1");
    close(hollow, floor(1.0 / 17.0 - 0.25 / 16.25));
    // A sphere: E = pi L (r / d)^2.
    close(lit("sphere s 0 0 4 0 0 5 1"), floor(1.0 / 25.0));
    // The sun: E = pi L sin^2.
    let sin = 1.0_f32.to_radians().sin();
    close(lit("source s 0 0 4 0 0 1 2"), floor(sin * sin));
    // A long thin cylinder across: E = pi L r / h.
    close(lit("cylinder s 0 0 7 -300 0 4 300 0 4 .01"), floor(0.01 / 4.0));
    // Inside a luminous half bubble the floor sees nothing but it: E = pi L.
    close(lit("bubble s 0 0 4 0 0 0 5"), floor(1.0));
}

#[test]
fn a_spotlight_lights_its_cone_only() {
    let text = &format!("{FLOOR}void spotlight l 0 0 7 8 8 8 60 0 0 -1\nl ring s 0 0 8 0 0 4 0 0 -1 0 .01\n");
    close(
        look(text, EYE, Vec3::ZERO),
        Vec3::splat(0.5 * 8.0 * 1e-4 / (16.0 + 1e-4)),
    );
    let lamp = Vec3::new(0.0, 0.0, 4.0);
    assert_eq!(look(text, EYE, Vec3::new(3.0, 0.0, 0.0)).0, Vec3::ZERO);
    assert_eq!(look(text, Vec3::new(0.0, 5.0, 0.5), lamp).0, Vec3::ZERO);
    close(look(text, Vec3::new(0.0, 1.0, 0.5), lamp), Vec3::splat(8.0));
}

#[test]
fn a_glow_of_negative_radius_is_seen_and_lights_nothing() {
    for radius in [0.0, 2.0, -1.0] {
        let text = format!("{FLOOR}void glow l 0 0 4 8 8 8 {radius}\nl ring s 0 0 8 0 0 4 0 0 -1 0 1\n");
        close(look(&text, EYE, Vec3::new(0.0, 0.0, 4.0)), Vec3::splat(8.0));
        let lit = if radius < 0.0 { 0.0 } else { 4.0 / 17.0 };
        close(look(&text, EYE, Vec3::ZERO), Vec3::splat(lit));
    }
}

#[test]
fn an_illum_lights_for_what_lies_behind_it_and_is_seen_as_its_other_material() {
    // A round window that faces down, behind it a red sky; the rest of the ceiling is black.
    for (alternate, seen) in [
        ("0", [3., 0., 0.]),
        ("1 void", [3., 0., 0.]),
        ("1 dark", [0., 0., 0.]),
    ] {
        let text = format!(
            "{FLOOR}void glow g 0 0 4 3 0 0 1\ng source sky 0 0 4 0 0 1 180\nvoid plastic dark 0 0 5 0 0 0 0 0\n\
             void illum l {alternate} 0 3 2 2 2\nl ring s 0 0 8 0 0 4 0 0 -1 0 1\n\
             dark ring t 0 0 8 0 0 4 0 0 -1 1 900\n"
        );
        close(look(&text, EYE, Vec3::new(0.0, 0.0, 4.0)), Vec3::from(seen));
        close(look(&text, EYE, Vec3::ZERO), Vec3::splat(0.5 * 2.0 / 17.0));
    }
}

#[test]
fn a_sky_of_glow_lights_the_ground_and_windows_become_portals() {
    let text = "void glow g 0 0 4 3 2 1 0\ng source sky 0 0 4 0 0 1 180\n\
                void plastic white 0 0 5 .5 .5 .5 0 0\nwhite ring f 0 0 8 0 0 0 0 0 1 0 5\n";
    close(look(text, Vec3::Z, Vec3::ZERO), Vec3::new(1.5, 1.0, 0.5));
    let window = "void glass w 0 0 3 .96 .96 .96\nw polygon p 0 0 12 0 0 1 1 0 1 1 1 1 0 1 1\n\
                  w polygon q 0 0 9 0 0 2 1 0 2 1 1 2\n";
    assert_eq!(parts(&format!("{text}{window}")).portals.len(), 1);
    assert_eq!(parts(window).portals.len(), 0);
}

#[test]
fn meshes_of_all_three_formats_are_the_same_triangle() {
    let obj = "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";
    let header = "property float x\nproperty float y\nproperty float z\nelement face 1\n\
                  property list uchar int vertex_indices\nend_header\n";
    let ply = &format!("ply\nformat ascii 1.0\nelement vertex 3\n{header}0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n");
    let stl = "solid a\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\nendloop\n\
               endfacet\nendsolid a\n";
    for (name, text) in [("m.obj", obj), ("m.ply", ply), ("m.stl", stl)] {
        let main = format!("{WHITE}white mesh m 6 {name} -mx -t 0 0 5 0 0\n");
        let p = load_with(&main, &[(name, text)]).unwrap().parts;
        assert_eq!(p.triangles.len(), 1, "{name}");
        let [a, b, c] = p.triangles[0].map(|k| Vec3::from(p.vertices[k as usize]));
        assert!((b - a).cross(c - a).z > 0.9, "{name}");
        assert_eq!(a.z, 5.0);
    }
    let few = &format!("ply\nformat ascii 1.0\nelement vertex 1\n{header}0 0 0\n3 0 1 2\n");
    let far = "v 0 0 0\nf 1 2 9\n";
    let cut = "solid a\nfacet\n";
    for (name, text) in [("m.obj", far), ("m.ply", few), ("m.stl", cut)] {
        let main = format!("{WHITE}white mesh m 1 {name} 0 0\n");
        let e = load_with(&main, &[(name, text)]).err().unwrap();
        assert!(e.starts_with(name), "{e}");
    }
}

#[test]
fn the_cornell_box_has_the_mean_radiance_that_rpict_finds() {
    // Mean of RADIANCE 6 by path tracing to five bounces: .4259 .4038 .3573; more bounces add a little.
    let text = "void plastic white 0 0 5 .75 .75 .75 0 0\nvoid plastic red 0 0 5 .63 .06 .05 0 0\n\
        void plastic green 0 0 5 .15 .48 .09 0 0\nvoid light lamp 0 0 3 15 15 15\n\
        white polygon floor 0 0 12 0 0 0  1 0 0  1 1 0  0 1 0\nwhite polygon ceil 0 0 12 0 0 1  0 1 1  1 1 1  1 0 1\n\
        white polygon back 0 0 12 0 1 0  1 1 0  1 1 1  0 1 1\nred polygon left 0 0 12 0 0 0  0 1 0  0 1 1  0 0 1\n\
        green polygon right 0 0 12 1 0 0  1 0 1  1 1 1  1 1 0\n\
        lamp polygon src 0 0 12 .35 .35 .998  .35 .65 .998  .65 .65 .998  .65 .35 .998\n\
        !genbox white tall .3 .3 .6 | xform -rz 18 -t .15 .5 .001\n\
        !genbox white short .3 .3 .3 | xform -rz -17 -t .58 .2 .001\n";
    let scene = Scene::new(parts(text)).unwrap();
    let words = "-vtv -vp .5 -1.35 .5 -vd 0 1 0 -vu 0 0 1 -vh 39 -vv 39";
    let words: Vec<&str> = words.split(' ').collect();
    let view = gonio_scene::view::parse(gonio_scene::view::STANDARD, &words).unwrap();
    let mut picture = Picture::new(64, 64);
    let effort = Effort {
        samples: 256,
        relative_error: None,
        limits: Limits {
            bounces: 6,
            roulette: 6,
        },
        seed: 5,
    };
    let camera = Camera::new(view).unwrap();
    picture.render(&scene, &camera, &effort, &Default::default(), &|_| {});
    let mut mean = [0.0; 3];
    for p in &picture.pixels {
        for (m, x) in mean.iter_mut().zip(p.mean()) {
            *m += x / picture.pixels.len() as f64;
        }
    }
    for (m, wanted) in mean.iter().zip([0.4259, 0.4038, 0.3573]) {
        assert!((m / wanted - 1.0).abs() < 0.01, "{mean:?}");
    }
}

#[test]
fn patterns_colour_what_they_touch_and_follow_their_transform() {
    // Stripes along x, scaled by two and shifted by one.
    let cal = "stripes = if(frac(Px) - .5, A1, A2);";
    let text = "void brightfunc s 8 stripes s.cal -s 2 -t 1 0 0 0 2 .8 .2\n\
                s glow g 0 0 4 1 2 3 0\ng polygon p 0 0 12 -9 -9 0 9 -9 0 9 9 0 -9 9 0\n";
    let scene = Scene::new(load_with(text, &[("s.cal", cal)]).unwrap().parts).unwrap();
    let seen = |x: f32| {
        let mut sampler = Sampler::new(1, 0, 0);
        scene.radiance(Vec3::new(x, 0.0, 1.0), -Vec3::Z, &Limits::default(), &mut sampler)
    };
    for (x, factor) in [(1.5, 0.2), (2.5, 0.8), (3.5, 0.2), (4.5, 0.8)] {
        assert!(
            seen(x).distance(factor * Vec3::new(1.0, 2.0, 3.0)) < 1e-5,
            "{x} {}",
            seen(x)
        );
    }
    for (text, wanted) in [
        (
            "void brightfunc s 2 Px+ . 0 0\ns glow g 0 0 4 1 1 1 0\ng sphere p 0 0 4 0 0 0 1",
            "a.rad, line 1: function",
        ),
        (
            "void brightfunc s 2 A1 . 0 0\ns glow g 0 0 4 1 1 1 0\ng sphere p 0 0 4 0 0 0 1",
            "a.rad, line 1: function",
        ),
        (
            "void brightfunc s 2 Px no.cal 0 0\ns glow g 0 0 4 1 1 1 0\ng sphere p 0 0 4 0 0 0 1",
            "a.rad, line 1: file",
        ),
    ] {
        let e = load(text).err().unwrap();
        assert!(e.starts_with(wanted), "{e}");
    }
}

#[test]
fn a_pattern_colours_the_body_of_plastic_and_all_of_metal() {
    // Under an even sky of radiance 1 what is seen is the albedo.
    let seen = |material: &str| {
        let text = format!(
            "void glow g 0 0 4 1 1 1 0\ng source sky 0 0 4 0 0 1 180\nvoid colorfunc c 4 1 .5 0 . 0 0\n\
             c {material}\nm ring f 0 0 8 0 0 0 0 0 1 0 5\n"
        );
        look(&text, Vec3::new(0.0, 0.0, 1.0), Vec3::ZERO)
    };
    close(seen("plastic m 0 0 5 .8 .8 .8 0 0"), Vec3::new(0.8, 0.4, 0.0));
    let glossy = "plastic m 0 0 5 .8 .8 .8 .1 .1";
    let (found, error) = seen(glossy);
    // The gloss of specularity .1 is the same in all channels, the body takes the pattern.
    let body = 0.8 * 0.9;
    let gloss = found.z;
    assert!(gloss > 0.05 && gloss < 0.11, "{gloss}");
    close((found - gloss, 2.0 * error), Vec3::new(body, 0.5 * body, 0.0));
    let (metal, _) = seen("metal m 0 0 5 .8 .8 .8 .5 .1");
    assert!(
        metal.z == 0.0 && (metal.x / metal.y - 2.0).abs() < 0.01,
        "{metal}"
    );
}

#[test]
fn the_sky_of_a_pattern_lights_by_its_luminance() {
    // Radiance max(Dz, 0): irradiance 2 pi / 3; a floor of reflectance .5 shows a third.
    let text = "void brightfunc up 2 if(Dz,Dz,0) . 0 0\nup glow g 0 0 4 1 1 1 0\ng source sky 0 0 4 0 0 1 180\n\
                void plastic white 0 0 5 .5 .5 .5 0 0\nwhite ring f 0 0 8 0 0 0 0 0 1 0 5\n";
    close(look(text, Vec3::Z, Vec3::ZERO), Vec3::splat(1.0 / 3.0));
}

#[test]
fn data_patterns_shape_the_light_of_a_lamp() {
    // Brightness by the angle from straight down in degrees: 1 at 0, 0 at 90.
    let data = "1\n0 90 2\n1 0\n";
    let cal = "twice(v) = 2*v; down = acos(-Dz)*180/PI;";
    let main = format!(
        "{FLOOR}void brightdata d 4 twice lamp.dat lamp.cal 180-down 0 0\nd light l 0 0 3 8 8 8\n\
         l ring s 0 0 8 0 0 4 0 0 -1 0 .01\n"
    );
    let parts = load_with(&main, &[("lamp.dat", data), ("lamp.cal", cal)])
        .unwrap()
        .parts;
    let scene = Scene::new(parts).unwrap();
    let seen = |from: Vec3| {
        let mut sampler = Sampler::new(1, 0, 0);
        let to = (Vec3::new(0.0, 0.0, 4.0) - from).normalize();
        scene.radiance(from, to, &Limits::default(), &mut sampler).x
    };
    assert!((seen(EYE) - 16.0).abs() < 0.1);
    assert!((seen(Vec3::new(1.0, 0.0, 3.0)) - 8.0).abs() < 0.1);
}

#[test]
fn anisotropic_materials_lie_as_in_radiance() {
    // What `rtrace -ab 0 -st 0 -ss 16 -lw 1e-7` of RADIANCE 6 prints for these rays, under a sun of 0.1 degrees.
    let sun = "void light sun 0 0 3 1e7 1e7 1e7\nsun source s 0 0 4 .3 .5 .8 .1\n";
    let brushed = "void metal2 m 8 1 .3 0 . -rz 30 -rx 10 0 6 .8 .7 .6 1 .05 .25\n\
                   !genbox m box 2 2 .1 | xform -t -1 -1 -.1 -rz 20 -ry 5\n";
    let coated = "void plastic2 m 4 0 1 0 . 0 6 .3 .4 .5 .2 .3 .1\nm ring f 0 0 8 0 0 0 .1 .2 1 0 5\n";
    let rays = [
        ([0., 0., 3.], [0.02, 0.01, -1.]),
        ([-0.8, -1.3, 2.], [0.8, 1.3, -2.]),
        ([-0.5, -1.5, 2.2], [0.5, 1.4, -2.]),
    ];
    let wanted_brushed = [
        [0.0; 3],
        [19.30581, 16.89258, 14.47936],
        [77.18406, 67.53605, 57.88805],
    ];
    let wanted_coated = [
        [11.01492, 11.57347, 12.13202],
        [5.277549, 5.836096, 6.394644],
        [11.03746, 11.59601, 12.15456],
    ];
    for (text, wanted) in [(brushed, wanted_brushed), (coated, wanted_coated)] {
        for ((from, along), wanted) in rays.iter().zip(wanted) {
            let from = Vec3::from(*from);
            let found = look(&format!("{sun}{text}"), from, from + Vec3::from(*along));
            close((found.0, found.1.max(1e-6)), Vec3::from(wanted));
        }
    }
}

/// Words from which damaged scenes are made.
const WORDS: [&str; 40] = [
    "void",
    "white",
    "polygon",
    "sphere",
    "ring",
    "cone",
    "source",
    "light",
    "glow",
    "illum",
    "plastic",
    "metal2",
    "alias",
    "inherit",
    "a",
    "b",
    "0",
    "1",
    "3",
    "4",
    "5",
    "8",
    "9",
    "12",
    "-1",
    "1e300",
    "nan",
    ".5",
    "\n!xform",
    "\n!genbox",
    "-a",
    "-i",
    "-rz",
    "|",
    "xform",
    "\n",
    "#",
    "'",
    "glass",
    "BSDF",
];

proptest::proptest! {
    #[test]
    fn no_text_makes_the_reader_panic_or_hang(
        picks in proptest::collection::vec(0..WORDS.len(), 0..60),
        bytes in proptest::collection::vec(proptest::prelude::any::<u8>(), 0..40),
        cut in 0_usize..200,
    ) {
        let mut text = format!("{FLOOR}{}", picks.iter().map(|k| WORDS[*k]).collect::<Vec<_>>().join(" ")).into_bytes();
        let files = gonio_scene::text::Files::default();
        for _ in 0..2 {
            if let Ok(entries) = gonio_scene::text::read_from("a.rad".as_ref(), &text, &files)
                && let Ok(loaded) = gonio_scene::assemble::assemble(entries, &files)
            {
                let _ = Scene::new(loaded.parts);
            }
            text.splice(cut.min(text.len())..(cut + 5).min(text.len()), bytes.iter().copied());
        }
        let words = String::from_utf8_lossy(&bytes).into_owned();
        let _ = gonio_scene::view::parse(gonio_scene::view::STANDARD, &words.split(' ').collect::<Vec<_>>());
    }
}
