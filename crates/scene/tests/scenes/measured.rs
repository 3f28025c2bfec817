//! Measured materials: light straight through, diffuse parts, thickness, up vectors that change.

use glam::Vec3;
use gonio_bsdf::klems::{Klems, KlemsBasis, KlemsMatrix};
use gonio_bsdf::{Channel, FourComponents};
use gonio_geom::{Component, Side};
use gonio_io::radiance_xml::{Material, RadianceXml, Tabulated, write_to};

use crate::{EYE, FLOOR, close, load_with, look_at, parts_of};

/// Transmittance that is diffuse, and that goes straight through.
const SPREAD: f64 = 0.2;
const STRAIGHT: f64 = 0.3;
/// Reflectance of either side.
const MIRRORED: f64 = 0.1;

/// The file of a curtain: diffuse, but for one patch of each column.
fn curtain() -> String {
    let basis = KlemsBasis::full();
    let n = basis.len();
    let lambda = basis.lambda().to_vec();
    let flat = |rho: f64, peak: f64| {
        let value = |k: usize| {
            let (o, i) = (k / n, k % n);
            let here = if o == i { peak / lambda[o] } else { 0.0 };
            (rho / std::f64::consts::PI + here) as f32
        };
        KlemsMatrix::new(basis.clone(), basis.clone(), (0..n * n).map(value).collect()).unwrap()
    };
    let mut all = FourComponents::default();
    for side in Side::BOTH {
        all.set(side, Component::Reflection, Some(flat(MIRRORED, 0.0)));
        all.set(side, Component::Transmission, Some(flat(SPREAD, STRAIGHT)));
    }
    let xml = RadianceXml {
        material: Material::default(),
        model: Tabulated::Klems(Klems::new(Channel::Photopic, all)),
    };
    let mut text = Vec::new();
    write_to(&mut text, &xml).unwrap();
    String::from_utf8(text).unwrap()
}

fn seen(text: &str, from: Vec3, to: Vec3) -> (Vec3, f32) {
    let file = curtain();
    let files = [("c.xml", file.as_str()), ("up.cal", "ux = Px; uy = 1; uz = 0;")];
    look_at(parts_of(load_with(text, &files)), from, to)
}

const PANE: &str = "polygon p 0 0 12 -9 -9 2 9 -9 2 9 9 2 -9 9 2\n";
const EVEN: &str = "void glow g 0 0 4 1 1 1 0\ng source sky 0 0 4 0 0 1 360\n";

#[test]
fn an_absdf_shows_what_lies_behind_it_sharp_and_a_bsdf_spreads_it() {
    // A glowing ball far behind the pane; all else is black but for the diffuse light of the ball itself, which is little.
    let ball = "void glow b 0 0 4 100 100 100 0\nb sphere s 0 0 4 0 0 -200 1\n";
    let sharp = seen(
        &format!("{ball}void aBSDF m 5 c.xml 0 1 0 . 0 0\nm {PANE}"),
        EYE,
        Vec3::ZERO,
    );
    close(sharp, Vec3::splat(100.0 * STRAIGHT as f32));
    let beside = seen(
        &format!("{ball}void aBSDF m 5 c.xml 0 1 0 . 0 0\nm {PANE}"),
        EYE,
        Vec3::new(0.3, 0.0, 0.0),
    );
    assert!(beside.0.x < 0.1, "{beside:?}");
    let (spread, _) = seen(
        &format!("{ball}void BSDF m 6 0 c.xml 0 1 0 . 0 0\nm {PANE}"),
        EYE,
        Vec3::ZERO,
    );
    assert!(spread.x < 10.0, "{spread}");
}

#[test]
fn an_absdf_keeps_all_light_of_its_table() {
    // Under an even sky what goes straight and what is spread add up to what the file says, from any direction.
    let all = (SPREAD + STRAIGHT + MIRRORED) as f32;
    for kind in ["BSDF m 6 0", "aBSDF m 5"] {
        for to in [Vec3::ZERO, Vec3::new(2.0, 1.0, 0.0), Vec3::new(0.0, -6.0, 0.0)] {
            let text = format!("{EVEN}void {kind} c.xml 0 1 0 . 0 0\nm {PANE}");
            close(seen(&text, EYE, to), Vec3::splat(all));
        }
    }
}

#[test]
fn diffuse_parts_stand_beside_those_of_the_file_on_their_side() {
    let all = (SPREAD + STRAIGHT + MIRRORED) as f32;
    let below = Vec3::new(0.5, 0.0, -3.0);
    for (reals, front, back) in [
        ("0", [0.0; 3], [0.0; 3]),
        ("3 .1 .2 .05", [0.1, 0.2, 0.05], [0.0; 3]),
        ("6 .1 .2 .05 .3 0 .2", [0.1, 0.2, 0.05], [0.3, 0.0, 0.2]),
        ("9 .1 .2 .05 .3 0 .2 0 .1 .1", [0.1, 0.3, 0.15], [0.3, 0.1, 0.3]),
    ] {
        let text = format!("{EVEN}void BSDF m 6 0 c.xml 0 1 0 . 0 {reals}\nm {PANE}");
        close(seen(&text, EYE, Vec3::ZERO), Vec3::from(front) + all);
        close(seen(&text, below, Vec3::ZERO), Vec3::from(back) + all);
    }
    let files = [("c.xml", curtain())];
    for (reals, found) in [
        ("4 .1 .1 .1 .1", "found 4, allowed 0, 3, 6 or 9"),
        ("3 .1 .1 2", "found 2, allowed 0 to 1"),
    ] {
        let text = format!("void BSDF m 6 0 c.xml 0 1 0 . 0 {reals}\nm {PANE}");
        let files: Vec<_> = files.iter().map(|(a, b)| (*a, b.as_str())).collect();
        let e = load_with(&text, &files).err().unwrap();
        assert!(e.contains("line 1") && e.contains(found), "{e}");
    }
}

#[test]
fn a_pattern_leaves_the_gloss_of_a_bsdf() {
    // All of this file's reflection is diffuse: half of everything stays.
    let all = 0.5 * (SPREAD + STRAIGHT + MIRRORED) as f32;
    let text = format!("{EVEN}void brightfunc h 2 .5 . 0 0\nh aBSDF m 5 c.xml 0 1 0 . 0 0\nm {PANE}");
    close(seen(&text, EYE, Vec3::ZERO), Vec3::splat(all));
}

#[test]
fn a_proxy_hides_what_lies_within_its_thickness_from_scattered_light_alone() {
    // A black plate under the proxy: the eye sees it, the floor sees the sky through the proxy as if it were not there.
    let sky = "void glow g 0 0 4 1 1 1 0\ng source sky 0 0 4 0 0 1 180\n";
    let plate =
        "void plastic black 0 0 5 0 0 0 0 0\nblack polygon b 0 0 12 -90 -90 4 90 -90 4 90 90 4 -90 90 4\n";
    let proxy = |thickness: &str, z: f64| {
        format!(
            "void BSDF m 6 {thickness} c.xml 0 1 0 . 0 0\n\
             m polygon p 0 0 12 -90 -90 {z} 90 -90 {z} 90 90 {z} -90 90 {z}\n"
        )
    };
    let floor = 0.5 * (SPREAD + STRAIGHT) as f32;
    // Rays up from the floor arrive at the back of the surface: with a negative thickness they meet the proxy there.
    let text = format!("{FLOOR}{sky}{plate}{}", proxy("-.5", 3.8));
    let wanted = floor / (1.0 - 0.5 * MIRRORED as f32);
    close(seen(&text, EYE, Vec3::ZERO), Vec3::splat(wanted));
    // The eye sees the plate from below: black.
    close(seen(&text, EYE, Vec3::new(0.0, 0.0, 9.0)), Vec3::ZERO);
    // With a thickness that is positive the back of the surface is not there; a little comes in far beside the plate.
    let text = format!("{FLOOR}{sky}{plate}{}", proxy(".5", 3.8));
    assert!(seen(&text, EYE, Vec3::ZERO).0.x < 0.002);
    // Nor without the plate: the floor sees the sky itself.
    let text = format!("{FLOOR}{sky}{}", proxy("1/2", 3.8));
    close(seen(&text, EYE, Vec3::ZERO), Vec3::splat(0.5));
}

#[test]
fn the_sun_shines_through_a_proxy_and_is_scattered_by_it() {
    let sun = "void light l 0 0 3 5000 5000 5000\nl source sun 0 0 4 .1 0 1 2\n";
    let sheet = |thickness: &str| {
        format!(
            "{FLOOR}{sun}void BSDF m 6 {thickness} c.xml 0 1 0 . 0 0\n\
             m polygon p 0 0 12 -5 -5 3.8 5 -5 3.8 5 5 3.8 -5 5 3.8\n"
        )
    };
    let open = seen(&format!("{FLOOR}{sun}"), EYE, Vec3::ZERO).0;
    let scattered = seen(&sheet("0"), EYE, Vec3::ZERO).0;
    assert!(
        scattered.x > 0.1 * open.x && scattered.x < 0.9 * open.x,
        "{scattered} {open}"
    );
    close(seen(&sheet("-.5"), EYE, Vec3::ZERO), open + scattered);
}

#[test]
fn an_up_vector_may_be_a_function_of_the_place() {
    let lamp = "void light l 0 0 3 80 80 80\nl ring s 0 0 8 2 0 6 0 0 -1 0 .5\n";
    let floor = |kind: &str, up: &str| {
        format!("{lamp}void {kind}\nm polygon f 0 0 12 -9 -9 0 9 -9 0 9 9 0 -9 9 0\n").replace("UP", up)
    };
    let metal = "metal2 m 4 UP 0 6 .5 .5 .5 .8 .05 .3";
    for at in [-0.7_f32, 0.0, 1.5] {
        let to = Vec3::new(at, 0.0, 0.0);
        let turned = seen(&floor(metal, "ux uy uz up.cal"), EYE, to);
        let fixed = seen(&floor(metal, &format!("{at} 1 0 .")), EYE, to);
        close(turned, fixed.0);
    }
    // It matters.
    let one = seen(&floor(metal, "ux uy uz up.cal"), EYE, Vec3::new(1.5, 0.0, 0.0)).0;
    let other = seen(&floor(metal, "0 1 0 ."), EYE, Vec3::new(1.5, 0.0, 0.0)).0;
    assert!((one.x / other.x - 1.0).abs() > 0.05, "{one} {other}");
}
