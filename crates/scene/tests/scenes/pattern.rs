//! Patterns, and anisotropic materials beside RADIANCE.

use glam::Vec3;
use gonio_trace::path::Limits;
use gonio_trace::sampler::Sampler;
use gonio_trace::scene::Scene;

use crate::{EYE, FLOOR, close, load, load_with, look};

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
