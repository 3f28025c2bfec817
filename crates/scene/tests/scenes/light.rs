//! Lamps, skies, meshes and the Cornell box.

use glam::Vec3;
use gonio_trace::camera::Camera;
use gonio_trace::path::Limits;
use gonio_trace::render::{Effort, Picture};
use gonio_trace::scene::Scene;

use crate::{EYE, FLOOR, WHITE, close, load_with, look, parts};

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
        // A unit length of the direction: the focus lies a unit behind the lamp.
        Vec3::splat(0.5 * 8.0 * 1e-4 / (25.0 + 1e-4)),
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
fn the_aft_clipping_plane_ends_what_the_eye_sees_but_not_what_a_mirror_shows() {
    // A pane of glass at 2 to the left, a wall of radiance 5 at 4 to the right, an even sky: as rpict shows them, a clipped
    // pane shows the sky that it mirrors (.0747 .149 .223 there) and nothing behind it.
    let text = "void glow g 0 0 4 1 2 3 0\ng source up 0 0 4 0 1 0 360\nvoid glow h 0 0 4 5 5 5 0\n\
        h polygon a 0 0 12 0 4 -9 9 4 -9 9 4 9 0 4 9\nvoid glass w 0 0 3 .9 .9 .9\n\
        w polygon b 0 0 12 -9 2 -9 -9 2 9 0 2 9 0 2 -9\n";
    let scene = Scene::new(parts(text)).unwrap();
    for letter in ["v", "l", "a", "c"] {
        for (aft, pane, wall) in [
            ("1.9", 0.0, 0.0),
            ("3.9", 0.0747, 0.0),
            ("4.2", 0.0747, 5.0),
            ("0", 0.898, 5.0),
        ] {
            let words = format!("-vt{letter} -vd 0 1 0 -vh 10 -vv 10 -va {aft}");
            let words: Vec<&str> = words.split(' ').collect();
            let view = gonio_scene::view::parse(gonio_scene::view::STANDARD, &words).unwrap();
            let mut picture = Picture::new(2, 1);
            let effort = Effort {
                samples: 8192,
                relative_error: None,
                limits: Limits::default(),
                seed: 5,
                share: true,
            };
            let camera = Camera::new(view).unwrap();
            picture.render(&scene, &camera, &effort, &Default::default(), &|_| {});
            for (pixel, wanted) in picture.pixels.iter().zip([pane, wall]) {
                let found = pixel.mean()[0];
                // Five standard errors of a choice between sky and mirror.
                let allowed = 0.02 * wanted + if wanted == 0.0747 { 0.015 } else { 0.0 };
                assert!(
                    (found - wanted).abs() <= allowed,
                    "{letter} {aft}: {found}, wanted {wanted}"
                );
            }
        }
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
        share: true,
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
