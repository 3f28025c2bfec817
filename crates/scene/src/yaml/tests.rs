use std::path::{Path, PathBuf};

use glam::Vec3;
use gonio_io::radiance_material::Body;
use gonio_trace::light::Light;

use super::*;
use crate::{Loaded, assemble};

/// Two squares of 2 x 2 m on each other, the lower of wood, the upper a lamp that looks down.
const ROOM: &str = "v 0 0 0\nv 2 0 0\nv 2 2 0\nv 0 2 0\nv 0 0 3\nv 2 0 3\nv 2 2 3\nv 0 2 3\nusemtl Floor\nf 1 2 3 4\n\
                    usemtl Lamp\nf 8 7 6 5\n";

fn folder() -> tempfile::TempDir {
    let dir = tempfile::tempdir().unwrap();
    std::fs::write(dir.path().join("room.obj"), ROOM).unwrap();
    std::fs::write(
        dir.path().join("lib.rad"),
        "void plastic oak 0 0 5 .4 .25 .1 0 0\n",
    )
    .unwrap();
    dir
}

fn load(text: &str) -> Result<Loaded, String> {
    let dir = folder();
    let path = dir.path().join("a.yaml");
    std::fs::write(&path, text).unwrap();
    let folder = format!("{}/", dir.path().display());
    assemble::read(&[path], &[]).map_err(|e| e.to_string().replace(&folder, ""))
}

fn entries(text: &str) -> Vec<Entry> {
    let dir = folder();
    read_from(&dir.path().join("a.yaml"), text.as_bytes(), &Files::default())
        .unwrap()
        .entries
}

const SCENE: &str = "\
radiance: [lib.rad]
materials:
  matt: {plastic: [.5, .5, .5, 0, 0]}
  gloss: plastic .2 .2 .2 .05 .1
  bright: {light: {lumens: 1000, colour: [1, .9, .8]}}
objects:
  - file: room.obj
    materials: {Floor: oak, Lamp: bright}
  - file: room.obj
    material: matt
    transform: -t 10 0 0
view: -vtv -vp 1 -5 1.5 -vd 0 1 0 -vh 60 -vv 40
";

#[test]
fn meshes_materials_and_lights_become_a_scene() {
    let loaded = load(SCENE).unwrap();
    assert!(loaded.warnings.is_empty(), "{:?}", loaded.warnings);
    assert_eq!(loaded.parts.triangles.len(), 8);
    let view = loaded.view.unwrap();
    assert_eq!((view.point, view.horizontal), (Vec3::new(1.0, -5.0, 1.5), 60.0));
    // Two triangles share 1000 lumens over 4 m2.
    assert_eq!(loaded.parts.lights.len(), 2);
    for light in &loaded.parts.lights {
        let Light::Flat(_) = light else {
            panic!("a flat light")
        };
        let c = light.radiance();
        let luminance = 179.0 * (0.2651 * c.x + 0.6701 * c.y + 0.0648 * c.z);
        assert!((luminance * std::f32::consts::PI * 4.0 / 1000.0 - 1.0).abs() < 1e-5);
        assert!((c.y / c.x - 0.9).abs() < 1e-6 && (c.z / c.x - 0.8).abs() < 1e-6);
    }
}

#[test]
fn units_and_the_axis_that_points_up_change_meshes_and_their_light() {
    let text = SCENE.replacen("radiance:", "units: cm\nup: y\nradiance:", 1);
    let parts = load(&text).unwrap().parts;
    let highest = parts.vertices.iter().map(|v| v[2]).fold(f32::MIN, f32::max);
    assert!((highest - 0.02).abs() < 1e-7, "{highest}");
    let whole = load(SCENE).unwrap().parts;
    let ratio = parts.lights[0].radiance().x / whole.lights[0].radiance().x;
    assert!((ratio - 1e4).abs() < 1.0, "{ratio}");
}

#[test]
fn names_that_one_object_gives_another_meaning_keep_theirs_for_the_next() {
    let text = "materials:\n  Floor: plastic .1 .1 .1 0 0\n  Lamp: plastic .2 .2 .2 0 0\n  red: plastic .9 0 0 0 0\nobjects:\n  \
                - {file: room.obj, materials: {Floor: red, Lamp: Floor}}\n  - {file: room.obj}\n";
    let parts = load(text).unwrap().parts;
    let looks: Vec<u32> = (0..8)
        .map(|k| parts.surfaces[parts.triangle_surface[k] as usize].material)
        .collect();
    let red = |k: u32| match &parts.materials[k as usize] {
        gonio_trace::material::Material::Diffuse { reflectance } => reflectance.x,
        _ => panic!("a Lambertian material"),
    };
    let found: Vec<f32> = looks.iter().map(|k| red(*k)).collect();
    assert_eq!(found, [0.9, 0.9, 0.1, 0.1, 0.1, 0.1, 0.2, 0.2]);
}

#[test]
fn skies_stand_where_place_and_time_put_the_sun() {
    let of = |sky: &str| -> Vec<(String, Vec<f64>)> {
        let all = entries(&format!("sky:\n  {}\n", sky.replace('\n', "\n  ")));
        let reals = all.into_iter().filter_map(|e| match e.item.body {
            Body::Other { type_word, reals, .. } => Some((type_word, reals)),
            _ => None,
        });
        reals.collect()
    };
    let source = |all: &[(String, Vec<f64>)]| {
        let found = all.iter().find(|(t, r)| t == "source" && r[3] < 1.0);
        found.map(|(_, r)| Vec3::new(r[0] as f32, r[1] as f32, r[2] as f32))
    };
    // East at 30 degrees.
    let sun = source(&of("kind: clear\nsun: {altitude: 30, azimuth: 90}")).unwrap();
    assert!(sun.distance(Vec3::new(0.75_f32.sqrt(), 0.0, 0.5)) < 1e-4, "{sun}");
    // North turned to the east turns the sun to the south.
    let sun = source(&of("kind: clear\nsun: {altitude: 30, azimuth: 90}\nnorth: 90")).unwrap();
    assert!(
        sun.distance(Vec3::new(0.0, -(0.75_f32.sqrt()), 0.5)) < 1e-4,
        "{sun}"
    );
    // Berlin, noon of the sun at 13:10 summer time: from the south, 90 - 52.5 + 23.4 degrees high.
    let berlin = "kind: perez\nplace: {latitude: 52.5, longitude: 13.4, time_zone: 2}\ntime: 2026-06-21 13:08\n\
                  direct_normal: 700\ndiffuse_horizontal: 150";
    let all = of(berlin);
    let sun = source(&all).unwrap();
    assert!((sun.z.asin().to_degrees() - 60.94).abs() < 0.1, "{sun}");
    assert!(sun.y < 0.0 && sun.x.abs() < 0.02, "{sun}");
    assert!(source(&of(&format!("{berlin}\nshow_sun: false"))).is_none());
    let loaded =
        load("sky: {kind: overcast, sun: {altitude: 40, azimuth: 180}, illuminance: 10000}\n").unwrap();
    assert!(loaded.parts.sky.is_some());
}

#[test]
fn panes_of_a_mesh_are_openings_for_the_sky() {
    let text = "materials: {pane: {glass: [.9, .9, .9]}, matt: plastic .5 .5 .5 0 0}\nobjects:\n  - file: room.obj\n    \
                materials: {Floor: matt, Lamp: pane}\nsky: {kind: uniform, sun: {altitude: 40, azimuth: 180}}\n";
    let parts = load(text).unwrap().parts;
    assert_eq!(parts.portals.len(), 1);
    let [corner, a, b] = parts.portals[0];
    assert!((a.cross(b).length() - 4.0).abs() < 1e-6 && corner.z == 3.0 && a.z == 0.0 && b.z == 0.0);
}

#[test]
fn what_is_wrong_is_named_by_line_and_field() {
    for (text, wanted) in [
        ("", "a.yaml, line 1: YAML: found 0 documents"),
        (
            "- a\n- b\n",
            "a.yaml, line 1: scene: found a list of 2, allowed units, up",
        ),
        ("materials: {\n", "a.yaml, line "),
        ("a: b: c\n", "a.yaml, line 1: YAML"),
        ("units: m\nunits: mm\n", "a.yaml, line 2: YAML"),
        (
            "\nlights: []\n",
            "a.yaml, line 2: lights: found a field \"lights\", allowed units, up, radiance",
        ),
        (
            "units: km\n",
            "a.yaml, line 1: units: found \"km\", allowed m, cm, mm, in, ft",
        ),
        ("materials: [a]\n", "a.yaml, line 1: materials: found a list of 1"),
        (
            "materials:\n  a: wood 1 2\n",
            "a.yaml, line 2: materials.a: found \"wood\", allowed a type of Radiance",
        ),
        (
            "materials:\n  a: plastic 1 x\n",
            "a.yaml, line 2: materials.a: found \"plastic 1 x\"",
        ),
        (
            "materials:\n  a:\n    plastic: [1, 1]\n",
            "a.yaml, line 3: materials.a.plastic: found real arguments",
        ),
        (
            "materials:\n  a: {plastic: [1, 1, .nan, 0, 0]}\n",
            "a.yaml, line 2: materials.a.plastic[3]: found NaN",
        ),
        (
            "materials:\n  a: {plastic: [.5, .5, .5, 0, 0], glass: [1, 1, 1]}\n",
            "a.yaml, line 2: materials.a: found 2 forms",
        ),
        (
            "materials:\n  a: {model: none.xml}\nobjects: [{file: room.obj, material: a}]\n",
            "a.yaml, line 2: file: found \"none.xml\"",
        ),
        (
            "materials:\n  a: {light: {lumens: 5}}\n",
            "a.yaml, line 2: materials.a.light.lumens: found no area",
        ),
        (
            "materials:\n  lamp: {light: {lumens: 5}}\nobjects: [{file: room.obj, material: lmap}]\n",
            "a.yaml, line 3: objects[1].material: found \"lmap\", allowed the name of a material of this scene: lamp, void",
        ),
        (
            "materials:\n  a: {light: {lumens: -5}}\n",
            "a.yaml, line 2: materials.a.light.lumens: found",
        ),
        (
            "materials:\n  a: {light: {}}\n",
            "a.yaml, line 2: materials.a.light: found 0 of them",
        ),
        (
            "materials:\n  a: {alias: b}\n",
            "a.yaml, line 2: alias: found \"b\"",
        ),
        (
            "objects:\n  - material: a\n",
            "a.yaml, line 2: objects[1]: found no field \"file\"",
        ),
        (
            "objects:\n  - file: none.obj\n    material: a\n",
            "a.yaml, line 2: objects[1].file: found \"none.obj\"",
        ),
        (
            "objects:\n  - file: room.obj\n    material: oak\n",
            "a.yaml, line 2: objects[1].material: found \"oak\"",
        ),
        (
            "objects:\n  - file: room.obj\n",
            "a.yaml, line 2: objects[1].materials.Floor: found \"Floor\"",
        ),
        (
            "materials: {b: plastic 1 1 1 0 0}\nobjects:\n  - file: room.obj\n    materials:\n      Wall: b\n",
            "a.yaml, line 5: objects[1].materials: found \"Wall\", allowed a material of the file: Floor, Lamp",
        ),
        (
            "objects:\n  - {file: room.obj, material: a, transform: -rz}\n",
            "a.yaml, line 2: objects[1].transform: found -rz",
        ),
        (
            "objects:\n  - {file: room.obj, material: a, transform: x}\n",
            "a.yaml, line 2: objects[1].transform: found \"x\"",
        ),
        (
            "radiance:\n  - none.rad\n",
            "a.yaml, line 2: radiance[1]: found \"none.rad\"",
        ),
        (
            "sky: {kind: blue}\n",
            "a.yaml, line 1: sky.kind: found \"blue\", allowed perez, clear",
        ),
        (
            "sky: {kind: clear}\n",
            "a.yaml, line 1: sky: found no place of the sun",
        ),
        (
            "sky: {kind: perez, sun: {altitude: 30, azimuth: 0}}\n",
            "a.yaml, line 1: sky: found a perez sky without",
        ),
        (
            "sky:\n  kind: clear\n  sun: {altitude: 95, azimuth: 0}\n",
            "a.yaml, line 3: sky.sun.altitude: found 95",
        ),
        (
            "sky:\n  kind: clear\n  place: {latitude: 1, longitude: 1, time_zone: 1}\n  time: 2026-02-30 10:00\n",
            "a.yaml, line 4: sky.time: found \"2026-02-30 10:00\"",
        ),
        ("view: -vtq\n", "a.yaml, line 1: view: found \"-vtq\""),
    ] {
        let e = load(text).err().unwrap_or_else(|| panic!("read: {text}"));
        assert!(e.starts_with(wanted), "{text}: {e}");
    }
    let deep = format!("a: {}{}", "[".repeat(100_000), "]".repeat(100_000));
    assert!(load(&deep).err().unwrap().contains("deep within"));
    let deep: String = (0..1000).map(|k| format!("{}a:\n", " ".repeat(k))).collect();
    assert!(load(&deep).err().unwrap().contains("deep within"));
    let laughs = "a: &a [1,1,1,1,1,1,1,1]\nb: &b [*a,*a,*a,*a,*a,*a,*a,*a]\nc: &c [*b,*b,*b,*b,*b,*b,*b,*b]\n\
                  d: &d [*c,*c,*c,*c,*c,*c,*c,*c]\ne: &e [*d,*d,*d,*d,*d,*d,*d,*d]\nf: &f [*e,*e,*e,*e,*e,*e,*e,*e]\n\
                  g: &g [*f,*f,*f,*f,*f,*f,*f,*f]\nh: [*g,*g,*g,*g,*g,*g,*g,*g]\n";
    assert!(load(laughs).is_err());
}

proptest::proptest! {
    #[test]
    fn no_text_makes_the_reader_panic(cut in 0_usize..400, bytes in proptest::collection::vec(proptest::prelude::any::<u8>(), 0..20)) {
        let mut text = SCENE.as_bytes().to_vec();
        text.splice(cut.min(text.len())..(cut + 4).min(text.len()), bytes.iter().copied());
        let dir = PathBuf::from("nowhere");
        let _ = read_from(&dir.join("a.yaml"), &text, &Files::default());
        let _ = read_from(Path::new("a.yaml"), &bytes, &Files::default());
    }
}
