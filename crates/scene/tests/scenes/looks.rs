//! Textures, mixtures and pictures show what they show in RADIANCE.

use gonio_scene::read;

use super::*;

/// A sun of 0.1 degrees alone lights a disk of radius 5 of the material `m`.
const SUN: &str = "void light sun 0 0 3 1e6 1e6 1e6\nsun source s 0 0 4 .3 .5 .8 .1\n";
const DISK: &str = "m ring f 0 0 8 0 0 0 0 0 1 0 5\n";
const RAYS: [[[f32; 3]; 2]; 3] = [
    [[0.3, 0.2, 3.], [0., 0., -1.]],
    [[-0.8, -1.3, 2.], [0.3, 0.1, -1.]],
    [[0.5, -0.5, 2.], [-0.2, 0.4, -1.]],
];

fn picture() -> Vec<u8> {
    let mut bytes = b"#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 2 +X 4\n".to_vec();
    for pixel in [
        [128, 0, 0, 129],
        [0, 128, 0, 129],
        [0, 0, 128, 129],
        [128, 128, 0, 129],
        [64, 64, 64, 129],
        [200, 10, 10, 129],
        [10, 200, 10, 129],
        [128, 128, 128, 130],
    ] {
        bytes.extend(pixel);
    }
    bytes
}

fn scene_of(text: &str) -> Result<gonio_scene::Loaded, String> {
    let dir = tempfile::tempdir().unwrap();
    let write = |name: &str, bytes: &[u8]| std::fs::write(dir.path().join(name), bytes).unwrap();
    write("a.rad", text.as_bytes());
    write("a.dat", b"1\n0 1 3\n0 .5 1\n");
    write("p.hdr", &picture());
    write(
        "noop.cal",
        b"u = Px + 1; v = Py + .5; grey(r,g,b) = (r+g+b)/3; same(x) = x; up(x,y,z) = x; none(x,y,z) = 0;",
    );
    write(
        "smooth.obj",
        b"v -5 -5 0\nv 5 -5 0\nv 0 5 0\nvn .1 .2 1\nvn .1 .2 1\nvn .1 .2 1\nf 1//1 2//2 3//3\n",
    );
    let folder = format!("{}/", dir.path().display());
    read(&[dir.path().join("a.rad")], &[]).map_err(|e| e.to_string().replace(&folder, ""))
}

fn seen(scene: &Scene, from: [f32; 3], along: [f32; 3], samples: u32) -> (Vec3, f32) {
    let limits = Limits::default();
    let (from, along) = (Vec3::from(from), Vec3::from(along).normalize());
    let (mut sum, mut square) = (Vec3::ZERO, 0.0);
    for index in 0..samples {
        let mut sampler = Sampler::new(3, 0, index);
        let one = scene.radiance(from, along, &limits, &mut sampler);
        sum += one;
        square += one.y * one.y;
    }
    let n = samples as f32;
    let mean = sum / n;
    (mean, ((square / n - mean.y * mean.y).max(0.0) / n).sqrt())
}

/// Against what `rtrace -ab 0 -st 0 -ss 16 -lw 1e-7` of RADIANCE 6 prints.
#[track_caller]
fn as_rtrace(text: &str, wanted: [[f32; 3]; 3]) {
    let loaded = scene_of(&format!("{SUN}{text}{DISK}")).unwrap();
    assert!(loaded.warnings.is_empty(), "{:?}", loaded.warnings);
    let scene = Scene::new(loaded.parts).unwrap();
    for ([from, along], wanted) in RAYS.into_iter().zip(wanted) {
        close(seen(&scene, from, along, 64), Vec3::from(wanted));
    }
}

#[test]
fn textures_turn_the_normal_as_in_radiance() {
    as_rtrace(
        "void texfunc t 4 .3 .1*Px -.05 . 0 0\nt plastic m 0 0 5 .5 .4 .3 0 0\n",
        [
            [3.338149e-01, 2.670519e-01, 2.002889e-01],
            [3.242487e-01, 2.593989e-01, 1.945492e-01],
            [3.300887e-01, 2.640710e-01, 1.980532e-01],
        ],
    );
    // Turned and scaled with its transform.
    as_rtrace(
        "void texfunc t 8 .3*Px .1 0 . -rz 30 -s 2 0 0\nt metal m 0 0 5 .5 .4 .3 .3 .1\n",
        [
            [2.430204e-01, 1.944163e-01, 1.458123e-01],
            [2.109523e-01, 1.687618e-01, 1.265714e-01],
            [2.269874e-01, 1.815899e-01, 1.361924e-01],
        ],
    );
    as_rtrace(
        "void texdata t 10 up none none a.dat a.dat a.dat noop.cal Px/2+.5 -rz 0 0 0\nt plastic m 0 0 5 .5 .4 .3 .05 .1\n",
        [
            [3.048402e-01, 2.438722e-01, 1.829041e-01],
            [3.121290e-01, 2.497032e-01, 1.872774e-01],
            [3.117278e-01, 2.499342e-01, 1.881406e-01],
        ],
    );
}

#[test]
fn mixtures_add_their_two_materials_as_in_radiance() {
    let two = "void plastic a 0 0 5 .8 .2 .1 0 0\nvoid plastic b 0 0 5 .1 .2 .9 .05 .1\n";
    let matt = "void plastic a 0 0 5 .8 .2 .1 0 0\nvoid plastic b 0 0 5 .1 .2 .9 0 0\n";
    as_rtrace(
        &format!("{two}void mixfunc n 4 a b .3 . 0 0\nvoid mixfunc m 4 n a .25 . 0 0\n"),
        [
            [4.164131e-01, 1.220115e-01, 1.428589e-01],
            [4.172192e-01, 1.228176e-01, 1.436650e-01],
            [4.164442e-01, 1.220426e-01, 1.428899e-01],
        ],
    );
    as_rtrace(
        "void colorfunc c 4 1 .5 .25 . 0 0\nc plastic a 0 0 5 .8 .2 .1 0 0\nvoid plastic b 0 0 5 .1 .2 .9 .05 .1\n\
         void mixfunc m 4 a b .3+.2*Px . 0 0\n",
        [
            [2.146749e-01, 9.700662e-02, 3.423131e-01],
            [1.746990e-01, 1.059566e-01, 3.968041e-01],
            [1.974417e-01, 9.934376e-02, 3.628666e-01],
        ],
    );
    as_rtrace(
        &format!("{matt}void mixdata m 6 a b same a.dat noop.cal Px+.5 0 0\n"),
        [
            [4.061773e-01, 1.230840e-01, 1.600092e-01],
            [1.907802e-01, 1.230840e-01, 4.061773e-01],
            [3.200185e-01, 1.230840e-01, 2.584764e-01],
        ],
    );
}

#[test]
fn pictures_colour_and_mix_as_in_radiance() {
    let coloured =
        "void colorpict p 7 red green blue p.hdr noop.cal u v 0 0\np plastic m 0 0 5 .5 .5 .5 0 0\n";
    let mixed = "void plastic a 0 0 5 .8 .2 .1 0 0\nvoid plastic b 0 0 5 .1 .2 .9 0 0\n\
                 void mixpict m 7 a b grey p.hdr noop.cal u v 0 0\n";
    // The second ray meets the disk beyond the edge of the picture, where RADIANCE carries the slope on.
    for (text, k, wanted) in [
        (coloured, 0, [1.526530e-02, 1.493596e-01, 2.130411e-01]),
        (coloured, 2, [3.798296e-02, 1.515472e-01, 1.660192e-01]),
        (mixed, 0, [2.377861e-01, 1.230840e-01, 3.524562e-01]),
        (mixed, 2, [2.274650e-01, 1.230840e-01, 3.642517e-01]),
    ] {
        let scene = Scene::new(scene_of(&format!("{SUN}{text}{DISK}")).unwrap().parts).unwrap();
        let [from, along] = RAYS[k];
        close(seen(&scene, from, along, 64), Vec3::from(wanted));
    }
}

#[test]
fn a_mixture_with_nothing_lets_its_share_of_light_through() {
    // A screen that is open by .3 of its area, above a glow of radiance 1: the eye sees .3 of it, and a floor below the
    // screen gets .3 of the light of the sky.
    let screen = "void plastic black 0 0 5 0 0 0 0 0\nvoid mixfunc m 4 void black .3 . 0 0\n";
    let up = format!("{screen}void glow g 0 0 4 1 1 1 -1\ng ring below 0 0 8 0 0 -1 0 0 1 0 9\n{DISK}");
    let scene = Scene::new(scene_of(&up).unwrap().parts).unwrap();
    close(
        seen(&scene, [0.1, 0.2, 3.0], [0.0, 0.0, -1.0], 4096),
        Vec3::splat(0.3),
    );
    let lit = format!(
        "{screen}void light l 0 0 3 1e4 1e4 1e4\nl source sun 0 0 4 0 0 1 .5\nm ring s 0 0 8 0 0 3 0 0 1 0 9\n\
         void plastic white 0 0 5 .5 .5 .5 0 0\nwhite ring f 0 0 8 0 0 0 0 0 1 0 5\n"
    );
    let scene = Scene::new(scene_of(&lit).unwrap().parts).unwrap();
    let half = 0.25_f32.to_radians();
    close(
        seen(&scene, [0.1, 0.2, 2.0], [0.0, 0.0, -1.0], 256),
        Vec3::splat(0.3 * 0.5 * 1e4 * half.sin().powi(2)),
    );
}

#[test]
fn smooth_meshes_and_textures_neither_make_light_nor_swallow_much() {
    // Under an even sky of radiance 1 what is seen is the albedo, of tilted normals as well, but for light that the
    // tilted lobe sends below the surface.
    let sky = "void glow g 0 0 4 1 1 1 0\ng source sky 0 0 4 0 0 1 360\n";
    for text in [
        "void plastic m 0 0 5 .8 .8 .8 0 0\nm mesh a 1 smooth.obj 0 0\n",
        "void texfunc t 4 .1 .2 0 . 0 0\nt plastic m 0 0 5 .8 .8 .8 0 0\nm polygon p 0 0 9 -5 -5 0 5 -5 0 0 5 0\n",
    ] {
        let scene = Scene::new(scene_of(&format!("{sky}{text}")).unwrap().parts).unwrap();
        let (found, error) = seen(&scene, [0.1, 0.2, 3.0], [0.0, 0.0, -1.0], 1 << 14);
        // The lobe tilted by alpha = atan(|(.1, .2)|) loses (1 - cos alpha) / 2.
        let lost = 0.5 * (1.0 - 1.0 / 1.05_f32.sqrt());
        close((found, error), Vec3::splat(0.8 * (1.0 - lost)));
    }
}

#[test]
fn smooth_normals_light_a_flat_triangle_as_one_that_is_tilted() {
    let text = format!("{SUN}void plastic m 0 0 5 .5 .4 .3 0 0\nm mesh a 1 smooth.obj 0 0\n");
    let scene = Scene::new(scene_of(&text).unwrap().parts).unwrap();
    let sun = Vec3::new(0.3, 0.5, 0.8).normalize();
    let normal = Vec3::new(0.1, 0.2, 1.0).normalize();
    let half = 0.05_f32.to_radians();
    let irradiance = 1e6 * std::f32::consts::PI * half.sin().powi(2) * normal.dot(sun);
    let wanted = Vec3::new(0.5, 0.4, 0.3) * irradiance * std::f32::consts::FRAC_1_PI;
    close(seen(&scene, [0.1, 0.2, 3.0], [0.0, 0.0, -1.0], 64), wanted);
}

#[test]
fn mixtures_that_cannot_be_are_refused_with_their_place() {
    let deep: String = (0..10)
        .map(|k| format!("void mixfunc n{} 4 n{k} void .5 . 0 0\n", k + 1))
        .collect();
    let nested = format!("void plastic n0 0 0 5 1 1 1 0 0\n{deep}n10 sphere s 0 0 4 0 0 0 1\n");
    for (text, wanted) in [
        (
            "void light l 0 0 3 1 1 1\nvoid mixfunc m 4 l void .5 . 0 0\nm sphere s 0 0 4 0 0 0 1\n",
            "a.rad, line 1: mixture: found a light",
        ),
        (
            "void mixfunc m 4 a void .5 . 0 0\nm sphere s 0 0 4 0 0 0 1\n",
            "a.rad, line 1: mixture: found \"a\"",
        ),
        (
            "void mixfunc m 4 m void .5 . 0 0\nm sphere s 0 0 4 0 0 0 1\n",
            "a.rad, line 1: mixture: found \"m\"",
        ),
        (
            "void dielectric d 0 0 5 1 1 1 1.5 0\nvoid mixfunc m 4 d void .5 . 0 0\nm sphere s 0 0 4 0 0 0 1\n",
            "a.rad, line 1: mixture: found dielectric",
        ),
        (
            "void mixfunc m 1 void 0 0\nm sphere s 0 0 4 0 0 0 1\n",
            "a.rad, line 1: string arguments: found 1",
        ),
        (
            "void mixtext m 4 void void a b 0 0\nm sphere s 0 0 4 0 0 0 1\n",
            "a.rad, line 1: type: found mixtext",
        ),
        (
            "void mixpict m 7 void void f no.hdr . 0 0 0 0\nm sphere s 0 0 4 0 0 0 1\n",
            "a.rad, line 1: file: found \"no.hdr\"",
        ),
        (
            "void colorpict p 7 red green blue a.dat . 0 0 0 0\np plastic m 0 0 5 1 1 1 0 0\nm sphere s 0 0 4 0 0 0 1\n",
            "a.dat, line 1: picture",
        ),
        (
            "void texfunc t 3 0 0 . 0 0\nt plastic m 0 0 5 1 1 1 0 0\nm sphere s 0 0 4 0 0 0 1\n",
            "a.rad, line 1: string arguments: found 3",
        ),
        (nested.as_str(), "a.rad, line 3: mixture: found \"n2\""),
    ] {
        let e = scene_of(text).err().unwrap();
        assert!(e.starts_with(wanted), "{text}: {e}");
    }
}
